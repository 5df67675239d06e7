// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/unknown_things.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "synthesize/paint.hpp"
#include "synthesize/pi.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3d;
using Eigen::Isometry3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// From 0 to 1 between two times, with speed 0 at both.
double eased(double time, double from, double to) {
  const double share = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

Isometry3d turned(const Vector3d& position, double yaw) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = position;
  pose.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// Adds a thing of one rigid piece, made of several meshes.
void addThing(Scene& scene, std::vector<LitMesh> parts, std::function<Isometry3d(double)> pose) {
  Mover thing;
  thing.is_person = false;
  thing.poses = [count = parts.size(), pose = std::move(pose)](double time) {
    return std::vector<Isometry3d>(count, pose(time));
  };
  thing.parts = std::move(parts);
  scene.movers.push_back(std::move(thing));
}

/// The same of pieces of furniture: `furnish` places them around the origin.
void addFurniture(const Workshop& w, const std::function<void(Furnisher&)>& furnish,
                  std::function<Isometry3d(double)> pose) {
  std::vector<LitMesh> parts;
  Furnisher furnisher(parts, w.scene.lighting, w.palette, w.seed);
  furnish(furnisher);
  addThing(w.scene, std::move(parts), std::move(pose));
}

int oneColour(TextureLibrary& textures, const paint::Color& color) {
  return textures.add([color] { return paint::plain({64, 64}, color); });
}

std::function<Isometry3d(double)> heldPose(const Hold& hold) {
  return [hold](double time) {
    const Posture who = hold.who->at(std::min(time, hold.until));
    Isometry3d pose = turned({who.x, who.y, 0.0}, who.heading);
    pose.translate(hold.offset);
    pose.translation().z() -= hold.down * eased(time, hold.until, hold.until + hold.seconds);
    return pose;
  };
}

/// Furniture faces -y, people walk along x: a quarter of a turn.
Isometry3f alongWalk(float x, float y, float z) { return placed(x, y, z, -0.5f * kPiF); }

}  // namespace

void addBalloon(const Workshop& w, const Vector3d& around) {
  const Material rubber{oneColour(w.scene.textures, {60, 50, 190}), 0.0f, {0, 0}, {1, 1}};
  Mesh mesh;
  addEllipsoid(mesh, Isometry3f::Identity(), {0.17f, 0.17f, 0.2f}, 32, rubber);
  addCylinder(mesh, {0, 0, -0.23f}, {0, 0, -0.195f}, 0.018f, 0.006f, 10, rubber);
  std::vector<LitMesh> parts;
  parts.push_back(bounded(std::move(mesh)));
  addThing(w.scene, std::move(parts), [around](double time) {
    return turned(around + Vector3d(0.6 * std::sin(0.55 * time - 0.6), 0.25 * std::sin(0.4 * time),
                                    0.2 * std::sin(0.8 * time)),
                  0.2 * time);
  });
}

void addHeldBox(const Workshop& w, const Vector3f& size, const Hold& hold) {
  addFurniture(
      w, [&size](Furnisher& f) { f.cardboardBox(alongWalk(0, 0, 0), size); }, heldPose(hold));
}

void addTrolley(const Workshop& w, const Hold& hold) {
  const auto build = [&w](Furnisher& f) {
    const Material metal{w.palette.grey_metal, 0.3f, {0, 0}, {1, 1}};
    const Material rubber{w.palette.black_plastic, 0.2f, {0, 0}, {1, 1}};
    Mesh frame;
    addBox(frame, placed(0, 0, 0.2f), {0.86f, 0.52f, 0.04f}, BoxMaterials::all(metal), 0.3f);
    for (const float y : {-0.22f, 0.22f}) {
      addCylinder(frame, {-0.41f, y, 0.2f}, {-0.48f, y, 0.98f}, 0.016f, 0.016f, 10, metal);
      for (const float x : {-0.34f, 0.34f}) {
        addCylinder(frame, {x, y - 0.02f, 0.08f}, {x, y + 0.02f, 0.08f}, 0.08f, 0.08f, 16, rubber);
      }
    }
    addCylinder(frame, {-0.48f, -0.22f, 0.98f}, {-0.48f, 0.22f, 0.98f}, 0.016f, 0.016f, 10, rubber);
    f.add(std::move(frame));
    f.cardboardBox(alongWalk(0.12f, 0, 0.22f), {0.44f, 0.5f, 0.36f});
    f.cardboardBox(alongWalk(0.08f, 0.03f, 0.58f), {0.36f, 0.4f, 0.26f});
  };
  addFurniture(w, build, heldPose(hold));
}

void addHeldChair(const Workshop& w, const Hold& hold) {
  addFurniture(
      w, [](Furnisher& f) { f.officeChair(placed(0, 0, 0, 0.5f * kPiF), true); }, heldPose(hold));
}

void addDoor(const Workshop& w, const Eigen::Vector2d& middle) {
  constexpr float kWidth = 0.86f;
  constexpr float kHeight = 2.0f;
  constexpr float kWall = 2.35f;   // (m) high
  constexpr float kBeside = 1.5f;  // (m) of wall on each side
  const auto x = static_cast<float>(middle.x());
  const auto y = static_cast<float>(middle.y());
  const int plaster = w.scene.textures.add([s = mixBits(w.seed + 41)] {
    return paint::plaster({185, 200, 190}, 0.6, s);
  });
  const BoxMaterials wall = BoxMaterials::all({plaster, 1.5f, {0, 0}, {1, 1}});
  Furnisher f(w.scene.room, w.scene.lighting, w.palette, w.seed);
  Mesh around;
  for (const float side : {-1.0f, 1.0f}) {
    addBox(around, placed(x + side * 0.5f * (kWidth + kBeside), y, 0.5f * kWall),
           {kBeside, 0.1f, kWall}, wall, 0.5f);
  }
  addBox(around, placed(x, y, 0.5f * (kWall + kHeight)), {kWidth, 0.1f, kWall - kHeight}, wall,
         0.5f);
  f.add(std::move(around));
  const int picture = w.scene.textures.add([s = mixBits(w.seed + 42)] { return paint::door(s); });
  Mesh leaf;
  addBox(leaf, placed(0.5f * kWidth, 0, 0.5f * kHeight), {kWidth - 0.01f, 0.04f, kHeight - 0.01f},
         BoxMaterials::all({picture, 0.0f, {0, 0}, {1, 1}}), 0.4f);
  std::vector<LitMesh> parts;
  parts.push_back(bounded(std::move(leaf)));
  const Vector3d hinge(middle.x() - 0.5 * static_cast<double>(kWidth), middle.y() - 0.07, 0.0);
  addThing(w.scene, std::move(parts), [hinge](double time) {
    return turned(hinge, -1.3 * (eased(time, 1.0, 2.6) - eased(time, 5.0, 6.6)));
  });
}

void addRobotVacuum(const Workshop& w, const Eigen::Vector2d& around) {
  Mesh mesh;
  addCylinder(mesh, {0, 0, 0.012f}, {0, 0, 0.08f}, 0.17f, 0.17f, 36,
              {w.palette.dark_metal, 0.0f, {0, 0}, {1, 1}});
  addCylinder(mesh, {0, 0, 0.08f}, {0, 0, 0.09f}, 0.17f, 0.155f, 36,
              {w.palette.white_plastic, 0.0f, {0, 0}, {1, 1}});
  addCylinder(mesh, {0.06f, 0, 0.09f}, {0.06f, 0, 0.105f}, 0.045f, 0.04f, 20,
              {w.palette.black_plastic, 0.0f, {0, 0}, {1, 1}});
  std::vector<LitMesh> parts;
  parts.push_back(bounded(std::move(mesh)));
  addThing(w.scene, std::move(parts), [around](double time) {
    constexpr double kStart = 1.0;  // (s)
    constexpr double kRamp = 0.5;   // (s) until it has its speed
    const double since = std::max(0.0, time - kStart);
    const double way = since < kRamp ? 0.5 * since * since / kRamp : since - 0.5 * kRamp;
    const double a = 0.4 * way;
    const Eigen::Vector2d along(0.8 * 0.4 * std::cos(a), 0.4 * 0.8 * std::cos(2.0 * a));
    return turned({around.x() + 0.8 * std::sin(a), around.y() + 0.4 * std::sin(2.0 * a), 0.0},
                  std::atan2(along.y(), along.x()));
  });
}

}  // namespace hmcdyn::synthesize
