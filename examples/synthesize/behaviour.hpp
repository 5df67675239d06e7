// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "synthesize/body.hpp"

namespace hmcdyn::synthesize {

/// One thing a person does after the other.
struct Action {
  enum class Kind {
    kWalk,   ///< To `target` at `speed`.
    kStand,  ///< For `seconds`, turned to `heading`.
    kSit,    ///< The same on a chair behind the feet; gets up afterwards.
  };
  Kind kind = Kind::kStand;
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  ///< (m)
  double speed = 1.0;                                ///< (m/s)
  double seconds = 1.0;                              ///< (s)
  double heading = 0.0;                              ///< (rad)
  double gesture = 0.0;                              ///< 0 = still, 1 = talks with both hands.
  double carry = 0.0;                                ///< 1 = both hands hold something in front.
};

Action walkTo(double x, double y, double speed = 1.0);
Action standFor(double seconds, double heading, double gesture = 0.0);
Action sitFor(double seconds, double heading, double gesture = 0.0);
/// The same with both hands on something in front.
Action carrying(Action action);

/// What a person does, from the first frame on; the actions repeat.
struct Behaviour {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< (m)
  double heading = 0.0;                             ///< (rad)
  bool starts_seated = false;
  double lag = 0.0;  ///< How far into the actions the first frame is (s).
  std::vector<Action> actions;
  std::uint64_t seed = 0;  ///< Of the small movements; 0 = the scene chooses one.
};

/// Postures over time: the behaviour played once through and kept, then read at any time.
class Performance {
 public:
  /// @param seconds how long it must last after the first frame.
  /// @throws std::invalid_argument without actions or with a time that is not positive.
  Performance(const Behaviour& behaviour, double seconds);

  /// Between the samples linear; before the first and after the last still.
  Posture at(double time) const;
  /// When the action of this number begins for the first time (s); infinite = not while it lasts.
  /// @throws std::out_of_range for a number that no action has.
  double startOf(std::size_t action) const { return starts_.at(action); }

 private:
  std::vector<Posture> samples_;
  std::vector<double> starts_;
};

}  // namespace hmcdyn::synthesize
