// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3d;

constexpr double kNear = 0.05;  // (m); corners nearer than this are not projected

/// Pixels this near to an edge (px) belong to both sides, so that rounding opens no gaps.
constexpr double kOnEdge = 1e-9;

/// Keeps the surface where it is nearer than what was drawn before.
void drawSpan(float* inverse_depths, std::uint32_t* ids, int first, int last, float start,
              float slope, std::uint32_t id) {
  for (int u = first; u <= last; ++u) {
    const float inverse_depth = start + slope * static_cast<float>(u);
    const bool nearer = inverse_depth > inverse_depths[u];
    inverse_depths[u] = nearer ? inverse_depth : inverse_depths[u];
    ids[u] = nearer ? id : ids[u];
  }
}

}  // namespace

Rasterizer::Rasterizer(int width, int height)
    : width_(width),
      height_(height),
      inverse_depths_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      ids_(inverse_depths_.size()) {}

void Rasterizer::draw(const std::vector<Instance>& instances,
                      const Eigen::Isometry3d& world_to_camera, const PinholeCamera& camera) {
  instances_ = &instances;
  camera_ = camera;
  surfaces_.clear();
  std::fill(inverse_depths_.begin(), inverse_depths_.end(), 0.0f);
  std::fill(ids_.begin(), ids_.end(), kNoSurface);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(instances.size()); ++i) {
    const Eigen::Isometry3d to_camera = world_to_camera * instances[i].to_world;
    if (!isOutOfView(instances[i], to_camera)) {
      drawInstance(i, to_camera);
    }
  }
}

bool Rasterizer::isOutOfView(const Instance& instance, const Eigen::Isometry3d& to_camera) const {
  const Vector3d centre = to_camera * instance.body->centre.cast<double>();
  const auto radius = static_cast<double>(instance.body->radius);
  if (centre.z() + radius < kNear) {
    return true;
  }
  const auto beyond = [&](double x, double tangent) {
    return x - tangent * centre.z() > radius * std::hypot(1.0, tangent);
  };
  return beyond(-centre.x(), camera_.cx / camera_.fx) ||
         beyond(centre.x(), (width_ - camera_.cx) / camera_.fx) ||
         beyond(-centre.y(), camera_.cy / camera_.fy) ||
         beyond(centre.y(), (height_ - camera_.cy) / camera_.fy);
}

void Rasterizer::drawInstance(std::uint32_t index, const Eigen::Isometry3d& to_camera) {
  const Mesh& mesh = (*instances_)[index].body->mesh;
  corners_.clear();
  for (const Vertex& vertex : mesh.vertices) {
    corners_.emplace_back(to_camera * vertex.position.cast<double>());
  }
  for (std::uint32_t t = 0; t < static_cast<std::uint32_t>(mesh.triangles.size()); ++t) {
    const auto& corners = mesh.triangles[t].corners;
    const Vector3d& a = corners_[corners[0]];
    const Vector3d& b = corners_[corners[1]];
    const Vector3d& c = corners_[corners[2]];
    const Vector3d bc = c.cross(b);
    const double determinant = a.dot(bc);
    if (determinant < 1e-12 || (a.z() < kNear && b.z() < kNear && c.z() < kNear)) {
      continue;  // seen from behind, on edge, or behind the camera
    }
    double v_min = 0.0;
    double v_max = height_ - 1.0;
    if (a.z() > kNear && b.z() > kNear && c.z() > kNear) {
      const double va = a.y() / a.z();
      const double vb = b.y() / b.z();
      const double vc = c.y() / c.z();
      v_min = std::max(v_min, std::ceil(camera_.fy * std::min({va, vb, vc}) + camera_.cy - 1e-6));
      v_max = std::min(v_max, std::floor(camera_.fy * std::max({va, vb, vc}) + camera_.cy + 1e-6));
      if (v_min > v_max) {
        continue;
      }
    }
    Surface surface;
    surface.barycentric.row(0) = bc;
    surface.barycentric.row(1) = a.cross(c);
    surface.barycentric.row(2) = b.cross(a);
    surface.barycentric /= determinant;
    surface.instance = index;
    surface.triangle = t;
    drawSurface(surface, v_min, v_max);
  }
}

void Rasterizer::drawSurface(const Surface& surface, double v_min, double v_max) {
  // Each barycentric coordinate over the depth, as a function of the pixel: a u + b v + c.
  std::array<Vector3d, 3> edges;
  for (int i = 0; i < 3; ++i) {
    const Vector3d n = surface.barycentric.row(i);
    const double a = n.x() / camera_.fx;
    const double b = n.y() / camera_.fy;
    edges[static_cast<std::size_t>(i)] = {a, b, n.z() - a * camera_.cx - b * camera_.cy};
  }
  const Vector3d depth_plane = edges[0] + edges[1] + edges[2];
  const auto id = static_cast<std::uint32_t>(surfaces_.size());
  bool drawn = false;
  const auto stride = static_cast<std::size_t>(width_);
  for (int v = static_cast<int>(v_min); v <= static_cast<int>(v_max); ++v) {
    double u_min = 0.0;
    double u_max = width_ - 1.0;
    for (const Vector3d& edge : edges) {
      const double rest = edge.y() * v + edge.z();
      if (edge.x() > 0.0) {
        u_min = std::max(u_min, std::ceil(-rest / edge.x() - kOnEdge));
      } else if (edge.x() < 0.0) {
        u_max = std::min(u_max, std::floor(-rest / edge.x() + kOnEdge));
      } else if (rest < 0.0) {
        u_max = -1.0;
      }
    }
    if (u_min > u_max) {
      continue;
    }
    drawn = true;
    const std::size_t row = static_cast<std::size_t>(v) * stride;
    drawSpan(inverse_depths_.data() + row, ids_.data() + row, static_cast<int>(u_min),
             static_cast<int>(u_max), static_cast<float>(depth_plane.y() * v + depth_plane.z()),
             static_cast<float>(depth_plane.x()), id);
  }
  if (drawn) {
    surfaces_.push_back(surface);
  }
}

}  // namespace hmcdyn::synthesize
