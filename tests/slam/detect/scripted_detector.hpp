// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/detect/detector.hpp"

namespace hmcdyn::slam::test {

/// Says what a function says; throws what it throws.
class ScriptedDetector final : public ObjectDetector {
 public:
  using Script = std::function<std::vector<DetectionBox>(const cv::Mat& bgr, double timestamp)>;
  explicit ScriptedDetector(Script script) : script_(std::move(script)) {}
  std::vector<DetectionBox> detect(const cv::Mat& bgr, double timestamp) override {
    return script_(bgr, timestamp);
  }
  std::string name() const override { return "scripted"; }

 private:
  Script script_;
};

/// Lets a detector go on frame by frame, and tells when it has begun one. No time is involved.
class Gate {
 public:
  /// Called by the detector.
  void pass() {
    std::unique_lock<std::mutex> lock(mutex_);
    ++begun_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return allowed_ >= begun_; });
  }
  void allow(int frames) {
    const std::lock_guard<std::mutex> lock(mutex_);
    allowed_ += frames;
    changed_.notify_all();
  }
  void awaitBegun(int frames) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return begun_ >= frames; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int begun_ = 0;
  int allowed_ = 0;
};

}  // namespace hmcdyn::slam::test
