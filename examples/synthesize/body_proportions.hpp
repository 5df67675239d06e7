// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Lengths of a grown-up's body as shares of the height (Drillis and Contini 1966, rounded).
namespace hmcdyn::synthesize::proportions {

inline constexpr double kHip = 0.525;           ///< Height of the hip joints over the floor.
inline constexpr double kHipHalfWidth = 0.052;  ///< Hip joint from the middle.
inline constexpr double kWaist = 0.08;          ///< Of the trunk's hinge over the hips.
inline constexpr double kShoulder = 0.215;      ///< Shoulder joint over the waist.
inline constexpr double kShoulderHalfWidth = 0.118;
inline constexpr double kNeck = 0.255;  ///< Base of the neck over the waist.
inline constexpr float kUpperArm = 0.172f;
inline constexpr float kForearm = 0.146f;
inline constexpr float kThigh = 0.245f;
inline constexpr float kShin = 0.246f;
inline constexpr float kAnkle = 0.045f;  ///< Height of the ankle over the sole.

}  // namespace hmcdyn::synthesize::proportions
