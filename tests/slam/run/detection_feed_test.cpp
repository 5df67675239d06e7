// SPDX-License-Identifier: BSD-3-Clause
// Drawn images: a textured thing moves before a textured wall by known steps; detectors say what
// the test wants.
#include "slam/run/detection_feed.hpp"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "detect/scripted_detector.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"

namespace hmcdyn::slam {
namespace {

using test::Gate;
using test::ScriptedDetector;

constexpr int kWidth = 320;
constexpr int kHeight = 240;

DetectionBox boxAt(int left) {
  const auto x = static_cast<float>(left);
  return {x, 60.0f, x + 79.0f, 179.0f, kPersonClassId, 0.8f};
}

class Feed : public testing::Test {
 protected:
  Feed() {
    calibration_.pinhole = {300.0, 300.0, 159.5, 119.5};
    calibration_.width = kWidth;
    calibration_.height = kHeight;
  }

  /// 20 frames a second; the thing is 80 x 120 px at 1.5 m and moves by 5 px a frame.
  PreparedFrame frameAt(std::size_t index) const {
    RgbdFrame frame;
    frame.index = index;
    frame.timestamp = timeOf(index);
    frame.gray = wall_.clone();
    frame.depth = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(4.0));
    const cv::Rect thing(leftAt(index), 60, 80, 120);
    thing_.copyTo(frame.gray(thing));
    frame.depth(thing).setTo(1.5);
    cv::cvtColor(frame.gray, frame.bgr, cv::COLOR_GRAY2BGR);
    return {frame, rectify(frame, rectifier()), {}};
  }
  static double timeOf(std::size_t index) { return 10.0 + 0.05 * static_cast<double>(index); }
  static int leftAt(std::size_t index) { return 40 + 5 * static_cast<int>(index); }
  static std::size_t indexOf(double timestamp) {
    return static_cast<std::size_t>(std::lround((timestamp - 10.0) / 0.05));
  }
  static std::vector<DetectionBox> truth(double timestamp) {
    return {boxAt(leftAt(indexOf(timestamp)))};
  }

  Rectifier rectifier() const { return Rectifier(calibration_); }
  DetectionFeed feed(const SlamOptions& options, ScriptedDetector::Script script) {
    return {options, rectifier(), [this](const std::string& line) { reports_.push_back(line); },
            std::make_unique<ScriptedDetector>(std::move(script))};
  }
  static SlamOptions realtime() {
    SlamOptions options;
    options.mode = RunMode::kRealtime;
    return options;
  }
  /// Offline, as a run goes: the frame after is asked for before the boxes are taken.
  std::vector<FrameBoxes> takeAll(DetectionFeed& feed, std::size_t frames) const {
    std::vector<FrameBoxes> taken;
    feed.ask(frameAt(0));
    for (std::size_t k = 0; k < frames; ++k) {
      if (k + 1 < frames) {
        feed.ask(frameAt(k + 1));
      }
      taken.push_back(feed.boxesOf(frameAt(k)));
    }
    return taken;
  }
  static void expectBoxAt(const FrameBoxes& taken, int left, float tolerance) {
    ASSERT_EQ(taken.boxes.size(), 1U);
    EXPECT_NEAR(taken.boxes[0].x_min, static_cast<float>(left), tolerance);
    EXPECT_NEAR(taken.boxes[0].y_max, 179.0f, tolerance);
  }

  CameraCalibration calibration_;
  cv::Mat wall_ = test::makeTexture({kWidth, kHeight}, 3);
  cv::Mat thing_ = test::makeTexture({80, 120}, 4);
  std::vector<std::string> reports_;
};

constexpr float kFlow = 2.0f;  // px

TEST_F(Feed, OfflineEachFrameHasTheBoxesOfItsOwnImage) {
  DetectionFeed detections = feed({}, [](const cv::Mat&, double time) { return truth(time); });
  const std::vector<FrameBoxes> taken = takeAll(detections, 6);
  for (std::size_t k = 0; k < taken.size(); ++k) {
    expectBoxAt(taken[k], leftAt(k), 0.0f);
    EXPECT_TRUE(taken[k].detected) << k;
    EXPECT_EQ(taken[k].bridged, 0U) << k;
  }
  EXPECT_EQ(detections.counts().detected, 6U);
  EXPECT_EQ(detections.detectorName(), "scripted");
}

TEST_F(Feed, OfflineAMissedBoxIsCarriedOnAndThenEnds) {
  SlamOptions options;
  options.bridge = 0.2;  // s: four frames
  DetectionFeed detections = feed(options, [](const cv::Mat&, double time) {
    return indexOf(time) < 3 ? truth(time) : std::vector<DetectionBox>{};
  });
  const std::vector<FrameBoxes> taken = takeAll(detections, 10);
  for (std::size_t k = 3; k < 7; ++k) {
    expectBoxAt(taken[k], leftAt(k), kFlow);
    EXPECT_EQ(taken[k].bridged, 1U) << k;
    EXPECT_TRUE(taken[k].detected) << "the detector did look at frame " << k;
  }
  EXPECT_TRUE(taken[7].boxes.empty());
}

TEST_F(Feed, OfflineWithoutBridgingAMissedBoxIsGone) {
  SlamOptions options;
  options.bridge = 0.0;
  DetectionFeed detections = feed(options, [](const cv::Mat&, double time) {
    return indexOf(time) < 3 ? truth(time) : std::vector<DetectionBox>{};
  });
  const std::vector<FrameBoxes> taken = takeAll(detections, 5);
  EXPECT_EQ(taken[2].boxes.size(), 1U);
  EXPECT_TRUE(taken[3].boxes.empty());
}

TEST_F(Feed, OfflineAFrameAtWhichTheDetectorThrowsHasTheBoxesCarriedToIt) {
  DetectionFeed detections = feed({}, [](const cv::Mat&, double time) {
    if (indexOf(time) == 3) {
      throw std::runtime_error("out of memory");
    }
    if (indexOf(time) == 4) {
      throw 4;  // not every library throws exceptions of the standard's
    }
    return truth(time);
  });
  const std::vector<FrameBoxes> taken = takeAll(detections, 6);
  for (const std::size_t k : {3U, 4U}) {
    EXPECT_FALSE(taken[k].detected) << k;
    expectBoxAt(taken[k], leftAt(k), kFlow);
  }
  EXPECT_TRUE(taken[5].detected);
  expectBoxAt(taken[5], leftAt(5), 0.0f);
  EXPECT_EQ(detections.counts().failed, 2U);
  EXPECT_EQ(detections.counts().detected, 4U);
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"scripted", "frame 3", "out of memory"}));
}

TEST_F(Feed, OfflineBoxesThatNobodyAskedForAreTheCallersMistake) {
  DetectionFeed detections = feed({}, [](const cv::Mat&, double time) { return truth(time); });
  EXPECT_THROW(detections.boxesOf(frameAt(0)), std::logic_error);
}

TEST_F(Feed, InRealTimeABusyDetectorIsNotWaitedForAndItsLateAnswerIsCarriedToThePresent) {
  Gate gate;
  DetectionFeed detections = feed(realtime(), [&](const cv::Mat&, double time) {
    gate.pass();
    return truth(time);
  });
  // Given a detector that is still at frame 0
  detections.ask(frameAt(0));
  EXPECT_TRUE(detections.boxesOf(frameAt(0)).boxes.empty());
  gate.awaitBegun(1);
  // When frames 1 and 2 come, then they have no boxes, and frame 1 is given up for frame 2.
  for (const std::size_t k : {1U, 2U}) {
    detections.ask(frameAt(k));
    const FrameBoxes taken = detections.boxesOf(frameAt(k));
    EXPECT_TRUE(taken.boxes.empty());
    EXPECT_FALSE(taken.detected);
  }
  EXPECT_EQ(detections.counts().replaced, 1U);
  // When it is done with frame 0 and at work on frame 2
  gate.allow(1);
  gate.awaitBegun(2);
  // Then frame 3 has the box of frame 0, moved along with the thing.
  const FrameBoxes late = detections.boxesOf(frameAt(3));
  EXPECT_FALSE(late.detected);
  expectBoxAt(late, leftAt(3), kFlow);
  gate.allow(1);
}

TEST_F(Feed, InRealTimeADetectorThatThrowsLeavesTheBoxesThatWereThere) {
  Gate gate;
  DetectionFeed detections = feed(realtime(), [&](const cv::Mat&, double time) {
    gate.pass();
    if (indexOf(time) > 0) {
      throw std::runtime_error("the network is gone");
    }
    return truth(time);
  });
  gate.allow(2);
  for (const std::size_t k : {0U, 1U, 2U}) {  // each begins when the one before is done
    detections.ask(frameAt(k));
    gate.awaitBegun(static_cast<int>(k) + 1);
  }
  detections.boxesOf(frameAt(0));
  expectBoxAt(detections.boxesOf(frameAt(1)), leftAt(1), kFlow);
  expectBoxAt(detections.boxesOf(frameAt(2)), leftAt(2), kFlow);
  EXPECT_EQ(detections.counts().failed, 1U);
  EXPECT_EQ(reports_.size(), 1U);
  gate.allow(1);
}

TEST_F(Feed, ADetectorSeesTheUndistortedImageAndABoxFileTheRawOne) {
  calibration_.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0};
  const PreparedFrame frame = frameAt(0);
  ASSERT_GT(cv::norm(frame.raw.bgr, frame.image.bgr, cv::NORM_INF), 0.0);
  double difference = -1.0;
  DetectionFeed own = feed({}, [&](const cv::Mat& bgr, double time) {
    difference = cv::norm(bgr, frame.image.bgr, cv::NORM_INF);
    return truth(time);
  });
  own.ask(frame);
  expectBoxAt(own.boxesOf(frame), leftAt(0), 0.0f);
  EXPECT_EQ(difference, 0.0);

  const hmcdyn::test::TemporaryFolder folder;
  SlamOptions options;
  options.detector.type = "file";
  options.detector.boxes = folder.write("boxes.txt", "10.0 person 40 60 119 179 0.8\n");
  DetectionFeed file(options, rectifier(), [](const std::string&) {});
  file.ask(frame);
  const FrameBoxes taken = file.boxesOf(frame);
  const DetectionBox expected = rectifier().box(boxAt(40));
  ASSERT_EQ(taken.boxes.size(), 1U);
  EXPECT_FLOAT_EQ(taken.boxes[0].x_min, expected.x_min);
  EXPECT_FLOAT_EQ(taken.boxes[0].y_max, expected.y_max);
  EXPECT_GT(std::abs(expected.x_min - 40.0f), 1.0f) << "the distortion is to be seen";
}

TEST_F(Feed, ADetectorThatIsNotKnownIsRefused) {
  SlamOptions options;
  options.detector.type = "oracle";
  EXPECT_THROW(DetectionFeed(options, rectifier(), [](const std::string&) {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam
