// SPDX-License-Identifier: BSD-3-Clause
#include "whole_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace hmcdyn::internal {
namespace {

constexpr auto kUnknownLabel = static_cast<std::uint8_t>(MaskLabel::kUnknown);
constexpr auto kStaticLabel = static_cast<std::uint8_t>(MaskLabel::kStatic);

/// Fills the gaps of a row or column: `count` pixels from `start`, `stride` apart.
void labelGaps(const SmallFrame& frame, const std::vector<std::uint8_t>& before, std::size_t start,
               std::size_t stride, int count, std::vector<std::uint8_t>& label) {
  const int border = std::max(1, count / 12);  // a Kinect's: 28 of 640 columns, 28 of 480 rows
  const int inside = std::max(1, count / 4);
  const auto index = [&](int k) { return start + static_cast<std::size_t>(k) * stride; };
  int last = -1;
  for (int k = 0; k <= count; ++k) {
    if (k < count && !(frame.depth[index(k)] > 0.0f)) {
      continue;
    }
    const int gap = k - last - 1;
    std::uint8_t fill = kUnknownLabel;
    if (gap > 0 && last < 0 && k < count) {
      fill = gap <= border ? before[index(k)] : fill;
    } else if (gap > 0 && last >= 0 && k == count) {
      fill = gap <= border ? before[index(last)] : fill;
    } else if (gap > 0 && last >= 0 && before[index(last)] == before[index(k)] &&
               frame.cells[index(last)].thing == frame.cells[index(k)].thing) {
      fill = gap <= inside ? before[index(k)] : fill;
    }
    if (fill != kUnknownLabel && fill != kStaticLabel) {
      for (int hole = last + 1; hole < k; ++hole) {
        label[index(hole)] = std::max(label[index(hole)], fill);
      }
    }
    last = k;
  }
}

bool isUniform(const std::vector<std::uint8_t>& label, int width, int height, int x, int y) {
  const std::uint8_t own = label[static_cast<std::size_t>(y * width + x)];
  for (int row = std::max(y - 1, 0); row <= std::min(y + 1, height - 1); ++row) {
    for (int column = std::max(x - 1, 0); column <= std::min(x + 1, width - 1); ++column) {
      if (label[static_cast<std::size_t>(row * width + column)] != own) {
        return false;
      }
    }
  }
  return true;
}

/// Label of the one of the four nearest reduced pixels whose depth is most like z.
std::uint8_t labelLike(float z, const SmallFrame& frame, const std::vector<std::uint8_t>& label,
                       int x, int y, int beside_x, int beside_y) {
  constexpr float kNearness = 0.01f;  // share of the depth that a step to the side costs
  const auto own = static_cast<std::size_t>(y * frame.width + x);
  std::uint8_t best = label[own];
  if (!(z > 0.0f)) {
    return best;
  }
  float least = std::numeric_limits<float>::max();
  const auto consider = [&](int column, int row, float penalty) {
    if (column < 0 || row < 0 || column >= frame.width || row >= frame.height) {
      return;
    }
    const auto at = static_cast<std::size_t>(row * frame.width + column);
    const float difference = std::abs(frame.depth[at] - z) + penalty * z;
    if (frame.depth[at] > 0.0f && difference < least) {
      least = difference;
      best = label[at];
    }
  };
  consider(x, y, 0.0f);
  consider(beside_x, y, kNearness);
  consider(x, beside_y, kNearness);
  consider(beside_x, beside_y, 2 * kNearness);
  return best;
}

}  // namespace

void labelHoles(const SmallFrame& frame, std::vector<std::uint8_t>& label,
                std::vector<std::uint8_t>& before) {
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!(frame.depth[i] > 0.0f)) {
      label[i] = kUnknownLabel;
    }
  }
  before = label;
  const auto width = static_cast<std::size_t>(frame.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(frame.height); ++y) {
    labelGaps(frame, before, y * width, 1, frame.width, label);
  }
  for (std::size_t x = 0; x < width; ++x) {
    labelGaps(frame, before, x, width, frame.height, label);
  }
}

void labelWholeImage(const cv::Mat& depth, const SmallFrame& frame, int reduction,
                     const std::vector<std::uint8_t>& label, cv::Mat& mask) {
  for (int y = 0; y < frame.height; ++y) {
    // what is left over at the right and lower border belongs to the last reduced pixel
    const int last_row = y + 1 == frame.height ? depth.rows : (y + 1) * reduction;
    for (int x = 0; x < frame.width; ++x) {
      const int first = x * reduction;
      const int last = x + 1 == frame.width ? depth.cols : first + reduction;
      if (isUniform(label, frame.width, frame.height, x, y)) {
        const std::uint8_t own = label[static_cast<std::size_t>(y * frame.width + x)];
        for (int row = y * reduction; row < last_row; ++row) {
          std::memset(mask.ptr(row) + first, own, static_cast<std::size_t>(last - first));
        }
        continue;
      }
      for (int row = y * reduction; row < last_row; ++row) {
        const auto* z = depth.ptr<float>(row);
        std::uint8_t* to = mask.ptr(row);
        const int beside_y = 2 * (row - y * reduction) < reduction ? y - 1 : y + 1;
        for (int column = first; column < last; ++column) {
          const int beside_x = 2 * (column - first) < reduction ? x - 1 : x + 1;
          to[column] = labelLike(z[column], frame, label, x, y, beside_x, beside_y);
        }
      }
    }
  }
}

}  // namespace hmcdyn::internal
