// SPDX-License-Identifier: BSD-3-Clause
// Dropping key points from a frame: every array that runs along them shrinks alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/span.hpp>

namespace hmcdyn::integration {

namespace detail {

inline void checkKeep(std::size_t rows, std::size_t flags) {
  if (rows != flags) {
    throw std::invalid_argument("compaction: " + std::to_string(rows) + " elements, but " +
                                std::to_string(flags) + " flags; expected equal sizes");
  }
}

}  // namespace detail

/// The elements whose flag is not 0, in their order.
/// @throws std::invalid_argument when sizes differ.
template <class T>
std::vector<T> keptElements(const std::vector<T>& values, Span<const std::uint8_t> keep) {
  detail::checkKeep(values.size(), keep.size());
  std::vector<T> kept;
  kept.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i] != 0) {
      kept.push_back(values[i]);
    }
  }
  return kept;
}

/// The rows whose flag is not 0, in their order: descriptors, one row a key point.
/// @throws std::invalid_argument when rows and flags differ in number.
inline cv::Mat keptRows(const cv::Mat& rows, Span<const std::uint8_t> keep) {
  detail::checkKeep(static_cast<std::size_t>(rows.rows), keep.size());
  cv::Mat kept(0, rows.cols, rows.type());
  kept.reserve(keep.size());
  for (int row = 0; row < rows.rows; ++row) {
    if (keep[static_cast<std::size_t>(row)] != 0) {
      kept.push_back(rows.row(row));
    }
  }
  return kept;
}

}  // namespace hmcdyn::integration
