// SPDX-License-Identifier: BSD-3-Clause
// The motion mask inside FrameFilter.
#include <cstddef>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/frame_filter.hpp>

#include "sliding_thing.hpp"

namespace hmcdyn {
namespace {

using test::SlidingThing;

constexpr double kStep = 1.0 / 30.0;  // s
constexpr double kSpeed = 0.9;        // m/s, of the board
constexpr int kFrames = 20;

FrameFilterOptions optionsWithCamera() {
  FrameFilterOptions options;
  options.camera = SlidingThing::kCamera;
  return options;
}

SlidingThing sceneAt(int frame) { return {kStep * frame, 0.0, -0.6 + kSpeed * kStep * frame}; }

std::vector<cv::KeyPoint> grid() {
  std::vector<cv::KeyPoint> points;
  for (int v = 4; v < SlidingThing::kHeight; v += 6) {
    for (int u = 4; u < SlidingThing::kWidth; u += 6) {
      points.emplace_back(static_cast<float>(u), static_cast<float>(v), 7.0f);
    }
  }
  return points;
}

/// The board's box, wider by 24 px on both sides: it holds wall as well.
DetectionBox wideBox(const SlidingThing& scene) {
  DetectionBox box = scene.box();
  box.x_min -= 24.0f;
  box.x_max += 24.0f;
  return box;
}

FrameFilterResult filterFrame(int frame, bool with_boxes, const Pose& predicted,
                              FrameFilter& filter) {
  const SlidingThing scene = sceneAt(frame);
  const std::vector<cv::KeyPoint> points = grid();
  FrameInput input;
  input.timestamp = scene.frame().timestamp;
  input.gray = scene.frame().gray;
  input.depth = scene.frame().depth;
  input.key_points = points;
  input.predicted_pose = predicted;
  const std::vector<DetectionBox> boxes{wideBox(scene)};
  FrameFilterResult result =
      with_boxes ? filter.filter(input, boxes) : filter.filter(input, Span<const DetectionBox>());
  filter.setPose(input.timestamp, predicted);
  return result;
}

/// Points of the grid well inside the board, and on the wall well outside it but in the wide box.
struct Parts {
  std::vector<std::size_t> board;
  std::vector<std::size_t> wall_in_box;
};

Parts partsOf(int frame) {
  const SlidingThing scene = sceneAt(frame);
  const DetectionBox board = scene.box();
  const DetectionBox wide = wideBox(scene);
  const std::vector<cv::KeyPoint> points = grid();
  Parts parts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f p = points[i].pt;
    constexpr float kClear = 8.0f;  // px: two reduced pixels and the silhouette
    if (p.x > board.x_min + kClear && p.x < board.x_max - kClear && p.y > board.y_min + kClear &&
        p.y < board.y_max - kClear) {
      parts.board.push_back(i);
    } else if (wide.contains(p.x, p.y) &&
               (p.x < board.x_min - kClear || p.x > board.x_max + kClear)) {
      parts.wall_in_box.push_back(i);
    }
  }
  return parts;
}

TEST(MaskInFrameFilter, TellsTheRoomInABoxFromWhatMovesThere) {
  FrameFilter filter(optionsWithCamera());
  FrameFilterResult result;
  for (int frame = 0; frame <= kFrames; ++frame) {
    result = filterFrame(frame, true, {}, filter);
  }
  ASSERT_NE(filter.mask(), nullptr);
  EXPECT_EQ(filter.mask()->state, MaskState::kGood);
  const Parts parts = partsOf(kFrames);
  ASSERT_GT(parts.board.size(), 20U);
  ASSERT_GT(parts.wall_in_box.size(), 20U);
  for (const std::size_t i : parts.board) {
    EXPECT_EQ(result.label[i], PointLabel::kDynamic) << "point " << i;
    EXPECT_EQ(result.reason[i], PointReason::kMask) << "point " << i;
    EXPECT_EQ(result.weight[i], 0.0f) << "point " << i;
  }
  std::size_t room = 0;  // but for the strip that the board has just left, of which nobody knows
  for (const std::size_t i : parts.wall_in_box) {
    EXPECT_NE(result.label[i], PointLabel::kDynamic) << "point " << i;
    room += result.reason[i] == PointReason::kRoom && result.weight[i] == 1.0f ? 1 : 0;
  }
  EXPECT_GE(2 * room, parts.wall_in_box.size());
}

TEST(MaskInFrameFilter, FindsWhatMovesWithoutABox) {
  FrameFilter filter(optionsWithCamera());
  FrameFilterResult result;
  for (int frame = 0; frame <= kFrames; ++frame) {
    result = filterFrame(frame, false, {}, filter);
  }
  for (const std::size_t i : partsOf(kFrames).board) {
    EXPECT_EQ(result.reason[i], PointReason::kMask) << "point " << i;
    EXPECT_EQ(result.keep[i], 0) << "point " << i;
  }
}

TEST(MaskInFrameFilter, AWorldThatMovesUnderTheCameraIsNoMotion) {
  FrameFilter filter(optionsWithCamera());
  Pose corrected;
  corrected.matrix(0, 3) = 0.4;  // m: a loop was closed
  for (int frame = 0; frame <= kFrames; ++frame) {
    const Pose predicted = frame < 10 ? Pose() : corrected;
    const FrameFilterResult result = filterFrame(frame, false, predicted, filter);
    if (frame == 9) {
      filter.setPose(kStep * 9, corrected);
    }
    ASSERT_NE(filter.mask(), nullptr);
    EXPECT_EQ(filter.mask()->state, frame == 0 ? MaskState::kFirstFrame : MaskState::kGood);
    if (frame == kFrames) {
      EXPECT_EQ(result.reason[partsOf(frame).board.front()], PointReason::kMask);
    }
  }
}

TEST(MaskInFrameFilter, NeedsACameraADepthImageAndTheRobustMethod) {
  FrameFilter without_camera(FrameFilterOptions{});
  EXPECT_TRUE(filterFrame(0, true, {}, without_camera).mask.empty());
  EXPECT_EQ(without_camera.mask(), nullptr);

  FrameFilterOptions paper = FrameFilterOptions::paper();
  paper.camera = SlidingThing::kCamera;
  FrameFilter as_the_paper_has_it(paper);
  EXPECT_TRUE(filterFrame(0, true, {}, as_the_paper_has_it).mask.empty());

  FrameFilterOptions peer = optionsWithCamera();
  peer.rule = FilterRule::kBox;
  FrameFilter by_boxes(peer);
  EXPECT_TRUE(filterFrame(0, true, {}, by_boxes).mask.empty());

  FrameFilter filter(optionsWithCamera());
  FrameInput no_depth;
  no_depth.gray = sceneAt(0).frame().gray;
  EXPECT_TRUE(filter.filter(no_depth, Span<const DetectionBox>()).mask.empty());
  EXPECT_EQ(filter.mask(), nullptr);
}

TEST(MaskInFrameFilter, AFrameThatIsNotComparedHasNotTheMaskOfTheOneBefore) {
  FrameFilter filter(optionsWithCamera());
  filterFrame(0, true, {}, filter);
  filterFrame(1, true, {}, filter);
  ASSERT_NE(filter.mask(), nullptr);
  EXPECT_EQ(filterFrame(1, true, {}, filter).status, FrameFilterStatus::kStampNotRising);
  EXPECT_EQ(filter.mask(), nullptr);
  filterFrame(2, true, {}, filter);
  ASSERT_NE(filter.mask(), nullptr);
  EXPECT_EQ(filter.mask()->state, MaskState::kGood);
}

TEST(MaskInFrameFilter, AResetForgetsIt) {
  FrameFilter filter(optionsWithCamera());
  filterFrame(0, false, {}, filter);
  filterFrame(1, false, {}, filter);
  filter.reset();
  EXPECT_EQ(filter.mask(), nullptr);
  filterFrame(2, false, {}, filter);
  ASSERT_NE(filter.mask(), nullptr);
  EXPECT_EQ(filter.mask()->state, MaskState::kFirstFrame);
}

}  // namespace
}  // namespace hmcdyn
