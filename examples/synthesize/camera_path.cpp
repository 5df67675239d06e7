// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/camera_path.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "synthesize/pi.hpp"
#include "synthesize/random.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d turned(const Isometry3d& pose, const Vector3d& axis, double angle) {
  Isometry3d result = pose;
  result.linear() = pose.linear() * AngleAxisd(angle, axis).toRotationMatrix();
  return result;
}

/// Which of three slots a time is in, and how far out the swing of that slot is (-1..1). Starts
/// and ends every slot at rest.
std::pair<int, double> slotAndSwing(double time, double slot) {
  const double place = time / slot;
  const double number = std::floor(place);
  const double q = place - number;
  const int index = static_cast<int>(number) % 3;
  return {index < 0 ? index + 3 : index, 1.3 * std::sin(2.0 * kPi * q) * std::sin(kPi * q)};
}

/// Six slow signals of unit variance, one a degree of freedom.
class Tremble {
 public:
  explicit Tremble(std::uint64_t seed) {
    Random random(seed, 23);
    for (auto& axis : axes_) {
      for (auto& term : axis) {
        term.rate = 2.0 * kPi * random.uniform(0.25, 1.9);
        term.phase = random.uniform(0.0, 2.0 * kPi);
      }
    }
  }
  double at(std::size_t axis, double time) const {
    double sum = 0.0;
    for (const Term& term : axes_[axis]) {
      sum += std::sin(term.rate * time + term.phase);
    }
    return sum * std::sqrt(2.0 / static_cast<double>(axes_[axis].size()));
  }

 private:
  struct Term {
    double rate = 0.0, phase = 0.0;
  };
  std::array<std::array<Term, 5>, 6> axes_;
};

}  // namespace

Isometry3d lookAt(const Vector3d& position, const Vector3d& target) {
  const Vector3d forward = (target - position).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() << right, forward.cross(right), forward;
  pose.translation() = position;
  return pose;
}

CameraPath stillPath(const Isometry3d& pose) {
  return [pose](double) { return pose; };
}

CameraPath axesPath(const Isometry3d& pose, double amplitude, double slot) {
  return [=](double time) {
    const auto [axis, swing] = slotAndSwing(time, slot);
    Isometry3d moved = pose;
    moved.translation()[axis] += (axis == 2 ? 0.7 : 1.0) * amplitude * swing;
    return moved;
  };
}

CameraPath rotationsPath(const Isometry3d& pose, double amplitude, double slot) {
  return [=](double time) {
    static const std::array<Vector3d, 3> kAxes{Vector3d::UnitZ(), Vector3d::UnitX(),
                                               Vector3d::UnitY()};
    const auto [axis, swing] = slotAndSwing(time, slot);
    return turned(pose, kAxes[static_cast<std::size_t>(axis)], amplitude * swing);
  };
}

CameraPath panningPath(const Isometry3d& pose, double yaw, double pitch, double period) {
  return [=](double time) {
    const double angle = 2.0 * kPi * time / period;
    return turned(turned(pose, Vector3d::UnitY(), yaw * std::sin(angle)), Vector3d::UnitX(),
                  pitch * std::sin(1.7 * angle));
  };
}

CameraPath halfSpherePath(const HalfSphere& s) {
  return [s](double time) {
    const double azimuth = s.azimuth * std::sin(2.0 * kPi * time / s.azimuth_period - 0.9);
    const double middle = 0.5 * (s.low + s.high);
    const double elevation =
        middle + 0.5 * (s.high - s.low) * std::sin(2.0 * kPi * time / s.elevation_period);
    const Vector3d direction(std::cos(elevation) * std::sin(azimuth),
                             -std::cos(elevation) * std::cos(azimuth), std::sin(elevation));
    return lookAt(s.centre + s.radius * direction, s.centre);
  };
}

CameraPath shuttlePath(const Isometry3d& pose, const Vector3d& way, double period) {
  return [=](double time) {
    Isometry3d moved = pose;
    moved.translation() += 0.5 * std::sin(2.0 * kPi * time / period) * way;
    return moved;
  };
}

CameraPath trianglePath(const Vector3d& corner, double side, double period,
                        const Vector3d& target) {
  const std::array<Vector3d, 3> corners{corner, corner + Vector3d(side, 0.0, 0.0),
                                        corner + Vector3d(0.5 * side, 0.866 * side, 0.0)};
  return [=](double time) {
    // The way around, averaged over a window, cuts the corners smoothly.
    Vector3d position = Vector3d::Zero();
    double total = 0.0;
    for (int i = -6; i <= 6; ++i) {
      const double place = 3.0 * (time / period + 0.007 * i);
      const double number = std::floor(place);
      const auto first = static_cast<std::size_t>(((static_cast<int>(number) % 3) + 3) % 3);
      const double weight = std::exp(-0.08 * i * i);
      position += weight *
                  (corners[first] + (place - number) * (corners[(first + 1) % 3] - corners[first]));
      total += weight;
    }
    position /= total;
    return lookAt(position, target + 0.25 * (position - corner).cwiseProduct(Vector3d(1, 0, 0)));
  };
}

CameraPath roundPath(const Round& r) {
  return [r](double time) {
    const double angle = 2.0 * kPi * time / r.period;
    const Vector3d outward(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d at =
        r.centre + r.radius * outward + Vector3d(0.0, 0.0, r.bob * std::sin(3.4 * angle));
    return lookAt(at, at + std::cos(r.down) * outward - Vector3d(0.0, 0.0, std::sin(r.down)));
  };
}

CameraPath strollPath(const Vector3d& position, const Vector3d& reach, const Vector3d& target,
                      double period) {
  return [=](double time) {
    const double angle = 2.0 * kPi * time / period;
    const Vector3d at =
        position + Vector3d(reach.x() * std::sin(angle), reach.y() * std::sin(1.37 * angle + 0.8),
                            reach.z() * std::sin(1.71 * angle + 2.0));
    const Vector3d eye = target + Vector3d(0.9 * reach.x() * std::sin(0.8 * angle + 0.5), 0.0,
                                           0.6 * reach.z() * std::sin(1.2 * angle));
    return lookAt(at, eye);
  };
}

CameraPath handHeld(CameraPath path, double translation, double rotation, std::uint64_t seed) {
  return [=, path = std::move(path), tremble = Tremble(seed)](double time) {
    Isometry3d pose = path(time);
    const Vector3d shift(tremble.at(0, time), tremble.at(1, time), tremble.at(2, time));
    const Vector3d turn(tremble.at(3, time), tremble.at(4, time), 0.7 * tremble.at(5, time));
    pose.translation() += translation * shift;
    const double angle = rotation * turn.norm();
    return angle > 0.0 ? turned(pose, turn.normalized(), angle) : pose;
  };
}

}  // namespace hmcdyn::synthesize
