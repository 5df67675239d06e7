// SPDX-License-Identifier: BSD-3-Clause
// Which earlier frames are kept, and which of them a frame is compared with.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// Earlier frames, oldest first: all of the youngest, every tenth of a second of the others.
class DepthHistory {
 public:
  bool empty() const { return frames_.empty(); }
  const SmallFrame& youngest() const { return frames_.back(); }
  void clear();
  /// A frame's memory for the next one.
  SmallFrame spare();
  /// A frame that is not kept: its memory is.
  void giveBack(SmallFrame frame) { spare_.push_back(std::move(frame)); }
  void push(SmallFrame frame, double max_age);
  /// Replaces the pose of the frame of this stamp, if it is kept.
  void setPose(double timestamp, const Pose& camera_from_world);
  /// Those whose ages are closest to 0.03, 0.1, 0.2, 0.4, 0.7, 1.2 and 2 s, youngest first; the
  /// pointers are valid until the next push. @param reuse its memory is taken over.
  std::vector<const SmallFrame*> select(double timestamp,
                                        std::vector<const SmallFrame*> reuse) const;

 private:
  void drop(std::size_t index);
  std::vector<SmallFrame> frames_;
  std::vector<SmallFrame> spare_;
};

/// At most so many frames are selected.
inline constexpr std::size_t kMaxSelected = 7;

}  // namespace hmcdyn::internal
