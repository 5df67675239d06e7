// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detection/detection_thread.hpp"

#include <atomic>
#include <future>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

/// What a test and its detector share. The detector waits at the gate where there is one.
struct Script {
  std::set<int> failures;  ///< Calls that throw, from 0.
  std::atomic<int> calls{0};
  std::atomic<bool> gated{false};
  std::promise<void> began;  ///< Set by the first call where gated.
  std::promise<void> open;   ///< Set by the test.
};

/// One box, its left border the image's time stamp.
class ScriptedDetector final : public ObjectDetector {
 public:
  explicit ScriptedDetector(Script& script) : script_(script) {}
  std::vector<DetectionBox> detect(const cv::Mat& /*bgr*/, double timestamp) override {
    const int call = script_.calls++;
    if (script_.gated && call == 0) {
      script_.began.set_value();
      script_.open.get_future().wait();
    }
    if (script_.failures.count(call) != 0) {
      throw std::runtime_error("out of memory");
    }
    DetectionBox box;
    box.x_min = static_cast<float>(timestamp);
    return {box};
  }
  std::string name() const override { return "scripted"; }

 private:
  Script& script_;
};

class Detections : public testing::Test {
 protected:
  DetectionThread start(std::size_t lookahead = 1) {
    return {std::make_unique<ScriptedDetector>(script_),
            [this](const std::string& line) { reports_.push_back(line); }, lookahead};
  }
  /// Frame i at i + 100 s.
  static DetectionRequest frame(std::size_t i) {
    return {i, 100.0 + static_cast<double>(i), cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(0))};
  }

  Script script_;
  std::vector<std::string> reports_;
};

TEST_F(Detections, OfflineEachFrameGetsItsOwnInOrder) {
  DetectionThread thread = start(2);
  thread.request(frame(0));
  for (std::size_t i = 0; i < 50; ++i) {
    thread.request(frame(i + 1));
    const Detection detection = thread.take();
    EXPECT_EQ(detection.frame, i);
    ASSERT_EQ(detection.boxes.size(), 1U);
    EXPECT_FLOAT_EQ(detection.boxes[0].x_min, 100.0f + static_cast<float>(i));
  }
  EXPECT_EQ(thread.pending(), 1U);
  EXPECT_EQ(thread.take().frame, 50U);
  EXPECT_EQ(thread.counts().requested, 51U);
  EXPECT_EQ(thread.counts().detected, 51U);
  EXPECT_EQ(thread.counts().replaced, 0U);
  EXPECT_THROW(thread.take(), std::logic_error);
}

TEST_F(Detections, ADetectorThatThrowsInTheMiddleIsCountedAndReportedOnce) {
  script_.failures = {1, 3};
  DetectionThread thread = start();
  std::vector<bool> failed;
  for (std::size_t i = 0; i < 5; ++i) {
    thread.request(frame(i));
    const Detection detection = thread.take();
    EXPECT_EQ(detection.boxes.size(), detection.failed ? 0U : 1U);
    failed.push_back(detection.failed);
  }
  EXPECT_EQ(failed, (std::vector<bool>{false, true, false, true, false}));
  EXPECT_EQ(thread.counts().failed, 2U);
  EXPECT_EQ(thread.counts().detected, 3U);
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"scripted", "frame 1", "out of memory"}));
}

TEST_F(Detections, InRealTimeASlowDetectorSeesTheNewestFrame) {
  script_.gated = true;
  DetectionThread thread = start();
  thread.requestNewest(frame(0));
  script_.began.get_future().wait();
  EXPECT_FALSE(thread.tryTakeNewest().has_value());  // nobody waits for the detector
  for (std::size_t i = 1; i <= 4; ++i) {
    thread.requestNewest(frame(i));
  }
  script_.open.set_value();
  EXPECT_EQ(thread.take().frame, 0U);
  EXPECT_EQ(thread.take().frame, 4U);
  EXPECT_EQ(script_.calls, 2);
  EXPECT_EQ(thread.counts().requested, 5U);
  EXPECT_EQ(thread.counts().replaced, 3U);
  EXPECT_EQ(thread.counts().detected, 2U);
}

/// Takes until the detector has answered everything; yields meanwhile.
std::optional<Detection> newestOf(DetectionThread& thread) {
  std::optional<Detection> newest;
  while (thread.pending() > 0) {
    if (std::optional<Detection> detection = thread.tryTakeNewest()) {
      newest = std::move(detection);
    }
    std::this_thread::yield();
  }
  return newest;
}

TEST_F(Detections, TheNewestIsTakenAndAFailedOneIsNone) {
  script_.failures = {2};
  DetectionThread thread = start(3);
  for (std::size_t i = 0; i < 3; ++i) {
    thread.request(frame(i));
  }
  const std::optional<Detection> newest = newestOf(thread);
  ASSERT_TRUE(newest.has_value());
  EXPECT_EQ(newest->frame, 1U);
  EXPECT_EQ(thread.counts().failed, 1U);
  EXPECT_EQ(thread.counts().detected, 2U);
  EXPECT_FALSE(thread.tryTakeNewest().has_value());
}

TEST_F(Detections, EndsWhileTheDetectorIsAtWorkAndRequestsWait) {
  script_.gated = true;
  {
    DetectionThread thread = start(2);
    thread.request(frame(0));
    script_.began.get_future().wait();
    thread.request(frame(1));
    script_.open.set_value();
  }
  EXPECT_GE(script_.calls, 1);
}

TEST_F(Detections, RefusesANullDetectorAndNoRoom) {
  EXPECT_THROW(DetectionThread(nullptr, [](const std::string&) {}), std::invalid_argument);
  EXPECT_THROW(start(0), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam
