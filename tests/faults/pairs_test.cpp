// SPDX-License-Identifier: BSD-3-Clause
// Kind 4: images without a partner are counted and named.
#include <string>

#include <gtest/gtest.h>

#include "fault_input.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
#include "slam/input/source/folder_source.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

class Pairs : public ToyFolder {
 protected:
  void keepEvery(const std::string& name, std::size_t n) const {
    std::string text;
    std::size_t i = 0;
    for (const std::string& line : linesOf(content(name))) {
      text += i++ % n == 0 ? line + "\n" : "";
    }
    write(name, text);
  }
};

TEST_F(Pairs, ADepthCameraAtAThirdOfTheRateLeavesColourImagesWithoutAPartner) {
  keepEvery("depth.txt", 3);
  const slam::FrameList list = slam::readFrameList(toy());
  EXPECT_EQ(list.frames.size(), 3U);  // of 8: 0, 3 and 6
  EXPECT_EQ(list.color_without_depth, 5U);
  EXPECT_EQ(list.depth_without_color, 0U);
  EXPECT_TRUE(oneMentions(list.notes, {"5 of the 8 colour images", "rgb/1000.033333.png",
                                       "every 0.1000 s", "every 0.0333 s"}));
}

TEST_F(Pairs, DepthImagesWithoutAPartnerAreCountedToo) {
  keepEvery("rgb.txt", 2);
  const slam::FrameList list = slam::readFrameList(toy());
  EXPECT_EQ(list.frames.size(), 4U);
  EXPECT_EQ(list.depth_without_color, 4U);
  EXPECT_TRUE(oneMentions(list.notes, {"4 of the 8 depth images"}));
}

TEST_F(Pairs, TheSourceCountsThem) {
  keepEvery("depth.txt", 3);
  std::vector<std::string> reports;
  slam::CameraCalibration calibration;
  const slam::TumFolderSource source(toy(), slam::DatasetOptions{}, calibration,
                                     [&](const std::string& line) { reports.push_back(line); });
  EXPECT_EQ(source.counts().unpaired, 5U);
  EXPECT_EQ(reports.size(), 1U);
}

TEST_F(Pairs, WhereAllHavePartnersNothingIsSaid) {
  EXPECT_TRUE(slam::readFrameList(toy()).notes.empty());
}

TEST_F(Pairs, TwoClocksAreNamedWithTheTimesOfBoth) {
  restamp("depth.txt",
          [](double time, std::size_t) { return fmt::format("{:.6f}", time - 958.0); });
  EXPECT_TRUE(
      mentions(messageOf<std::runtime_error>([&] { slam::readFrameList(toy()); }),
               {"two clocks", "1000.000000", "42.000000", "differ by 958.000 s: colour is ahead"}));
}

}  // namespace
}  // namespace hmcdyn::faults
