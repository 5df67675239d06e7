// SPDX-License-Identifier: BSD-3-Clause
// Dropping key points from a frame: every array that runs along them shrinks alike. [OpenCV]
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/span.hpp>

namespace hmcdyn {

namespace detail {

template <class T>
std::size_t rowsOf(const std::vector<T>& values) {
  return values.size();
}
inline std::size_t rowsOf(const cv::Mat& rows) { return static_cast<std::size_t>(rows.rows); }

template <class T>
void compactOne(Span<const std::uint8_t> keep, std::vector<T>& values) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) {
      if (kept != i) {
        values[kept] = std::move(values[i]);
      }
      ++kept;
    }
  }
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(kept), values.end());
}

/// Into memory of its own: other matrices may share the rows.
inline void compactOne(Span<const std::uint8_t> keep, cv::Mat& rows) {
  cv::Mat kept(0, rows.cols, rows.type());
  kept.reserve(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) {
      kept.push_back(rows.row(static_cast<int>(i)));
    }
  }
  rows = std::move(kept);
}

}  // namespace detail

/// Keeps the elements, or rows, whose flag is not 0, in their order.
///
///     compact(result.keep, key_points, depth, right_u, descriptors);
///
/// @param keep N flags. @param arrays any number of std::vector of N elements, and of cv::Mat of N
/// rows; a cv::Mat gets memory of its own.
/// @return how many are kept.
/// @throws std::invalid_argument when an array has another size; then none of them has changed.
template <class... Arrays>
std::size_t compact(Span<const std::uint8_t> keep, Arrays&... arrays) {
  const auto check = [&](std::size_t rows) {
    if (rows != keep.size()) {
      throw std::invalid_argument("compact: " + std::to_string(keep.size()) +
                                  " flags, but an array of " + std::to_string(rows) +
                                  " elements or rows; expected equal sizes");
    }
  };
  (check(detail::rowsOf(arrays)), ...);
  (detail::compactOne(keep, arrays), ...);
  std::size_t kept = 0;
  for (const std::uint8_t flag : keep) {
    kept += flag != 0 ? 1 : 0;
  }
  return kept;
}

}  // namespace hmcdyn
