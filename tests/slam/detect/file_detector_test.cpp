// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/file_detector.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "slam/detect/detector_factory.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

class BoxFile : public testing::Test {
 protected:
  std::vector<TimedBox> read(const std::string& text) const {
    return readBoxFile(folder.write("boxes.txt", text));
  }
  std::string readError(const std::string& text) const {
    return messageOf<std::runtime_error>([&] { read(text); });
  }
  std::unique_ptr<ObjectDetector> detector(const std::string& text, DetectorOptions options = {}) {
    options.type = "file";
    options.boxes = folder.write("boxes.txt", text);
    return makeDetector(options);
  }

  TemporaryFolder folder;
  cv::Mat image{480, 640, CV_8UC3, cv::Scalar(0)};
};

TEST_F(BoxFile, ClassesAreNumbersOrNames) {
  const std::vector<TimedBox> boxes = read(
      "# timestamp class x_min y_min x_max y_max score\n"
      "2.5 56 1 2 3 4 0.5\n"
      "\n"
      "1.5 person 10.5 20 30 40 1\r\n"
      "1.5 traffic light 1 2 3 4 0.25\n"
      "1.5 cell_phone 1 2 3 4 0\n");
  ASSERT_EQ(boxes.size(), 4U);  // by time, those of one time as in the file
  EXPECT_EQ(boxes[0].timestamp, 1.5);
  EXPECT_EQ(boxes[0].box.class_id, 0);
  EXPECT_EQ(boxes[0].box.x_min, 10.5f);
  EXPECT_EQ(boxes[0].box.y_min, 20.0f);
  EXPECT_EQ(boxes[0].box.x_max, 30.0f);
  EXPECT_EQ(boxes[0].box.y_max, 40.0f);
  EXPECT_EQ(boxes[0].box.score, 1.0f);
  EXPECT_EQ(boxes[1].box.class_id, 9);
  EXPECT_EQ(boxes[2].box.class_id, 67);
  EXPECT_EQ(boxes[3].box.class_id, 56);
  EXPECT_EQ(boxes[3].timestamp, 2.5);
}

TEST_F(BoxFile, AnInvertedBoxIsKeptAsItIs) {
  const std::vector<TimedBox> boxes = read("1.0 person 30 40 10 20 1\n");
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].box.x_min, 30.0f);
  EXPECT_EQ(boxes[0].box.x_max, 10.0f);
  EXPECT_FALSE(boxes[0].box.contains(20.0f, 30.0f));
}

TEST_F(BoxFile, NoBoxIsFine) {
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read("# nobody there\n").empty());
  EXPECT_TRUE(detector("")->detect(image, 1.0).empty());
}

TEST_F(BoxFile, AMalformedLineIsNamedWithItsNumber) {
  EXPECT_TRUE(mentions(readError("# boxes\n1.0 person 1 2 3 4\n"), {"boxes.txt:2:", "6 fields"}));
  EXPECT_TRUE(mentions(readError("1.0 person 1 2 3 4 0.5 extra\n"), {"boxes.txt:1:", "8 fields"}));
  EXPECT_TRUE(mentions(readError("now person 1 2 3 4 1\n"), {"boxes.txt:1: timestamp is 'now'"}));
  EXPECT_TRUE(mentions(readError("1.0 robot 1 2 3 4 1\n"), {"boxes.txt:1: class is 'robot'"}));
  EXPECT_TRUE(mentions(readError("1.0 80 1 2 3 4 1\n"), {"boxes.txt:1: class is '80'", "0..79"}));
  EXPECT_TRUE(mentions(readError("1.0 -1 1 2 3 4 1\n"), {"boxes.txt:1: class is '-1'"}));
  EXPECT_TRUE(mentions(readError("1.0 0 1 2 3 nan 1\n"), {"boxes.txt:1: y_max is 'nan'"}));
  EXPECT_TRUE(mentions(readError("1.0 0 inf 2 3 4 1\n"), {"boxes.txt:1: x_min is 'inf'"}));
  EXPECT_TRUE(mentions(readError("1.0 0 1 2 3 4 87\n"), {"boxes.txt:1: score is 87", "0..1"}));
  EXPECT_TRUE(mentions(readError("nan 0 1 2 3 4 1\n"), {"boxes.txt:1: timestamp is 'nan'"}));
}

TEST_F(BoxFile, AMissingFileIsNamed) {
  const std::filesystem::path file = folder.path() / "none.txt";
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { readBoxFile(file); }),
                       {file.string(), "no such file"}));
}

TEST_F(BoxFile, TheNearestTimeStampWithinTheToleranceCounts) {
  const auto boxes = detector(
      "1.000 person 1 1 2 2 0.9\n"
      "1.000 person 3 3 4 4 1.0\n"
      "1.030 person 5 5 6 6 0.8\n");
  ASSERT_EQ(boxes->detect(image, 1.0).size(), 2U);
  EXPECT_EQ(boxes->detect(image, 1.0)[0].x_min, 3.0f);  // strongest first
  EXPECT_EQ(boxes->detect(image, 0.981).size(), 2U);
  EXPECT_EQ(boxes->detect(image, 0.979).size(), 0U);
  EXPECT_EQ(boxes->detect(image, 1.014).size(), 2U);
  EXPECT_EQ(boxes->detect(image, 1.016).size(), 1U);
  EXPECT_EQ(boxes->detect(image, 1.049).size(), 1U);
  EXPECT_EQ(boxes->detect(image, 1.051).size(), 0U);
  EXPECT_EQ(boxes->name(), "file boxes.txt");
}

TEST_F(BoxFile, ThresholdClassesAndImageApply) {
  DetectorOptions options;
  options.score_threshold = 0.5f;
  options.classes = {0};
  const auto boxes = detector(
      "1 person -10 -10 20 900 0.5\n"
      "1 person 0 0 9 9 0.49\n"
      "1 chair 0 0 9 9 0.9\n"
      "1 person 700 0 800 9 0.9\n"
      "1 person 30 0 20 9 0.9\n",
      options);
  const std::vector<DetectionBox> found = boxes->detect(image, 1.0);
  ASSERT_EQ(found.size(), 1U);  // the last one is inverted
  EXPECT_EQ(found[0].x_min, 0.0f);
  EXPECT_EQ(found[0].y_max, 479.0f);
}

}  // namespace
}  // namespace hmcdyn::slam
