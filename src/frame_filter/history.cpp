// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/history.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "se3.hpp"

namespace hmcdyn::internal {

std::vector<const RememberedFrame*> FrameHistory::earlierThan(double timestamp) const {
  std::vector<const RememberedFrame*> earlier;
  for (const double baseline : baselines_) {
    const auto youngest = std::find_if(
        frames_.rbegin(), frames_.rend(),
        [&](const RememberedFrame& past) { return timestamp - past.timestamp >= baseline; });
    if (youngest != frames_.rend() && (earlier.empty() || earlier.back() != &*youngest)) {
      earlier.push_back(&*youngest);
    }
  }
  return earlier;
}

void FrameHistory::checkSize(const cv::Size& size) const {
  if (frames_.empty() || frames_.back().pyramid.front().size() == size) {
    return;
  }
  const cv::Size before = frames_.back().pyramid.front().size();
  throw std::invalid_argument("FrameFilter: gray is " + std::to_string(size.width) + " x " +
                              std::to_string(size.height) + " px, after " +
                              std::to_string(before.width) + " x " + std::to_string(before.height) +
                              " px; expected one size, or reset() before");
}

void FrameHistory::add(RememberedFrame frame) {
  const double longest = baselines_.empty() ? 0.0 : baselines_.back();
  constexpr double kSpare = 0.5;  // s: a late frame must still find one that is old enough
  while (!frames_.empty() && frames_.front().timestamp < frame.timestamp - longest - kSpare) {
    spare_ = std::move(frames_.front().pyramid);
    frames_.pop_front();
  }
  frames_.push_back(std::move(frame));
}

std::optional<Eigen::Isometry3d> FrameHistory::odometryOf(
    const Eigen::Isometry3d& camera_from_world) const {
  if (frames_.empty() || !frames_.back().camera_from_world) {
    return std::nullopt;
  }
  const RememberedFrame& last = frames_.back();
  return camera_from_world * last.camera_from_world->inverse() * last.odometry;
}

std::optional<Eigen::Isometry3d> FrameHistory::setPose(double timestamp,
                                                       const Eigen::Isometry3d& camera_from_world) {
  const auto found =
      std::find_if(frames_.begin(), frames_.end(),
                   [&](const RememberedFrame& frame) { return frame.timestamp == timestamp; });
  if (found == frames_.end()) {
    return std::nullopt;
  }
  const bool given_before = found->pose_is_given;
  if (found->camera_from_world) {
    // The world moved under the cameras, or under those that nobody but the filter has placed.
    const Eigen::Isometry3d old_from_new = found->camera_from_world->inverse() * camera_from_world;
    for (auto frame = frames_.begin(); frame != found; ++frame) {
      if (frame->camera_from_world && (found->pose_is_given || !frame->pose_is_given)) {
        frame->camera_from_world = *frame->camera_from_world * old_from_new;
      }
    }
  }
  found->camera_from_world = camera_from_world;
  found->pose_is_given = true;
  in_callers_world_ = true;
  if (given_before || found == frames_.begin() || std::next(found) != frames_.end()) {
    return std::nullopt;
  }
  const RememberedFrame& before = *std::prev(found);
  if (before.camera_from_world) {
    found->odometry = camera_from_world * before.camera_from_world->inverse() * before.odometry;
  }
  return found->odometry;
}

std::optional<Eigen::Isometry3d> FrameHistory::poseFrom(
    const std::vector<const RememberedFrame*>& past,
    const std::vector<EarlierFrameReport>& reports) {
  for (std::size_t k = 0; k < reports.size(); ++k) {
    if (reports[k].current_from_earlier && past[k]->camera_from_world) {
      return Eigen::Isometry3d(*reports[k].current_from_earlier) * *past[k]->camera_from_world;
    }
  }
  const bool nobody = std::none_of(
      frames_.begin(), frames_.end(),
      [](const RememberedFrame& frame) { return frame.camera_from_world.has_value(); });
  if (!nobody) {
    return std::nullopt;
  }
  in_callers_world_ = in_callers_world_ && frames_.empty();
  return Eigen::Isometry3d::Identity();
}

std::optional<Eigen::Isometry3d> FrameHistory::predict(double timestamp) const {
  if (frames_.empty() || !frames_.back().camera_from_world) {
    return std::nullopt;
  }
  const RememberedFrame& last = frames_.back();
  if (frames_.size() < 2 || !frames_[frames_.size() - 2].camera_from_world) {
    return last.camera_from_world;
  }
  const RememberedFrame& before = frames_[frames_.size() - 2];
  const double ratio = (timestamp - last.timestamp) / (last.timestamp - before.timestamp);
  const Eigen::Isometry3d step = *last.camera_from_world * before.camera_from_world->inverse();
  return se3::motionOf(ratio * se3::stepOf(step)) * *last.camera_from_world;
}

std::vector<EarlierFrame> earlierFrames(const std::vector<const RememberedFrame*>& frames,
                                        double timestamp,
                                        const std::optional<Eigen::Isometry3d>& predicted) {
  std::vector<EarlierFrame> earlier;
  for (const RememberedFrame* frame : frames) {
    earlier.emplace_back();
    earlier.back().pyramid = &frame->pyramid;
    earlier.back().age = timestamp - frame->timestamp;
    if (predicted && frame->camera_from_world) {
      earlier.back().current_from_earlier = *predicted * frame->camera_from_world->inverse();
    }
  }
  return earlier;
}

}  // namespace hmcdyn::internal
