// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "slam/output/dense/fusion.hpp"
#include "slam/output/dense/static_depth.hpp"

namespace hmcdyn::slam {

/// Where a key frame ended up.
struct KeyFramePose {
  std::size_t id = 0;
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();  ///< Translation in m.
};

/// Keeps key frames until the end of the run and fuses them with the poses of then: so a map knows
/// every correction by bundle adjustment and loops. Memory is bounded by the capacity: when it is
/// reached, every second key frame goes, and from then on every second one is kept. Not
/// synchronised: one thread adds, and nobody fuses meanwhile.
class DenseMap {
 public:
  /// @param capacity key frames at most, at least 2; 300 of 640x480 at stride 2 take some 140 MB.
  /// @throws std::invalid_argument for a smaller one.
  explicit DenseMap(std::size_t capacity = 300);

  /// Adds a key frame, or thins out. @param id unique, ascending from call to call.
  /// @throws std::invalid_argument where it is not.
  void add(std::size_t id, ThinnedKeyFrame key_frame);

  std::size_t size() const noexcept { return key_frames_.size(); }

  /// The map with these poses. A key frame without a pose here is left out, as is a pose without a
  /// key frame. @throws std::invalid_argument as fuseKeyFrames().
  FusionResult fuse(const std::vector<KeyFramePose>& poses, const PinholeCamera& camera,
                    const FusionOptions& options = {}) const;

 private:
  struct Kept {
    std::size_t number = 0;  // of the call to add()
    ThinnedKeyFrame images;
  };

  std::size_t capacity_;
  std::size_t stride_ = 1;
  std::size_t added_ = 0;
  std::size_t last_id_ = 0;
  std::map<std::size_t, Kept> key_frames_;  // by id
};

}  // namespace hmcdyn::slam
