// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "synthesize/mesh.hpp"

namespace hmcdyn::synthesize {

/// Diffuse light of a room: sky light from above, one window side, lamps.
struct Lighting {
  struct Lamp {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< (m)
    float strength = 1.0f;                               ///< Factor of albedo at 1 m, head on.
  };
  float ambient = 0.46f;                                  ///< From everywhere.
  float sky = 0.16f;                                      ///< More from above than below.
  Eigen::Vector3f window_direction{-0.8f, -0.35f, 0.5f};  ///< Towards the window.
  float window = 0.22f;                                   ///< On a surface that faces it.
  std::vector<Lamp> lamps;

  /// Factor of a surface's albedo, 0.15..1.35.
  float at(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;
};

/// A mesh that is rigid, and its light at each vertex.
struct LitMesh {
  Mesh mesh;
  std::vector<float> light;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< Of the bounding sphere (m).
  float radius = 0.0f;                               ///< Of the bounding sphere (m).
};

/// Adds the bounding sphere; the light stays empty.
LitMesh bounded(Mesh mesh);

/// Adds the bounding sphere and the light of a mesh that stands still in the world.
/// @param glow above 0: the surface shines by itself with this factor (a screen, a lamp).
LitMesh litStill(Mesh mesh, const Lighting& lighting, float glow = 0.0f);

/// Light at each vertex of a mesh that moves.
std::vector<float> lightOf(const LitMesh& body, const Eigen::Isometry3d& to_world,
                           const Lighting& lighting);

}  // namespace hmcdyn::synthesize
