// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detection/motion_regions.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include <hmcdyn/box_carrier.hpp>
#include <hmcdyn/epipolar.hpp>
#include <hmcdyn/fundamental.hpp>

#include "slam/detection/option_check.hpp"

namespace hmcdyn::slam {
namespace {

/// Regions are followed on images of half the size: their flow needs no more.
constexpr float kFlowScale = 0.5f;

void checkOptions(const MotionRegionOptions& o) {
  requireOption(o.reduction >= 1 && o.reduction <= 16, "MotionRegionOptions::reduction",
                o.reduction, "1..16");
  requireOption(o.depth_step > 0.0f, "MotionRegionOptions::depth_step", o.depth_step,
                "more than 0");
  requireOption(o.max_slope > 0.0f, "MotionRegionOptions::max_slope", o.max_slope, "more than 0");
  requireOption(o.min_area >= 0.0f && o.min_area < o.max_area, "MotionRegionOptions::min_area",
                o.min_area, "0 or more, below max_area");
  requireOption(o.baseline > 0.0 && o.baseline <= o.history, "MotionRegionOptions::baseline",
                o.baseline, "more than 0 s, at most history");
  requireOption(o.grid_step >= 4, "MotionRegionOptions::grid_step", o.grid_step, "4 px or more");
  requireOption(o.min_distance > 0.0f, "MotionRegionOptions::min_distance", o.min_distance,
                "more than 0 px");
  requireOption(o.min_moving > 0.0f && o.min_moving <= 1.0f, "MotionRegionOptions::min_moving",
                o.min_moving, "0..1");
  requireOption(o.max_pause >= 0.0, "MotionRegionOptions::max_pause", o.max_pause, "0 s or more");
}

/// The depths in the middle of each square of pixels.
cv::Mat reduced(const cv::Mat& depth, int reduction) {
  cv::Mat small(depth.rows / reduction, depth.cols / reduction, CV_32FC1);
  for (int row = 0; row < small.rows; ++row) {
    const auto* from = depth.ptr<float>(row * reduction + reduction / 2);
    auto* to = small.ptr<float>(row);
    for (int column = 0; column < small.cols; ++column) {
      to[column] = from[column * reduction + reduction / 2];
    }
  }
  return small;
}

/// -1 where a pixel can belong to no segment, -2 where it waits for one.
cv::Mat candidates(const cv::Mat& depth, float max_slope) {
  cv::Mat label(depth.size(), CV_32SC1, cv::Scalar(-1));
  for (int row = 0; row < depth.rows; ++row) {
    const auto* above = depth.ptr<float>(std::max(row - 1, 0));
    const auto* here = depth.ptr<float>(row);
    const auto* below = depth.ptr<float>(std::min(row + 1, depth.rows - 1));
    for (int column = 0; column < depth.cols; ++column) {
      const float z = here[column];
      // Of the two sides the flatter one counts, so that a thing keeps its borders.
      const auto slope = [z](float other) { return hasDepth(other) ? std::abs(other - z) : 0.0f; };
      const float flatter = std::min(slope(above[column]), slope(below[column]));
      if (hasDepth(z) && flatter <= max_slope * z) {
        label.at<int>(row, column) = -2;
      }
    }
  }
  return label;
}

struct Grown {
  std::vector<cv::Point> pixels;
  cv::Rect rect;
};

/// Takes all that hangs together with the seed, and marks it with the label.
Grown grow(cv::Mat& label, const cv::Mat& depth, cv::Point seed, int mark, float depth_step) {
  Grown grown;
  grown.pixels.push_back(seed);
  label.at<int>(seed) = mark;
  cv::Point low = seed;
  cv::Point high = seed;
  for (std::size_t k = 0; k < grown.pixels.size(); ++k) {
    const cv::Point at = grown.pixels[k];
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    for (const cv::Point step :
         {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point next = at + step;
      if (next.x < 0 || next.y < 0 || next.x >= depth.cols || next.y >= depth.rows ||
          label.at<int>(next) != -2) {
        continue;
      }
      const float z = depth.at<float>(at);
      if (std::abs(depth.at<float>(next) - z) <= depth_step * z) {
        label.at<int>(next) = mark;
        grown.pixels.push_back(next);
      }
    }
  }
  grown.rect = cv::Rect(low, high + cv::Point(1, 1));
  return grown;
}

KeyPoints gridOver(const cv::Mat& depth, int step) {
  KeyPoints points;
  for (int v = step / 2; v < depth.rows; v += step) {
    for (int u = step / 2; u < depth.cols; u += step) {
      points.push_back(static_cast<float>(u) * kFlowScale, static_cast<float>(v) * kFlowScale,
                       depth.at<float>(v, u));
    }
  }
  return points;
}

/// Distances (px of the whole image) of the points from where static ones could be; NaN = unknown.
std::vector<float> distancesOf(const KeyPoints& points, const FlowMatches& matches,
                               const MotionRegionOptions& region) {
  const auto whole = [](std::vector<float> values) {
    std::transform(values.begin(), values.end(), values.begin(),
                   [](float value) { return value / kFlowScale; });
    return values;
  };
  const std::vector<float> earlier_u = whole(matches.u);
  const std::vector<float> earlier_v = whole(matches.v);
  const std::vector<float> current_u = whole(points.u);
  const std::vector<float> current_v = whole(points.v);
  const PointPairsView pairs{earlier_u, earlier_v, current_u, current_v};
  TwoViewOptions options;
  options.max_iterations = region.max_iterations;
  options.seed = region.seed;
  return modelDistances(estimateTwoViewModel(pairs, {}, options).model, pairs);
}

/// What the flow says about a segment.
struct Evidence {
  std::size_t points = 0;
  std::size_t moving = 0;
};

std::vector<Evidence> evidenceOf(const DepthSegments& segments, const KeyPoints& points,
                                 const std::vector<float>& distance,
                                 const MotionRegionOptions& options) {
  std::vector<Evidence> evidence(segments.rect.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int column = static_cast<int>(points.u[i] / kFlowScale) / options.reduction;
    const int row = static_cast<int>(points.v[i] / kFlowScale) / options.reduction;
    if (!std::isfinite(distance[i]) || column >= segments.label.cols ||
        row >= segments.label.rows) {
      continue;
    }
    const int label = segments.label.at<int>(row, column);
    if (label >= 0) {
      Evidence& of = evidence[static_cast<std::size_t>(label)];
      ++of.points;
      of.moving += distance[i] > options.min_distance ? 1 : 0;
    }
  }
  return evidence;
}

DetectionBox boxOf(const cv::Rect& rect, cv::Size image, float score,
                   const MotionRegionOptions& options) {
  const auto at = [&](int reduced_pixel) {
    return static_cast<float>(reduced_pixel * options.reduction);
  };
  DetectionBox box;
  box.x_min = std::max(at(rect.x) - options.margin, 0.0f);
  box.y_min = std::max(at(rect.y) - options.margin, 0.0f);
  box.x_max = std::min(at(rect.br().x) + options.margin, static_cast<float>(image.width - 1));
  box.y_max = std::min(at(rect.br().y) + options.margin, static_cast<float>(image.height - 1));
  box.class_id = kUnknownClassId;
  box.score = score;
  return box;
}

}  // namespace

DepthSegments segmentDepth(const cv::Mat& depth, const MotionRegionOptions& options) {
  if (depth.empty() || depth.type() != CV_32FC1) {
    throw std::invalid_argument("segmentDepth: depth is " +
                                (depth.empty() ? "empty" : cv::typeToString(depth.type())) +
                                "; expected CV_32FC1 (m)");
  }
  const cv::Mat small = reduced(depth, options.reduction);
  DepthSegments segments;
  segments.label = candidates(small, options.max_slope);
  const auto total = static_cast<float>(small.total());
  for (int row = 0; row < small.rows; ++row) {
    for (int column = 0; column < small.cols; ++column) {
      if (segments.label.at<int>(row, column) != -2) {
        continue;
      }
      const Grown grown = grow(segments.label, small, {column, row},
                               static_cast<int>(segments.rect.size()), options.depth_step);
      const float share = static_cast<float>(grown.pixels.size()) / total;
      if (share >= options.min_area && share <= options.max_area) {
        segments.rect.push_back(grown.rect);
        continue;
      }
      for (const cv::Point pixel : grown.pixels) {
        segments.label.at<int>(pixel) = -1;
      }
    }
  }
  return segments;
}

MotionRegions::MotionRegions(const MotionRegionOptions& options) : options_(options) {
  checkOptions(options_);
}

const MotionRegions::Moment* MotionRegions::comparable(double timestamp) const {
  const auto youngest = std::find_if(history_.rbegin(), history_.rend(), [&](const Moment& moment) {
    return timestamp - moment.timestamp >= options_.baseline;
  });
  return youngest != history_.rend() && timestamp - youngest->timestamp <= options_.history
             ? &*youngest
             : nullptr;
}

void MotionRegions::remember(double timestamp, const std::vector<DetectionBox>& moving,
                             std::vector<DetectionBox> still) {
  std::vector<Region> regions;
  regions.reserve(moving.size() + still.size());
  for (const DetectionBox& box : moving) {
    regions.push_back({box, timestamp});
  }
  for (DetectionBox& box : still) {
    const auto known = std::find_if(regions_.begin(), regions_.end(), [&](const Region& region) {
      return timestamp - region.moved_at <= options_.max_pause &&
             intersectionOverUnion(region.box, box) >= options_.remembered_iou;
    });
    if (known != regions_.end()) {
      box.score = known->box.score;
      regions.push_back({box, known->moved_at});
    }
  }
  regions_ = std::move(regions);
}

std::vector<DetectionBox> MotionRegions::update(const RgbdFrame& frame) {
  if (frame.gray.size() != frame.depth.size()) {
    throw std::invalid_argument("MotionRegions: gray and depth differ in size");
  }
  cv::Mat half;
  cv::resize(frame.gray, half, cv::Size(), kFlowScale, kFlowScale, cv::INTER_AREA);
  if (!history_.empty() && (frame.timestamp <= history_.back().timestamp ||
                            history_.back().pyramid.front().size() != half.size())) {
    history_.clear();
    regions_.clear();
  }
  Moment now{frame.timestamp, buildFlowPyramid(half, options_.flow)};
  const DepthSegments segments = segmentDepth(frame.depth, options_);
  std::vector<Evidence> evidence(segments.rect.size());
  if (const Moment* earlier = comparable(frame.timestamp)) {
    const KeyPoints points = gridOver(frame.depth, options_.grid_step);
    const FlowMatches matches =
        trackIntoEarlierFrame(now.pyramid, earlier->pyramid, points.view(), options_.flow);
    evidence = evidenceOf(segments, points, distancesOf(points, matches, options_), options_);
  }
  std::vector<DetectionBox> moving;
  std::vector<DetectionBox> still;
  for (std::size_t i = 0; i < segments.rect.size(); ++i) {
    const float share = evidence[i].points == 0 ? 0.0f
                                                : static_cast<float>(evidence[i].moving) /
                                                      static_cast<float>(evidence[i].points);
    const bool moves = evidence[i].points >= options_.min_points && share >= options_.min_moving;
    (moves ? moving : still).push_back(boxOf(segments.rect[i], frame.gray.size(), share, options_));
  }
  remember(frame.timestamp, moving, std::move(still));
  history_.push_back(std::move(now));
  while (frame.timestamp - history_.front().timestamp > options_.history) {
    history_.pop_front();
  }
  std::vector<DetectionBox> boxes;
  for (const Region& region : regions_) {
    boxes.push_back(region.box);
  }
  return boxes;
}

}  // namespace hmcdyn::slam
