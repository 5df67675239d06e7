// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/mesh.hpp"

#include <algorithm>
#include <cmath>

#include "synthesize/pi.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

std::uint32_t addVertex(Mesh& mesh, const Vector3f& position, const Vector3f& normal,
                        const Vector2f& uv) {
  mesh.vertices.push_back({position, normal, uv});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

/// Two triangles over corners given counter-clockwise seen from outside.
void addCell(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
             int texture) {
  mesh.triangles.push_back({{a, b, c}, texture});
  mesh.triangles.push_back({{a, c, d}, texture});
}

int cellsOf(float length, float max_cell) {
  return std::max(1, static_cast<int>(std::ceil(length / max_cell - 1e-4f)));
}

/// Where tiled surfaces start in their picture: different from surface to surface, so that two
/// desks do not carry the same knots.
Vector2f tileOffset(const Vector3f& origin) {
  const float a = std::abs(origin.dot(Vector3f(0.731f, 1.237f, 2.113f)));
  const float b = std::abs(origin.dot(Vector3f(1.417f, 0.619f, 0.953f)));
  return {a - std::floor(a), b - std::floor(b)};
}

/// A point on a superellipse and the outward direction there.
std::pair<Vector2f, Vector2f> onRing(const Ring& ring, float angle) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  const float power = 2.0f / ring.exponent;
  const Vector2f unit(std::copysign(std::pow(std::abs(c), power), c),
                      std::copysign(std::pow(std::abs(s), power), s));
  const Vector2f normal(std::copysign(std::pow(std::abs(c), 2.0f - power), c) * ring.ry,
                        std::copysign(std::pow(std::abs(s), 2.0f - power), s) * ring.rx);
  return {{ring.x + ring.rx * unit.x(), ring.y + ring.ry * unit.y()},
          normal.norm() > 1e-9f ? Vector2f(normal.normalized()) : Vector2f(c, s)};
}

void addCap(Mesh& mesh, const Isometry3f& pose, const Ring& ring, int segments, bool up,
            const Material& material) {
  if (ring.rx < 1e-4f || ring.ry < 1e-4f) {
    return;
  }
  const Vector3f normal = pose.linear() * Vector3f(0.0f, 0.0f, up ? 1.0f : -1.0f);
  const Vector2f middle = 0.5f * (material.uv_min + material.uv_max);
  const Vector2f half = 0.5f * (material.uv_max - material.uv_min);
  const std::uint32_t centre =
      addVertex(mesh, pose * Vector3f(ring.x, ring.y, ring.z), normal, middle);
  for (int i = 0; i <= segments; ++i) {
    const float angle = 2.0f * kPiF * static_cast<float>(i) / static_cast<float>(segments);
    const Vector2f p = onRing(ring, angle).first;
    const Vector2f uv =
        middle + 0.5f * half.cwiseProduct(Vector2f(std::cos(angle), std::sin(angle)));
    const std::uint32_t corner = addVertex(mesh, pose * Vector3f(p.x(), p.y(), ring.z), normal, uv);
    if (i > 0) {
      const std::uint32_t a = up ? corner - 1 : corner;
      const std::uint32_t b = up ? corner : corner - 1;
      mesh.triangles.push_back({{centre, a, b}, material.texture});
    }
  }
}

}  // namespace

void addQuad(Mesh& mesh, const Vector3f& origin, const Vector3f& right, const Vector3f& down,
             const Material& material, float max_cell) {
  const int columns = cellsOf(right.norm(), max_cell);
  const int rows = cellsOf(down.norm(), max_cell);
  const Vector3f normal = down.cross(right).normalized();
  Vector2f uv_min = material.uv_min;
  Vector2f uv_size = material.uv_max - material.uv_min;
  if (material.tile > 0.0f) {
    uv_min = tileOffset(origin);
    uv_size = {right.norm() / material.tile, down.norm() / material.tile};
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Vector2f s(static_cast<float>(i) / static_cast<float>(columns),
                       static_cast<float>(j) / static_cast<float>(rows));
      addVertex(mesh, origin + s.x() * right + s.y() * down, normal,
                uv_min + uv_size.cwiseProduct(s));
    }
  }
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
      const std::uint32_t upper_left = first + j * stride + i;
      addCell(mesh, upper_left, upper_left + stride, upper_left + stride + 1, upper_left + 1,
              material.texture);
    }
  }
}

void addBox(Mesh& mesh, const Isometry3f& pose, const Vector3f& size, const BoxMaterials& materials,
            float max_cell) {
  const Vector3f h = 0.5f * size;
  const Vector3f x = pose.linear() * Vector3f(size.x(), 0, 0);
  const Vector3f y = pose.linear() * Vector3f(0, size.y(), 0);
  const Vector3f z = pose.linear() * Vector3f(0, 0, size.z());
  const auto corner = [&](float sx, float sy, float sz) -> Vector3f {
    return pose * Vector3f(sx * h.x(), sy * h.y(), sz * h.z());
  };
  addQuad(mesh, corner(-1, -1, 1), x, -z, materials.front, max_cell);
  addQuad(mesh, corner(1, 1, 1), -x, -z, materials.back, max_cell);
  addQuad(mesh, corner(-1, 1, 1), -y, -z, materials.left, max_cell);
  addQuad(mesh, corner(1, -1, 1), y, -z, materials.right, max_cell);
  addQuad(mesh, corner(-1, 1, 1), x, -y, materials.top, max_cell);
  addQuad(mesh, corner(-1, -1, -1), x, y, materials.bottom, max_cell);
}

void addLoft(Mesh& mesh, const Isometry3f& pose, const std::vector<Ring>& rings, int segments,
             const Material& material) {
  if (rings.size() < 2) {
    return;
  }
  std::vector<float> length(rings.size(), 0.0f);  // along the profile, for v
  for (std::size_t k = 1; k < rings.size(); ++k) {
    const float dr = 0.5f * (rings[k].rx + rings[k].ry - rings[k - 1].rx - rings[k - 1].ry);
    length[k] = length[k - 1] + std::hypot(rings[k].z - rings[k - 1].z, dr);
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const Ring& below = rings[k == 0 ? 0 : k - 1];
    const Ring& above = rings[std::min(k + 1, rings.size() - 1)];
    for (int i = 0; i <= segments; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(segments);
      const float angle = 2.0f * kPiF * s - kPiF;
      const auto [p, radial] = onRing(rings[k], angle);
      // The profile's slope tilts the normal up or down.
      const Vector2f before = onRing(below, angle).first;
      const Vector2f after = onRing(above, angle).first;
      const Vector3f along(after.x() - before.x(), after.y() - before.y(), above.z - below.z);
      const float outward = radial.x() * along.x() + radial.y() * along.y();
      const Vector3f normal =
          Vector3f(radial.x() * along.z(), radial.y() * along.z(), -outward).normalized();
      const Vector2f uv(s, 1.0f - length[k] / std::max(1e-6f, length.back()));
      addVertex(mesh, pose * Vector3f(p.x(), p.y(), rings[k].z), pose.linear() * normal,
                material.uv_min + (material.uv_max - material.uv_min).cwiseProduct(uv));
    }
  }
  const auto stride = static_cast<std::uint32_t>(segments + 1);
  for (std::uint32_t k = 0; k + 1 < static_cast<std::uint32_t>(rings.size()); ++k) {
    for (std::uint32_t i = 0; i + 1 < stride; ++i) {
      const std::uint32_t lower = first + k * stride + i;
      addCell(mesh, lower, lower + 1, lower + stride + 1, lower + stride, material.texture);
    }
  }
  addCap(mesh, pose, rings.front(), segments, false, material);
  addCap(mesh, pose, rings.back(), segments, true, material);
}

void addCylinder(Mesh& mesh, const Vector3f& from, const Vector3f& to, float from_radius,
                 float to_radius, int segments, const Material& material) {
  const Vector3f axis = to - from;
  Isometry3f pose = Isometry3f::Identity();
  pose.translation() = from;
  pose.linear() = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), axis).toRotationMatrix();
  addLoft(mesh, pose, {{0.0f, from_radius, from_radius}, {axis.norm(), to_radius, to_radius}},
          segments, material);
}

void addEllipsoid(Mesh& mesh, const Isometry3f& pose, const Vector3f& radii, int segments,
                  const Material& material) {
  const int bands = std::max(3, segments / 2);
  std::vector<Ring> rings;
  for (int k = 0; k <= bands; ++k) {
    const float angle = kPiF * (static_cast<float>(k) / static_cast<float>(bands) - 0.5f);
    const float c = k == 0 || k == bands ? 0.0f : std::cos(angle);
    rings.push_back({radii.z() * std::sin(angle), radii.x() * c, radii.y() * c});
  }
  addLoft(mesh, pose, rings, segments, material);
}

Isometry3f placed(float x, float y, float z, float yaw) {
  Isometry3f pose = Isometry3f::Identity();
  pose.translation() = Vector3f(x, y, z);
  pose.linear() = Eigen::AngleAxisf(yaw, Vector3f::UnitZ()).toRotationMatrix();
  return pose;
}

Isometry3f moved(const Isometry3f& at, float x, float y, float z, float yaw) {
  return at * placed(x, y, z, yaw);
}

Vector3f point(const Isometry3f& at, float x, float y, float z) { return at * Vector3f(x, y, z); }

}  // namespace hmcdyn::synthesize
