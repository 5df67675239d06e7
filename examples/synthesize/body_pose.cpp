// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "synthesize/body.hpp"
#include "synthesize/body_proportions.hpp"
#include "synthesize/pi.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d offset(const Vector3d& t) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = t;
  return pose;
}

Isometry3d rotation(double angle, const Vector3d& axis) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = AngleAxisd(angle, axis).toRotationMatrix();
  return pose;
}

/// Frame of a limb: origin at `from`, -z towards `to`, x as near to `forward` as can be.
Isometry3d limbPose(const Vector3d& from, const Vector3d& to, const Vector3d& forward) {
  const Vector3d z = (from - to).normalized();
  const Vector3d x = (forward - forward.dot(z) * z).normalized();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = from;
  return pose;
}

/// Where a foot is in the gait, in the frame of the walk.
struct FootTarget {
  double x = 0.0;      ///< Forward of the body (m).
  double lift = 0.0;   ///< Over the floor (m).
  double pitch = 0.0;  ///< Toes down (rad).
};

FootTarget footAt(double phase, const Posture& p) {
  constexpr double kStance = 0.6;  // share of the cycle on the floor
  const double cycle = phase - std::floor(phase);
  FootTarget foot;
  if (cycle < kStance) {
    foot.x = p.step * (0.5 - cycle / kStance);
  } else {
    const double q = (cycle - kStance) / (1.0 - kStance);
    foot.x = p.step * (-0.5 + q * q * (3.0 - 2.0 * q));
    foot.lift = 0.07 * p.swing * std::sin(kPi * q);
  }
  // The heel rises before the toes leave, and strikes first.
  const double rise = std::exp(-std::pow((cycle - 0.62) / 0.11, 2.0));
  const double strike = std::exp(-std::pow((cycle - 0.95) / 0.06, 2.0));
  foot.pitch = p.swing * (0.6 * rise - 0.22 * strike);
  foot.lift += 0.12 * std::max(0.0, std::sin(foot.pitch));
  return foot;
}

/// Thigh, shin and foot of one leg.
void appendLeg(double h, const Isometry3d& root, const Vector3d& hip, double side,
               const FootTarget& foot, std::vector<Isometry3d>& poses) {
  const Vector3d forward = root.linear().col(0);
  const Vector3d ankle = root * Vector3d(foot.x, side * proportions::kHipHalfWidth * h,
                                         static_cast<double>(proportions::kAnkle) * h + foot.lift);
  const double thigh = static_cast<double>(proportions::kThigh) * h;
  const double shin = static_cast<double>(proportions::kShin) * h;
  const Vector3d to_ankle = ankle - hip;
  const double reach = std::clamp(to_ankle.norm(), 0.3 * h * 0.5, 0.999 * (thigh + shin));
  const Vector3d along = to_ankle.normalized();
  const double share = (thigh * thigh - shin * shin + reach * reach) / (2.0 * reach);
  const double bend = std::sqrt(std::max(0.0, thigh * thigh - share * share));
  const Vector3d hint = forward + Vector3d(0.0, 0.0, 0.3);
  const Vector3d outward = (hint - hint.dot(along) * along).normalized();
  const Vector3d knee = hip + share * along + bend * outward;
  const Vector3d end = hip + reach * along;
  const Vector3d toes = forward + Vector3d(0.0, 0.0, 0.5);
  poses.push_back(limbPose(hip, knee, toes));
  poses.push_back(limbPose(knee, end, toes));
  Isometry3d shoe = offset(end);
  shoe.linear() = root.linear() * AngleAxisd(foot.pitch, Vector3d::UnitY()).toRotationMatrix();
  poses.push_back(shoe);
}

/// Upper arm and forearm of one side. Angles in the chest's frame (rad).
void appendArm(double h, const Isometry3d& chest, double side, double raise, double elbow,
               double spread, std::vector<Isometry3d>& poses) {
  const Vector3d shoulder =
      chest * Vector3d(0.0, side * proportions::kShoulderHalfWidth * h, proportions::kShoulder * h);
  const auto direction = [&](double pitch, double inward) -> Vector3d {
    return chest.linear() * Vector3d(std::sin(pitch) * std::cos(inward), -side * std::sin(inward),
                                     -std::cos(pitch) * std::cos(inward));
  };
  const Vector3d elbow_point =
      shoulder + static_cast<double>(proportions::kUpperArm) * h * direction(raise, -spread);
  const Vector3d wrist =
      elbow_point + static_cast<double>(proportions::kForearm) * h *
                        direction(raise + elbow, 0.25 * std::min(1.0, elbow) - 0.3 * spread);
  const Vector3d forward = chest.linear() * Vector3d(1.0, 0.0, 0.4);
  poses.push_back(limbPose(shoulder, elbow_point, forward));
  poses.push_back(limbPose(elbow_point, wrist, forward));
}

}  // namespace

std::vector<Isometry3d> bodyPoses(double height, const Posture& p) {
  const double h = height;
  const Isometry3d root = offset({p.x, p.y, 0.0}) * rotation(p.heading, Vector3d::UnitZ());
  const double cycle = 2.0 * kPi * p.phase;
  // The hips sink while the legs are apart, so that both feet can reach the floor.
  const double spread_angle = 0.5 * p.step / (2.0 * 0.245 * h);
  const double sink = 0.5 * p.swing * h * 0.49 * spread_angle * spread_angle * 1.2;
  const double bob = 0.012 * p.swing * std::cos(2.0 * cycle + 0.6);
  const double seat = 0.46 + 0.06 * h;
  const double hip_height = (proportions::kHip * h - sink + bob) * (1.0 - p.sit) + seat * p.sit;
  const double hips_back = -0.24 * h * p.sit;
  const double hip_sway = 0.012 * p.swing * std::sin(cycle);
  const double hip_yaw = 0.09 * p.swing * std::cos(cycle);
  const Isometry3d pelvis =
      root * offset({hips_back, hip_sway, hip_height}) * rotation(-hip_yaw, Vector3d::UnitZ());
  const Isometry3d chest = root * offset({hips_back, hip_sway, hip_height}) *
                           offset({0.0, 0.0, proportions::kWaist * h}) *
                           rotation(p.lean + 0.04 * p.swing, Vector3d::UnitY()) *
                           rotation(-p.sway, Vector3d::UnitX()) *
                           rotation(p.twist + 0.8 * hip_yaw, Vector3d::UnitZ());
  const Isometry3d head = chest * offset({0.0, 0.0, proportions::kNeck * h}) *
                          rotation(p.head_yaw - 0.8 * hip_yaw, Vector3d::UnitZ()) *
                          rotation(p.head_pitch - 0.6 * p.lean, Vector3d::UnitY());
  std::vector<Isometry3d> poses{pelvis, chest, head};
  const double arm_swing = 0.42 * p.swing * std::cos(cycle);
  const double natural = 0.18 + 0.16 * p.swing;
  appendArm(h, chest, 1.0, -arm_swing + p.left_raise, natural - 0.2 * arm_swing + p.left_elbow,
            0.08 + p.left_spread, poses);
  appendArm(h, chest, -1.0, arm_swing + p.right_raise, natural + 0.2 * arm_swing + p.right_elbow,
            0.08 + p.right_spread, poses);
  for (const double side : {1.0, -1.0}) {
    const Vector3d hip = pelvis * Vector3d(0.0, side * proportions::kHipHalfWidth * h, 0.0);
    appendLeg(h, root, hip, side, footAt(p.phase + (side > 0.0 ? 0.0 : 0.5), p), poses);
  }
  return poses;
}

}  // namespace hmcdyn::synthesize
