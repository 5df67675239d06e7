// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/detection_thread.hpp"

#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "support/stage_times.hpp"

namespace hmcdyn::slam {
namespace {

/// std::function copies what it holds, so the one detector is shared by the copies.
std::shared_ptr<ObjectDetector> requireDetector(std::unique_ptr<ObjectDetector> detector) {
  if (!detector) {
    throw std::invalid_argument("DetectionThread: detector is null");
  }
  return detector;
}

}  // namespace

DetectionThread::DetectionThread(std::unique_ptr<ObjectDetector> detector, Report report,
                                 std::size_t lookahead)
    : name_(detector ? detector->name() : ""),
      report_(std::move(report)),
      worker_([shared = requireDetector(std::move(detector))](
                  const DetectionRequest& request) { return detect(*shared, request); },
              lookahead) {}

DetectionThread::Answer DetectionThread::detect(ObjectDetector& detector,
                                                const DetectionRequest& request) {
  Answer answer;
  answer.detection.frame = request.frame;
  answer.detection.timestamp = request.timestamp;
  const support::StageTimer timer;
  try {
    Seen seen = detector.see(request.bgr, request.timestamp);
    answer.detection.boxes = std::move(seen.boxes);
    answer.detection.labels = std::move(seen.labels);
  } catch (const std::exception& error) {
    answer.detection.failed = true;
    answer.error = error.what();
  } catch (...) {
    answer.detection.failed = true;
    answer.error = "it threw what is no std::exception";
  }
  const support::StageTime time = timer.elapsed("detect");
  answer.detection.wall_ms = time.wall_ms;
  answer.detection.cpu_ms = time.cpu_ms;
  return answer;
}

void DetectionThread::request(DetectionRequest request) {
  ++counts_.requested;
  worker_.submit(std::move(request));
}

void DetectionThread::requestNewest(DetectionRequest request) {
  ++counts_.requested;
  if (worker_.submitReplacingOldest(std::move(request))) {
    ++counts_.replaced;
  }
}

Detection DetectionThread::take() { return account(worker_.take()); }

std::optional<Detection> DetectionThread::tryTakeNewest() {
  std::optional<Detection> newest;
  while (std::optional<Answer> answer = worker_.tryTake()) {
    Detection detection = account(std::move(*answer));
    if (!detection.failed) {
      newest = std::move(detection);
    }
  }
  return newest;
}

Detection DetectionThread::account(Answer answer) {
  if (answer.detection.failed) {
    counts_.last_failure = fmt::format("at frame {}: {}", answer.detection.frame, answer.error);
    if (++counts_.failed == 1) {
      counts_.first_failure = counts_.last_failure;
      report_(
          fmt::format("detector {}: failed at frame {}, which goes without its boxes: {}; further "
                      "failures are only counted",
                      name_, answer.detection.frame, answer.error));
    }
  } else {
    ++counts_.detected;
  }
  return std::move(answer.detection);
}

}  // namespace hmcdyn::slam
