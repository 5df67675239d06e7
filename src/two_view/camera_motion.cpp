// SPDX-License-Identifier: BSD-3-Clause
#include "two_view/camera_motion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "se3.hpp"

namespace hmcdyn::internal {
namespace {

using se3::Matrix6d;
using se3::Vector6d;

/// A point in the current camera's frame, and where it was seen in the earlier image.
struct Sighting {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;
};

std::vector<Sighting> sightingsOf(const PinholeCamera& camera, const PointPairsView& pairs,
                                  Span<const float> depth, Span<const std::uint8_t> may_speak) {
  std::vector<Sighting> sightings;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (may_speak[i] != 0 && hasDepth(depth[i]) && std::isfinite(pairs.earlier_u[i]) &&
        std::isfinite(pairs.earlier_v[i])) {
      sightings.push_back({camera.unproject(pairs.current_u[i], pairs.current_v[i], depth[i]),
                           {pairs.earlier_u[i], pairs.earlier_v[i]}});
    }
  }
  return sightings;
}

/// At most so many, evenly: a step's cost grows with their number, its precision hardly.
std::vector<Sighting> someOf(const std::vector<Sighting>& all) {
  constexpr std::size_t kEnough = 150;
  if (all.size() <= kEnough) {
    return all;
  }
  std::vector<Sighting> some;
  some.reserve(kEnough);
  for (std::size_t k = 0; k < kEnough; ++k) {
    some.push_back(all[k * all.size() / kEnough]);
  }
  return some;
}

constexpr double kNearest = 0.05;  // m: nearer, or behind the camera, nothing is seen

/// One Gauss-Newton step of the motion that takes points into the earlier camera's frame.
Vector6d stepOf(const PinholeCamera& camera, const std::vector<Sighting>& sightings,
                const Eigen::Isometry3d& earlier_from_current, double scale) {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const Sighting& sighting : sightings) {
    const Eigen::Vector3d p = earlier_from_current * sighting.point;
    if (p.z() < kNearest) {
      continue;
    }
    const Eigen::Vector2d residual = camera.project(p) - sighting.pixel;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera.fx / p.z(), 0.0, -camera.fx * p.x() / (p.z() * p.z()), 0.0,
        camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
    Eigen::Matrix<double, 3, 6> by_step;
    by_step << 0.0, p.z(), -p.y(), 1.0, 0.0, 0.0, -p.z(), 0.0, p.x(), 0.0, 1.0, 0.0, p.y(), -p.x(),
        0.0, 0.0, 0.0, 1.0;
    const Eigen::Matrix<double, 2, 6> jacobian = by_point * by_step;
    const double share = scale * scale / (scale * scale + residual.squaredNorm());
    const double weight = share * share;  // Geman-McClure
    information += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
  }
  // What nothing determines stays as predicted: 1e-3 px^2 a radian or metre^2 are nothing else.
  information.diagonal().array() += 1e-3;
  return -information.ldlt().solve(gradient);
}

}  // namespace

std::optional<CameraMotion> fitCameraMotion(const PinholeCamera& camera,
                                            const PointPairsView& pairs, Span<const float> depth,
                                            Span<const std::uint8_t> may_speak,
                                            const Eigen::Isometry3d& predicted, float uncertainty,
                                            const TwoViewOptions& options) {
  const std::vector<Sighting> sightings = sightingsOf(camera, pairs, depth, may_speak);
  if (sightings.size() < static_cast<std::size_t>(options.min_matches)) {
    return std::nullopt;
  }
  const std::vector<Sighting> some = someOf(sightings);
  const double finest = options.inlier_threshold;
  double scale = std::max(static_cast<double>(uncertainty), finest);
  Eigen::Isometry3d earlier_from_current = predicted.inverse();
  constexpr int kMostSteps = 20;
  constexpr double kNarrowing = 0.7;
  constexpr double kConverged = 1e-6;  // rad, m
  for (int k = 0; k < kMostSteps; ++k) {
    const Vector6d step = stepOf(camera, some, earlier_from_current, scale);
    if (!step.allFinite()) {
      return std::nullopt;
    }
    earlier_from_current = se3::motionOf(step) * earlier_from_current;
    if (scale <= finest && step.norm() < kConverged) {
      break;
    }
    scale = std::max(kNarrowing * scale, finest);
  }
  CameraMotion motion;
  motion.current_from_earlier = earlier_from_current.inverse();
  motion.points = sightings.size();
  for (const Sighting& sighting : sightings) {
    const Eigen::Vector3d p = earlier_from_current * sighting.point;
    if (p.z() >= kNearest && (camera.project(p) - sighting.pixel).norm() <= 2.0 * finest) {
      ++motion.inliers;
    }
  }
  return motion;
}

}  // namespace hmcdyn::internal
