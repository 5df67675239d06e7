// SPDX-License-Identifier: BSD-3-Clause
#include "mask/small_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <opencv2/core/hal/intrin.hpp>

namespace hmcdyn::internal {
namespace {

constexpr float kFar = 1e6f;          // stands for "no depth" where the nearest is looked for
constexpr float kLongest = 100.0f;    // (m): no depth camera measures that far
constexpr float kOneSurface = 0.03f;  // depths of one surface in a square (share of the depth)
constexpr int kFewestOfNine = 6;      // depths around a pixel that may speak of free space

bool isDepth(float z) { return z > 0.0f && z < kLongest; }

/// Depth of the pixel in the middle of a square, or of one beside it: what is missing there.
void middleDepths(const cv::Mat& depth, int reduction, SmallFrame& small) {
  const int middle = reduction / 2;
  const int beside = std::max(middle - 1, 0);
  for (int y = 0; y < small.height; ++y) {
    const auto* row = depth.ptr<float>(y * reduction + middle);
    const auto* row_beside = depth.ptr<float>(y * reduction + beside);
    float* to = small.depth.data() + small.index(y, 0);
    for (int x = 0; x < small.width; ++x) {
      const int column = x * reduction + middle;
      const int column_beside = x * reduction + beside;
      float z = row[column];
      if (!isDepth(z)) {
        for (const float other :
             {row_beside[column_beside], row[column_beside], row_beside[column]}) {
          z = isDepth(other) && !isDepth(z) ? other : z;
        }
        z = isDepth(z) ? z : 0.0f;
      }
      to[x] = z;
    }
  }
}

/// Sum and number of the depths in each column of a row of squares that are like the middle's. In
/// lanes by hand: GCC sees control flow in the plain loop, which takes three times as long.
void sumColumns(const cv::Mat& depth, int first_row, int end_row, ReduceWorkspace& w) {
  using Lanes = cv::v_float32x4;
  constexpr std::size_t kLanes = Lanes::nlanes;  // no more than columns: kSmallestSide
  const Lanes one = cv::v_setall_f32(1.0f);
  const Lanes share = cv::v_setall_f32(kOneSurface);
  const std::size_t columns = w.middles.size();
  for (std::size_t first = 0; first < columns; first += kLanes) {
    const std::size_t start = std::min(first, columns - kLanes);  // the last overlap their left
    const Lanes middle = cv::v_load(w.middles.data() + start);
    const Lanes limit = share * middle;
    Lanes sum = cv::v_setzero_f32();
    Lanes count = cv::v_setzero_f32();
    for (int row = first_row; row < end_row; ++row) {
      const Lanes z = cv::v_load(depth.ptr<float>(row) + start);
      const Lanes alike = cv::v_abs(z - middle) < limit;
      sum += z & alike;
      count += one & alike;
    }
    cv::v_store(w.depth_sums.data() + start, sum);
    cv::v_store(w.depth_counts.data() + start, count);
  }
}

/// Mean of the depths of each square that are of the middle's surface: less noise, and no depth
/// between two surfaces. What is not finite compares false.
void reduceDepth(const cv::Mat& depth, int reduction, SmallFrame& small, ReduceWorkspace& w) {
  middleDepths(depth, reduction, small);
  const std::size_t columns =
      static_cast<std::size_t>(small.width) * static_cast<std::size_t>(reduction);
  w.middles.resize(columns);
  w.depth_sums.resize(columns);
  w.depth_counts.resize(columns);
  std::size_t measured = 0;
  for (int y = 0; y < small.height; ++y) {
    float* to = small.depth.data() + small.index(y, 0);
    for (int x = 0; x < small.width; ++x) {
      std::fill_n(w.middles.begin() + std::ptrdiff_t{x} * reduction, reduction, to[x]);
    }
    sumColumns(depth, y * reduction, (y + 1) * reduction, w);
    const float* sums = w.depth_sums.data();
    const float* counts = w.depth_counts.data();
    for (int x = 0; x < small.width; ++x, sums += reduction, counts += reduction) {
      const float count = std::accumulate(counts, counts + reduction, 0.0f);
      to[x] = count > 0.0f ? std::accumulate(sums, sums + reduction, 0.0f) / count : to[x];
      measured += to[x] > 0.0f ? 1 : 0;
    }
  }
  small.depth_share = static_cast<float>(measured) / static_cast<float>(small.size());
}

/// Mean gray level of each square.
void reduceGray(const cv::Mat& gray, int reduction, SmallFrame& small,
                std::vector<std::uint32_t>& sums) {
  small.gray.resize(small.size());
  const auto columns = static_cast<std::size_t>(small.width) * static_cast<std::size_t>(reduction);
  const auto count = static_cast<double>(reduction) * static_cast<double>(reduction);
  const double half = 0.5 * count;
  std::uint64_t total = 0;
  for (int y = 0; y < small.height; ++y) {
    sums.assign(columns, 0);
    for (int row = y * reduction; row < (y + 1) * reduction; ++row) {
      const std::uint8_t* from = gray.ptr(row);
      for (std::size_t x = 0; x < columns; ++x) {
        sums[x] += from[x];
      }
    }
    const std::uint32_t* from = sums.data();
    std::uint8_t* to = small.gray.data() + small.index(y, 0);
    for (int x = 0; x < small.width; ++x, from += reduction) {
      const std::uint32_t sum = std::accumulate(from, from + reduction, 0U);
      to[x] = static_cast<std::uint8_t>((static_cast<double>(sum) + half) / count);
      total += sum;
    }
  }
  small.brightness =
      static_cast<float>(static_cast<double>(total) / (count * static_cast<double>(small.size())));
}

template <typename T>
T smallest(T a, T b, T c) {
  return std::min(std::min(a, b), c);
}
template <typename T>
T largest(T a, T b, T c) {
  return std::max(std::max(a, b), c);
}

/// Three neighbours above each other; at index x + 1, beside what leaves all as it is.
void extremesOfColumns(const SmallFrame& small, int y, ReduceWorkspace& w) {
  const int above = std::max(y - 1, 0);
  const int below = std::min(y + 1, small.height - 1);
  const float* z_above = small.depth.data() + small.index(above, 0);
  const float* z_here = small.depth.data() + small.index(y, 0);
  const float* z_below = small.depth.data() + small.index(below, 0);
  const int has_above = above < y ? 1 : 0;
  const int has_below = below > y ? 1 : 0;
  float* nearest = w.nearest.data() + 1;
  float* farthest = w.farthest.data() + 1;
  int* measured = w.measured.data() + 1;
  const auto near = [](float z) { return z > 0.0f ? z : kFar; };
  const auto count = [](float z) { return z > 0.0f ? 1 : 0; };
  for (int x = 0; x < small.width; ++x) {
    nearest[x] = smallest(near(z_above[x]), near(z_here[x]), near(z_below[x]));
    farthest[x] = largest(z_above[x], z_here[x], z_below[x]);
    measured[x] = has_above * count(z_above[x]) + count(z_here[x]) + has_below * count(z_below[x]);
  }
  if (small.gray.empty()) {
    return;
  }
  const std::uint8_t* g_above = small.gray.data() + small.index(above, 0);
  const std::uint8_t* g_here = small.gray.data() + small.index(y, 0);
  const std::uint8_t* g_below = small.gray.data() + small.index(below, 0);
  std::uint8_t* darkest = w.darkest.data() + 1;
  std::uint8_t* brightest = w.brightest.data() + 1;
  for (int x = 0; x < small.width; ++x) {
    darkest[x] = smallest(g_above[x], g_here[x], g_below[x]);
    brightest[x] = largest(g_above[x], g_here[x], g_below[x]);
  }
}

void fillCells(SmallFrame& small, ReduceWorkspace& w) {
  const std::size_t padded = static_cast<std::size_t>(small.width) + 2;
  w.nearest.assign(padded, kFar);
  w.farthest.assign(padded, 0.0f);
  w.measured.assign(padded, 0);
  // without a gray image every gray level is possible
  w.darkest.assign(padded, small.gray.empty() ? 0 : 255);
  w.brightest.assign(padded, small.gray.empty() ? 255 : 0);
  for (int y = 0; y < small.height; ++y) {
    extremesOfColumns(small, y, w);
    MaskCell* cells = small.cells.data() + small.index(y, 0);
    for (std::size_t x = 0; x + 2 < padded; ++x) {
      const int measured = w.measured[x] + w.measured[x + 1] + w.measured[x + 2];
      const float nearest = smallest(w.nearest[x], w.nearest[x + 1], w.nearest[x + 2]);
      cells[x] = {measured >= kFewestOfNine ? nearest : 0.0f,
                  largest(w.farthest[x], w.farthest[x + 1], w.farthest[x + 2]),
                  0.0f,
                  smallest(w.darkest[x], w.darkest[x + 1], w.darkest[x + 2]),
                  largest(w.brightest[x], w.brightest[x + 1], w.brightest[x + 2]),
                  0};
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
                       ReduceWorkspace& workspace) {
  SmallFrame small = std::move(reuse);
  small.timestamp = frame.timestamp;
  small.camera_from_world = frame.camera_from_world;
  small.width = frame.depth.cols / reduction;
  small.height = frame.depth.rows / reduction;
  small.depth.resize(static_cast<std::size_t>(small.width) *
                     static_cast<std::size_t>(small.height));
  small.cells.resize(small.depth.size());
  reduceDepth(frame.depth, reduction, small, workspace);
  if (frame.gray.empty()) {
    small.gray.clear();
  } else {
    reduceGray(frame.gray, reduction, small, workspace.sums);
  }
  fillCells(small, workspace);
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
  const std::uint32_t row = pixel / width;
  const std::uint32_t column = pixel % width;
  const float z = frame.depth[pixel];
  const StaticPlace place =
      placeOnRay((static_cast<float>(column) - camera.cx) / camera.fx,
                 (static_cast<float>(row) - camera.cy) / camera.fy, z, camera, motion);
  return z > 0.0f && place.depth >= kNearestPlace ? place : StaticPlace{};
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
