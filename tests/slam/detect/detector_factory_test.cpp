// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/detector_factory.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/frame.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;

std::string refusal(const DetectorOptions& options) {
  return messageOf<std::invalid_argument>([&] { makeDetector(options); });
}

DetectorOptions ofType(const std::string& type) {
  DetectorOptions options;
  options.type = type;
  return options;
}

cv::Mat noise(int rows, int columns) {
  cv::Mat image(rows, columns, CV_8UC3);
  cv::RNG random(11);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(DetectorFactory, AnUnknownTypeListsTheTypes) {
  EXPECT_TRUE(mentions(refusal(ofType("yolov9")),
                       {"'yolov9'", "darknet, yolo, file, command, hog, masks, none"}));
}

TEST(DetectorFactory, TheFormerTypeMotionNamesWhatTookItsPlace) {
  EXPECT_TRUE(mentions(refusal(ofType("motion")), {"'motion'", "--detector none --filter robust"}));
}

TEST(DetectorFactory, AFileDetectorNeedsItsFile) {
  EXPECT_TRUE(mentions(refusal(ofType("file")), {"file", "--boxes is not given"}));
}

TEST(DetectorFactory, MasksNeedTheirFolderAndTheirType) {
  EXPECT_TRUE(mentions(refusal(ofType("masks")), {"masks", "--masks is not given"}));
  DetectorOptions options = ofType("none");
  options.masks = "mask";
  EXPECT_TRUE(mentions(refusal(options), {"--masks is given", "'none'", "--detector masks"}));
  options = ofType("none");
  options.mask_margin = -1;
  EXPECT_TRUE(mentions(refusal(options), {"mask_margin is -1 px"}));
}

TEST(DetectorFactory, ValuesOutOfRangeAreNamed) {
  DetectorOptions options = ofType("none");
  options.score_threshold = 1.5f;
  EXPECT_TRUE(mentions(refusal(options), {"score_threshold is 1.5", "0..1"}));
  options = ofType("none");
  options.nms_threshold = kNaN;
  EXPECT_TRUE(mentions(refusal(options), {"nms_threshold is nan"}));
  options = ofType("none");
  options.input_size = 100;
  EXPECT_TRUE(mentions(refusal(options), {"input_size is 100", "multiple of 32"}));
  options = ofType("none");
  options.classes = {0, 80};
  EXPECT_TRUE(mentions(refusal(options), {"classes has 80", "0..79"}));
  options = ofType("none");
  options.time_tolerance = -0.5;
  EXPECT_TRUE(mentions(refusal(options), {"time_tolerance is -0.5"}));
}

TEST(NoDetector, FindsNothing) {
  const auto detector = makeDetector(ofType("none"));
  EXPECT_TRUE(detector->detect(noise(480, 640), 0.0).empty());
  EXPECT_EQ(detector->name(), "none");
  EXPECT_THROW(detector->detect(cv::Mat(), 0.0), std::invalid_argument);
}

TEST(HogDetector, FindsNobodyInAnEmptyOrTinyImage) {
  const auto detector = makeDetector(ofType("hog"));
  EXPECT_TRUE(detector->detect(cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 90, 90)), 0.0).empty());
  EXPECT_TRUE(detector->detect(noise(127, 64), 0.0).empty());
  EXPECT_TRUE(detector->detect(noise(128, 63), 0.0).empty());
  EXPECT_TRUE(detector->detect(noise(1, 3), 0.0).empty());
  EXPECT_EQ(detector->name(), "hog");
  EXPECT_THROW(detector->detect(cv::Mat(480, 640, CV_8UC1), 0.0), std::invalid_argument);
}

TEST(HogDetector, FindsTheManWhoStandsUprightAndTheSameTwice) {
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50");
  constexpr std::size_t kUpright = 32;  // seen from head to thigh, at the columns 145..275
  const FrameEntry entry =
      listFrames(test::sharedPath("data/fr3_walking_halfsphere_first50")).at(kUpright);
  const cv::Mat image = loadFrame(entry, loadCamera("tum3")).bgr;
  const auto detector = makeDetector(ofType("hog"));

  const std::vector<DetectionBox> people = detector->detect(image, 0.0);

  ASSERT_FALSE(people.empty());
  EXPECT_EQ(people[0].class_id, kPersonClassId);
  EXPECT_TRUE(people[0].contains(240.0f, 180.0f)) << "his head";
  EXPECT_TRUE(people[0].contains(200.0f, 300.0f)) << "his arm";
  EXPECT_FALSE(people[0].contains(400.0f, 200.0f)) << "the other man's head";
  for (int repetition = 0; repetition < 3; ++repetition) {
    const std::vector<DetectionBox> again = detector->detect(image, 0.0);
    ASSERT_EQ(again.size(), people.size());
    for (std::size_t i = 0; i < people.size(); ++i) {
      EXPECT_EQ(again[i].x_min, people[i].x_min);
      EXPECT_EQ(again[i].score, people[i].score);
    }
  }
}

}  // namespace
}  // namespace hmcdyn::slam
