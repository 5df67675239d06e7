// SPDX-License-Identifier: BSD-3-Clause
// What each pixel's earlier views say about it.
#pragma once

#include <cstdint>
#include <vector>

#include "mask/model.hpp"
#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// Evidence of one pixel: value / weight lies in -1 (static) .. 1.
struct Evidence {
  float value = 0.0f;
  float weight = 0.0f;
};

/// One bit an earlier frame, youngest first.
struct Comparisons {
  std::uint8_t free = 0;      ///< There was free space.
  std::uint8_t same = 0;      ///< There was a surface with the same gray level.
  std::uint8_t mismatch = 0;  ///< There was a surface with another one.
};

/// Where the surfaces of one row are in another frame: worked out for a row at once, so that the
/// compiler takes several pixels at a time.
struct RowPlaces {
  std::vector<float> ray;           ///< Of each column: x of its ray at z = 1.
  std::vector<float> depth;         ///< There (m).
  std::vector<std::int32_t> pixel;  ///< There; -1 = outside, or nothing to compare.
};

struct EvidenceImage {
  std::vector<Evidence> evidence;
  std::vector<Comparisons> comparisons;
  float agreement = 1.0f;     ///< Surfaces that were there in the youngest earlier frame.
  std::uint8_t fresh = 0;     ///< Bits of frames at most fresh_age old.
  std::uint8_t proof = 0;     ///< Bits of frames at least proof_age old.
  RowPlaces places;           ///< Workspace.
  std::vector<float> errors;  ///< Workspace.
};

/// @param named a flag a pixel: a box or mask says that it may move; empty = none.
/// @param reuse its memory is taken over.
EvidenceImage compareWithEarlier(const SmallFrame& frame, const SmallCamera& camera,
                                 const std::vector<const SmallFrame*>& earlier,
                                 const std::vector<std::uint8_t>& named, const MaskModel& model,
                                 EvidenceImage reuse);

/// Adds what key points say that were found to move.
void addPoints(const MotionMaskFrame& frame, int reduction, const SmallFrame& small, float weight,
               std::vector<Evidence>& evidence);

}  // namespace hmcdyn::internal
