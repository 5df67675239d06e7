// SPDX-License-Identifier: BSD-3-Clause
// Step 4: which detection boxes hold something that moves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hmcdyn/detail/bits.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Thresholds of the paper's box test (section III-A).
struct BoxDynamismOptions {
  float distance_threshold = 1.0f;         ///< A point is dynamic beyond this distance (px).
  float person_distance_threshold = 0.9f;  ///< The same for a point in a person's box (px).
  float dynamic_ratio = 0.1f;              ///< A box is dynamic beyond this share of its points.
  int person_class_id = kPersonClassId;    ///< Detector class of a person.
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const BoxDynamismOptions& options) {
  const auto require = [](bool good, const char* name, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("BoxDynamismOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(options.distance_threshold >= 0.0f, "distance_threshold", options.distance_threshold,
          "a value >= 0 (px)");
  require(options.person_distance_threshold >= 0.0f, "person_distance_threshold",
          options.person_distance_threshold, "a value >= 0 (px)");
  require(options.dynamic_ratio >= 0.0f && options.dynamic_ratio <= 1.0f, "dynamic_ratio",
          options.dynamic_ratio, "a share in [0, 1]");
}

/// Which key points each box holds: box b holds indices[offsets[b]] .. indices[offsets[b + 1] - 1],
/// in the order of the key points. A point may lie in several boxes.
struct BoxMembership {
  std::vector<std::size_t> offsets;    ///< Boxes + 1 elements.
  std::vector<std::uint32_t> indices;  ///< Key points, box by box.

  /// Number of boxes.
  std::size_t boxes() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
  /// Positions of the key points in a box, rising.
  /// @param box below boxes().
  Span<const std::uint32_t> pointsIn(std::size_t box) const noexcept {
    return {indices.data() + offsets[box], offsets[box + 1] - offsets[box]};
  }
};

namespace detail {

/// Which of the points first .. first + 31 the box holds.
inline std::uint32_t pointsInBox(const KeyPointsView& points, std::size_t first,
                                 const DetectionBox& box) noexcept {
  const float* const u = points.u.data() + first;
  const float* const v = points.v.data() + first;
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < kBlock; ++i) {
    // Not box.contains(): without shortcuts, the loop vectorises.
    // NOLINTBEGIN(readability-implicit-bool-conversion,clang-diagnostic-bitwise-instead-of-logical)
    const bool columns = (u[i] >= box.x_min) & (u[i] <= box.x_max);
    const bool rows = (v[i] >= box.y_min) & (v[i] <= box.y_max);
    bits |= (columns & rows) ? kBits.bit[i] : 0;
    // NOLINTEND(readability-implicit-bool-conversion,clang-diagnostic-bitwise-instead-of-logical)
  }
  return bits;
}

/// Appends first + i for each bit i that is set.
inline void appendOnes(std::uint64_t bits, std::uint32_t first,
                       std::vector<std::uint32_t>& indices) {
  const std::size_t before = indices.size();
  indices.resize(before + countOnes(bits));
  std::uint32_t* next = indices.data() + before;
  for (; bits != 0; bits &= bits - 1) {
    *next++ = first + lowestOne(bits);
  }
}

}  // namespace detail

/// Which of the N key points lie in which box, borders included.
/// @param reuse a result whose memory is taken over.
/// @throws std::invalid_argument when the points' arrays differ in size.
inline BoxMembership assignToBoxes(const KeyPointsView& points, Span<const DetectionBox> boxes,
                                   BoxMembership reuse = {}) {
  checkKeyPoints(points);
  reuse.offsets.clear();
  reuse.indices.clear();
  reuse.offsets.push_back(0);
  constexpr std::size_t kStep = 2 * detail::kBlock;
  const std::size_t n = points.size();
  for (const DetectionBox& box : boxes) {
    if (n < kStep) {
      for (std::size_t i = 0; i < n; ++i) {
        if (box.contains(points.u[i], points.v[i])) {
          reuse.indices.push_back(static_cast<std::uint32_t>(i));
        }
      }
    } else {
      for (std::size_t i = 0; i < n; i += kStep) {
        // The last step begins earlier, so that it is a whole one, and leaves out what was seen.
        const std::size_t first = std::min(i, n - kStep);
        const std::uint64_t high = detail::pointsInBox(points, first + detail::kBlock, box);
        const std::uint64_t bits =
            detail::pointsInBox(points, first, box) | (high << detail::kBlock);
        detail::appendOnes(bits >> (i - first), static_cast<std::uint32_t>(i), reuse.indices);
      }
    }
    reuse.offsets.push_back(reuse.indices.size());
  }
  return reuse;
}

namespace detail {

/// @throws std::invalid_argument when a box holds a point beyond the first `points`, or where the
/// offsets do not delimit the indices.
inline void checkMembership(const char* caller, const BoxMembership& membership,
                            std::size_t points) {
  const std::vector<std::size_t>& offsets = membership.offsets;
  const bool offsets_fit = offsets.empty() ? membership.indices.empty()
                                           : offsets.front() == 0 &&
                                                 std::is_sorted(offsets.begin(), offsets.end()) &&
                                                 offsets.back() == membership.indices.size();
  if (!offsets_fit) {
    throw std::invalid_argument(std::string(caller) + ": membership has offsets that do not rise " +
                                "from 0 to its number of indices, " +
                                std::to_string(membership.indices.size()) +
                                "; expected what assignToBoxes or assignToRegions gives");
  }
  std::uint32_t largest = 0;
  for (const std::uint32_t index : membership.indices) {
    largest = std::max(largest, index);
  }
  if (!membership.indices.empty() && largest >= points) {
    throw std::invalid_argument(std::string(caller) + ": membership holds point " +
                                std::to_string(largest) + ", but there are " +
                                std::to_string(points) +
                                " points; expected the membership of these points");
  }
}

}  // namespace detail

/// What the test counted in one box.
struct BoxVerdict {
  std::size_t points = 0;    ///< Key points in the box.
  std::size_t measured = 0;  ///< Those with a distance.
  std::size_t dynamic = 0;   ///< Those beyond their threshold.
  bool is_dynamic = false;   ///< dynamic > dynamic_ratio * points.
};

/// What the test says about a frame.
struct BoxDynamism {
  std::vector<BoxVerdict> boxes;  ///< One a detection box.
  /// N distance thresholds (px). A point in several boxes takes the strictest; outside all boxes
  /// distance_threshold.
  std::vector<float> threshold;
};

/// The paper's test (section III-A): a point is dynamic when its distance exceeds 1 px, 0.9 px in a
/// person's box; a box is dynamic when more than 10 % of the points in it are. Points without a
/// distance count as points of the box, not as dynamic ones. An empty box is not dynamic.
///
/// @param distance N distances (px), NaN = none.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline BoxDynamism testBoxes(Span<const float> distance, Span<const DetectionBox> boxes,
                             const BoxMembership& membership,
                             const BoxDynamismOptions& options = {}, BoxDynamism reuse = {}) {
  checkOptions(options);
  if (membership.boxes() != boxes.size()) {
    throw std::invalid_argument("testBoxes: membership of " + std::to_string(membership.boxes()) +
                                " boxes for " + std::to_string(boxes.size()) + " boxes");
  }
  detail::checkMembership("testBoxes", membership, distance.size());
  constexpr float kInNoBox = std::numeric_limits<float>::infinity();
  reuse.threshold.assign(distance.size(), kInNoBox);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const float threshold = boxes[b].class_id == options.person_class_id
                                ? options.person_distance_threshold
                                : options.distance_threshold;
    for (const std::uint32_t i : membership.pointsIn(b)) {
      reuse.threshold[i] = std::min(reuse.threshold[i], threshold);
    }
  }
  const float outside = options.distance_threshold;
  for (float& threshold : reuse.threshold) {
    threshold = threshold < kInNoBox ? threshold : outside;
  }
  reuse.boxes.clear();
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    BoxVerdict verdict;
    for (const std::uint32_t i : membership.pointsIn(b)) {
      ++verdict.points;
      verdict.measured += std::isnan(distance[i]) ? 0 : 1;
      verdict.dynamic += distance[i] > reuse.threshold[i] ? 1 : 0;
    }
    verdict.is_dynamic = static_cast<float>(verdict.dynamic) >
                         options.dynamic_ratio * static_cast<float>(verdict.points);
    reuse.boxes.push_back(verdict);
  }
  return reuse;
}

}  // namespace hmcdyn
