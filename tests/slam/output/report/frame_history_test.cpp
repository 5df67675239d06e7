// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/frame_history.hpp"

#include <cstddef>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

std::vector<std::size_t> numbersOf(const FrameHistory& history) {
  std::vector<std::size_t> numbers;
  for (const ReportFrame& frame : history.frames()) {
    numbers.push_back(frame.number.value_or(9999));
  }
  return numbers;
}

TEST(FrameHistory, KeepsAllFramesOfAShortRun) {
  FrameHistory history(4);
  for (int i = 0; i < 4; ++i) {
    history.add({});
  }
  EXPECT_EQ(numbersOf(history), (std::vector<std::size_t>{0, 1, 2, 3}));
}

// At the fifth frame 1 and 3 go; 4 and 5 come; at the seventh 2 and 5 go (the later ones of 0, 2
// and of 4, 5); 6 and 7 come; at the ninth 4 and 7 go.
TEST(FrameHistory, StaysWithinItsCapacityHoweverLongTheRun) {
  FrameHistory history(4);
  for (int i = 0; i < 9; ++i) {
    history.add({});
    EXPECT_LE(history.frames().size(), 4U);
  }
  EXPECT_EQ(numbersOf(history), (std::vector<std::size_t>{0, 6, 8}));
  EXPECT_EQ(history.added(), 9U);
  EXPECT_THROW(FrameHistory(1), std::invalid_argument);
}

TEST(FrameHistory, LostFramesAndKeyFramesOutliveTheirNeighbours) {
  FrameHistory history(4);
  for (int i = 0; i < 5; ++i) {
    ReportFrame frame;
    frame.failure = i == 1 ? "too few matches" : "";
    frame.key_frame = i == 3;
    history.add(frame);
  }
  EXPECT_EQ(numbersOf(history), (std::vector<std::size_t>{1, 3, 4}));
}

TEST(FrameHistory, PicturesFindTheirPlaceAmongTheKeptFrames) {
  FrameHistory history(4);
  for (int i = 0; i < 9; ++i) {
    history.add({});
  }
  const std::vector<FramePicture> placed =
      byPlace({{0, ""}, {5, ""}, {6, ""}, {7, ""}, {8, ""}}, history.frames());
  std::vector<std::size_t> places;
  for (const FramePicture& picture : placed) {
    places.push_back(picture.frame);
  }
  EXPECT_EQ(places, (std::vector<std::size_t>{0, 0, 1, 1, 2}));
}

}  // namespace
}  // namespace hmcdyn::slam
