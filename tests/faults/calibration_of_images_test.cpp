// SPDX-License-Identifier: BSD-3-Clause
// Kind 6, told by the images: depths that no camera sees, a calibration for images of another size.
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "fault_input.hpp"
#include "slam/input/camera/plausibility.hpp"
#include "slam/run/input_check.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

TEST(DepthFactor, DepthsThatNoCameraSeesAreSaidWithTheFactorThatFits) {
  const auto around = [](float metres) {
    std::vector<float> depths;
    for (int i = 0; i < 100; ++i) {
      depths.push_back(metres * (0.5f + 0.01f * static_cast<float>(i)));
    }
    return depths;
  };
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(around(9000.0f), 1.0), {"median", "km", "5000"}));
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(around(0.02f), 5e5), {"median", "cm"}));
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(around(0.4f), 5000.0),
                       {"small for a depth camera", "1000", "1.98 m", "millimetres"}));
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(around(13.4f), 1000.0),
                       {"large for a depth camera", "13.3 m", "5000", "2.65 m"}));
  EXPECT_EQ(slam::whatIsOddAbout(around(12.0f), 5000.0), "");
  // A Kinect's disparities of 1/8 px, 580 px * 0.075 m apart, in whole millimetres: from 2 to 4 m,
  // each eight times.
  std::vector<float> steps;
  for (int i = 0; i < 8 * 88; ++i) {
    const int eighths = 87 + i / 8;
    steps.push_back(
        static_cast<float>(std::round(1000.0 * 580.0 * 0.075 * 8.0 / eighths) / 1000.0));
  }
  EXPECT_EQ(slam::whatIsOddAbout(steps, 1000.0), "");
  std::vector<float> as_fives = steps;
  std::vector<float> as_millimetres = steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    as_fives[i] = 0.2f * steps[i];
    as_millimetres[i] = 5.0f * steps[i];
  }
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(as_fives, 5000.0),
                       {"five times those of structured light", "with 1000", "millimetres"}));
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(as_millimetres, 1000.0), {"with 5000"}));
  EXPECT_TRUE(mentions(slam::whatIsOddAbout(std::vector<float>(50, 13.107f), 5000.0),
                       {"13.1 m nearly everywhere", "depth images"}));
  for (const float metres : {0.8f, 2.0f, 5.0f, 8.0f}) {
    EXPECT_EQ(slam::whatIsOddAbout(around(metres), 5000.0), "") << metres;
    EXPECT_EQ(slam::whatIsOddAbout(around(metres), 1000.0), "") << metres;
  }
  EXPECT_EQ(slam::whatIsOddAbout({}, 5000.0), "");
}

class CalibrationOfAFolder : public ToyFolder {};

TEST_F(CalibrationOfAFolder, TakesItsSizeFromTheImages) {
  slam::SlamOptions options = this->options();
  options.camera = write("old.yaml",
                         "Camera.fx: 300\nCamera.fy: 300\nCamera.cx: 159.5\n"
                         "Camera.cy: 119.5\nDepthMapFactor: 1\n")
                       .string();
  const slam::RunInput input = slam::checkInput(options, false);
  EXPECT_EQ(input.calibration.width, 320);
  EXPECT_EQ(input.calibration.height, 240);
  EXPECT_TRUE(oneMentions(input.notes, {"old.yaml", "median of", "km", "with 5000 it would be"}));
}

TEST_F(CalibrationOfAFolder, ForImagesOfAnotherSizeIsAnErrorBeforeTheRun) {
  slam::SlamOptions options = this->options();
  options.camera = "tum3";
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { slam::checkInput(options, false); }),
                       {"camera tum3", "320 x 240", "only scaled"}));
}

}  // namespace
}  // namespace hmcdyn::faults
