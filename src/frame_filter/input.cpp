// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/input.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <hmcdyn/filter_stage.hpp>

#include "frame_filter/decision.hpp"
#include "image_text.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn::internal {
namespace {

void requireValue(bool good, const char* name, double value, const char* expected) {
  if (!good) {
    throw std::invalid_argument(std::string("FrameFilterOptions::") + name + " is " +
                                std::to_string(value) + "; expected " + expected);
  }
}

/// The nearest pixel's depth; 0 outside the image and for points that are not finite.
float nearestDepth(const cv::Mat& depth, const cv::Point2f& point) {
  const float column = std::floor(point.x + 0.5f);
  const float row = std::floor(point.y + 0.5f);
  const bool inside = column >= 0.0f && row >= 0.0f && column < static_cast<float>(depth.cols) &&
                      row < static_cast<float>(depth.rows);
  return inside ? depth.at<float>(static_cast<int>(row), static_cast<int>(column)) : 0.0f;
}

}  // namespace

FrameFilterOptions checked(FrameFilterOptions options) {
  for (const double baseline : options.baselines) {
    if (!(baseline >= 0.0 && std::isfinite(baseline))) {
      throw std::invalid_argument("FrameFilterOptions::baselines holds " +
                                  std::to_string(baseline) + "; expected ages >= 0 (s)");
    }
  }
  requireValue(options.soft_weight_gate >= 0.0 && options.soft_weight_gate <= 1.0,
               "soft_weight_gate", options.soft_weight_gate, "a share in [0, 1]");
  requireValue(options.bridge >= 0.0 && std::isfinite(options.bridge), "bridge", options.bridge,
               "0 s or more");
  requireValue(options.min_kept >= 0, "min_kept", options.min_kept, "0 or more points");
  constexpr int kLeastFollowed = 2 * 12;  // what a model needs, in boxes and elsewhere
  requireValue(options.max_followed == 0 || options.max_followed >= kLeastFollowed, "max_followed",
               options.max_followed, "0 (all), or 24 points or more");
  std::sort(options.baselines.begin(), options.baselines.end());
  return options;
}

void checkFrame(const FrameInput& frame) {
  if (frame.gray.empty() || frame.gray.type() != CV_8UC1) {
    throw std::invalid_argument("FrameFilter: gray is " + imageText(frame.gray) +
                                "; expected an image, CV_8UC1");
  }
  if (!frame.depth.empty() &&
      (frame.depth.type() != CV_32FC1 || frame.depth.size() != frame.gray.size())) {
    throw std::invalid_argument("FrameFilter: depth is " + imageText(frame.depth) +
                                "; expected CV_32FC1 (m) of the image's size, " +
                                std::to_string(frame.gray.cols) + " x " +
                                std::to_string(frame.gray.rows) + " px");
  }
  const std::size_t n = frame.key_points.size();
  if (!frame.point_depth.empty() && frame.point_depth.size() != n) {
    throw std::invalid_argument("FrameFilter: " + std::to_string(n) + " key points, but " +
                                std::to_string(frame.point_depth.size()) +
                                " depths; expected equal sizes, or none");
  }
  if (!frame.matched_pixels.empty() && frame.matched_pixels.size() != n) {
    throw std::invalid_argument("FrameFilter: " + std::to_string(n) + " key points, but " +
                                std::to_string(frame.matched_pixels.size()) +
                                " matched pixels; expected equal sizes, or none");
  }
}

void checkRegions(const FrameInput& frame, const Regions& regions) {
  if (regions.byMask() && !regions.boxes.empty()) {
    throw std::invalid_argument("FrameFilter: " + std::to_string(regions.boxes.size()) +
                                " boxes and a label image; expected one or the other");
  }
  if ((regions.byMask() || !regions.labelled.empty()) &&
      regions.labels.size() != frame.gray.size()) {
    throw std::invalid_argument("FrameFilter: labels is " + imageText(regions.labels) +
                                "; expected the image's size, " + std::to_string(frame.gray.cols) +
                                " x " + std::to_string(frame.gray.rows) + " px");
  }
}

std::vector<DetectionBox> namedBoxes(const Regions* regions) {
  if (regions == nullptr) {
    return {};
  }
  return regions->byMask()
             ? boundingBoxes(regions->labels, regions->labelled)
             : std::vector<DetectionBox>(regions->boxes.begin(), regions->boxes.end());
}

KeyPoints keyPointsOf(const FrameInput& frame) {
  KeyPoints points;
  points.reserve(frame.key_points.size());
  for (std::size_t i = 0; i < frame.key_points.size(); ++i) {
    const cv::Point2f& pixel = frame.key_points[i].pt;
    points.push_back(
        pixel.x, pixel.y,
        frame.point_depth.empty() ? nearestDepth(frame.depth, pixel) : frame.point_depth[i]);
  }
  return points;
}

DepthImageView viewOf(const cv::Mat& depth) {
  return depth.empty() ? DepthImageView{}
                       : DepthImageView{depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
}

Pixels matchedPixelsOf(const FrameInput& frame) {
  Pixels matched;
  for (const cv::Point2f& pixel : frame.matched_pixels) {
    matched.u.push_back(pixel.x);
    matched.v.push_back(pixel.y);
  }
  return matched;
}

void giveMatches(const std::vector<const RememberedFrame*>& frames, double timestamp,
                 const Pixels& matched, std::vector<EarlierFrame>& earlier) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!matched.u.empty() && frames[k]->timestamp == timestamp) {
      earlier[k].matched_u = matched.u;
      earlier[k].matched_v = matched.v;
    }
  }
}

FrameFilterResult notCompared(const FrameInput& frame, std::vector<DetectionBox> boxes,
                              const FrameFilterOptions& options) {
  const KeyPoints points = keyPointsOf(frame);
  FrameRegions regions;
  regions.membership = assignToBoxes(points.view(), boxes);
  DynamicFeatureFilterResult nothing;
  nothing.distance.assign(points.size(), kNaN);
  FilterStageOptions none;
  none.rule = FilterRule::kNone;
  nothing.stage = filterKeyPoints(points.view(), nothing.distance, boxes, none);
  const std::vector<std::uint8_t> in_region = inRegion(regions, points.size());
  FrameFilterResult result = decide(std::move(nothing), {}, in_region, options);
  result.status = FrameFilterStatus::kStampNotRising;
  if (options.drop_boxes_without_history && options.rule != FilterRule::kNone) {
    dropRegions(in_region, result);
  }
  result.boxes = std::move(boxes);
  return keepEnough(std::move(result), options);
}

}  // namespace hmcdyn::internal
