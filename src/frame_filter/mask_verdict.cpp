// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/mask_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hmcdyn::internal {
namespace {

/// Weight of a point that the steps before call dynamic and the mask does not: that of one kept for
/// number only.
constexpr float kContestedWeight = kRescueWeight;

/// A corner so near to what moves (px) is of its silhouette, not of the room: the ring that FAST
/// looks at has a radius of 3 px, and colour and depth are registered no better than to one.
constexpr int kOfSilhouette = 4;

bool isBesideMoving(const cv::Mat& label, int column, int row) {
  const int first = std::max(column - kOfSilhouette, 0);
  const int end = std::min(column + kOfSilhouette + 1, label.cols);
  const int last_row = std::min(row + kOfSilhouette, label.rows - 1);
  for (int y = std::max(row - kOfSilhouette, 0); y <= last_row; ++y) {
    const std::uint8_t* labels = label.ptr(y);
    if (std::find(labels + first, labels + end, static_cast<std::uint8_t>(MaskLabel::kMoving)) !=
        labels + end) {
      return true;
    }
  }
  return false;
}

MaskLabel labelAt(const MotionMask& mask, float u, float v) {
  const int column = std::clamp(static_cast<int>(std::lround(u)), 0, mask.label.cols - 1);
  const int row = std::clamp(static_cast<int>(std::lround(v)), 0, mask.label.rows - 1);
  const auto label = static_cast<MaskLabel>(mask.label.at<std::uint8_t>(row, column));
  return label == MaskLabel::kStatic && isBesideMoving(mask.label, column, row)
             ? MaskLabel::kUnknown
             : label;
}

/// What it does not know, and things that stand, of which parts may move.
bool leavesOpen(MaskLabel label) {
  return label == MaskLabel::kUnknown || label == MaskLabel::kStanding;
}

void countLabels(FilterStageResult& stage) {
  const auto count = [&](PointLabel label) {
    return static_cast<std::size_t>(std::count(stage.label.begin(), stage.label.end(), label));
  };
  stage.frame.dynamic = count(PointLabel::kDynamic);
  stage.frame.suspect = count(PointLabel::kSuspect);
  stage.frame.unmatched = count(PointLabel::kUnmatched);
}

}  // namespace

bool canBeMasked(const FrameInput& frame) {
  constexpr int kSmallest = 16;  // px, of the mask
  return !frame.depth.empty() && std::min(frame.depth.cols, frame.depth.rows) >= kSmallest;
}

MotionMaskFrame maskFrameOf(const FrameInput& frame, const DynamicFeatureFilterInput& input,
                            const Eigen::Isometry3d& odometry, bool pose_is_known) {
  MotionMaskFrame masked;
  masked.timestamp = frame.timestamp;
  masked.depth = frame.depth;
  masked.gray = frame.gray;
  masked.camera_from_world = Pose(odometry);
  masked.pose_is_known = pose_is_known;
  masked.regions = input.regions;
  return masked;
}

std::vector<MaskLabel> labelsAt(const KeyPointsView& points, const MotionMask& mask) {
  std::vector<MaskLabel> labels(points.size(), MaskLabel::kUnknown);
  if (mask.state != MaskState::kGood && mask.state != MaskState::kTooLarge) {
    return labels;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isfinite(points.u[i]) && std::isfinite(points.v[i])) {
      labels[i] = labelAt(mask, points.u[i], points.v[i]);
    }
  }
  return labels;
}

std::vector<std::uint8_t> leftOpen(Span<const MaskLabel> seen) {
  std::vector<std::uint8_t> is_open;
  is_open.reserve(seen.size());
  for (const MaskLabel label : seen) {
    is_open.push_back(leavesOpen(label) ? 1 : 0);
  }
  return is_open;
}

DynamicFeatureFilterResult judgeByMask(DynamicFeatureFilterResult result,
                                       Span<const MaskLabel> seen,
                                       const MotionBeliefOptions& options) {
  const bool has_beliefs = result.belief.size() == seen.size();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    PointLabel& label = result.stage.label[i];
    float& weight = result.stage.weight[i];
    if (leavesOpen(seen[i])) {
      if (label == PointLabel::kDynamic) {
        label = PointLabel::kSuspect;
        weight = kContestedWeight;
      }
      continue;
    }
    const bool moves = seen[i] == MaskLabel::kMoving;
    label = moves ? PointLabel::kDynamic : PointLabel::kStatic;
    weight = moves ? 0.0f : 1.0f;
    if (has_beliefs) {
      result.belief.belief[i] = moves ? 1.0f : 0.0f;
      result.belief.weight[i] = options.memory_decay;
    }
  }
  if (!seen.empty()) {
    countLabels(result.stage);
  }
  return result;
}

}  // namespace hmcdyn::internal
