// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "synthesize/lighting.hpp"
#include "synthesize/paint.hpp"
#include "synthesize/texture.hpp"

namespace hmcdyn::synthesize {

/// What a person looks like.
struct BodyLook {
  double height = 1.78;  ///< (m)
  double girth = 1.0;    ///< Factor of the widths, about 0.9..1.15.
  paint::Cloth shirt = paint::Cloth::kChecks;
  paint::Color shirt_color{150, 120, 90};
  paint::Color shirt_second{230, 230, 230};
  paint::Cloth trousers = paint::Cloth::kDenim;
  paint::Color trousers_color{95, 65, 45};
  paint::Color skin{150, 175, 220};
  paint::Color hair{35, 50, 70};
  bool long_sleeves = false;
  bool beard = false;
  bool glasses = false;
  std::uint64_t seed = 1;
};

/// A look drawn from a seed: 1.65-1.9 m tall, one of many clothes.
BodyLook randomLook(std::uint64_t seed);

/// How a person stands in the world at one moment. x forward, y left, z up.
struct Posture {
  double x = 0.0;             ///< Point on the floor between the feet (m).
  double y = 0.0;             ///< (m)
  double heading = 0.0;       ///< Direction of the walk in the plane (rad), 0 = +x of the world.
  double phase = 0.0;         ///< Of the gait (cycles); the left heel strikes at whole numbers.
  double step = 0.0;          ///< Way of a foot on the floor, relative to the body (m).
  double swing = 0.0;         ///< 0 = standing, 1 = walking.
  double sit = 0.0;           ///< 0 = upright, 1 = on a chair of 0.46 m.
  double lean = 0.0;          ///< Of the trunk, forward (rad).
  double sway = 0.0;          ///< Of the trunk, to the left (rad).
  double twist = 0.0;         ///< Of the chest against the pelvis, to the left (rad).
  double head_yaw = 0.0;      ///< To the left (rad).
  double head_pitch = 0.0;    ///< Down (rad).
  double left_raise = 0.0;    ///< Upper arm forward, beyond the swing of the gait (rad).
  double right_raise = 0.0;   ///< (rad)
  double left_elbow = 0.0;    ///< Bend beyond the natural one (rad).
  double right_elbow = 0.0;   ///< (rad)
  double left_spread = 0.0;   ///< Upper arm away from the body (rad).
  double right_spread = 0.0;  ///< (rad)
};

/// The rigid parts of a body, in the order of bodyPoses().
std::vector<LitMesh> buildBody(TextureLibrary& textures, const BodyLook& look);

/// Places of the parts in the world. Feet that should stand still do: the legs are solved from the
/// ankles (two-link inverse kinematics).
std::vector<Eigen::Isometry3d> bodyPoses(double height, const Posture& posture);

}  // namespace hmcdyn::synthesize
