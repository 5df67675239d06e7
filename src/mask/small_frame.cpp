// SPDX-License-Identifier: BSD-3-Clause
#include "small_frame.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmcdyn::internal {
namespace {

constexpr float kFar = 1e6f;        // stands for "no depth" where the nearest is looked for
constexpr float kLongest = 100.0f;  // (m): no depth camera measures that far
constexpr int kFewestOfNine = 6;    // depths around a pixel that may speak of free space

std::size_t at(int row, int column, int width) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(column);
}

/// Depth of the pixel in the middle of a square, or of one beside it: what is missing there.
void reduceDepth(const cv::Mat& depth, int reduction, SmallFrame& small) {
  const int middle = reduction / 2;
  const int beside = std::max(middle - 1, 0);
  std::size_t measured = 0;
  for (int y = 0; y < small.height; ++y) {
    const auto* row = depth.ptr<float>(y * reduction + middle);
    const auto* row_beside = depth.ptr<float>(y * reduction + beside);
    for (int x = 0; x < small.width; ++x) {
      const int column = x * reduction + middle;
      const int column_beside = x * reduction + beside;
      float z = 0.0f;
      for (const float candidate :
           {row[column], row_beside[column_beside], row[column_beside], row_beside[column]}) {
        if (candidate > 0.0f && candidate < kLongest) {
          z = candidate;
          ++measured;
          break;
        }
      }
      small.depth[at(y, x, small.width)] = z;
    }
  }
  small.depth_share = static_cast<float>(measured) / static_cast<float>(small.size());
}

/// Mean gray level of each square.
void reduceGray(const cv::Mat& gray, int reduction, SmallFrame& small) {
  small.gray.resize(small.size());
  const int count = reduction * reduction;
  double total = 0.0;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      int sum = 0;
      for (int row = y * reduction; row < (y + 1) * reduction; ++row) {
        const std::uint8_t* from = gray.ptr(row) + x * reduction;
        for (int k = 0; k < reduction; ++k) {
          sum += from[k];
        }
      }
      small.gray[at(y, x, small.width)] = static_cast<std::uint8_t>((sum + count / 2) / count);
      total += sum;
    }
  }
  small.brightness =
      static_cast<float>(total / (static_cast<double>(count) * static_cast<double>(small.size())));
}

struct Extremes {
  float nearest = kFar;
  float farthest = 0.0f;
  int measured = 0;
  std::uint8_t darkest = 255;
  std::uint8_t brightest = 0;

  void take(const Extremes& other) {
    nearest = std::min(nearest, other.nearest);
    farthest = std::max(farthest, other.farthest);
    measured += other.measured;
    darkest = std::min(darkest, other.darkest);
    brightest = std::max(brightest, other.brightest);
  }
};

/// The extremes of three neighbours, packed in cells: `thing` counts depths.
void extremesAlongRow(const SmallFrame& small, int y, MaskCell* to) {
  const auto pixel = [&](int x) {
    Extremes one;
    const std::size_t i = at(y, x, small.width);
    const float z = small.depth[i];
    if (z > 0.0f) {
      one.nearest = one.farthest = z;
      one.measured = 1;
    }
    if (!small.gray.empty()) {
      one.darkest = one.brightest = small.gray[i];
    }
    return one;
  };
  Extremes before;
  Extremes here = pixel(0);
  for (int x = 0; x < small.width; ++x) {
    const Extremes after = x + 1 < small.width ? pixel(x + 1) : Extremes{};
    Extremes all = before;
    all.take(here);
    all.take(after);
    to[x] = {all.nearest, all.farthest,  0.0f,
             all.darkest, all.brightest, static_cast<std::int16_t>(all.measured)};
    before = here;
    here = after;
  }
}

void fillCells(SmallFrame& small, std::vector<MaskCell>& rows) {
  const auto width = static_cast<std::size_t>(small.width);
  rows.resize(small.size());
  for (int y = 0; y < small.height; ++y) {
    extremesAlongRow(small, y, rows.data() + static_cast<std::size_t>(y) * width);
  }
  for (int y = 0; y < small.height; ++y) {
    const int first = std::max(y - 1, 0);
    const int last = std::min(y + 1, small.height - 1);
    for (std::size_t x = 0; x < width; ++x) {
      MaskCell cell = rows[static_cast<std::size_t>(first) * width + x];
      int measured = cell.thing;
      for (int r = first + 1; r <= last; ++r) {
        const MaskCell& other = rows[static_cast<std::size_t>(r) * width + x];
        cell.nearest = std::min(cell.nearest, other.nearest);
        cell.farthest = std::max(cell.farthest, other.farthest);
        cell.darkest = std::min(cell.darkest, other.darkest);
        cell.brightest = std::max(cell.brightest, other.brightest);
        measured += other.thing;
      }
      cell.nearest = measured >= kFewestOfNine ? cell.nearest : 0.0f;
      cell.thing = 0;
      if (small.gray.empty()) {
        cell.darkest = 0;
        cell.brightest = 255;
      }
      small.cells[static_cast<std::size_t>(y) * width + x] = cell;
    }
  }
}

}  // namespace

int reductionOf(int image_width, int working_width) {
  return std::max(1, (image_width + working_width / 2) / working_width);
}

SmallCamera smallCamera(const PinholeCamera& camera, int reduction) {
  const double r = reduction;
  const double middle = reduction / 2;  // NOLINT(bugprone-integer-division): as reduceDepth
  return {static_cast<float>(camera.fx / r), static_cast<float>(camera.fy / r),
          static_cast<float>((camera.cx - middle) / r),
          static_cast<float>((camera.cy - middle) / r)};
}

SmallFrame reduceFrame(const MotionMaskFrame& frame, int reduction, SmallFrame reuse,
                       std::vector<MaskCell>& scratch) {
  SmallFrame small = std::move(reuse);
  small.timestamp = frame.timestamp;
  small.camera_from_world = frame.camera_from_world;
  small.width = frame.depth.cols / reduction;
  small.height = frame.depth.rows / reduction;
  small.depth.resize(static_cast<std::size_t>(small.width) *
                     static_cast<std::size_t>(small.height));
  small.cells.resize(small.depth.size());
  reduceDepth(frame.depth, reduction, small);
  if (frame.gray.empty()) {
    small.gray.clear();
  } else {
    reduceGray(frame.gray, reduction, small);
  }
  fillCells(small, scratch);
  return small;
}

RelativePose relativePose(const Pose& earlier, const Pose& current) {
  // [R_e | t_e] after the inverse of [R_c | t_c]
  const Eigen::Matrix3d rotation = earlier.linear() * current.linear().transpose();
  const Eigen::Vector3d shift = earlier.translation() - rotation * current.translation();
  RelativePose relative{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      relative.rotation[static_cast<std::size_t>(3 * i + j)] = static_cast<float>(rotation(i, j));
    }
    relative.translation[static_cast<std::size_t>(i)] = static_cast<float>(shift(i));
  }
  return relative;
}

StaticPlace staticPlace(std::uint32_t pixel, const SmallFrame& frame, const SmallCamera& camera,
                        const RelativePose& motion) {
  const auto width = static_cast<std::uint32_t>(frame.width);
  return staticPlace(static_cast<int>(pixel / width), static_cast<int>(pixel % width),
                     frame.depth[pixel], camera, motion);
}

bool isFinite(const Pose& pose) { return pose.matrix.map().allFinite(); }

PoseStep stepBetween(const Pose& earlier, const Pose& current) {
  const RelativePose relative = relativePose(earlier, current);
  const auto& t = relative.translation;
  const double trace = static_cast<double>(relative.rotation[0]) +
                       static_cast<double>(relative.rotation[4]) +
                       static_cast<double>(relative.rotation[8]);
  return {std::sqrt(static_cast<double>(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])),
          std::acos(std::clamp((trace - 1.0) / 2.0, -1.0, 1.0))};
}

}  // namespace hmcdyn::internal
