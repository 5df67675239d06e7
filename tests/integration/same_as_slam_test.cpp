// SPDX-License-Identifier: BSD-3-Clause
// The adapter filters as the SLAM example does, given the same points and boxes.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "filmed_scene.hpp"
#include "integration/frame_filter.hpp"
#include "shared_data.hpp"
#include "slam/camera/calibration.hpp"
#include "slam/dataset/frame.hpp"
#include "slam/detection/detector_factory.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/filtering/motion_filter.hpp"

namespace hmcdyn::integration {
namespace {

constexpr const char* kClip = "data/fr3_walking_halfsphere_first50";
constexpr const char* kModel = "models/yolo-fastest-1.1/yolo-fastest-1.1.cfg";
constexpr const char* kWeights = "models/yolo-fastest-1.1/yolo-fastest-1.1.weights";

/// What both made of the same frames.
struct Tally {
  std::size_t frames = 0;
  std::size_t dynamic = 0;  ///< Points that the SLAM example's filter calls dynamic.
  std::size_t weighed = 0;  ///< Frames with eq. 7's weights.
};

/// Runs one frame through both, and expects one result.
void compare(const cv::Mat& gray, const cv::Mat& depth, const std::vector<DetectionBox>& boxes,
             slam::Frame& frame, slam::MotionFilter& slam_filter, FrameFilter& adapter,
             Tally& tally) {
  FrameInput input;
  input.timestamp = frame.timestamp;
  input.gray = gray;
  input.depth = depth;
  input.key_points = frame.features.key_points;
  input.point_depth = frame.points.depth;
  const FrameFilterResult result = adapter.filter(input, boxes);
  const DynamicFeatureFilterResult expected = slam_filter.filter(gray, depth, boxes, frame);

  EXPECT_EQ(result.details.stage.label, frame.label) << "frame " << frame.index;
  EXPECT_EQ(result.weight, frame.weight) << "frame " << frame.index;
  EXPECT_EQ(result.soft_weights, frame.soft_weights) << "frame " << frame.index;
  ASSERT_EQ(result.keep.size(), frame.label.size());
  for (std::size_t i = 0; i < frame.label.size(); ++i) {
    if (frame.label[i] == PointLabel::kDynamic) {
      EXPECT_EQ(result.keep[i], 0) << "frame " << frame.index << ", point " << i;
    }
  }
  ++tally.frames;
  tally.dynamic += expected.stage.frame.dynamic;
  tally.weighed += frame.soft_weights ? 1 : 0;
}

TEST(SameAsSlam, OnADrawnScene) {
  const test::FilmedScene film;
  slam::MotionFilter slam_filter{slam::MotionFilterOptions{}};
  FrameFilter adapter;
  Tally tally;
  for (int f = 0; f < test::FilmedScene::kFrames; ++f) {
    const FrameInput input = film.input(f);
    slam::Features features;
    features.key_points = film.key_points;
    slam::Frame frame =
        slam::makeFrame(static_cast<std::size_t>(f), input.timestamp, features, input.depth, 1.2f);
    compare(input.gray, input.depth, film.boxes, frame, slam_filter, adapter, tally);
  }
  EXPECT_GT(tally.dynamic, 100U);
}

TEST(SameAsSlam, OnTheRealClip) {
  HMCDYN_SKIP_WITHOUT_SHARED(kClip);
  HMCDYN_SKIP_WITHOUT_SHARED(kWeights);
  // Given real frames, ORB key points and the boxes of a detector
  slam::DetectorOptions detection;
  detection.type = "darknet";
  detection.model = hmcdyn::test::sharedPath(kModel);
  detection.weights = hmcdyn::test::sharedPath(kWeights);
  detection.classes = {kPersonClassId};
  const std::unique_ptr<slam::ObjectDetector> detector = slam::makeDetector(detection);
  const slam::CameraCalibration calibration = slam::loadCamera("tum3");
  slam::OrbExtractor extractor;
  slam::MotionFilter slam_filter{slam::MotionFilterOptions{}};
  FrameFilter adapter;
  Tally tally;
  // When, then
  for (const slam::FrameEntry& entry : slam::listFrames(hmcdyn::test::sharedPath(kClip))) {
    const slam::RgbdFrame image = slam::loadFrame(entry, calibration);
    slam::Frame frame = slam::makeFrame(image.index, image.timestamp, extractor.extract(image.gray),
                                        image.depth, extractor.options().scale_factor);
    compare(image.gray, image.depth, detector->detect(image.bgr, image.timestamp), frame,
            slam_filter, adapter, tally);
  }
  EXPECT_EQ(tally.frames, 49U);
  EXPECT_GT(tally.dynamic, 4900U);  // 100 a frame: two men among 1000 points
}

}  // namespace
}  // namespace hmcdyn::integration
