// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/dense_mapper.hpp"

#include <utility>

#include "slam/output/dense/static_depth.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kQueue = 4;

std::vector<cv::Point2f> dynamicPoints(const FrameOutcome& outcome) {
  std::vector<cv::Point2f> points;
  for (std::size_t i = 0; i < outcome.points.size(); ++i) {
    if (outcome.filtered.stage.label[i] == PointLabel::kDynamic) {
      points.emplace_back(outcome.points.u[i], outcome.points.v[i]);
    }
  }
  return points;
}

}  // namespace

cv::Mat DenseMapper::staticMaskOf(const Job& job) {
  const cv::Mat mask =
      job.motion.empty() ? staticMask(job.bgr.size(), job.boxes, job.dynamic_points)
                         : staticMaskByMotion(job.motion, job.depth, job.boxes, job.dynamic_points);
  return job.labels.empty() ? mask : withoutLabels(mask, job.labels);
}

DenseMapper::DenseMapper()
    : dense_(std::make_shared<DenseMap>()),
      worker_(
          [dense = dense_](const Job& job) {
            dense->add(job.key_frame, thinKeyFrame(job.bgr, job.depth, staticMaskOf(job)));
            return std::monostate{};
          },
          kQueue) {}

void DenseMapper::add(std::size_t key_frame, const FrameOutcome& outcome) {
  std::vector<std::uint8_t> is_dynamic;
  for (const BoxDecision& box : outcome.filtered.stage.boxes) {
    is_dynamic.push_back(box.verdict.is_dynamic ? 1 : 0);
  }
  std::vector<DetectionBox> boxes;
  if (outcome.mask.empty()) {
    boxes = boxesToLeaveOut(outcome.boxes, is_dynamic);
  }
  cv::Mat motion;
  if (outcome.motion != nullptr) {
    motion = outcome.motion->label.clone();  // the filter writes the next frame's there
  }
  worker_.submit({key_frame, outcome.image.bgr, outcome.image.depth, std::move(boxes),
                  outcome.mask.labels, std::move(motion), dynamicPoints(outcome)});
  while (worker_.tryTake()) {
  }
}

void DenseMapper::finish() {
  while (worker_.pending() > 0) {
    worker_.take();
  }
}

FusionResult DenseMapper::fuse(const Map& map) {
  std::vector<KeyFramePose> poses;
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    poses.push_back({k, map.poseOf(static_cast<int>(k))});
  }
  return dense_->fuse(poses, map.camera());
}

}  // namespace hmcdyn::slam
