// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/scene_catalog.hpp"

#include <stdexcept>
#include <utility>

#include "synthesize/stage.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3d;

/// Walks to and fro in front of the desks along y = `lane`, then once around them.
Behaviour aroundDesks(double lane, double speed) {
  Behaviour b;
  b.start = {-0.9, lane};
  b.actions = {walkTo(0.75, lane, speed), standFor(0.6, 1.2, 0.8),   walkTo(-0.75, lane, speed),
               walkTo(0.9, lane, speed),  walkTo(2.35, -0.6, speed), walkTo(2.5, 0.9, speed),
               walkTo(1.9, 1.35, speed),  walkTo(-2.0, 1.35, speed), walkTo(-2.75, 0.6, speed),
               walkTo(-2.4, -0.9, speed)};
  return b;
}

/// Gets up from the right chair, walks, talks, sits down again.
Behaviour leavesChair(double seconds_seated) {
  Behaviour b;
  b.start = {0.47, -0.29};
  b.heading = 2.27;
  b.starts_seated = true;
  b.actions = {
      sitFor(seconds_seated, 2.27, 0.6), walkTo(-0.05, -0.4, 0.6), walkTo(-0.1, -0.95, 0.9),
      walkTo(-1.7, -0.98, 1.0),          standFor(1.2, 0.3, 1.0),  walkTo(1.5, -0.98, 1.1),
      standFor(1.0, kTowards, 0.5),      walkTo(-0.1, -0.95, 0.9), walkTo(-0.05, -0.4, 0.6),
      walkTo(0.47, -0.29, 0.5),          standFor(0.8, 2.27)};
  return b;
}

Behaviour paces(double from, double to, double lane, double speed, double pause, double gesture) {
  Behaviour b;
  b.start = {from, lane};
  b.heading = to > from ? kRight : kLeft;
  b.actions = {walkTo(to, lane, speed)};
  if (pause > 0.0) {
    b.actions.push_back(standFor(pause, kTowards, gesture));
  }
  b.actions.push_back(walkTo(from, lane, speed));
  if (pause > 0.0) {
    b.actions.push_back(standFor(pause, kTowards, gesture));
  }
  return b;
}

Round hallRound() {
  Round round;
  round.centre = {0.0, -0.8, 1.45};
  return round;
}

/// Along the walls of the hall, around a camera in its middle, one way or the other.
Behaviour aroundCamera(bool clockwise) {
  Behaviour b;
  if (clockwise) {
    b.start = {-1.9, -2.6};
    b.actions = {walkTo(-1.9, 0.9, 0.9), walkTo(1.9, 0.9, 0.9), standFor(0.8, kLeft, 0.8),
                 walkTo(1.9, -2.6, 0.9), walkTo(-1.9, -2.6, 0.9)};
  } else {
    b.start = {2.1, 0.6};
    b.actions = {walkTo(-2.1, 0.6, 1.0), walkTo(-2.1, -2.4, 1.0), walkTo(2.1, -2.4, 1.0),
                 walkTo(2.1, 0.6, 1.0)};
  }
  return b;
}

void walkingPair(Stage& stage, double lane) {
  stage.person(aroundDesks(lane, 1.05));
  stage.person(leavesChair(2.0));
}

void sittingPair(Stage& stage) {
  Behaviour left;
  left.start = {-0.52, -0.29};
  left.heading = 0.87;
  left.starts_seated = true;
  left.actions = {sitFor(1000.0, 0.87, 0.9)};
  Behaviour right = left;
  right.start = {0.47, -0.29};
  right.heading = 2.27;
  right.actions = {sitFor(1000.0, 2.27, 0.8)};
  stage.person(left);
  stage.person(right);
}

HalfSphere officeSphere() {
  HalfSphere sphere;
  sphere.centre = {0.0, 0.3, 0.9};
  sphere.radius = 2.8;
  sphere.azimuth = 0.55;
  sphere.azimuth_period = 22.0;
  sphere.low = 0.1;
  sphere.high = 0.42;
  return sphere;
}

/// People who walk to and fro in lanes of different distance from the camera.
void crowdOf(Stage& stage, int people, double nearest, double gap) {
  for (int i = 0; i < people; ++i) {
    Random random(stage.options.seed * 77 + static_cast<std::uint64_t>(people),
                  100 + static_cast<std::uint64_t>(i));
    const double lane = nearest + gap * i;
    const double reach = random.uniform(0.5, 0.8) + 0.1 * i;
    const double speed = random.uniform(0.6, 1.15);
    Behaviour b = i % 2 == 0 ? paces(-reach, reach, lane, speed, random.uniform(0.3, 1.0), 1.0)
                             : paces(reach, -reach, lane, speed, random.uniform(0.3, 1.0), 0.6);
    b.lag = random.uniform(0.3, 3.0);
    stage.person(b);
  }
}

void hallWalkers(Stage& stage) {
  stage.person(paces(-1.1, 1.1, -0.7, 1.0, 0.8, 0.8));
  Behaviour second = paces(1.5, -1.4, 0.1, 0.85, 0.0, 0.0);
  second.lag = 0.8;
  stage.person(second);
  Behaviour third;
  third.start = {0.9, 1.2};
  third.heading = kTowards;
  third.actions = {standFor(3.0, kTowards, 0.4), walkTo(-1.5, 1.3, 0.9), standFor(2.0, kTowards),
                   walkTo(0.9, 1.2, 0.9)};
  stage.person(third);
}

void addOfficeRecipes(std::vector<Recipe>& r) {
  r.push_back({{"walking_xyz", "office, two people walk and sit down, camera along x, y and z"},
               [](Stage& s) {
                 s.office();
                 walkingPair(s, -1.35);
                 s.carried(axesPath(officeView(), 0.24, 5.0));
               }});
  r.push_back(
      {{"walking_halfsphere", "office, two people walk, camera on a half sphere"}, [](Stage& s) {
         s.office();
         walkingPair(s, -1.0);
         s.carried(halfSpherePath(officeSphere()));
       }});
  r.push_back(
      {{"walking_rpy", "office, two people walk, camera rolls, pitches and yaws"}, [](Stage& s) {
         s.office();
         walkingPair(s, -1.35);
         s.carried(rotationsPath(officeView(), 0.25, 4.5));
       }});
  r.push_back(
      {{"walking_static", "office, two people walk, camera held still by hand"}, [](Stage& s) {
         s.office();
         walkingPair(s, -1.2);
         s.held(stillPath(officeView()));
       }});
  r.push_back({{"sitting_halfsphere", "office, two people sit and talk, camera on a half sphere"},
               [](Stage& s) {
                 s.office();
                 sittingPair(s);
                 HalfSphere sphere = officeSphere();
                 sphere.radius = 2.3;
                 s.carried(halfSpherePath(sphere));
               }});
  r.push_back({{"sitting_static", "office, two people sit and talk, camera held still by hand"},
               [](Stage& s) {
                 s.office();
                 sittingPair(s);
                 s.held(stillPath(lookAt({0.0, -2.1, 1.4}, kOfficeTarget)));
               }});
}

void addHallRecipes(std::vector<Recipe>& r) {
  const Vector3d reach(0.4, 0.25, 0.12);
  r.push_back(
      {{"crowd", "hall, six people walk to and fro close to the camera"}, [reach](Stage& s) {
         s.hall();
         crowdOf(s, 6, -1.5, 0.36);
         s.carried(strollPath(kHallEye, reach, kHallTarget, 11.0));
       }});
  r.push_back(
      {{"crowd2", "hall, seven people, closer still, pausing and talking"}, [reach](Stage& s) {
         s.hall();
         crowdOf(s, 7, -1.5, 0.36);
         s.carried(strollPath(kHallEye, reach, kHallTarget, 13.0));
       }});
  r.push_back({{"crowd3", "hall, eight people in narrow lanes"}, [reach](Stage& s) {
                 s.hall();
                 crowdOf(s, 8, -1.55, 0.33);
                 s.carried(strollPath(kHallEye, 0.8 * reach, kHallTarget, 9.0));
               }});
  r.push_back({{"synchronous2", "hall, two people walk side by side in step"}, [reach](Stage& s) {
                 s.hall();
                 for (const double lane : {-0.7, -0.1}) {
                   Behaviour b = paces(-1.0, 1.0, lane, 0.95, 0.4, 0.0);
                   b.seed = 4242;  // the same for both: the same gait at the same time
                   s.person(b);
                 }
                 s.carried(strollPath(kHallEye, 0.8 * reach, kHallTarget, 12.0));
               }});
  r.push_back({{"half", "hall, three people, camera on a half sphere (paper's own recording)"},
               [](Stage& s) {
                 s.hall();
                 hallWalkers(s);
                 HalfSphere sphere;
                 sphere.centre = {0.0, 0.8, 0.9};
                 sphere.radius = 3.1;
                 sphere.azimuth = 0.5;
                 sphere.low = 0.1;
                 sphere.high = 0.36;
                 s.carried(halfSpherePath(sphere));
               }});
  r.push_back({{"xyz", "hall, three people, camera along x, y and z (paper's own recording)"},
               [](Stage& s) {
                 s.hall();
                 hallWalkers(s);
                 s.carried(axesPath(hallView(), 0.26, 5.0));
               }});
  r.push_back({{"tri", "hall, three people, camera around a triangle (paper's own recording)"},
               [](Stage& s) {
                 s.hall();
                 hallWalkers(s);
                 s.carried(trianglePath({-0.45, -3.0, 1.45}, 0.9, 11.0, kHallTarget));
               }});
  r.push_back({{"front", "hall, three people, camera to and fro along its view (paper's own)"},
               [](Stage& s) {
                 s.hall();
                 hallWalkers(s);
                 s.carried(shuttlePath(hallView(), {0.0, 0.9, -0.1}, 9.0));
               }});
  r.push_back(
      {{"static", "hall, three people, camera on a table (paper's own recording)"}, [](Stage& s) {
         s.hall();
         hallWalkers(s);
         s.camera(handHeld(stillPath(hallView()), 0.0001, 0.0001, s.options.seed));
       }});
}

void addHardRecipes(std::vector<Recipe>& r) {
  r.push_back({{"along_line", "people walk along the epipolar lines of a camera moving sideways"},
               [](Stage& s) {
                 s.office();
                 s.person(paces(-1.1, 1.1, -0.95, 0.8, 0.0, 0.0));
                 Behaviour back = paces(1.5, -1.5, 1.35, 0.9, 0.0, 0.0);
                 back.lag = 0.5;
                 s.person(back);
                 s.carried(shuttlePath(officeView(), {0.8, 0.0, 0.0}, 8.0));
               }});
  r.push_back({{"occluder", "boxes, a plant and a broom hide parts of the people behind them"},
               [](Stage& s) {
                 s.office(true);
                 s.person(paces(-1.0, 1.0, -0.85, 0.8, 0.6, 0.8));
                 Behaviour back = paces(1.2, -1.5, 1.35, 0.9, 0.5, 0.0);
                 s.person(back);
                 s.carried(axesPath(officeView(), 0.22, 5.0));
               }});
  r.push_back({{"late_start", "two people stand still for five and seven seconds, then walk"},
               [](Stage& s) {
                 s.office();
                 Behaviour first;
                 first.start = {-0.25, -1.0};
                 first.heading = -1.2;
                 first.actions = {standFor(5.0, -1.2), walkTo(0.8, -1.1, 1.0),
                                  walkTo(-0.9, -1.1, 1.0), walkTo(-0.25, -1.0, 1.0)};
                 Behaviour second = first;
                 second.start = {1.35, -0.6};
                 second.heading = -2.0;
                 second.actions = {standFor(7.0, -2.0), walkTo(0.6, -1.45, 0.9),
                                   walkTo(-0.6, -1.5, 1.1), walkTo(1.35, -0.6, 1.1)};
                 s.person(first);
                 s.person(second);
                 s.carried(axesPath(officeView(), 0.2, 5.0));
               }});
  r.push_back({{"still_camera", "the camera does not move at all, two people walk"}, [](Stage& s) {
                 s.office();
                 walkingPair(s, -1.2);
                 s.camera(stillPath(officeView()));
               }});
  r.push_back({{"pure_rotation", "the camera turns around its optical centre, two people walk"},
               [](Stage& s) {
                 s.office();
                 walkingPair(s, -1.3);
                 s.camera(panningPath(officeView(), 0.28, 0.09, 7.0));
               }});
  r.push_back(
      {{"low_texture", "blank walls, a plain floor and bare desks, two people walk"}, [](Stage& s) {
         s.bareOffice();
         walkingPair(s, -1.3);
         s.carried(axesPath(officeView(), 0.24, 5.0));
       }});
  r.push_back({{"empty", "the office with nobody in it, camera along x, y and z"}, [](Stage& s) {
                 s.office();
                 s.carried(axesPath(officeView(), 0.24, 5.0));
               }});
  r.push_back({{"round", "the hall with nobody in it, camera once round in 14 s and on: a loop"},
               [](Stage& s) {
                 s.hall();
                 s.carried(roundPath(hallRound()));
               }});
  r.push_back(
      {{"walking_round", "the same round, two people walk between camera and walls"}, [](Stage& s) {
         s.hall();
         s.person(aroundCamera(false));
         s.person(aroundCamera(true));
         s.carried(roundPath(hallRound()));
       }});
}

std::vector<Recipe> allRecipes() {
  std::vector<Recipe> recipes;
  addOfficeRecipes(recipes);
  addHallRecipes(recipes);
  addHardRecipes(recipes);
  addThingRecipes(recipes);
  return recipes;
}

}  // namespace

const std::vector<SceneInfo>& sceneCatalog() {
  static const std::vector<SceneInfo> kCatalog = [] {
    std::vector<SceneInfo> infos;
    for (const Recipe& recipe : allRecipes()) {
      infos.push_back(recipe.info);
    }
    return infos;
  }();
  return kCatalog;
}

BuiltScene buildScene(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const Recipe& recipe : allRecipes()) {
    if (recipe.info.name == name) {
      Stage stage;
      stage.options = options;
      recipe.stage(stage);
      if (options.paint) {
        stage.built.scene.textures.paint(options.threads, options.max_texture);
      }
      return std::move(stage.built);
    }
    known += (known.empty() ? "" : ", ") + recipe.info.name;
  }
  throw std::invalid_argument("scene is '" + name + "', expected one of: " + known);
}

}  // namespace hmcdyn::synthesize
