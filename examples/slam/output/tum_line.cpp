// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/tum_line.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::slam {

std::string tumLine(double timestamp, const Eigen::Isometry3d& camera_from_world) {
  if (!std::isfinite(timestamp) || !camera_from_world.matrix().allFinite()) {
    throw std::invalid_argument(
        fmt::format("trajectory: stamp {} or its pose is not finite", timestamp));
  }
  const Eigen::Isometry3d pose = camera_from_world.inverse();
  const Eigen::Vector3d t = pose.translation();
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();  // of the two that mean this rotation, always the same
  }
  return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", timestamp, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace hmcdyn::slam
