// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/detection_thread.hpp"

#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "detect/scripted_detector.hpp"

namespace hmcdyn::slam {
namespace {

using test::Gate;
using test::ScriptedDetector;

DetectionRequest requestOf(std::size_t frame) {
  return {frame, static_cast<double>(frame), cv::Mat(4, 4, CV_8UC3, cv::Scalar(0, 0, 0))};
}

void expectFound(const Detection& detection, std::size_t frame) {
  EXPECT_EQ(detection.frame, frame);
  EXPECT_EQ(detection.timestamp, static_cast<double>(frame));
  EXPECT_FALSE(detection.failed);
  ASSERT_EQ(detection.boxes.size(), 1u);
  EXPECT_EQ(detection.boxes[0].x_min, static_cast<float>(frame));
}

class Detecting : public testing::Test {
 protected:
  /// Finds one box, at the time stamp; before that it does what the test wants.
  static std::unique_ptr<ObjectDetector> fake(std::function<void(double)> before) {
    return std::make_unique<ScriptedDetector>(
        [before = std::move(before)](const cv::Mat& /*bgr*/, double timestamp) {
          before(timestamp);
          DetectionBox box;
          box.x_min = static_cast<float>(timestamp);
          return std::vector<DetectionBox>{box};
        });
  }
  Report report() {
    return [this](const std::string& line) { reports_.push_back(line); };
  }

  Gate gate_;
  std::vector<std::string> reports_;
};

TEST_F(Detecting, OfflineEveryFrameGetsItsOwnWhileOthersWait) {
  DetectionThread thread(fake([](double) {}), report(), 2);
  std::size_t taken = 0;
  for (std::size_t frame = 0; frame < 20; ++frame) {
    thread.request(requestOf(frame));
    if (frame >= 1) {  // one ahead
      expectFound(thread.take(), taken++);
    }
  }
  expectFound(thread.take(), taken);
  EXPECT_EQ(thread.pending(), 0u);
  EXPECT_EQ(thread.counts().requested, 20u);
  EXPECT_EQ(thread.counts().detected, 20u);
  EXPECT_EQ(thread.counts().replaced, 0u);
  EXPECT_EQ(thread.detectorName(), "scripted");
}

TEST_F(Detecting, RunsTheDetectorOnOneOtherThread) {
  std::set<std::thread::id> threads;
  {
    DetectionThread thread(fake([&](double) { threads.insert(std::this_thread::get_id()); }),
                           report());
    for (std::size_t frame = 0; frame < 3; ++frame) {
      thread.request(requestOf(frame));
      thread.take();
    }
  }
  EXPECT_EQ(threads.size(), 1u);
  EXPECT_EQ(threads.count(std::this_thread::get_id()), 0u);
}

TEST_F(Detecting, InRealTimeTheNewestFrameWinsAndNobodyWaits) {
  DetectionThread thread(fake([this](double) { gate_.pass(); }), report());
  thread.requestNewest(requestOf(0));
  gate_.awaitBegun(1);
  for (std::size_t frame = 1; frame <= 4; ++frame) {  // while the detector is busy with frame 0
    thread.requestNewest(requestOf(frame));
    EXPECT_FALSE(thread.tryTakeNewest().has_value());
  }
  EXPECT_EQ(thread.counts().replaced, 3u);  // 1, 2 and 3
  EXPECT_EQ(thread.pending(), 2u);
  gate_.allow(1);
  gate_.awaitBegun(2);  // frame 0 is done when the next begins
  expectFound(thread.tryTakeNewest().value(), 0);
  gate_.allow(1);
  expectFound(thread.take(), 4);
  EXPECT_EQ(thread.counts().requested, 5u);
  EXPECT_EQ(thread.counts().detected, 2u);
}

TEST_F(Detecting, OfSeveralThatCameOnlyTheNewestIsGiven) {
  DetectionThread thread(fake([this](double) { gate_.pass(); }), report(), 3);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    thread.requestNewest(requestOf(frame));
  }
  gate_.allow(2);
  gate_.awaitBegun(3);
  expectFound(thread.tryTakeNewest().value(), 1);
  EXPECT_FALSE(thread.tryTakeNewest().has_value());
  EXPECT_EQ(thread.counts().detected, 2u);
  gate_.allow(1);
}

TEST_F(Detecting, ADetectorThatThrowsIsReportedOnceCountedAndGoesOn) {
  DetectionThread thread(fake([](double timestamp) {
                           if (timestamp == 1.0 || timestamp == 2.0) {
                             throw std::runtime_error("layer 7 is sick");
                           }
                         }),
                         report(), 4);
  for (std::size_t frame = 0; frame < 4; ++frame) {
    thread.request(requestOf(frame));
  }
  expectFound(thread.take(), 0);
  for (std::size_t frame = 1; frame <= 2; ++frame) {
    const Detection failed = thread.take();
    EXPECT_EQ(failed.frame, frame);
    EXPECT_TRUE(failed.failed);
    EXPECT_TRUE(failed.boxes.empty());
  }
  expectFound(thread.take(), 3);
  EXPECT_EQ(thread.counts().failed, 2u);
  EXPECT_EQ(thread.counts().detected, 2u);
  EXPECT_EQ(thread.counts().first_failure, "at frame 1: layer 7 is sick");
  EXPECT_EQ(thread.counts().last_failure, "at frame 2: layer 7 is sick");
  ASSERT_EQ(reports_.size(), 1u);
  EXPECT_NE(reports_[0].find("frame 1"), std::string::npos) << reports_[0];
  EXPECT_NE(reports_[0].find("layer 7 is sick"), std::string::npos) << reports_[0];
}

TEST_F(Detecting, InRealTimeAFailureIsNoDetection) {
  DetectionThread thread(fake([this](double timestamp) {
                           gate_.pass();
                           if (timestamp == 1.0) {
                             throw std::runtime_error("sick");
                           }
                         }),
                         report(), 3);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    thread.requestNewest(requestOf(frame));
  }
  gate_.allow(2);
  gate_.awaitBegun(3);
  expectFound(thread.tryTakeNewest().value(), 0);  // frame 1 is newer, and failed
  EXPECT_EQ(thread.counts().failed, 1u);
  gate_.allow(1);
}

TEST_F(Detecting, RefusesWhatCannotBe) {
  EXPECT_THROW(DetectionThread(nullptr, report()), std::invalid_argument);
  EXPECT_THROW(DetectionThread(fake([](double) {}), report(), 0), std::invalid_argument);
  DetectionThread idle(fake([](double) {}), report());
  EXPECT_THROW(idle.take(), std::logic_error);
  EXPECT_FALSE(idle.tryTakeNewest().has_value());
}

}  // namespace
}  // namespace hmcdyn::slam
