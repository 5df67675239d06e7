// SPDX-License-Identifier: BSD-3-Clause
// Scenes of things that move and that no detector knows. Where somebody moves them he or she has a
// box, the thing has none.
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "synthesize/behaviour.hpp"
#include "synthesize/furniture.hpp"
#include "synthesize/stage.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3d;

/// Stands for a second, walks along x with something in front, leaves it, and walks back.
Behaviour takesAlong(double from, double to, double lane, double speed) {
  Behaviour b;
  b.start = {from, lane};
  b.heading = kRight;
  b.actions = {carrying(standFor(1.0, kRight)), carrying(walkTo(to, lane, speed)),
               standFor(2.2, kRight), walkTo(from - 0.4, lane + 0.1, 0.9), standFor(100.0, kRight)};
  return b;
}
constexpr std::size_t kArrival = 2;  // number of the action that begins there

void carriesBox(Stage& s) {
  s.hall();
  constexpr double kLane = -0.4;
  const auto who = s.person(takesAlong(-1.1, 0.35, kLane, 0.7));
  // a crate to put it on
  Furnisher crates(s.built.scene.room, s.built.scene.lighting, s.palette.value(), s.options.seed);
  crates.cardboardBox(placed(0.85f, static_cast<float>(kLane), 0), {0.6f, 0.6f, 0.62f});
  Hold hold;
  hold.who = who;
  hold.offset = {0.46, 0.0, 0.95};
  hold.until = who->startOf(kArrival);
  hold.down = 0.95 - 0.625;
  addHeldBox(s.workshop(), {0.46f, 0.36f, 0.32f}, hold);
  s.carried(axesPath(hallView(), 0.24, 5.0));
}

void pushesTrolley(Stage& s) {
  s.hall();
  Hold hold;
  hold.who = s.person(takesAlong(-1.35, 0.9, -0.2, 0.75));
  hold.offset = {0.86, 0.0, 0.0};
  hold.until = hold.who->startOf(kArrival);
  addTrolley(s.workshop(), hold);
  s.carried(axesPath(hallView(), 0.24, 5.0));
}

void leavesAChair(Stage& s) {
  s.office();
  Hold hold;
  hold.who = s.person(takesAlong(-0.9, 0.3, -1.1, 0.5));
  hold.offset = {0.55, 0.0, 0.0};
  hold.until = hold.who->startOf(kArrival);
  addHeldChair(s.workshop(), hold);
  s.carried(axesPath(lookAt(kOfficeEye, {0.0, -0.3, 0.7}), 0.24, 5.0));
}

}  // namespace

void addThingRecipes(std::vector<Recipe>& r) {
  r.push_back({{"balloon", "office, nobody; a balloon of one colour drifts in front of the desks"},
               [](Stage& s) {
                 s.office();
                 addBalloon(s.workshop(), {0.0, -0.75, 1.25});
                 s.carried(axesPath(officeView(), 0.24, 5.0));
               }});
  r.push_back(
      {{"carried_box", "hall, somebody carries a box, puts it down and walks away"}, carriesBox});
  r.push_back({{"trolley", "hall, somebody pushes a trolley with boxes"}, pushesTrolley});
  r.push_back({{"opening_door", "hall, nobody; a door opens and shuts"}, [](Stage& s) {
                 s.hall();
                 addDoor(s.workshop(), {0.1, 0.3});
                 s.carried(axesPath(hallView(), 0.24, 5.0));
               }});
  r.push_back({{"moved_chair", "office, somebody pushes a chair to another place and leaves it"},
               leavesAChair});
  r.push_back({{"robot_vacuum", "office, nobody; a flat robot cleans the floor"}, [](Stage& s) {
                 s.office();
                 addRobotVacuum(s.workshop(), {0.0, -0.95});
                 s.carried(axesPath(lookAt(kOfficeEye, {0.0, -0.7, 0.35}), 0.24, 5.0));
               }});
}

}  // namespace hmcdyn::synthesize
