// SPDX-License-Identifier: BSD-3-Clause
#include "pose_contenders.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <utility>

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <ceres/tiny_solver.h>
#include <ceres/version.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace hmcdyn::bench {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
const double kHuber = PoseRefinementOptions().huber_two_rows;

Eigen::Vector3d worldPoint(const PoseInput& input, std::size_t i) {
  return Eigen::Vector3f(input.x[i], input.y[i], input.z[i]).cast<double>();
}

Eigen::Vector2d pixel(const PoseInput& input, std::size_t i) {
  return Eigen::Vector2f(input.u[i], input.v[i]).cast<double>();
}

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Eigen::Isometry3d fromAngleAxis(const Vector6d& pose) {
  const double angle = pose.head<3>().norm();
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  if (angle > 0.0) {
    isometry.linear() = Eigen::AngleAxisd(angle, pose.head<3>() / angle).toRotationMatrix();
  }
  isometry.translation() = pose.tail<3>();
  return isometry;
}

Vector6d toAngleAxis(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd angle_axis(pose.linear());
  Vector6d vector;
  vector << angle_axis.angle() * angle_axis.axis(), pose.translation();
  return vector;
}

/// dh/dp of the pixel of a point p in the camera's frame.
Eigen::Matrix<double, 2, 3> pixelByPoint(const PinholeCamera& camera, const Eigen::Vector3d& p) {
  const double inverse_z = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> m;
  m << camera.fx * inverse_z, 0.0, -camera.fx * p.x() * inverse_z * inverse_z,  //
      0.0, camera.fy * inverse_z, -camera.fy * p.y() * inverse_z * inverse_z;
  return m;
}

// The usual way to optimise on SE(3) with analytic Jacobians: the cost function gives the
// derivative by the tangent, and the manifold's Jacobian passes it on unchanged.
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
class Se3Manifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    return tangentFirst(jacobian);
  }
  bool Minus(const double* /*y*/, const double* /*x*/, double* /*delta*/) const override {
    return false;  // the solver does not need it
  }
  bool MinusJacobian(const double* /*x*/, double* /*jacobian*/) const override { return false; }
#else
class Se3Manifold final : public ceres::LocalParameterization {
 public:
  int GlobalSize() const override { return 7; }
  int LocalSize() const override { return 6; }
  bool ComputeJacobian(const double* /*x*/, double* jacobian) const override {
    return tangentFirst(jacobian);
  }
#endif
  bool Plus(const double* x, const double* delta, double* sum) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(x);
    const Eigen::Map<const Eigen::Vector3d> t(x + 4);
    const Eigen::Map<const Eigen::Vector3d> omega(delta);
    const double angle = omega.norm();
    Eigen::Quaterniond step = Eigen::Quaterniond::Identity();
    if (angle > 0.0) {
      step = Eigen::AngleAxisd(angle, omega / angle);
    }
    Eigen::Map<Eigen::Quaterniond>{sum} = (step * q).normalized();
    Eigen::Map<Eigen::Vector3d>{sum + 4} = step * t + Eigen::Map<const Eigen::Vector3d>(delta + 3);
    return true;
  }

 private:
  static bool tangentFirst(double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

class AnalyticCost final : public ceres::SizedCostFunction<2, 7> {
 public:
  AnalyticCost(Eigen::Vector3d world, Eigen::Vector2d pixel, const PinholeCamera& camera)
      : world_(std::move(world)), pixel_(std::move(pixel)), camera_(camera) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
    const Eigen::Vector3d p = q * world_ + Eigen::Map<const Eigen::Vector3d>(parameters[0] + 4);
    Eigen::Map<Eigen::Vector2d>{residuals} = pixel_ - camera_.project(p);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
      const Eigen::Matrix<double, 2, 3> by_point = pixelByPoint(camera_, p);
      jacobian.leftCols<3>() = by_point * skew(p);
      jacobian.middleCols<3>(3) = -by_point;
      jacobian.col(6).setZero();
    }
    return true;
  }

 private:
  Eigen::Vector3d world_;
  Eigen::Vector2d pixel_;
  PinholeCamera camera_;
};

struct AutoDiffResidual {
  Eigen::Vector3d world;
  Eigen::Vector2d pixel;
  PinholeCamera camera;

  template <class T>
  bool operator()(const T* pose, T* residual) const {
    const std::array<T, 3> point{T(world.x()), T(world.y()), T(world.z())};
    std::array<T, 3> p{};
    ceres::AngleAxisRotatePoint(pose, point.data(), p.data());
    const T z = p[2] + pose[5];
    residual[0] = pixel.x() - camera.fx * ((p[0] + pose[3]) / z) - camera.cx;
    residual[1] = pixel.y() - camera.fy * ((p[1] + pose[4]) / z) - camera.cy;
    return true;
  }
};

ceres::LossFunction* weightedHuber(float weight) {
  return new ceres::ScaledLoss(new ceres::HuberLoss(kHuber),
                               static_cast<double>(weight) * static_cast<double>(weight),
                               ceres::TAKE_OWNERSHIP);
}

void solve(ceres::Problem& problem, double tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // faster here than DENSE_QR
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = tolerance;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

/// All residuals at once for TinySolver.
struct AllResiduals {
  using Scalar = double;
  // NOLINTNEXTLINE(readability-identifier-naming): TinySolver's names
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 6 };

  const PoseInput* input = nullptr;

  // NOLINTNEXTLINE(readability-identifier-naming)
  int NumResiduals() const { return 2 * static_cast<int>(input->x.size()); }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const Eigen::Map<const Vector6d> pose(parameters);
    const Eigen::Isometry3d isometry = fromAngleAxis(pose);
    const Eigen::Matrix3d left = leftJacobian(pose.head<3>());
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6>> j(jacobian, NumResiduals(), 6);
    for (std::size_t i = 0; i < input->x.size(); ++i) {
      const Eigen::Vector3d rotated = isometry.linear() * worldPoint(*input, i);
      const Eigen::Vector3d p = rotated + isometry.translation();
      const Eigen::Vector2d e = pixel(*input, i) - input->camera.project(p);
      const double s = e.squaredNorm();
      const bool beyond = s > kHuber * kHuber;
      // phi e with phi^2 s = rho(s), and its derivative.
      const double rho = beyond ? 2.0 * kHuber * std::sqrt(s) - kHuber * kHuber : s;
      const double phi = beyond ? std::sqrt(rho / s) : 1.0;
      const auto weight = static_cast<double>(input->weight[i]);
      Eigen::Map<Eigen::Vector2d>{residuals + 2 * i} = weight * phi * e;
      if (jacobian == nullptr) {
        continue;
      }
      const Eigen::Matrix<double, 2, 3> by_point = pixelByPoint(input->camera, p);
      Eigen::Matrix<double, 2, 6> by_pose;
      by_pose << by_point * skew(rotated) * left, -by_point;
      if (beyond) {
        const double slope = (kHuber * std::sqrt(s) - rho) / (2.0 * s * s * phi);  // dphi/ds
        const Eigen::Matrix2d scale =
            phi * Eigen::Matrix2d::Identity() + 2.0 * slope * e * e.transpose();
        by_pose = (scale * by_pose).eval();
      }
      j.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = weight * by_pose;
    }
    return true;
  }

  static Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& omega) {
    const double angle = omega.norm();
    if (angle < 1e-8) {
      return Eigen::Matrix3d::Identity() + 0.5 * skew(omega);
    }
    const Eigen::Matrix3d k = skew(omega / angle);
    return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle * k +
           (1.0 - std::sin(angle) / angle) * k * k;
  }
};

}  // namespace

double robustCost(const PoseInput& input, const Eigen::Isometry3d& pose) {
  double cost = 0.0;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    const Eigen::Vector3d p = pose * worldPoint(input, i);
    const double s = (pixel(input, i) - input.camera.project(p)).squaredNorm();
    const double rho = s > kHuber * kHuber ? 2.0 * kHuber * std::sqrt(s) - kHuber * kHuber : s;
    cost += std::pow(static_cast<double>(input.weight[i]), 2) * rho;
  }
  return cost;
}

double plainCost(const PoseInput& input, const Eigen::Isometry3d& pose) {
  double cost = 0.0;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    const Eigen::Vector3d p = pose * worldPoint(input, i);
    cost += (pixel(input, i) - input.camera.project(p)).squaredNorm();
  }
  return cost;
}

Eigen::Isometry3d solveWithCeres(const PoseInput& input, double tolerance) {
  Eigen::Matrix<double, 7, 1> pose;
  pose << Eigen::Quaterniond(input.initial.linear()).normalized().coeffs(),
      input.initial.translation();
  ceres::Problem problem;
  problem.AddParameterBlock(pose.data(), 7, new Se3Manifold);
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    problem.AddResidualBlock(new AnalyticCost(worldPoint(input, i), pixel(input, i), input.camera),
                             weightedHuber(input.weight[i]), pose.data());
  }
  solve(problem, tolerance);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(pose.head<4>()).normalized().toRotationMatrix();
  result.translation() = pose.tail<3>();
  return result;
}

Eigen::Isometry3d solveWithCeresAutoDiff(const PoseInput& input, double tolerance) {
  Vector6d pose = toAngleAxis(input.initial);
  ceres::Problem problem;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<AutoDiffResidual, 2, 6>(
            new AutoDiffResidual{worldPoint(input, i), pixel(input, i), input.camera}),
        weightedHuber(input.weight[i]), pose.data());
  }
  solve(problem, tolerance);
  return fromAngleAxis(pose);
}

struct TinySolverOverAllResiduals::Solver {
  ceres::TinySolver<AllResiduals> tiny;
};

TinySolverOverAllResiduals::TinySolverOverAllResiduals() : solver_(std::make_shared<Solver>()) {}

Eigen::Isometry3d TinySolverOverAllResiduals::operator()(const PoseInput& input,
                                                         double tolerance) const {
  Vector6d pose = toAngleAxis(input.initial);
  solver_->tiny.options.max_num_iterations = 100;
  // Absolute in TinySolver; the noise is 1 px, so the cost is of the order of the residuals.
  solver_->tiny.options.function_tolerance = tolerance * 2.0 * static_cast<double>(input.x.size());
  solver_->tiny.Solve(AllResiduals{&input}, &pose);
  return fromAngleAxis(pose);
}

Eigen::Isometry3d solveWithOpenCvDefaults(const PoseInput& input) {
  return solveWithOpenCv(input, FLT_EPSILON, 20);
}

Eigen::Isometry3d solveWithOpenCv(const PoseInput& input, double tolerance, int iterations) {
  std::vector<cv::Point3f> world;
  std::vector<cv::Point2f> pixels;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    world.emplace_back(input.x[i], input.y[i], input.z[i]);
    pixels.emplace_back(input.u[i], input.v[i]);
  }
  const PinholeCamera& camera = input.camera;
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  Vector6d pose = toAngleAxis(input.initial);
  cv::Vec3d rotation(pose[0], pose[1], pose[2]);
  cv::Vec3d translation(pose[3], pose[4], pose[5]);
  cv::solvePnPRefineLM(
      world, pixels, matrix, cv::noArray(), rotation, translation,
      cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, iterations, tolerance));
  pose << rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2];
  return fromAngleAxis(pose);
}

}  // namespace hmcdyn::bench
