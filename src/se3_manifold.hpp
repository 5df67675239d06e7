// SPDX-License-Identifier: BSD-3-Clause
// The steps of se3.hpp for Ceres. The one place that knows which of its interfaces there is:
// Manifold came with 2.1, LocalParameterization left with 2.2.
#pragma once

#include <Eigen/Core>
#include <ceres/problem.h>
#include <ceres/version.h>

#include "se3.hpp"

#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): the preprocessor asks for it
#define HMCDYN_CERES_HAS_MANIFOLD
#include <ceres/manifold.h>
#else
#include <ceres/local_parameterization.h>
#endif

namespace hmcdyn::se3 {

#ifdef HMCDYN_CERES_HAS_MANIFOLD
using ManifoldBase = ceres::Manifold;
#else
using ManifoldBase = ceres::LocalParameterization;
#endif

/// Poses of seven numbers that move by moved().
///
/// Ceres multiplies a cost's derivative by the seven numbers with PlusJacobian(). Here that is
/// (I6; 0), and a cost that goes with it writes its derivative by delta into the first six columns
/// and 0 into the seventh: the same product without the detour over the quaternion. It is no
/// manifold for costs that were not written for it, automatic derivatives among them. A template
/// for the reason that rotationOf() gives.
template <class Pose>
class ManifoldOf final : public ManifoldBase {
 public:
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    Eigen::Map<Pose>{x_plus_delta} =
        moved(Eigen::Map<const Pose>(x), Eigen::Map<const Vector6d>(delta));
    return true;
  }
#ifdef HMCDYN_CERES_HAS_MANIFOLD
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Lift>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>{y_minus_x} = between(Eigen::Map<const Pose>(x), Eigen::Map<const Pose>(y));
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
#else
  int GlobalSize() const override { return kPoseSize; }
  int LocalSize() const override { return 6; }
  bool ComputeJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Lift>{jacobian}.setIdentity();
    return true;
  }
#endif

 private:
  using Lift = Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>;
};
using Manifold = ManifoldOf<PoseVector>;

/// Says to Ceres that the manifold of a problem's poses is its owner's.
inline void keepManifold(ceres::Problem::Options& options) {
#ifdef HMCDYN_CERES_HAS_MANIFOLD
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
#else
  options.local_parameterization_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
#endif
}

}  // namespace hmcdyn::se3
