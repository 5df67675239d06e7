// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "synthesize/furniture.hpp"
#include "synthesize/paint.hpp"
#include "synthesize/rooms.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3f;

void addShell(Furnisher& f, Scene& scene, const RoomBounds& bounds, std::uint64_t seed) {
  const Vector3f low = bounds.min().cast<float>();
  const Vector3f high = bounds.max().cast<float>();
  const Vector3f size = high - low;
  const int floor = scene.textures.add([s = mixBits(seed + 31)] {
    return paint::concrete({135, 142, 146}, s);
  });
  const int wood = scene.textures.add([s = mixBits(seed + 32)] {
    return paint::woodPlanks({95, 135, 165}, s);
  });
  const int wall = scene.textures.add([s = mixBits(seed + 33)] {
    return paint::plaster({196, 204, 206}, 1.0, s);
  });
  constexpr float kCell = 0.5f;
  Mesh shell;
  addQuad(shell, {low.x(), high.y(), 0}, {size.x(), 0, 0}, {0, -size.y(), 0},
          {floor, 2.4f, {0, 0}, {1, 1}}, kCell);
  addQuad(shell, {low.x(), low.y(), high.z()}, {size.x(), 0, 0}, {0, size.y(), 0},
          {wood, 2.5f, {0, 0}, {1, 1}}, kCell);
  const Vector3f down(0, 0, -size.z());
  const Material plaster{wall, 2.5f, {0, 0}, {1, 1}};
  addQuad(shell, {low.x(), high.y(), high.z()}, {size.x(), 0, 0}, down, plaster, kCell);
  addQuad(shell, {high.x(), low.y(), high.z()}, {-size.x(), 0, 0}, down, plaster, kCell);
  addQuad(shell, {low.x(), low.y(), high.z()}, {0, size.y(), 0}, down, plaster, kCell);
  addQuad(shell, {high.x(), high.y(), high.z()}, {0, -size.y(), 0}, down, plaster, kCell);
  f.add(std::move(shell));
}

/// Girders, pillars and lamps under the roof.
void addRoof(Furnisher& f, const Scene& scene, const Palette& palette, const RoomBounds& bounds) {
  const auto top = static_cast<float>(bounds.max().z());
  const auto width = static_cast<float>(bounds.sizes().x());
  const Material metal{palette.dark_metal, 0.5f, {0, 0}, {1, 1}};
  Mesh girders;
  for (const float y : {-2.6f, -1.2f, 0.2f, 1.6f}) {
    addBox(girders, placed(0, y, top - 0.3f), {width, 0.08f, 0.06f}, BoxMaterials::all(metal),
           1.0f);
    addBox(girders, placed(0, y, top - 0.05f), {width, 0.08f, 0.06f}, BoxMaterials::all(metal),
           1.0f);
    for (float x = -0.5f * width; x < 0.5f * width - 0.3f; x += 0.6f) {
      addCylinder(girders, {x, y, top - 0.3f}, {x + 0.3f, y, top - 0.05f}, 0.015f, 0.015f, 6,
                  metal);
      addCylinder(girders, {x + 0.3f, y, top - 0.05f}, {x + 0.6f, y, top - 0.3f}, 0.015f, 0.015f, 6,
                  metal);
    }
  }
  f.add(std::move(girders));
  for (const Lighting::Lamp& lamp : scene.lighting.lamps) {
    Mesh mesh;
    addBox(mesh, placed(lamp.position.x(), lamp.position.y(), lamp.position.z()),
           {1.3f, 0.2f, 0.08f}, BoxMaterials::all({palette.paper_white, 0.4f, {0, 0}, {1, 1}}));
    f.add(std::move(mesh), 1.15f);
  }
}

void hangPictures(Furnisher& f, const Palette& palette) {
  const auto& p = palette.posters;
  const Vector3f from_back(0, -1, 0);
  for (int i = 0; i < 6; ++i) {
    const auto x = -2.9f + 1.12f * static_cast<float>(i);
    f.onWall({x, 2.4f, 1.75f + 0.12f * static_cast<float>(i % 2)}, from_back, 0.65f, 0.9f,
             p[static_cast<std::size_t>(2 * i)]);
  }
  for (int i = 0; i < 4; ++i) {
    const auto y = -2.6f + 1.25f * static_cast<float>(i);
    f.onWall({-3.6f, y, 1.7f}, {1, 0, 0}, 0.65f, 0.9f, p[static_cast<std::size_t>(2 * i + 1)]);
    f.onWall({3.6f, y + 0.5f, 1.7f}, {-1, 0, 0}, 0.8f, 0.58f, p[static_cast<std::size_t>(3 * i)]);
  }
  f.onWall({-1.5f, -4.0f, 1.7f}, {0, 1, 0}, 0.65f, 0.9f, p[9]);
  f.onWall({1.5f, -4.0f, 1.7f}, {0, 1, 0}, 0.8f, 0.58f, p[5]);
}

}  // namespace

RoomBounds furnishHall(Scene& scene, const Palette& palette, std::uint64_t seed) {
  const RoomBounds bounds(Eigen::Vector3d(-3.6, -4.0, 0.0), Eigen::Vector3d(3.6, 2.4, 3.3));
  for (const float x : {-2.2f, 2.2f}) {
    for (const float y : {-2.6f, -0.6f, 1.4f}) {
      scene.lighting.lamps.push_back({{x, y, 2.95f}, 1.0f});
    }
  }
  Furnisher f(scene.room, scene.lighting, palette, seed);
  addShell(f, scene, bounds, seed);
  addRoof(f, scene, palette, bounds);
  hangPictures(f, palette);

  f.cardboardBox(placed(-2.2f, 1.85f, 0, 0.3f), {0.6f, 0.45f, 0.42f});
  f.cardboardBox(placed(-2.15f, 1.85f, 0.42f, 0.05f), {0.48f, 0.4f, 0.36f});
  f.cardboardBox(placed(-1.5f, 1.95f, 0, -0.2f), {0.45f, 0.4f, 0.5f});
  f.cardboardBox(placed(3.0f, 0.9f, 0, 0.5f), {0.7f, 0.5f, 0.5f});
  f.cardboardBox(placed(2.95f, 0.9f, 0.5f, 0.2f), {0.5f, 0.4f, 0.35f});
  f.woodenChair(placed(1.2f, 1.75f, 0, 0.4f));
  f.woodenChair(placed(-3.0f, 0.3f, 0, 1.3f));
  f.officeChair(placed(2.9f, -0.4f, 0, -1.0f), true);
  f.broom({0.5f, 1.8f, 0.0f}, {0.35f, 2.36f, 1.35f});
  f.stepLadder(placed(-0.4f, 1.9f, 0, 0.3f), 1.7f);
  f.bookcase(placed(2.5f, 2.23f, 0), 1.4f, 1.9f);
  f.cabinet(placed(-3.0f, 2.15f, 0), 1.0f, 1.2f);
  f.plant(placed(1.65f, 2.0f, 0), 1.2f);
  f.plant(placed(-3.2f, 1.3f, 0), 1.1f);
  f.backpack(placed(0.8f, 2.05f, 0, 0.5f), false);
  f.backpack(placed(-0.95f, 2.0f, 0, -0.2f), true);
  f.desk(placed(-3.1f, -1.3f, 0, 1.5708f), 1.5f, 0.75f);
  f.monitor(placed(-3.25f, -1.3f, 0.74f, 1.5708f), 0.5f, true);
  f.keyboard(placed(-2.9f, -1.3f, 0.74f, 1.5708f));
  f.clutter(placed(-3.05f, -1.3f, 0.74f, 1.5708f), 1.3f, 0.5f, 5);
  f.bookPile(placed(-3.0f, 2.1f, 1.2f), 4);
  f.cable({{-3.1f, -0.6f, 0.01f},
           {-2.0f, 0.0f, 0.01f},
           {-1.0f, 0.4f, 0.01f},
           {0.4f, 0.5f, 0.01f},
           {1.6f, 1.3f, 0.01f},
           {3.1f, 1.5f, 0.01f}},
          0.012f);
  f.cable({{3.4f, -2.0f, 0.01f},
           {2.2f, -0.9f, 0.01f},
           {0.9f, -0.2f, 0.01f},
           {-0.6f, 0.9f, 0.01f},
           {-1.1f, 2.3f, 0.01f}},
          0.01f);
  return bounds;
}

}  // namespace hmcdyn::synthesize
