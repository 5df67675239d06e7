// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmcdyn::synthesize {

struct Vertex {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< (m)
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();   ///< Unit length, outwards.
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();        ///< Texture coordinates.
};

/// Seen from outside the corners run counter-clockwise; from inside it is invisible.
struct Triangle {
  std::array<std::uint32_t, 3> corners{};
  int texture = 0;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
};

/// How a surface is papered.
struct Material {
  int texture = 0;    ///< Number in the TextureLibrary.
  float tile = 0.0f;  ///< Side that one copy of the picture covers (m); 0 = whole surface.
  Eigen::Vector2f uv_min{0.0f, 0.0f};  ///< Part of the picture that is used when tile is 0.
  Eigen::Vector2f uv_max{1.0f, 1.0f};
};

/// A flat rectangle: `origin` is its upper left corner seen from outside, `right` and `down` its
/// sides (m). Cut into cells of at most `max_cell` (m), so that light can vary over it.
void addQuad(Mesh& mesh, const Eigen::Vector3f& origin, const Eigen::Vector3f& right,
             const Eigen::Vector3f& down, const Material& material, float max_cell = 1e9f);

/// The six faces of a box.
struct BoxMaterials {
  Material front;   ///< -y
  Material back;    ///< +y
  Material left;    ///< -x
  Material right;   ///< +x
  Material top;     ///< +z
  Material bottom;  ///< -z

  static BoxMaterials all(const Material& m) { return {m, m, m, m, m, m}; }
  static BoxMaterials topAndSides(const Material& t, const Material& s) {
    return {s, s, s, s, t, s};
  }
};

/// A box of `size` (m) whose centre and axes are `pose`.
void addBox(Mesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& size,
            const BoxMaterials& materials, float max_cell = 1e9f);

/// One cross section of a body of revolution-like shape along z: a superellipse.
struct Ring {
  float z = 0.0f;         ///< Height (m).
  float rx = 0.0f;        ///< Half axis along x (m).
  float ry = 0.0f;        ///< Half axis along y (m).
  float x = 0.0f;         ///< Centre (m).
  float y = 0.0f;         ///< Centre (m).
  float exponent = 2.0f;  ///< 2 = ellipse, more = towards a rectangle.
};

/// A skin over rings of rising z, in the frame of `pose`. Picture: u runs counter-clockwise around
/// from the -x side, so that +x shows the picture's middle; v runs down from the last ring.
/// The ends are closed where their ring has a size.
void addLoft(Mesh& mesh, const Eigen::Isometry3f& pose, const std::vector<Ring>& rings,
             int segments, const Material& material);

/// A cylinder or truncated cone between two points.
void addCylinder(Mesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to,
                 float from_radius, float to_radius, int segments, const Material& material);

/// An ellipsoid with half axes `radii` (m).
void addEllipsoid(Mesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& radii,
                  int segments, const Material& material);

/// A pose from a position (m) and a turn about z (rad).
Eigen::Isometry3f placed(float x, float y, float z, float yaw = 0.0f);

/// A pose given in the frame of `at`: position (m) and turn about its z (rad).
Eigen::Isometry3f moved(const Eigen::Isometry3f& at, float x, float y, float z, float yaw = 0.0f);

/// A point given in the frame of `at` (m).
Eigen::Vector3f point(const Eigen::Isometry3f& at, float x, float y, float z);

}  // namespace hmcdyn::synthesize
