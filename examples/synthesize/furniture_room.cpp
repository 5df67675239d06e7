// SPDX-License-Identifier: BSD-3-Clause
// Things on the floor and on the walls.
#include <algorithm>
#include <cmath>
#include <utility>

#include "synthesize/furniture.hpp"
#include "synthesize/pi.hpp"

namespace hmcdyn::synthesize {

using Eigen::Isometry3f;
using Eigen::Vector3f;

void Furnisher::bookcase(const Isometry3f& at, float width, float height) {
  Mesh mesh;
  const Material wood{palette_.light_wood, 0.9f, {0, 0}, {1, 1}};
  constexpr float kDepth = 0.3f;
  for (const float side : {-1.0f, 1.0f}) {
    addBox(mesh, moved(at, side * 0.5f * width, 0, 0.5f * height), {0.025f, kDepth, height},
           BoxMaterials::all(wood));
  }
  addBox(mesh, moved(at, 0, 0.5f * kDepth, 0.5f * height), {width, 0.012f, height},
         BoxMaterials::all({palette_.dark_wood, 0.9f, {0, 0}, {1, 1}}));
  const int shelves = static_cast<int>(height / 0.36f);
  const float gap = height / static_cast<float>(shelves);
  for (int shelf = 0; shelf <= shelves; ++shelf) {
    const float z = gap * static_cast<float>(shelf);
    addBox(mesh, moved(at, 0, 0, z + 0.01f), {width, kDepth, 0.022f}, BoxMaterials::all(wood));
    if (shelf == shelves) {
      break;
    }
    float x = -0.5f * width + 0.03f;
    while (x < 0.5f * width - 0.1f) {
      if (random_.chance(0.07)) {  // a gap with something else in it
        cardboardBox(moved(at, x + 0.09f, -0.02f, z + 0.02f), {0.14f, 0.16f, 0.14f});
        x += 0.19f;
        continue;
      }
      const auto thickness = static_cast<float>(random_.uniform(0.02, 0.055));
      const auto tall = static_cast<float>(random_.uniform(0.6, 0.92)) * (gap - 0.02f);
      const float u = static_cast<float>(random_.integer(0, 15)) / 16.0f;
      const Material spine{palette_.spines, 0.0f, {u + 0.003f, 0.0f}, {u + 0.059f, 1.0f}};
      const auto back = static_cast<float>(random_.uniform(-0.03, 0.03));
      addBox(mesh, moved(at, x + 0.5f * thickness, back, z + 0.021f + 0.5f * tall),
             {thickness - 0.001f, 0.2f, tall}, BoxMaterials::all(spine));
      x += thickness;
    }
  }
  add(std::move(mesh));
}

void Furnisher::cabinet(const Isometry3f& at, float width, float height) {
  Mesh mesh;
  const Material body{palette_.white_plastic, 0.7f, {0, 0}, {1, 1}};
  const Material front{palette_.light_wood, 1.1f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, 0.5f * height), {width, 0.42f, height}, BoxMaterials::all(body),
         0.4f);
  const int drawers = std::max(2, static_cast<int>(height / 0.3f));
  const float gap = height / static_cast<float>(drawers);
  for (int i = 0; i < drawers; ++i) {
    const float z = gap * (static_cast<float>(i) + 0.5f);
    addBox(mesh, moved(at, 0, -0.22f, z), {width - 0.03f, 0.02f, gap - 0.02f},
           BoxMaterials::all(front));
    addBox(mesh, moved(at, 0, -0.24f, z + 0.2f * gap), {0.16f, 0.02f, 0.02f},
           BoxMaterials::all({palette_.dark_metal, 0.2f, {0, 0}, {1, 1}}));
    addBox(mesh, moved(at, 0.2f * width, -0.232f, z), {0.08f, 0.004f, 0.05f},
           BoxMaterials::all({pick(palette_.pages), 0.0f, {0, 0}, {1, 0.3f}}));
  }
  add(std::move(mesh));
}

void Furnisher::officeChair(const Isometry3f& at, bool red) {
  Mesh mesh;
  const Material fabric{red ? palette_.red_fabric : palette_.blue_fabric, 0.0f, {0, 0}, {1, 1}};
  const Material metal{palette_.dark_metal, 0.0f, {0, 0}, {1, 1}};
  addLoft(
      mesh, moved(at, 0, 0, 0.42f),
      {{0, 0.21f, 0.2f, 0, 0, 4}, {0.03f, 0.24f, 0.23f, 0, 0, 4}, {0.075f, 0.22f, 0.21f, 0, 0, 4}},
      24, fabric);
  addLoft(mesh, moved(at, 0, 0.23f, 0.6f),
          {{0, 0.17f, 0.025f, 0, 0, 4},
           {0.15f, 0.22f, 0.035f, 0, 0.01f, 4},
           {0.35f, 0.22f, 0.03f, 0, 0.03f, 4},
           {0.45f, 0.16f, 0.022f, 0, 0.05f, 4}},
          24, fabric);
  addBox(mesh, moved(at, 0, 0.24f, 0.54f), {0.06f, 0.02f, 0.25f},
         BoxMaterials::all({palette_.dark_metal, 0.2f, {0, 0}, {1, 1}}));
  addCylinder(mesh, point(at, 0, 0, 0.1f), point(at, 0, 0, 0.42f), 0.03f, 0.025f, 12, metal);
  for (int leg = 0; leg < 5; ++leg) {
    const float angle = 2.0f * kPiF * static_cast<float>(leg) / 5.0f + 0.3f;
    const Vector3f end = point(at, 0.3f * std::cos(angle), 0.3f * std::sin(angle), 0.07f);
    addCylinder(mesh, point(at, 0, 0, 0.12f), end, 0.025f, 0.016f, 8, metal);
    addCylinder(mesh, end + Vector3f(-0.015f, 0, -0.04f), end + Vector3f(0.015f, 0, -0.04f), 0.03f,
                0.03f, 10, metal);
  }
  for (const float side : {-1.0f, 1.0f}) {
    addCylinder(mesh, point(at, side * 0.25f, 0.08f, 0.45f), point(at, side * 0.27f, 0.08f, 0.66f),
                0.014f, 0.014f, 8, metal);
    addBox(mesh, moved(at, side * 0.27f, 0.02f, 0.67f), {0.05f, 0.26f, 0.03f},
           BoxMaterials::all({palette_.black_plastic, 0.3f, {0, 0}, {1, 1}}));
  }
  add(std::move(mesh));
}

void Furnisher::woodenChair(const Isometry3f& at) {
  Mesh mesh;
  const Material wood{palette_.light_wood, 0.6f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, 0.45f), {0.42f, 0.42f, 0.025f}, BoxMaterials::all(wood));
  for (const float x : {-0.18f, 0.18f}) {
    addBox(mesh, moved(at, x, -0.18f, 0.22f), {0.035f, 0.035f, 0.44f}, BoxMaterials::all(wood));
    addBox(mesh, moved(at, x, 0.19f, 0.44f), {0.035f, 0.035f, 0.88f}, BoxMaterials::all(wood));
    addBox(mesh, moved(at, x, 0, 0.2f), {0.02f, 0.36f, 0.03f}, BoxMaterials::all(wood));
  }
  for (const float z : {0.62f, 0.72f, 0.83f}) {
    addBox(mesh, moved(at, 0, 0.195f, z), {0.34f, 0.018f, 0.06f}, BoxMaterials::all(wood));
  }
  add(std::move(mesh));
}

void Furnisher::computer(const Isometry3f& at) {
  Mesh mesh;
  const Material black{palette_.black_plastic, 0.3f, {0, 0}, {1, 1}};
  const Material metal{palette_.grey_metal, 0.3f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, 0.22f), {0.19f, 0.45f, 0.43f}, BoxMaterials::all(black));
  for (const float z : {0.36f, 0.31f, 0.26f}) {
    addBox(mesh, moved(at, 0, -0.226f, z), {0.15f, 0.006f, 0.035f}, BoxMaterials::all(metal));
  }
  addBox(mesh, moved(at, 0.05f, -0.227f, 0.1f), {0.05f, 0.004f, 0.04f},
         BoxMaterials::all({pick(palette_.covers), 0.0f, {0, 0}, {1, 1}}));
  add(std::move(mesh));
}

void Furnisher::bin(const Isometry3f& at) {
  Mesh mesh;
  addCylinder(mesh, point(at, 0, 0, 0), point(at, 0, 0, 0.32f), 0.12f, 0.15f, 20,
              {palette_.dark_metal, 0.0f, {0, 0}, {1, 1}});
  add(std::move(mesh));
}

void Furnisher::backpack(const Isometry3f& at, bool red) {
  Mesh mesh;
  const Material cloth{red ? palette_.red_fabric : palette_.blue_fabric, 0.0f, {0, 0}, {1, 1}};
  addLoft(mesh, at,
          {{0, 0.14f, 0.1f, 0, 0, 3},
           {0.05f, 0.17f, 0.12f, 0, 0, 3},
           {0.28f, 0.16f, 0.11f, 0, 0, 3},
           {0.42f, 0.1f, 0.06f, 0, 0, 3},
           {0.45f, 0.03f, 0.02f, 0, 0, 3}},
          20, cloth);
  addBox(mesh, moved(at, 0, -0.13f, 0.13f), {0.22f, 0.05f, 0.18f}, BoxMaterials::all(cloth));
  addBox(mesh, moved(at, 0, -0.16f, 0.18f), {0.2f, 0.006f, 0.012f},
         BoxMaterials::all({palette_.white_plastic, 0.2f, {0, 0}, {1, 1}}));
  add(std::move(mesh));
}

void Furnisher::plant(const Isometry3f& at, float height) {
  Mesh mesh;
  const float pot = 0.25f * height;
  addCylinder(mesh, point(at, 0, 0, 0), point(at, 0, 0, pot), 0.12f * height, 0.16f * height, 20,
              {palette_.red_fabric, 0.0f, {0, 0}, {1, 1}});
  addCylinder(mesh, point(at, 0, 0, pot), point(at, 0, 0, pot + 0.004f), 0.15f * height,
              0.15f * height, 20, {palette_.soil, 0.0f, {0, 0}, {1, 1}});
  for (int i = 0; i < 26; ++i) {
    const auto angle = static_cast<float>(random_.uniform(0.0, 6.28));
    const auto reach = static_cast<float>(random_.uniform(0.12, 0.36)) * height;
    const auto top = static_cast<float>(random_.uniform(0.55, 1.0)) * height;
    const Vector3f tip = point(at, reach * std::cos(angle), reach * std::sin(angle), top);
    const Vector3f root =
        point(at, 0.1f * reach * std::cos(angle), 0.1f * reach * std::sin(angle), pot);
    const Vector3f bend = 0.35f * root + 0.65f * tip + Vector3f(0, 0, 0.12f * height);
    const Material green{palette_.green_leaf, 0.0f, {0, 0}, {1, 1}};
    addCylinder(mesh, root, bend, 0.006f, 0.004f, 5, green);
    Isometry3f leaf = Isometry3f::Identity();
    leaf.translation() = 0.5f * (bend + tip);
    leaf.linear() =
        Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), tip - bend).toRotationMatrix() *
        Eigen::AngleAxisf(angle, Vector3f::UnitZ()).toRotationMatrix();
    const float length = 0.5f * (tip - bend).norm() + 0.05f;
    addEllipsoid(mesh, leaf, {0.045f, 0.006f, length}, 10, green);
  }
  add(std::move(mesh));
}

void Furnisher::cardboardBox(const Isometry3f& at, const Vector3f& size) {
  Mesh mesh;
  addBox(mesh, moved(at, 0, 0, 0.5f * size.z()), size,
         BoxMaterials::all({pick(palette_.cardboards), 0.0f, {0, 0}, {1, 1}}), 0.4f);
  add(std::move(mesh));
}

void Furnisher::broom(const Vector3f& foot, const Vector3f& top) {
  Mesh mesh;
  const Vector3f along = (top - foot).normalized();
  addCylinder(mesh, foot + 0.08f * along, top, 0.013f, 0.013f, 10,
              {palette_.light_wood, 0.0f, {0, 0}, {0.2f, 1}});
  addBox(mesh, placed(foot.x(), foot.y(), foot.z() + 0.05f, 0.4f), {0.36f, 0.06f, 0.1f},
         BoxMaterials::all({palette_.red_fabric, 0.0f, {0, 0}, {1, 0.4f}}));
  add(std::move(mesh));
}

void Furnisher::stepLadder(const Isometry3f& at, float height) {
  Mesh mesh;
  const Material metal{palette_.grey_metal, 0.0f, {0, 0}, {1, 1}};
  for (const float side : {-0.22f, 0.22f}) {
    addCylinder(mesh, point(at, side, -0.35f, 0), point(at, 0.8f * side, 0, height), 0.02f, 0.02f,
                8, metal);
    addCylinder(mesh, point(at, side, 0.35f, 0), point(at, 0.8f * side, 0, height), 0.02f, 0.02f, 8,
                metal);
  }
  for (float z = 0.25f; z < height; z += 0.25f) {
    const float y = -0.35f * (1.0f - z / height);
    addBox(mesh, moved(at, 0, y, z), {0.42f, 0.09f, 0.025f},
           BoxMaterials::all({palette_.dark_metal, 0.2f, {0, 0}, {1, 1}}));
  }
  add(std::move(mesh));
}

void Furnisher::partition(const Isometry3f& at, float width, float height) {
  Mesh mesh;
  addBox(mesh, moved(at, 0, 0, 0.5f * height), {width, 0.04f, height},
         BoxMaterials::all({palette_.grey_fabric, 0.8f, {0, 0}, {1, 1}}), 0.4f);
  const Material metal{palette_.grey_metal, 0.4f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, height + 0.012f), {width + 0.04f, 0.06f, 0.025f},
         BoxMaterials::all(metal));
  for (const float side : {-1.0f, 1.0f}) {
    addBox(mesh, moved(at, side * 0.5f * width, 0, 0.5f * height), {0.04f, 0.06f, height},
           BoxMaterials::all(metal));
  }
  add(std::move(mesh));
}

void Furnisher::onWall(const Vector3f& centre, const Vector3f& normal, float width, float height,
                       int texture, float thickness, float glow) {
  const Vector3f up = Vector3f::UnitZ();
  const Vector3f right = up.cross(normal).normalized();
  Isometry3f pose = Isometry3f::Identity();
  pose.linear() << right, -normal, up;
  pose.translation() = centre + 0.5f * thickness * normal;
  Mesh mesh;
  const Material picture{texture, 0.0f, {0, 0}, {1, 1}};
  const Material edge{palette_.paper_white, 0.2f, {0, 0}, {1, 1}};
  addBox(mesh, pose, {width, thickness, height}, {picture, edge, edge, edge, edge, edge},
         glow > 0.0f ? 1e9f : 0.5f);
  add(std::move(mesh), glow);
}

}  // namespace hmcdyn::synthesize
