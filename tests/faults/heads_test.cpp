// SPDX-License-Identifier: BSD-3-Clause
// Kind 9: a network whose output is not decoded here is named for what it is.
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "detect/tiny_models.hpp"
#include "fault_input.hpp"
#include "slam/detect/detector_factory.hpp"
#include "slam/detect/yolo_heads.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

/// An output of zeros of the given sides.
cv::Mat outputOf(const std::vector<int>& sides) {
  return {static_cast<int>(sides.size()), sides.data(), CV_32F, cv::Scalar(0)};
}

TEST(Heads, AreGuessedByTheirShapes) {
  struct Kind {
    std::vector<int> sides;
    const char* said;
  };
  for (const Kind& kind : std::vector<Kind>{{{1, 300, 6}, "YOLOv10"},
                                            {{37, 7}, "YOLOv7 --end2end"},
                                            {{1, 116, 8400}, "segmentation"},
                                            {{1, 25200, 117}, "segmentation"},
                                            {{1, 56, 8400}, "pose"},
                                            {{1, 5, 8400}, "a detector of 1 classes"},
                                            {{1, 24, 8400}, "a detector of 20 classes"},
                                            {{1, 8400, 84}, "transposed YOLOv8"},
                                            {{1, 3, 80, 80, 85}, "not decoded"},
                                            {{1, 255, 20, 20}, "not decoded"},
                                            {{1, 144, 80, 80}, "not decoded"},
                                            {{1, 1000}, "no head that is known"}}) {
    const std::string guess = slam::guessOfHead({outputOf(kind.sides)});
    EXPECT_TRUE(mentions(guess, {kind.said, "export"}));
  }
  EXPECT_TRUE(mentions(slam::guessOfHead({}), {"no output"}));
}

/// A YOLOv5 head of 63 candidates for an input of 64 px, decoded or not.
cv::Mat headOf(float centre_step, float size, float score) {
  cv::Mat output = outputOf({1, 63, 85});
  for (int i = 0; i < 63; ++i) {
    auto* const row = output.ptr<float>(0, i);
    row[0] = row[1] = centre_step * static_cast<float>(i);
    row[2] = row[3] = size;
    row[4] = row[5] = score;
  }
  return output;
}

TEST(Heads, AreToldByTheirValues) {
  EXPECT_EQ(slam::whatIsWrongWithHead(headOf(1.0f, 20.0f, 0.01f), 64), "");
  EXPECT_TRUE(mentions(slam::whatIsWrongWithHead(headOf(0.01f, -1.2f, 0.01f), 64),
                       {"YOLOX", "--decode_in_inference"}));
  EXPECT_TRUE(mentions(slam::whatIsWrongWithHead(headOf(0.01f, 3.0f, 0.01f), 64), {"YOLOX"}));
  EXPECT_TRUE(mentions(slam::whatIsWrongWithHead(headOf(0.015f, 0.3f, 0.01f), 64), {"shares"}));
  EXPECT_TRUE(mentions(slam::whatIsWrongWithHead(headOf(1.0f, 20.0f, -4.0f), 64), {"sigmoid"}));
  EXPECT_EQ(slam::whatIsWrongWithHead(outputOf({1, 3, 85}), 64), "");  // too few to tell
}

TEST(Heads, ThatAreNotDecodedAreRefusedWhenTheModelIsLoadedAndNobodyBlamesOpenCv) {
  const hmcdyn::test::TemporaryFolder folder;
  const auto refusal = [&](const std::vector<std::int64_t>& shape, float bias) {
    std::size_t size = 1;
    for (const std::int64_t side : shape) {
      size *= static_cast<std::size_t>(side);
    }
    slam::DetectorOptions options;
    options.type = "yolo";
    options.input_size = 64;
    options.model =
        folder.write("net.onnx", hmcdyn::test::tinyOnnx(shape, std::vector<float>(size, bias),
                                                        std::vector<float>(3 * size, 0.0f)));
    const std::string message = messageOf<std::runtime_error>([&] { slam::makeDetector(options); });
    EXPECT_EQ(message.find("OpenCV"), std::string::npos) << message;
    EXPECT_TRUE(mentions(message, {"net.onnx", "hmcdyn does not decode"}));
    return message;
  };
  EXPECT_TRUE(mentions(refusal({1, 300, 6}, 0.5f), {"1 x 300 x 6", "YOLOv10"}));
  EXPECT_TRUE(mentions(refusal({1, 63, 85}, -0.5f), {"YOLOX"}));
}

}  // namespace
}  // namespace hmcdyn::faults
