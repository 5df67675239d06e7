// SPDX-License-Identifier: BSD-3-Clause
// Drawn images: a textured thing moves before a textured wall by known steps.
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <hmcdyn/steps/box_carrier.hpp>

#include "drawn_texture.hpp"

namespace hmcdyn {
namespace {

constexpr float kTolerance = 2.0f;  // px
constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// Frames at 20 Hz. The thing is 80 x 120 px at 1.5 m, its box 40 px wider: a third of the box is
/// wall, at 4 m.
class Carrier : public testing::Test {
 protected:
  CarriedFrame frameAt(std::size_t index, int left, int top = 60, bool with_depth = true) const {
    CarriedFrame frame;
    frame.index = index;
    frame.timestamp = 10.0 + 0.05 * static_cast<double>(index);
    frame.gray = wall_.clone();
    frame.depth = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(4.0));
    const cv::Rect thing = cv::Rect(left, top, 80, 120) & cv::Rect(0, 0, kWidth, kHeight);
    if (!thing.empty()) {
      const cv::Rect part(thing.x - left, thing.y - top, thing.width, thing.height);
      thing_(part).copyTo(frame.gray(thing));
      frame.depth(thing).setTo(1.5);
    }
    if (!with_depth) {
      frame.depth.setTo(0.0);
    }
    return frame;
  }
  static DetectionBox boxAt(int left, int top = 60) {
    const auto x = static_cast<float>(left);
    const auto y = static_cast<float>(top);
    return {x - 20.0f, y, x + 100.0f, y + 120.0f, kPersonClassId, 0.8f};
  }
  static FrameDetection detected(std::size_t index, std::vector<DetectionBox> boxes) {
    return {index, std::move(boxes)};
  }
  static void expectNear(const DetectionBox& box, const DetectionBox& truth) {
    EXPECT_NEAR(box.x_min, truth.x_min, kTolerance);
    EXPECT_NEAR(box.y_min, truth.y_min, kTolerance);
    EXPECT_NEAR(box.x_max, truth.x_max, kTolerance);
    EXPECT_NEAR(box.y_max, truth.y_max, kTolerance);
  }

  cv::Mat wall_ = test::makeTexture({kWidth, kHeight}, 3);
  cv::Mat thing_ = test::makeTexture({80, 120}, 4);
};

TEST_F(Carrier, DetectedBoxesComeOutAsTheyWentIn) {
  BoxCarrier carrier;
  const std::vector<DetectionBox> boxes =
      carrier.update(frameAt(0, 100), detected(0, {boxAt(100)}));
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].x_min, boxAt(100).x_min);
  EXPECT_EQ(boxes[0].y_max, boxAt(100).y_max);
  EXPECT_EQ(boxes[0].score, 0.8f);
  EXPECT_EQ(carrier.bridged(), 0U);
}

TEST_F(Carrier, WithoutANewAnswerABoxFollowsTheThingAndNotTheWall) {
  BoxCarrier carrier;
  carrier.update(frameAt(0, 60), detected(0, {boxAt(60)}));
  std::vector<DetectionBox> boxes;
  for (int i = 1; i <= 8; ++i) {
    boxes =
        carrier.update(frameAt(static_cast<std::size_t>(i), 60 + 6 * i, 60 + 2 * i), std::nullopt);
  }
  ASSERT_EQ(boxes.size(), 1U);
  expectNear(boxes[0], boxAt(108, 76));
  EXPECT_EQ(carrier.bridged(), 0U);  // nobody missed it
}

TEST_F(Carrier, WithoutDepthTheMiddleOfTheBoxIsFollowed) {
  BoxCarrier carrier;
  carrier.update(frameAt(0, 60, 60, false), detected(0, {boxAt(60)}));
  const std::vector<DetectionBox> boxes = carrier.update(frameAt(1, 66, 60, false), std::nullopt);
  ASSERT_EQ(boxes.size(), 1U);
  expectNear(boxes[0], boxAt(66));
}

TEST_F(Carrier, ABoxGrowsWithTheThing) {
  // The whole image, the wall of depth 1.5 m, is scaled by 1.02 a frame about (160, 120).
  const auto scaled = [this](std::size_t index, double scale) {
    CarriedFrame frame = frameAt(index, 1000);
    frame.depth.setTo(1.5);
    const cv::Matx23d zoom(scale, 0, 160 * (1 - scale), 0, scale, 120 * (1 - scale));
    cv::warpAffine(wall_, frame.gray, zoom, wall_.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    return frame;
  };
  BoxCarrier carrier;
  carrier.update(scaled(0, 1.0), detected(0, {{110, 70, 210, 170}}));
  std::vector<DetectionBox> boxes;
  for (int i = 1; i <= 5; ++i) {
    boxes = carrier.update(scaled(static_cast<std::size_t>(i), std::pow(1.02, i)), std::nullopt);
  }
  ASSERT_EQ(boxes.size(), 1U);
  const float half = 50.0f * static_cast<float>(std::pow(1.02, 5));
  expectNear(boxes[0], {160 - half, 120 - half, 160 + half, 120 + half});
}

TEST_F(Carrier, ANearPersonWhoseLimbsSwingIsFollowed) {
  // 280 x 420 px, a diagonal of 505: its upper and lower parts, of two in seven rows of points
  // each, move by less and more than its middle, which moves 20 px to the right.
  const cv::Mat wall = test::makeTexture({640, 480}, 5);
  const cv::Mat thing = test::makeTexture({280, 420}, 6);
  const auto carriedAfter = [&](int swing) {
    BoxCarrier carrier;
    std::vector<DetectionBox> boxes;
    for (int i = 0; i < 2; ++i) {
      CarriedFrame frame;
      frame.index = static_cast<std::size_t>(i);
      frame.timestamp = 10.0 + 0.05 * i;
      frame.gray = wall.clone();
      frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(4.0));
      for (int part = -1; part <= 1; ++part) {
        const cv::Rect rows(0, part < 0 ? 0 : part == 0 ? 120 : 300, 280, part == 0 ? 180 : 120);
        const cv::Rect place = rows + cv::Point(100 + i * (20 + part * swing), 30);
        thing(rows).copyTo(frame.gray(place));
        frame.depth(place).setTo(1.5);
      }
      boxes = carrier.update(
          frame, i == 0 ? std::optional(FrameDetection{0, {{100, 30, 380, 450}}}) : std::nullopt);
    }
    return boxes;
  };
  const std::vector<DetectionBox> boxes = carriedAfter(8);  // 2 % of the diagonal are 10.1 px
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].x_min, 120.0f, kTolerance);
  EXPECT_TRUE(carriedAfter(14).empty());  // not one thing
}

TEST_F(Carrier, AMissedBoxIsBridgedUntilTheAgeLimit) {
  BoxCarrierOptions options;
  options.max_bridge = 0.15;  // three frames
  BoxCarrier carrier(options);
  carrier.update(frameAt(0, 100), detected(0, {boxAt(100)}));
  carrier.update(frameAt(1, 104), detected(1, {boxAt(104)}));
  for (std::size_t i = 2; i <= 4; ++i) {
    const int left = 100 + 4 * static_cast<int>(i);
    const std::vector<DetectionBox> boxes = carrier.update(frameAt(i, left), detected(i, {}));
    ASSERT_EQ(boxes.size(), 1U) << i;
    expectNear(boxes[0], boxAt(left));
    EXPECT_EQ(carrier.bridged(), 1U);
  }
  EXPECT_TRUE(carrier.update(frameAt(5, 120), detected(5, {})).empty());
  EXPECT_EQ(carrier.bridged(), 0U);
}

TEST_F(Carrier, ADetectorThatAnswersForEveryThirdFrameIsBridgedFromItsSecondBoxOn) {
  BoxCarrierOptions twice;
  twice.min_detections = 2;
  BoxCarrier carrier(twice);
  for (std::size_t i = 0; i < 12; ++i) {
    const int left = 100 + 4 * static_cast<int>(i);
    const std::vector<DetectionBox> boxes =
        carrier.update(frameAt(i, left), i % 3 == 0 ? detected(i, {boxAt(left)}) : detected(i, {}));
    const bool seen_once = i == 1 || i == 2;
    ASSERT_EQ(boxes.size(), seen_once ? 0U : 1U) << i;
    EXPECT_EQ(carrier.bridged(), seen_once || i % 3 == 0 ? 0U : 1U) << i;
    if (!seen_once) {
      expectNear(boxes[0], boxAt(left));
    }
  }
}

TEST_F(Carrier, TwoDetectionsFartherApartThanTheBridgeAreTwoFalseAlarms) {
  BoxCarrierOptions options;
  options.max_bridge = 0.1;  // two frames
  options.min_detections = 2;
  BoxCarrier carrier(options);
  for (std::size_t i = 0; i < 6; ++i) {
    const bool seen = i == 0 || i == 4;
    const std::vector<DetectionBox> boxes =
        carrier.update(frameAt(i, 100), seen ? detected(i, {boxAt(100)}) : detected(i, {}));
    EXPECT_EQ(boxes.size(), seen ? 1U : 0U) << i;
  }
}

TEST_F(Carrier, NothingIsBridgedWhereTheOptionIsZeroOrTheBoxWasSeenTooRarely) {
  BoxCarrierOptions off;
  off.max_bridge = 0.0;
  BoxCarrier never(off);
  BoxCarrierOptions twice;
  twice.min_detections = 2;
  BoxCarrier once(twice);
  for (BoxCarrier* carrier : {&never, &once}) {
    carrier->update(frameAt(0, 100), detected(0, {boxAt(100)}));
  }
  never.update(frameAt(1, 100), detected(1, {boxAt(100)}));
  EXPECT_TRUE(never.update(frameAt(2, 100), detected(2, {})).empty());
  EXPECT_TRUE(once.update(frameAt(1, 100), detected(1, {})).empty());
}

// A slow detector sees every n-th frame, and for the others its file has no boxes.
TEST_F(Carrier, ADetectorThatSeesEveryNthFrameLeavesNoFrameWithoutABox) {
  for (const std::size_t every : {2U, 3U, 5U}) {
    BoxCarrier carrier;
    for (std::size_t i = 0; i < 16; ++i) {
      const int left = 60 + 4 * static_cast<int>(i);
      std::vector<DetectionBox> seen;
      if (i % every == 0) {
        seen.push_back(boxAt(left));
      }
      const std::vector<DetectionBox> boxes =
          carrier.update(frameAt(i, left), detected(i, std::move(seen)));
      ASSERT_EQ(boxes.size(), 1U) << "every " << every << ", frame " << i;
      expectNear(boxes[0], boxAt(left));
    }
  }
}

TEST_F(Carrier, ABoxThatWasSeenOnceIsBridgedForThePromisedHalfSecond) {
  BoxCarrier carrier;
  carrier.update(frameAt(0, 60), detected(0, {boxAt(60)}));
  for (std::size_t i = 1; i <= 10; ++i) {  // 20 Hz
    const int left = 60 + 2 * static_cast<int>(i);
    EXPECT_EQ(carrier.update(frameAt(i, left), detected(i, {})).size(), 1U) << i;
  }
  EXPECT_TRUE(carrier.update(frameAt(11, 82), detected(11, {})).empty());
}

TEST_F(Carrier, AfterAResetThereIsNoBox) {
  BoxCarrier carrier;
  carrier.update(frameAt(0, 60), detected(0, {boxAt(60)}));
  carrier.reset();
  EXPECT_TRUE(carrier.update(frameAt(1, 62), std::nullopt).empty());
}

TEST_F(Carrier, ABoxEndsWhereItsThingIsGone) {
  BoxCarrier carrier;
  carrier.update(frameAt(0, 100), detected(0, {boxAt(100)}));
  carrier.update(frameAt(1, 100), detected(1, {boxAt(100)}));
  // In one frame the thing is gone, in the next there is only wall at the box's place.
  carrier.update(frameAt(2, 1000), detected(2, {}));
  EXPECT_TRUE(carrier.update(frameAt(3, 1000), detected(3, {})).empty());
}

TEST_F(Carrier, ABoxEndsAtTheBorder) {
  BoxCarrier carrier;
  std::vector<DetectionBox> boxes = carrier.update(frameAt(0, 200), detected(0, {boxAt(200)}));
  bool was_clipped = false;
  for (int i = 1; i <= 14 && !boxes.empty(); ++i) {
    boxes = carrier.update(frameAt(static_cast<std::size_t>(i), 200 + 8 * i), std::nullopt);
    for (const DetectionBox& box : boxes) {
      EXPECT_LE(box.x_max, 319.0f);
      was_clipped = was_clipped || box.x_max == 319.0f;
    }
  }
  EXPECT_TRUE(was_clipped);
  EXPECT_TRUE(boxes.empty());
}

TEST_F(Carrier, ALateDetectionIsCarriedToThePresent) {
  BoxCarrier carrier;
  for (int i = 0; i <= 4; ++i) {
    EXPECT_TRUE(
        carrier.update(frameAt(static_cast<std::size_t>(i), 60 + 6 * i), std::nullopt).empty());
  }
  const std::vector<DetectionBox> boxes =
      carrier.update(frameAt(5, 90), detected(1, {boxAt(66)}));  // of four frames ago
  ASSERT_EQ(boxes.size(), 1U);
  expectNear(boxes[0], boxAt(90));
}

TEST_F(Carrier, ADetectionOlderThanTheHistoryIsLeftOut) {
  BoxCarrierOptions options;
  options.history = 0.1;
  BoxCarrier carrier(options);
  for (std::size_t i = 0; i < 6; ++i) {
    carrier.update(frameAt(i, 100), std::nullopt);
  }
  EXPECT_TRUE(carrier.update(frameAt(6, 100), detected(1, {boxAt(100)})).empty());
}

TEST_F(Carrier, AJumpOfTimeForgetsAllBoxes) {
  BoxCarrier carrier;
  carrier.update(frameAt(5, 100), detected(5, {boxAt(100)}));
  CarriedFrame back = frameAt(6, 100);
  back.timestamp = 9.0;
  EXPECT_TRUE(carrier.update(back, std::nullopt).empty());
}

TEST(MergeDoubles, TwoBoxesOfOneThingBecomeTheStrongerAndAPersonInFrontStays) {
  const DetectionBox large{0, 0, 100, 200, kPersonClassId, 0.9f};
  const DetectionBox within{5, 5, 95, 165, kPersonClassId, 0.6f};   // 72 % of the area
  const DetectionBox small{10, 10, 50, 110, kPersonClassId, 0.6f};  // 20 %
  DetectionBox chair = within;
  chair.class_id = 56;
  const std::vector<DetectionBox> kept = mergeDoubles({within, large, small, chair}, {});
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].score, 0.9f);
  EXPECT_EQ(kept[1].x_max, 50.0f);
  EXPECT_EQ(kept[2].class_id, 56);
  BoxCarrierOptions off;
  off.duplicate_overlap = 1.0f;
  EXPECT_EQ(mergeDoubles({within, large}, off).size(), 2U);
}

TEST(IntersectionOverUnion, IsThatOfTheAreas) {
  // 10 x 10 each, 5 x 10 in common: 50 / 150.
  EXPECT_FLOAT_EQ(intersectionOverUnion({0, 0, 10, 10}, {5, 0, 15, 10}), 1.0f / 3.0f);
  EXPECT_EQ(intersectionOverUnion({0, 0, 10, 10}, {10, 0, 20, 10}), 0.0f);
  EXPECT_EQ(intersectionOverUnion({0, 0, 10, 10}, {9, 9, 3, 3}), 0.0f);
}

TEST(BoxCarrierOptionsCheck, NamesTheOption) {
  BoxCarrierOptions options;
  options.max_bridge = -1.0;
  EXPECT_THROW(BoxCarrier{options}, std::invalid_argument);
  options = {};
  options.grid = 1;
  EXPECT_THROW(BoxCarrier{options}, std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn
