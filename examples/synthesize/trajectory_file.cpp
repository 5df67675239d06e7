// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/trajectory_file.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "support/text_table.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Weighted mean of poses; the quaternions are near to each other, so their sum will do.
class PoseMean {
 public:
  void add(const Isometry3d& pose, double weight) {
    Quaterniond q(pose.linear());
    if (q.coeffs().dot(rotation_) < 0.0) {
      q.coeffs() = -q.coeffs();
    }
    rotation_ += weight * q.coeffs();
    translation_ += weight * pose.translation();
    total_ += weight;
  }
  Isometry3d value() const {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Quaterniond(rotation_.normalized()).toRotationMatrix();
    pose.translation() = translation_ / total_;
    return pose;
  }

 private:
  Eigen::Vector4d rotation_ = Eigen::Vector4d::Zero();
  Vector3d translation_ = Vector3d::Zero();
  double total_ = 0.0;
};

Isometry3d between(const StampedPose& a, const StampedPose& b, double time) {
  const double t = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() =
      (1.0 - t) * a.camera_to_world.translation() + t * b.camera_to_world.translation();
  pose.linear() = Quaterniond(a.camera_to_world.linear())
                      .slerp(t, Quaterniond(b.camera_to_world.linear()))
                      .toRotationMatrix();
  return pose;
}

Isometry3d interpolated(const std::vector<StampedPose>& poses, double time) {
  const auto above =
      std::upper_bound(poses.begin() + 1, poses.end() - 1, time,
                       [](double t, const StampedPose& pose) { return t < pose.time; });
  return between(*(above - 1), *above, time);
}

Isometry3d smoothed(const std::vector<StampedPose>& poses, double time) {
  constexpr double kStep = 0.01;  // (s)
  PoseMean mean;
  for (int i = -4; i <= 4; ++i) {
    mean.add(interpolated(poses, time + kStep * i), std::exp(-0.125 * i * i));
  }
  return mean.value();
}

}  // namespace

namespace {

StampedPose parsePose(const support::TextRow& row, const std::filesystem::path& path) {
  const auto fail = [&](const std::string& problem) {
    throw support::errorAt(path.string(), row.line, problem);
  };
  constexpr std::size_t kValues = 8;
  if (row.fields.size() != kValues) {
    fail(std::to_string(row.fields.size()) + " values, expected timestamp tx ty tz qx qy qz qw" +
         support::guessOfPose(row));
  }
  std::vector<double> values;
  for (const std::string& word : row.fields) {
    double value = 0.0;
    if (!support::parseNumber(word, value) || !std::isfinite(value)) {
      fail("'" + support::printable(word) + "' is not a finite number");
    }
    values.push_back(value);
  }
  const Quaterniond q(values[7], values[4], values[5], values[6]);
  if (q.norm() < 1e-3) {
    fail("the quaternion has no length");
  }
  StampedPose pose;
  pose.time = values[0];
  pose.camera_to_world.translation() = Vector3d(values[1], values[2], values[3]);
  pose.camera_to_world.linear() = q.normalized().toRotationMatrix();
  return pose;
}

/// Makes seconds of stamps in another unit, where that is plain.
void toSeconds(std::vector<StampedPose>& poses) {
  std::vector<double> stamps;
  stamps.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    stamps.push_back(pose.time);
  }
  const support::StampReview review = support::reviewStamps(stamps);
  if (review.doubt.empty() && review.unit != support::TimeUnit::kSeconds) {
    for (StampedPose& pose : poses) {
      pose.time *= support::secondsOf(review.unit, 1.0);
    }
  }
}

}  // namespace

std::vector<StampedPose> readTrajectory(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error(path.string() + ": cannot be read");
  }
  std::vector<StampedPose> poses;
  const support::TextTable table =
      support::readTable(path, [](std::size_t fields) { return fields == 8; });
  for (const support::TextRow& row : table.rows) {
    const StampedPose pose = parsePose(row, path);
    if (!poses.empty() && pose.time < poses.back().time) {
      throw support::errorAt(path.string(), row.line, "the time stamp falls");
    }
    if (poses.empty() || pose.time != poses.back().time) {
      poses.push_back(pose);  // motion capture repeats itself, TUM's fr3_walking_static for one
    }
  }
  toSeconds(poses);
  return poses;
}

CameraPath pathFromFile(const std::filesystem::path& path, const Isometry3d& view, double seconds,
                        const RoomBounds& bounds) {
  std::vector<StampedPose> poses = readTrajectory(path);
  if (poses.size() < 2 || poses.back().time - poses.front().time < seconds) {
    const double length = poses.empty() ? 0.0 : poses.back().time - poses.front().time;
    throw std::runtime_error(path.string() + ": lasts " + std::to_string(length) +
                             " s, but the frames need " + std::to_string(seconds) +
                             " s; ask for fewer frames");
  }
  const double first = poses.front().time;
  PoseMean mean;
  for (StampedPose& pose : poses) {
    pose.time -= first;
    if (pose.time <= seconds) {
      mean.add(pose.camera_to_world, 1.0);
    }
  }
  const Isometry3d into_room = view * mean.value().inverse();
  constexpr double kMargin = 0.15;  // (m) from walls
  const RoomBounds inside(bounds.min() + Vector3d::Constant(kMargin),
                          bounds.max() - Vector3d::Constant(kMargin));
  for (StampedPose& pose : poses) {
    pose.camera_to_world = into_room * pose.camera_to_world;
    if (pose.time <= seconds && !inside.contains(pose.camera_to_world.translation())) {
      std::ostringstream text;
      text << path.string() << ": leaves the room " << pose.time << " s after its start, at "
           << pose.camera_to_world.translation().transpose() << " m; ask for fewer frames";
      throw std::runtime_error(text.str());
    }
  }
  auto kept = std::make_shared<const std::vector<StampedPose>>(std::move(poses));
  return [kept](double time) { return smoothed(*kept, time); };
}

}  // namespace hmcdyn::synthesize
