// SPDX-License-Identifier: BSD-3-Clause
#include "mask/whole_mask.hpp"

#include <algorithm>
#include <array>
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

/// Flags of the pixels of a row that have the label of all around them.
void markUniform(const std::vector<std::uint8_t>& label, const SmallFrame& frame, int y,
                 std::uint8_t* uniform) {
  const int last = frame.width - 1;
  const std::uint8_t* here = label.data() + frame.index(y, 0);
  const std::uint8_t* above = label.data() + frame.index(std::max(y - 1, 0), 0);
  const std::uint8_t* below = label.data() + frame.index(std::min(y + 1, frame.height - 1), 0);
  // differences as bits, and no branch: the compiler takes several pixels at a time
  const auto column = [=](int x, unsigned own) {
    return (here[x] ^ own) | (above[x] ^ own) | (below[x] ^ own);
  };
  const auto all = [=](int left, int x, int right) {
    const unsigned own = here[x];
    const unsigned differences = column(left, own) | column(x, own) | column(right, own);
    return static_cast<std::uint8_t>(differences == 0 ? 1 : 0);
  };
  for (int x = 1; x < last; ++x) {
    uniform[x] = all(x - 1, x, x + 1);
  }
  uniform[0] = all(0, 0, std::min(1, last));
  uniform[last] = all(std::max(last - 1, 0), last, last);
}

/// A reduced pixel whose label a pixel of the whole image may get.
struct Candidate {
  float depth = 0.0f;
  float penalty = 0.0f;  ///< Share of the pixel's depth.
  std::uint8_t label = 0;
};

/// The reduced pixel and those beside it that have a depth.
struct Candidates {
  std::array<Candidate, 4> items{};
  std::size_t count = 0;
  std::uint8_t own = 0;  ///< Label where none is like the pixel.
  bool differ = false;   ///< Not all have the label `own`.
};

Candidates candidatesFor(const SmallFrame& frame, const std::vector<std::uint8_t>& label, int x,
                         int y, int beside_x, int beside_y) {
  constexpr float kNearness = 0.01f;  // share of the depth that a step to the side costs
  Candidates candidates;
  candidates.own = label[frame.index(y, x)];
  const auto consider = [&](int column, int row, float penalty) {
    if (column < 0 || row < 0 || column >= frame.width || row >= frame.height) {
      return;
    }
    const std::size_t at = frame.index(row, column);
    if (frame.depth[at] > 0.0f) {
      candidates.items[candidates.count++] = {frame.depth[at], penalty, label[at]};
      candidates.differ |= label[at] != candidates.own;
    }
  };
  consider(x, y, 0.0f);
  consider(beside_x, y, kNearness);
  consider(x, beside_y, kNearness);
  consider(beside_x, beside_y, 2 * kNearness);
  return candidates;
}

/// Label of the candidate whose depth is most like z.
std::uint8_t labelLike(float z, const Candidates& candidates) {
  std::uint8_t best = candidates.own;
  if (!(z > 0.0f)) {
    return best;
  }
  float least = std::numeric_limits<float>::max();
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const Candidate& candidate = candidates.items[k];
    const float difference = std::abs(candidate.depth - z) + candidate.penalty * z;
    if (difference < least) {
      least = difference;
      best = candidate.label;
    }
  }
  return best;
}

void fill(std::uint8_t label, const cv::Range& rows, const cv::Range& columns, cv::Mat& mask) {
  for (int row = rows.start; row < rows.end; ++row) {
    std::memset(mask.ptr(row) + columns.start, label, static_cast<std::size_t>(columns.size()));
  }
}

/// Labels for the pixels of one reduced pixel, a quarter of them after the other: the candidates
/// are those that are nearest to it.
void labelByDepth(const cv::Mat& depth, const SmallFrame& frame,
                  const std::vector<std::uint8_t>& label, int reduction, const cv::Point& at,
                  const cv::Range& rows, const cv::Range& columns, cv::Mat& mask) {
  const auto halves = [reduction](const cv::Range& all) {
    const int middle = std::min(all.start + (reduction + 1) / 2, all.end);
    return std::array<cv::Range, 2>{cv::Range(all.start, middle), cv::Range(middle, all.end)};
  };
  const std::array<cv::Range, 2> row_halves = halves(rows);
  const std::array<cv::Range, 2> column_halves = halves(columns);
  for (int down = 0; down < 2; ++down) {
    for (int right = 0; right < 2; ++right) {
      const cv::Range& quarter_rows = row_halves[static_cast<std::size_t>(down)];
      const cv::Range& quarter_columns = column_halves[static_cast<std::size_t>(right)];
      const Candidates candidates =
          candidatesFor(frame, label, at.x, at.y, at.x + 2 * right - 1, at.y + 2 * down - 1);
      if (!candidates.differ) {
        fill(candidates.own, quarter_rows, quarter_columns, mask);
        continue;
      }
      for (int row = quarter_rows.start; row < quarter_rows.end; ++row) {
        const auto* z = depth.ptr<float>(row);
        std::uint8_t* to = mask.ptr(row);
        for (int column = quarter_columns.start; column < quarter_columns.end; ++column) {
          to[column] = labelLike(z[column], candidates);
        }
      }
    }
  }
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
                     const std::vector<std::uint8_t>& label, std::vector<std::uint8_t>& uniform,
                     cv::Mat& mask) {
  uniform.resize(frame.size());
  // what is left over at the right and lower border belongs to the last reduced pixel
  const auto end = [reduction](int k, int count, int whole) {
    return k + 1 == count ? whole : (k + 1) * reduction;
  };
  for (int y = 0; y < frame.height; ++y) {
    const cv::Range rows(y * reduction, end(y, frame.height, depth.rows));
    markUniform(label, frame, y, uniform.data());
    for (int x = 0; x < frame.width; ++x) {
      const int first = x * reduction;
      if (uniform[static_cast<std::size_t>(x)] == 0) {
        labelByDepth(depth, frame, label, reduction, {x, y}, rows,
                     {first, end(x, frame.width, depth.cols)}, mask);
        continue;
      }
      while (x + 1 < frame.width && uniform[static_cast<std::size_t>(x) + 1] != 0) {
        ++x;  // neighbours that are uniform have one label
      }
      fill(label[frame.index(y, x)], rows, {first, end(x, frame.width, depth.cols)}, mask);
    }
  }
}

}  // namespace hmcdyn::internal
