// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace hmcdyn::masking {

struct MaskScoreOptions {
  std::size_t skip_frames = 10;  ///< First frames, in which no method can know.
  int border_distance = 3;       ///< Borders that are nearer than this (px) agree.
  double min_thing = 0.003;      ///< Smaller things are not looked for (share of the image).
};

/// How the moving pixels (255) of masks compare with the truth. Pixels that stand (128) or are
/// unknown (64) in the truth are left out.
struct MaskScore {
  std::size_t frames = 0;
  std::size_t without_mask =
      0;                     ///< Frames whose mask is missing or of another size: nothing moves.
  double true_moving = 0;    ///< Pixels.
  double false_moving = 0;   ///< Pixels.
  double missed = 0;         ///< Pixels.
  double static_pixels = 0;  ///< In the truth.
  double standing = 0;       ///< Pixels that stand in the truth.
  double standing_as_moving = 0;  ///< Of those, called moving.
  double border_agreed = 0;       ///< Pixels of the mask's border near one of the truth.
  double border_pixels = 0;
  double true_border_found = 0;  ///< Pixels of the truth's border near one of the mask.
  double true_border_pixels = 0;
  std::size_t things = 0;                  ///< Things that move, a frame each.
  std::size_t things_found = 0;            ///< With half of their pixels.
  std::vector<double> seconds_to_find;     ///< Of things that begin to move or appear.
  std::vector<double> seconds_to_release;  ///< Of things that stop.
  std::size_t never_found = 0;     ///< Things that began to move, and stopped or left unfound.
  std::size_t never_released = 0;  ///< Things that stopped, and went on or left unreleased.

  double iou() const;         ///< 0..1; NaN where nothing moves and nothing was called moving.
  double precision() const;   ///< 0..1; NaN where nothing was called moving.
  double recall() const;      ///< 0..1; NaN where nothing moves.
  double falseShare() const;  ///< False pixels of all scored ones, 0..1.
  double boundaryF() const;   ///< Boundary measure of DAVIS (Perazzi et al., CVPR 2016).
};

/// @param sequence folder with mask/TIMESTAMP.png, the truth, or rgb/ alone: then nothing moves.
/// @param folder with the masks, named by the same stamps (to the millisecond).
/// @throws std::runtime_error naming a folder without masks, or a file that is no 8-bit image.
MaskScore scoreMasks(const std::filesystem::path& sequence, const std::filesystem::path& folder,
                     const MaskScoreOptions& options = {});

/// Adds one frame's pixels and borders; of equal size.
void scoreFrame(const cv::Mat& truth, const cv::Mat& mask, const MaskScoreOptions& options,
                MaskScore& score);

/// Follows the things of the truth, to time when they are found and released.
class ThingClock {
 public:
  explicit ThingClock(const MaskScoreOptions& options) : options_(options) {}
  /// @param scored false: the frame is followed, not counted.
  void update(double timestamp, const cv::Mat& truth, const cv::Mat& mask, bool scored,
              MaskScore& score);

 private:
  struct Thing {
    int id = 0;
    bool moves = false;
    bool waits = false;  ///< To be found or released.
    double since = 0.0;  ///< (s)
  };
  MaskScoreOptions options_;
  std::vector<Thing> things_;
  cv::Mat ids_;  ///< CV_32SC1 of the frame before; 0 = none.
  int next_id_ = 1;
  bool first_ = true;
};

}  // namespace hmcdyn::masking
