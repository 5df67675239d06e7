// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core/version.hpp>

#include "detect/tiny_models.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"
#include "slam/detect/detector_factory.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/frame.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

const cv::Scalar kRed(0, 0, 255);
const cv::Scalar kGreen(0, 255, 0);
const cv::Scalar kBlue(255, 0, 0);

cv::Mat imageOf(const cv::Scalar& color) { return {480, 640, CV_8UC3, color}; }

void expectBox(const DetectionBox& box, const DetectionBox& expected, float score_tolerance) {
  EXPECT_NEAR(box.x_min, expected.x_min, 0.01);
  EXPECT_NEAR(box.y_min, expected.y_min, 0.01);
  EXPECT_NEAR(box.x_max, expected.x_max, 0.01);
  EXPECT_NEAR(box.y_max, expected.y_max, 0.01);
  EXPECT_EQ(box.class_id, expected.class_id);
  EXPECT_NEAR(box.score, expected.score, score_tolerance);
}

std::string makeError(const DetectorOptions& options) {
  return messageOf<std::runtime_error>([&] { makeDetector(options); });
}

class TinyDarknet : public testing::Test {
 protected:
  TinyDarknet() {
    options.type = "darknet";
    options.model = folder.write("tiny.cfg", test::tinyDarknetCfg());
    options.weights = folder.write("tiny.weights", test::tinyDarknetWeights(0.8));
  }

  TemporaryFolder folder;
  DetectorOptions options;
};

TEST_F(TinyDarknet, FindsWhatItsWeightsSay) {
  const auto detector = makeDetector(options);
  // Half the width and a quarter of the height in the middle; 0.8 * 0.9.
  const std::vector<DetectionBox> red = detector->detect(imageOf(kRed), 0.0);
  ASSERT_EQ(red.size(), 1U);
  expectBox(red[0], {160.0f, 180.0f, 480.0f, 300.0f, 0, 0.72f}, 1e-4f);
  const std::vector<DetectionBox> blue = detector->detect(imageOf(kBlue), 0.0);
  ASSERT_EQ(blue.size(), 1U);
  expectBox(blue[0], {160.0f, 180.0f, 480.0f, 300.0f, 2, 0.72f}, 1e-4f);
  EXPECT_TRUE(detector->detect(imageOf(kGreen), 0.0).empty());
  EXPECT_EQ(detector->name(), "darknet tiny.cfg 32x32");
}

TEST_F(TinyDarknet, AThresholdBelowOpenCvsOwnCounts) {
  options.weights = folder.write("weak.weights", test::tinyDarknetWeights(0.1));  // 0.1 * 0.9
  EXPECT_TRUE(makeDetector(options)->detect(imageOf(kRed), 0.0).empty());
  options.score_threshold = 0.08f;
  EXPECT_EQ(makeDetector(options)->detect(imageOf(kRed), 0.0).size(), 1U);
}

TEST_F(TinyDarknet, OnlyWantedClassesAreReported) {
  options.classes = {0};
  const auto detector = makeDetector(options);
  EXPECT_EQ(detector->detect(imageOf(kRed), 0.0).size(), 1U);
  EXPECT_TRUE(detector->detect(imageOf(kBlue), 0.0).empty());
}

TEST_F(TinyDarknet, AnotherInputSizeHasMoreCells) {
  options.input_size = 64;  // 2 x 2 cells; the anchor covers a quarter by an eighth
  const auto detector = makeDetector(options);
  std::vector<DetectionBox> boxes = detector->detect(imageOf(kRed), 0.0);
  ASSERT_EQ(boxes.size(), 4U);
  expectBox(boxes[0], {80.0f, 90.0f, 240.0f, 150.0f, 0, 0.72f}, 1e-4f);
  EXPECT_EQ(detector->name(), "darknet tiny.cfg 64x64");
}

TEST_F(TinyDarknet, WhatIsNoColourImageIsTheCallersMistake) {
  const auto detector = makeDetector(options);
  EXPECT_THROW(detector->detect(cv::Mat(), 0.0), std::invalid_argument);
  EXPECT_THROW(detector->detect(cv::Mat(480, 640, CV_8UC1), 0.0), std::invalid_argument);
}

TEST_F(TinyDarknet, AMissingOptionIsNamed) {
  options.weights.clear();
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([&] { makeDetector(options); }),
                       {"darknet", "--weights is not given"}));
  options.model.clear();
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([&] { makeDetector(options); }),
                       {"darknet", "--model is not given"}));
}

TEST_F(TinyDarknet, AMissingFileIsNamed) {
  options.weights = folder.path() / "none.weights";
  EXPECT_TRUE(mentions(makeError(options), {options.weights.string(), "no such file"}));
  options.model = folder.path() / "none.cfg";
  EXPECT_TRUE(mentions(makeError(options), {options.model.string(), "no such file"}));
}

TEST_F(TinyDarknet, WeightsOfAnotherLengthAreRefused) {
  const std::string weights = test::tinyDarknetWeights(0.8);
  options.weights = folder.write("bad.weights", "");
  EXPECT_TRUE(mentions(makeError(options), {"bad.weights", "OpenCV " CV_VERSION, "is empty"}));
  for (const std::string& bytes :
       {weights.substr(0, weights.size() - 4), weights.substr(0, 10), weights + "1234"}) {
    options.weights = folder.write("bad.weights", bytes);
    EXPECT_TRUE(
        mentions(makeError(options), {"bad.weights", std::to_string(bytes.size()) + " bytes",
                                      "asks for " + std::to_string(weights.size())}));
  }
  options.weights = folder.write("bad.weights", "these are words, and no weights at all\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.weights", "OpenCV " CV_VERSION}));
}

TEST_F(TinyDarknet, ACfgThatIsNoneIsRefused) {
  options.model = folder.write("bad.cfg", "");
  EXPECT_TRUE(mentions(makeError(options), {"bad.cfg", "[net]"}));
  options.model = folder.write("bad.cfg", "just words\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.cfg", "[net]"}));
  options.model = folder.write("bad.cfg", "[net]\nwidth=32\nheight=wide\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.cfg:3:", "height is 'wide'"}));
  options.model = folder.write("bad.cfg", "[net]\nwidth=0\nheight=32\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.cfg:2:", "width is 0"}));
  options.model = folder.write("bad.cfg", test::tinyDarknetCfg() + "[wormhole]\nsize=1\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.cfg", "OpenCV " CV_VERSION, "wormhole"}));
}

TEST_F(TinyDarknet, ANetworkOfOtherClassesIsRefused) {
  options.model = folder.write("voc.cfg", test::tinyDarknetCfg(20));
  options.weights = folder.write("voc.weights", test::tinyDarknetWeights(0.8, 20));
  EXPECT_TRUE(mentions(makeError(options), {"voc.cfg", "1 x 25", "N x 85"}));
}

class TinyOnnx : public testing::Test {
 protected:
  TinyOnnx() {
    options.type = "yolo";
    options.input_size = 64;
  }

  // A head with N candidates of which the one at `index` has a box: the person's probability is
  // 0.9 times the mean red, the car's 0.9 times the mean blue.
  void writeHead(std::int64_t candidates, bool v8, std::size_t index) {
    const std::size_t n = static_cast<std::size_t>(candidates);
    const std::size_t values = v8 ? 84 : 85;
    const std::size_t first_class = v8 ? 4 : 5;
    const auto at = [&](std::size_t value) { return v8 ? value * n + index : index * 85 + value; };
    std::vector<float> biases(n * values, 0.0f);
    std::vector<float> kernels(biases.size() * 3, 0.0f);
    biases[at(0)] = 32.0f;
    biases[at(1)] = 32.0f;
    biases[at(2)] = 32.0f;
    biases[at(3)] = 24.0f;
    if (!v8) {
      biases[at(4)] = 0.8f;
    }
    kernels[at(first_class + 0) * 3 + 0] = 0.9f;
    kernels[at(first_class + 2) * 3 + 2] = 0.9f;
    const std::vector<std::int64_t> shape = v8 ? std::vector<std::int64_t>{1, 84, candidates}
                                               : std::vector<std::int64_t>{1, candidates, 85};
    options.model = folder.write("tiny.onnx", test::tinyOnnx(shape, biases, kernels));
  }

  TemporaryFolder folder;
  DetectorOptions options;
};

// The input is 64 x 64, of which the image of 640 x 480 covers the rows 8 to 55 at a tenth of its
// size, between grey (114 of 255); so a mean colour is 3/4 of the image's and 1/4 of the grey.
constexpr float kMean = 0.75f + 0.25f * 114.0f / 255.0f;
// The box has 16..48 x 20..44 in the input, so 160..480 x (20 - 8) * 10..(44 - 8) * 10.
constexpr DetectionBox kBox{160.0f, 120.0f, 480.0f, 360.0f, 0, 0.9f * kMean};

TEST_F(TinyOnnx, AYoloV5HeadIsDecodedAndTakenOutOfItsLetterbox) {
  writeHead(3, false, 1);
  const auto detector = makeDetector(options);
  const std::vector<DetectionBox> red = detector->detect(imageOf(kRed), 0.0);
  ASSERT_EQ(red.size(), 1U);
  DetectionBox expected = kBox;
  expected.score = 0.8f * kBox.score;
  expectBox(red[0], expected, 1e-4f);
  const std::vector<DetectionBox> blue = detector->detect(imageOf(kBlue), 0.0);
  ASSERT_EQ(blue.size(), 1U);
  EXPECT_EQ(blue[0].class_id, 2);
  EXPECT_TRUE(detector->detect(imageOf(kGreen), 0.0).empty());
  EXPECT_EQ(detector->name(), "yolo tiny.onnx 64x64");
}

TEST_F(TinyOnnx, AYoloV8HeadIsToldByItsShape) {
  writeHead(3, true, 2);
  const auto detector = makeDetector(options);
  const std::vector<DetectionBox> red = detector->detect(imageOf(kRed), 0.0);
  ASSERT_EQ(red.size(), 1U);
  expectBox(red[0], kBox, 1e-4f);
  EXPECT_EQ(detector->detect(imageOf(kBlue), 0.0).at(0).class_id, 2);
}

TEST_F(TinyOnnx, AnUnknownHeadIsNamedByItsShape) {
  options.model = folder.write(
      "odd.onnx", test::tinyOnnx({1, 3, 7}, std::vector<float>(21), std::vector<float>(63)));
  EXPECT_TRUE(mentions(makeError(options), {"odd.onnx", "1 x 3 x 7", "1 x N x 85"}));
}

TEST_F(TinyOnnx, ARefusalNamesFileVersionAndWayOut) {
  options.model = folder.write("odd.onnx", test::tinyOnnx({1, 1, 85}, std::vector<float>(85),
                                                          std::vector<float>(255), "Wormhole"));
  EXPECT_TRUE(
      mentions(makeError(options), {"odd.onnx", "OpenCV " CV_VERSION, "float32", "darknet"}));
}

TEST_F(TinyOnnx, AModelThatDoesNotLoadIsNamed) {
  writeHead(3, false, 1);
  const std::filesystem::path whole = options.model;
  options.model = folder.path() / "none.onnx";
  EXPECT_TRUE(mentions(makeError(options), {"none.onnx", "no such file"}));
  options.model = folder.write("bad.onnx", "");
  EXPECT_TRUE(mentions(makeError(options), {"bad.onnx", "OpenCV " CV_VERSION}));
  options.model = folder.write("bad.onnx", "just words\n");
  EXPECT_TRUE(mentions(makeError(options), {"bad.onnx", "OpenCV " CV_VERSION}));
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) / 2);
  options.model = whole;
  EXPECT_TRUE(mentions(makeError(options), {"tiny.onnx", "OpenCV " CV_VERSION}));
  options.model.clear();
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([&] { makeDetector(options); }),
                       {"yolo", "--model is not given"}));
}

// The two men of the real clip, as outlined by hand in two of its first frames.
struct OutlinedFrame {
  std::size_t index;
  DetectionBox left_man;
  DetectionBox right_man;
};
const OutlinedFrame kOutlined[] = {{0, {46, 207, 244, 479}, {358, 268, 598, 479}},
                                   {4, {42, 214, 236, 479}, {336, 291, 569, 479}}};

double overlapOf(const DetectionBox& a, const DetectionBox& b) {
  const auto area = [](double width, double height) {
    return std::max(0.0, width) * std::max(0.0, height);
  };
  const double shared = area(std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min),
                             std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min));
  return shared / (area(a.x_max - a.x_min, a.y_max - a.y_min) +
                   area(b.x_max - b.x_min, b.y_max - b.y_min) - shared);
}

void expectBothMen(const DetectorOptions& options) {
  const auto detector = makeDetector(options);
  const std::vector<FrameEntry> frames =
      listFrames(test::sharedPath("data/fr3_walking_halfsphere_first50"));
  for (const OutlinedFrame& outlined : kOutlined) {
    const RgbdFrame frame = loadFrame(frames.at(outlined.index), loadCamera("tum3"));
    const std::vector<DetectionBox> boxes = detector->detect(frame.bgr, frame.timestamp);
    for (const DetectionBox& man : {outlined.left_man, outlined.right_man}) {
      EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(),
                              [&](const DetectionBox& box) {
                                return box.class_id == kPersonClassId && overlapOf(box, man) > 0.5;
                              }))
          << "frame " << outlined.index << ", man at column " << man.x_min;
    }
    // and the same boxes once more, bit for bit
    const std::vector<DetectionBox> again = detector->detect(frame.bgr, frame.timestamp);
    ASSERT_EQ(again.size(), boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(again[i].x_min, boxes[i].x_min);
      EXPECT_EQ(again[i].y_max, boxes[i].y_max);
      EXPECT_EQ(again[i].score, boxes[i].score);
    }
  }
}

TEST(RealModel, YoloFastestFindsBothMen) {
  HMCDYN_SKIP_WITHOUT_SHARED("models/yolo-fastest-1.1/yolo-fastest-1.1.weights");
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50");
  DetectorOptions options;
  options.type = "darknet";
  options.model = test::sharedPath("models/yolo-fastest-1.1/yolo-fastest-1.1.cfg");
  options.weights = test::sharedPath("models/yolo-fastest-1.1/yolo-fastest-1.1.weights");
  expectBothMen(options);
  EXPECT_EQ(makeDetector(options)->name(), "darknet yolo-fastest-1.1.cfg 320x320");
}

TEST(RealModel, YoloV5nFindsBothMen) {
  HMCDYN_SKIP_WITHOUT_SHARED("models/yolov5n/yolov5n_fp32.onnx");
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50");
  DetectorOptions options;
  options.type = "yolo";
  options.model = test::sharedPath("models/yolov5n/yolov5n_fp32.onnx");
  expectBothMen(options);
}

TEST(RealModel, AnotherInputSizeThanTheExportsIsRefused) {
  HMCDYN_SKIP_WITHOUT_SHARED("models/yolov5n/yolov5n_fp32.onnx");
  DetectorOptions options;
  options.type = "yolo";
  options.model = test::sharedPath("models/yolov5n/yolov5n_fp32.onnx");
  options.input_size = 320;
  EXPECT_TRUE(mentions(makeError(options), {"yolov5n_fp32.onnx", "320x320", "input size"}));
}

}  // namespace
}  // namespace hmcdyn::slam
