// SPDX-License-Identifier: BSD-3-Clause
// Things that move and that no detector knows: not people, so they get no box.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include <Eigen/Core>

#include "synthesize/behaviour.hpp"
#include "synthesize/furniture.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

/// How somebody holds a thing, and when it is left.
struct Hold {
  std::shared_ptr<const Performance> who;
  /// The thing's origin in the frame of the feet: x forward, y left, z up (m).
  Eigen::Vector3d offset{0.5, 0.0, 0.0};
  double until = std::numeric_limits<double>::infinity();  ///< Afterwards it stays where it is (s),
  double down = 0.0;                                       ///< lowered by so much (m)
  double seconds = 1.2;                                    ///< in this time (s).
};

/// What things are made of; all borrowed.
struct Workshop {
  Scene& scene;
  const Palette& palette;
  std::uint64_t seed;
};

/// Adds a balloon of one colour, 0.34 m wide, that drifts at up to 0.4 m/s around a point (m).
void addBalloon(const Workshop& workshop, const Eigen::Vector3d& around);

/// Adds a cardboard box of a size (m) whose origin is the middle of its bottom.
void addHeldBox(const Workshop& workshop, const Eigen::Vector3f& size, const Hold& hold);

/// Adds a trolley with two boxes on it; its handle is 0.48 m behind its origin on the floor.
void addTrolley(const Workshop& workshop, const Hold& hold);

/// Adds an office chair whose origin is on the floor; its back is towards who holds it.
void addHeldChair(const Workshop& workshop, const Hold& hold);

/// Adds a wall across the room with a doorway of 0.86 m x 2 m, and the door in it: shut for a
/// second, then it opens towards -y, and shuts again after 4 s. @param middle of the doorway on the
/// floor (m).
void addDoor(const Workshop& workshop, const Eigen::Vector2d& middle);

/// Adds a robot of 0.34 m x 0.09 m that cleans the floor around a point (m) at up to 0.4 m/s, from
/// one second on.
void addRobotVacuum(const Workshop& workshop, const Eigen::Vector2d& around);

}  // namespace hmcdyn::synthesize
