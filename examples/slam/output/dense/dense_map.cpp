// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/dense_map.hpp"

#include <iterator>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {

DenseMap::DenseMap(std::size_t capacity) : capacity_(capacity) {
  if (capacity < 2) {
    throw std::invalid_argument(
        fmt::format("dense map: capacity {}; expected at least 2 key frames", capacity));
  }
}

void DenseMap::add(std::size_t id, ThinnedKeyFrame key_frame) {
  if (added_ > 0 && id <= last_id_) {
    throw std::invalid_argument(
        fmt::format("dense map: key frame {} after {}; expected ascending ids", id, last_id_));
  }
  last_id_ = id;
  const std::size_t number = added_++;
  if (number % stride_ != 0) {
    return;
  }
  key_frames_.emplace(id, Kept{number, std::move(key_frame)});
  if (key_frames_.size() <= capacity_) {
    return;
  }
  stride_ *= 2;
  for (auto kept = key_frames_.begin(); kept != key_frames_.end();) {
    kept = kept->second.number % stride_ != 0 ? key_frames_.erase(kept) : std::next(kept);
  }
}

FusionResult DenseMap::fuse(const std::vector<KeyFramePose>& poses, const PinholeCamera& camera,
                            const FusionOptions& options) const {
  std::map<std::size_t, PosedKeyFrame> posed;  // by id, whatever the order of the poses
  for (const KeyFramePose& pose : poses) {
    const auto kept = key_frames_.find(pose.id);
    if (kept != key_frames_.end()) {
      posed[pose.id] = {&kept->second.images, pose.camera_from_world};
    }
  }
  std::vector<PosedKeyFrame> in_order;
  in_order.reserve(posed.size());
  for (const auto& [id, key_frame] : posed) {
    in_order.push_back(key_frame);
  }
  return fuseKeyFrames(in_order, camera, options);
}

}  // namespace hmcdyn::slam
