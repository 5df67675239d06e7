// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/lighting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmcdyn::synthesize {

float Lighting::at(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const {
  float light = ambient + sky * 0.5f * (1.0f + normal.z()) +
                window * std::max(0.0f, normal.dot(window_direction.normalized()));
  for (const Lamp& lamp : lamps) {
    const Eigen::Vector3f to_lamp = lamp.position - position;
    const float distance = std::max(0.05f, to_lamp.norm());
    // Half-Lambert: walls bounce light behind the terminator.
    const float cosine = std::max(0.0f, 0.5f * (1.0f + normal.dot(to_lamp) / distance));
    light += lamp.strength * cosine * cosine / (1.0f + distance * distance);
  }
  return std::clamp(light, 0.15f, 1.35f);
}

LitMesh bounded(Mesh mesh) {
  LitMesh lit;
  lit.mesh = std::move(mesh);
  if (lit.mesh.vertices.empty()) {
    return lit;
  }
  Eigen::Vector3f low = lit.mesh.vertices.front().position;
  Eigen::Vector3f high = low;
  for (const Vertex& vertex : lit.mesh.vertices) {
    low = low.cwiseMin(vertex.position);
    high = high.cwiseMax(vertex.position);
  }
  lit.centre = 0.5f * (low + high);
  for (const Vertex& vertex : lit.mesh.vertices) {
    lit.radius = std::max(lit.radius, (vertex.position - lit.centre).norm());
  }
  return lit;
}

LitMesh litStill(Mesh mesh, const Lighting& lighting, float glow) {
  LitMesh lit = bounded(std::move(mesh));
  lit.light.reserve(lit.mesh.vertices.size());
  for (const Vertex& vertex : lit.mesh.vertices) {
    lit.light.push_back(glow > 0.0f ? glow : lighting.at(vertex.position, vertex.normal));
  }
  return lit;
}

std::vector<float> lightOf(const LitMesh& body, const Eigen::Isometry3d& to_world,
                           const Lighting& lighting) {
  const Eigen::Isometry3f pose = to_world.cast<float>();
  std::vector<float> light;
  light.reserve(body.mesh.vertices.size());
  for (const Vertex& vertex : body.mesh.vertices) {
    light.push_back(lighting.at(pose * vertex.position, pose.linear() * vertex.normal));
  }
  return light;
}

}  // namespace hmcdyn::synthesize
