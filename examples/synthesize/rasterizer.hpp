// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "synthesize/lighting.hpp"

namespace hmcdyn::synthesize {

/// A mesh at a place.
struct Instance {
  const LitMesh* body = nullptr;
  const float* light = nullptr;  ///< One value a vertex of the mesh.
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
  int mover = -1;  ///< Number of the moving thing it is part of; -1 = the room.
};

/// A triangle as one camera sees it. With r = ((u - cx) / fx, (v - cy) / fy, 1) the ray of a pixel,
/// barycentric[i].dot(r) is the i-th barycentric coordinate divided by the depth, and their sum the
/// inverse depth, exact over the whole plane (homogeneous rasterisation, Olano and Greer 1997).
struct Surface {
  Eigen::Matrix3d barycentric;  ///< One row a corner.
  std::uint32_t instance = 0;
  std::uint32_t triangle = 0;

  double inverseDepth(const Eigen::Vector3d& ray) const {
    return barycentric.colwise().sum().dot(ray);
  }
};

inline constexpr std::uint32_t kNoSurface = 0xffffffffU;

/// Which surface each pixel's centre ray meets first.
class Rasterizer {
 public:
  Rasterizer(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Forgets what was drawn and draws `instances`. They are borrowed until the next call.
  void draw(const std::vector<Instance>& instances, const Eigen::Isometry3d& world_to_camera,
            const PinholeCamera& camera);

  /// Numbers of the surfaces of a row, kNoSurface where nothing was met.
  const std::uint32_t* row(int v) const {
    return ids_.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(width_);
  }
  const Surface& surface(std::uint32_t id) const { return surfaces_[id]; }
  const Instance& instance(const Surface& s) const { return (*instances_)[s.instance]; }
  const PinholeCamera& camera() const { return camera_; }

 private:
  bool isOutOfView(const Instance& instance, const Eigen::Isometry3d& to_camera) const;
  void drawInstance(std::uint32_t index, const Eigen::Isometry3d& to_camera);
  void drawSurface(const Surface& surface, double v_min, double v_max);

  int width_;
  int height_;
  PinholeCamera camera_;
  const std::vector<Instance>* instances_ = nullptr;
  std::vector<float> inverse_depths_;
  std::vector<std::uint32_t> ids_;
  std::vector<Surface> surfaces_;
  std::vector<Eigen::Vector3d> corners_;  // of the mesh being drawn, in the camera's frame
};

}  // namespace hmcdyn::synthesize
