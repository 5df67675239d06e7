// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/static_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::slam {
namespace {

constexpr float kMillimetres = 1000.0f;
constexpr float kLargestDepth = 32.0f;

void checkOptions(const StaticDepthOptions& options) {
  if (options.stride < 1 || !(options.min_depth > 0.0f) ||
      !(options.max_depth > options.min_depth && options.max_depth <= kLargestDepth) ||
      !(options.box_margin >= 0.0f) || !(options.point_radius >= 0.0f) ||
      !(options.edge_share > 0.0f) || !(options.room_behind >= 0.0f)) {
    throw std::invalid_argument(fmt::format(
        "dense map: stride {}, depths {} to {} m, box margin {} px, point radius {} px, edge share "
        "{}, room behind {} m; expected a stride above 0, 0 < depths <= {} m in order, margin, "
        "radius and room behind of at least 0, a share above 0",
        options.stride, options.min_depth, options.max_depth, options.box_margin,
        options.point_radius, options.edge_share, options.room_behind, kLargestDepth));
  }
}

void checkImages(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask) {
  if (bgr.empty() || bgr.type() != CV_8UC3 || depth.type() != CV_32FC1 ||
      depth.size() != bgr.size() ||
      (!mask.empty() && (mask.type() != CV_8UC1 || mask.size() != bgr.size()))) {
    throw std::invalid_argument(fmt::format(
        "dense map: colour {}x{} type {}, depth {}x{} type {}, mask {}x{} type {}; expected one "
        "size with pixels, CV_8UC3, CV_32FC1, CV_8UC1 or no mask",
        bgr.cols, bgr.rows, bgr.type(), depth.cols, depth.rows, depth.type(), mask.cols, mask.rows,
        mask.type()));
  }
}

/// Whole pixels that a range covers, within 0..size.
cv::Range pixels(float low, float high, int size) {
  const auto limit = static_cast<float>(size);
  return {static_cast<int>(std::ceil(std::clamp(low, 0.0f, limit))),
          static_cast<int>(std::floor(std::clamp(high, -1.0f, limit - 1.0f))) + 1};
}

/// The pixels of a box that is larger by the margin; none for a NaN or an inverted box.
cv::Rect boundsOf(const DetectionBox& box, float margin, cv::Size size) {
  if (!(box.x_min <= box.x_max && box.y_min <= box.y_max)) {
    return {};
  }
  const cv::Range columns = pixels(box.x_min - margin, box.x_max + margin, size.width);
  const cv::Range rows = pixels(box.y_min - margin, box.y_max + margin, size.height);
  return columns.start < columns.end && rows.start < rows.end
             ? cv::Rect(columns.start, rows.start, columns.size(), rows.size())
             : cv::Rect();
}

/// Depth (m) of what moves or may move in a box: nine tenths of its pixels are nearer (its border
/// is ragged, and so holds some of the room). Infinite where nothing does.
float depthOfThing(const cv::Mat& motion, const cv::Mat& depth) {
  constexpr float kShare = 0.9f;
  std::vector<float> depths;
  for (int row = 0; row < motion.rows; ++row) {
    for (int column = 0; column < motion.cols; ++column) {
      const float z = depth.at<float>(row, column);
      if (motion.at<std::uint8_t>(row, column) >= static_cast<int>(MaskLabel::kStanding) &&
          hasDepth(z)) {
        depths.push_back(z);
      }
    }
  }
  if (depths.empty()) {
    return std::numeric_limits<float>::infinity();
  }
  const auto place =
      depths.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<float>(depths.size() - 1));
  std::nth_element(depths.begin(), place, depths.end());
  return *place;
}

bool atJump(const cv::Mat& depth, int row, int column, float share) {
  constexpr int kReach = 2;
  const float here = depth.at<float>(row, column);
  constexpr std::array<std::pair<int, int>, 4> kSteps{
      {{-kReach, 0}, {kReach, 0}, {0, -kReach}, {0, kReach}}};
  return std::any_of(kSteps.begin(), kSteps.end(), [&](const std::pair<int, int>& step) {
    const int r = row + step.first;
    const int c = column + step.second;
    if (r < 0 || c < 0 || r >= depth.rows || c >= depth.cols) {
      return false;
    }
    const float there = depth.at<float>(r, c);
    return hasDepth(there) && std::abs(there - here) > share * here;
  });
}

}  // namespace

cv::Mat staticMask(cv::Size size, Span<const DetectionBox> boxes,
                   Span<const cv::Point2f> dynamic_points, const StaticDepthOptions& options) {
  checkOptions(options);
  if (size.width < 1 || size.height < 1) {
    throw std::invalid_argument(
        fmt::format("dense map: mask of {}x{}; expected pixels", size.width, size.height));
  }
  cv::Mat mask(size, CV_8UC1, cv::Scalar(255));
  for (const DetectionBox& box : boxes) {
    mask(boundsOf(box, options.box_margin, size)).setTo(0);
  }
  for (const cv::Point2f& point : dynamic_points) {
    if (std::isfinite(point.x) && std::isfinite(point.y)) {
      mask(boundsOf({point.x, point.y, point.x, point.y}, options.point_radius, size)).setTo(0);
    }
  }
  return mask;
}

cv::Mat staticMaskByMotion(const cv::Mat& motion, const cv::Mat& depth,
                           Span<const DetectionBox> boxes, Span<const cv::Point2f> dynamic_points,
                           const StaticDepthOptions& options) {
  if (motion.type() != CV_8UC1 || depth.type() != CV_32FC1 || depth.size() != motion.size()) {
    throw std::invalid_argument(fmt::format(
        "dense map: motion mask {}x{} type {}, depth {}x{} type {}; expected CV_8UC1 and CV_32FC1 "
        "of one size",
        motion.cols, motion.rows, motion.type(), depth.cols, depth.rows, depth.type()));
  }
  const cv::Mat points = staticMask(motion.size(), {}, dynamic_points, options);
  cv::Mat mask = withoutLabels(points, motion >= static_cast<int>(MaskLabel::kStanding), options);
  for (const DetectionBox& box : boxes) {
    const cv::Rect rect = boundsOf(box, options.box_margin, motion.size());
    if (!rect.empty()) {
      const float room = depthOfThing(motion(rect), depth(rect)) + options.room_behind;
      mask(rect).setTo(0, ~(depth(rect) > room));  // true for a NaN
    }
  }
  return mask;
}

cv::Mat withoutLabels(const cv::Mat& mask, const cv::Mat& labels,
                      const StaticDepthOptions& options) {
  checkOptions(options);
  if (mask.type() != CV_8UC1 || labels.channels() != 1 || labels.size() != mask.size()) {
    throw std::invalid_argument(fmt::format(
        "dense map: labels of {}x{} for a mask of {}x{}; expected one channel and equal sizes",
        labels.cols, labels.rows, mask.cols, mask.rows));
  }
  const int margin = static_cast<int>(std::lround(options.box_margin));
  cv::Mat covered;
  cv::dilate(labels != 0, covered,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * margin + 1, 2 * margin + 1}));
  cv::Mat rest = mask.clone();
  rest.setTo(0, covered);
  return rest;
}

std::vector<DetectionBox> boxesToLeaveOut(Span<const DetectionBox> boxes,
                                          Span<const std::uint8_t> box_is_dynamic) {
  if (box_is_dynamic.size() != boxes.size()) {
    throw std::invalid_argument(fmt::format("dense map: {} boxes, {} verdicts; expected one a box",
                                            boxes.size(), box_is_dynamic.size()));
  }
  std::vector<DetectionBox> left_out;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].class_id == kPersonClassId || box_is_dynamic[i] != 0) {
      left_out.push_back(boxes[i]);
    }
  }
  return left_out;
}

ThinnedKeyFrame thinKeyFrame(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask,
                             const StaticDepthOptions& options) {
  checkOptions(options);
  checkImages(bgr, depth, mask);
  const int rows = (bgr.rows + options.stride - 1) / options.stride;
  const int columns = (bgr.cols + options.stride - 1) / options.stride;
  ThinnedKeyFrame thin;
  thin.stride = options.stride;
  thin.depth = cv::Mat(rows, columns, CV_16UC1, cv::Scalar(0));
  thin.usable = cv::Mat(rows, columns, CV_8UC1, cv::Scalar(0));
  thin.colour = cv::Mat(rows, columns, CV_8UC3);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int row = r * options.stride;
      const int column = c * options.stride;
      thin.colour.at<cv::Vec3b>(r, c) = bgr.at<cv::Vec3b>(row, column);
      const float z = depth.at<float>(row, column);
      if (!hasDepth(z) || z > kLargestDepth) {
        continue;
      }
      thin.depth.at<std::uint16_t>(r, c) =
          static_cast<std::uint16_t>(std::lround(z * kMillimetres));
      const bool in_range = z >= options.min_depth && z <= options.max_depth;
      if (in_range && (mask.empty() || mask.at<std::uint8_t>(row, column) != 0) &&
          !atJump(depth, row, column, options.edge_share)) {
        thin.usable.at<std::uint8_t>(r, c) = 255;
      }
    }
  }
  return thin;
}

}  // namespace hmcdyn::slam
