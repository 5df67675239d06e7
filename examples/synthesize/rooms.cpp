// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/rooms.hpp"

#include <utility>

#include "synthesize/furniture.hpp"
#include "synthesize/paint.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3f;

struct ShellTextures {
  int floor = 0, wall = 0, ceiling = 0;
  float floor_tile = 1.6f, wall_tile = 2.5f;
};

/// Floor, walls and ceiling, seen from inside.
void addShell(Furnisher& furnisher, const RoomBounds& bounds, const ShellTextures& t) {
  const Vector3f low = bounds.min().cast<float>();
  const Vector3f high = bounds.max().cast<float>();
  const Vector3f size = high - low;
  constexpr float kCell = 0.5f;
  const Material wall{t.wall, t.wall_tile, {0, 0}, {1, 1}};
  Mesh floor;
  addQuad(floor, {low.x(), high.y(), low.z()}, {size.x(), 0, 0}, {0, -size.y(), 0},
          {t.floor, t.floor_tile, {0, 0}, {1, 1}}, kCell);
  furnisher.add(std::move(floor));
  Mesh ceiling;
  addQuad(ceiling, {low.x(), low.y(), high.z()}, {size.x(), 0, 0}, {0, size.y(), 0},
          {t.ceiling, 1.2f, {0, 0}, {1, 1}}, kCell);
  furnisher.add(std::move(ceiling));
  const Vector3f down(0, 0, -size.z());
  Mesh walls;
  addQuad(walls, {low.x(), high.y(), high.z()}, {size.x(), 0, 0}, down, wall, kCell);
  addQuad(walls, {high.x(), low.y(), high.z()}, {-size.x(), 0, 0}, down, wall, kCell);
  addQuad(walls, {low.x(), low.y(), high.z()}, {0, size.y(), 0}, down, wall, kCell);
  addQuad(walls, {high.x(), high.y(), high.z()}, {0, -size.y(), 0}, down, wall, kCell);
  furnisher.add(std::move(walls));
}

void addLamps(Scene& scene, const RoomBounds& bounds) {
  const Vector3f middle = bounds.center().cast<float>();
  const auto z = static_cast<float>(bounds.max().z()) - 0.15f;
  for (const float x : {-1.8f, 1.8f}) {
    for (const float y : {-1.6f, 1.6f}) {
      scene.lighting.lamps.push_back({{middle.x() + x, middle.y() + y, z}, 1.25f});
    }
  }
}

void hangLamps(Furnisher& furnisher, const Scene& scene, const Palette& palette) {
  for (const Lighting::Lamp& lamp : scene.lighting.lamps) {
    Mesh mesh;
    addBox(mesh, placed(lamp.position.x(), lamp.position.y(), lamp.position.z() + 0.1f),
           {0.3f, 1.2f, 0.06f}, BoxMaterials::all({palette.paper_white, 0.4f, {0, 0}, {1, 1}}));
    furnisher.add(std::move(mesh), 1.1f);
  }
}

/// A work place on a desk whose top is `top`: monitor, keyboard, mouse and what gathers there.
void setWorkplace(Furnisher& f, const Eigen::Isometry3f& top, bool screen_on) {
  f.monitor(top * placed(0.05f, 0.2f, 0), 0.52f, screen_on);
  f.keyboard(top * placed(0.0f, -0.13f, 0, 0.06f));
  f.mouse(top * placed(0.32f, -0.12f, 0, -0.1f));
  f.paper(top * placed(-0.42f, -0.14f, 0, 0.3f));
  f.clutter(top * placed(0.0f, 0.06f, 0), 1.3f, 0.34f, 5);
  f.cable({top * Vector3f(0.05f, 0.28f, 0.05f), top * Vector3f(0.3f, 0.33f, 0.006f),
           top * Vector3f(0.55f, 0.26f, 0.006f), top * Vector3f(0.72f, 0.34f, 0.006f),
           top * Vector3f(0.74f, 0.42f, -0.3f)});
}

void hangPosters(Furnisher& f, const Palette& palette) {
  const auto& p = palette.posters;
  const Vector3f from_back(0, -1, 0);
  const Vector3f from_left(1, 0, 0);
  const Vector3f from_right(-1, 0, 0);
  const Vector3f from_front(0, 1, 0);
  f.onWall({-2.75f, 2.7f, 1.75f}, from_back, 0.6f, 0.85f, p[0]);
  f.onWall({-2.0f, 2.7f, 1.72f}, from_back, 0.59f, 0.84f, p[3]);
  f.onWall({0.1f, 2.7f, 2.3f}, from_back, 0.42f, 0.6f, p[1]);
  f.onWall({2.9f, 2.7f, 1.7f}, from_back, 0.9f, 0.64f, p[2]);
  f.onWall({2.85f, 2.7f, 2.35f}, from_back, 0.5f, 0.37f, p[5]);
  f.onWall({4.0f, 2.25f, 1.65f}, from_right, 0.59f, 0.84f, p[6]);
  f.onWall({4.0f, 1.55f, 1.75f}, from_right, 0.42f, 0.6f, p[4]);
  f.onWall({4.0f, 0.55f, 1.85f}, from_right, 1.0f, 0.7f, p[8]);
  f.onWall({4.0f, -0.2f, 1.7f}, from_right, 0.42f, 0.6f, p[12]);
  f.onWall({4.0f, -1.6f, 1.6f}, from_right, 0.59f, 0.84f, p[9]);
  f.onWall({-4.0f, -0.6f, 1.65f}, from_left, 0.59f, 0.84f, p[10]);
  f.onWall({-4.0f, -1.6f, 1.7f}, from_left, 0.5f, 0.7f, p[7]);
  f.onWall({-4.0f, 0.3f, 1.6f}, from_left, 0.42f, 0.6f, p[11]);
  f.onWall({-1.2f, -3.8f, 1.6f}, from_front, 0.9f, 0.64f, p[2]);
  f.onWall({1.2f, -3.8f, 1.6f}, from_front, 0.6f, 0.85f, p[9]);
}

void furnishWorkplaces(Furnisher& f, const Palette& palette) {
  f.desk(placed(-0.82f, 0.4f, 0), 1.6f, 0.8f);
  f.desk(placed(0.82f, 0.4f, 0), 1.6f, 0.8f);
  setWorkplace(f, placed(-0.8f, 0.42f, 0.74f), true);
  setWorkplace(f, placed(0.85f, 0.42f, 0.74f), true);
  f.deskLamp(placed(-1.5f, 0.62f, 0.74f, 0.5f));
  f.plant(placed(1.5f, 0.62f, 0.74f), 0.42f);
  f.bookPile(placed(0.02f, 0.6f, 0.74f), 5);
  f.partition(placed(-0.82f, 0.86f, 0), 1.62f, 1.32f);
  f.partition(placed(0.82f, 0.86f, 0), 1.62f, 1.32f);
  const Vector3f to_camera(0, -1, 0);
  f.onWall({-1.28f, 0.838f, 1.12f}, to_camera, 0.24f, 0.34f, palette.pages[0]);
  f.onWall({-0.15f, 0.838f, 1.1f}, to_camera, 0.28f, 0.4f, palette.posters[4]);
  f.onWall({0.25f, 0.838f, 1.14f}, to_camera, 0.21f, 0.3f, palette.pages[2]);
  f.onWall({1.45f, 0.838f, 1.12f}, to_camera, 0.26f, 0.36f, palette.posters[7]);
  f.computer(placed(-1.35f, 0.5f, 0));
  f.computer(placed(1.4f, 0.5f, 0));
  f.bin(placed(0.0f, 0.55f, 0));
  f.officeChair(placed(-2.05f, -0.2f, 0, 1.9f), true);
  f.woodenChair(placed(0.75f, -0.62f, 0, 3.84f));
  f.woodenChair(placed(-0.8f, -0.62f, 0, 2.443f));
}

/// Things that stand between the camera and the people.
void addOccluders(Furnisher& f) {
  f.cardboardBox(placed(-0.55f, -1.2f, 0, 0.2f), {0.5f, 0.4f, 0.45f});
  f.cardboardBox(placed(-0.52f, -1.2f, 0.45f, -0.1f), {0.45f, 0.38f, 0.4f});
  f.cardboardBox(placed(-0.57f, -1.2f, 0.85f, 0.15f), {0.4f, 0.34f, 0.36f});
  f.plant(placed(0.5f, -1.3f, 0), 1.25f);
  f.broom({1.15f, -1.25f, 0.0f}, {1.3f, -1.2f, 1.4f});
}

void furnishWalls(Furnisher& f, const Palette& palette, TextureLibrary& textures,
                  std::uint64_t seed) {
  f.bookcase(placed(-1.05f, 2.53f, 0), 0.95f, 2.1f);
  f.bookcase(placed(-0.05f, 2.53f, 0), 0.95f, 1.85f);
  f.bookcase(placed(3.83f, 0.3f, 0, -1.5708f), 1.1f, 1.4f);
  f.cabinet(placed(2.6f, 2.45f, 0), 1.0f, 1.15f);
  f.cabinet(placed(-3.75f, 0.9f, 0, 1.5708f), 1.2f, 0.85f);
  const int whiteboard = textures.add([s = mixBits(seed + 21)] { return paint::whiteboard(s); });
  const int door = textures.add([s = mixBits(seed + 22)] { return paint::door(s); });
  const int window = textures.add([s = mixBits(seed + 23)] { return paint::windowView(s); });
  const int clock = textures.add([] { return paint::clockFace(); });
  f.onWall({1.35f, 2.7f, 1.55f}, {0, -1, 0}, 1.5f, 1.0f, whiteboard, 0.03f);
  f.onWall({1.35f, 2.7f, 2.4f}, {0, -1, 0}, 0.3f, 0.3f, clock, 0.03f);
  f.onWall({-3.45f, 2.7f, 1.02f}, {0, -1, 0}, 0.92f, 2.04f, door, 0.04f);
  f.onWall({-4.0f, 1.7f, 1.65f}, {1, 0, 0}, 1.5f, 1.25f, window, 0.02f, 1.3f);
  for (const float y : {0.93f, 1.7f, 2.47f}) {  // window frame
    Mesh frame;
    addBox(frame, placed(-3.96f, y, 1.65f), {0.08f, 0.06f, 1.34f},
           BoxMaterials::all({palette.white_plastic, 0.3f, {0, 0}, {1, 1}}));
    f.add(std::move(frame));
  }
  f.plant(placed(-3.35f, 2.15f, 0), 1.5f);
  f.plant(placed(3.5f, 2.2f, 0), 1.2f);
  f.cardboardBox(placed(2.55f, 2.4f, 1.15f, 0.2f), {0.4f, 0.3f, 0.28f});
  f.cardboardBox(placed(3.45f, 1.45f, 0, 0.4f), {0.5f, 0.4f, 0.36f});
  f.cardboardBox(placed(3.42f, 1.47f, 0.36f, 0.1f), {0.38f, 0.32f, 0.26f});
  f.bookPile(placed(-3.7f, 0.7f, 0.85f, 1.3f), 5);
  f.penCup(placed(-3.7f, 1.2f, 0.85f));
  f.backpack(placed(1.95f, -0.1f, 0, -0.4f), true);
  f.backpack(placed(-2.4f, 2.35f, 0, 0.6f), false);
  f.officeChair(placed(1.75f, 2.1f, 0, 0.5f), false);
  f.stepLadder(placed(3.3f, -1.0f, 0, 1.2f), 1.4f);
  f.cable({{-1.6f, 0.8f, 0.01f},
           {-2.2f, 0.5f, 0.01f},
           {-2.5f, 1.2f, 0.01f},
           {-3.2f, 1.4f, 0.01f},
           {-3.95f, 2.0f, 0.01f}},
          0.008f);
}

}  // namespace

RoomBounds furnishOffice(Scene& scene, const Palette& palette, std::uint64_t seed,
                         bool with_occluders) {
  const RoomBounds bounds(Eigen::Vector3d(-4.0, -3.8, 0.0), Eigen::Vector3d(4.0, 2.7, 2.85));
  addLamps(scene, bounds);
  Furnisher f(scene.room, scene.lighting, palette, seed);
  ShellTextures shell;
  shell.floor = scene.textures.add([s = mixBits(seed + 11)] {
    return paint::carpet({118, 112, 104}, s);
  });
  shell.floor_tile = 2.0f;
  shell.wall = scene.textures.add([s = mixBits(seed + 12)] {
    return paint::plaster({205, 218, 222}, 1.0, s);
  });
  shell.ceiling = scene.textures.add([s = mixBits(seed + 13)] { return paint::ceilingTiles(s); });
  addShell(f, bounds, shell);
  hangLamps(f, scene, palette);
  hangPosters(f, palette);
  furnishWorkplaces(f, palette);
  furnishWalls(f, palette, scene.textures, seed);
  if (with_occluders) {
    addOccluders(f);
  }
  return bounds;
}

RoomBounds furnishBareOffice(Scene& scene, const Palette& palette, std::uint64_t seed) {
  const RoomBounds bounds(Eigen::Vector3d(-4.0, -3.8, 0.0), Eigen::Vector3d(4.0, 2.7, 2.85));
  addLamps(scene, bounds);
  Furnisher f(scene.room, scene.lighting, palette, seed);
  ShellTextures shell;
  shell.floor = scene.textures.add([s = mixBits(seed + 11)] {
    return paint::plaster({120, 125, 128}, 0.25, s);
  });
  shell.wall = scene.textures.add([s = mixBits(seed + 12)] {
    return paint::plaster({205, 215, 218}, 0.2, s);
  });
  shell.ceiling = shell.wall;
  addShell(f, bounds, shell);
  hangLamps(f, scene, palette);
  f.desk(placed(-0.82f, 0.4f, 0), 1.6f, 0.8f);
  f.desk(placed(0.82f, 0.4f, 0), 1.6f, 0.8f);
  f.monitor(placed(-0.75f, 0.62f, 0.74f), 0.52f, false);
  f.keyboard(placed(-0.75f, 0.26f, 0.74f));
  f.mug(placed(0.3f, 0.35f, 0.74f));
  f.paper(placed(0.85f, 0.3f, 0.74f, 0.3f));
  f.bookPile(placed(1.2f, 0.5f, 0.74f), 2);
  f.woodenChair(placed(0.75f, -0.62f, 0, 3.25f));
  f.cabinet(placed(2.6f, 2.45f, 0), 1.0f, 1.15f);
  f.onWall({-1.9f, 2.7f, 1.7f}, {0, -1, 0}, 0.42f, 0.6f, palette.posters[1]);
  f.onWall({-3.45f, 2.7f, 1.02f}, {0, -1, 0}, 0.92f, 2.04f, palette.light_wood, 0.04f);
  return bounds;
}

}  // namespace hmcdyn::synthesize
