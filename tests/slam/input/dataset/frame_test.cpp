// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/frame.hpp"

#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

// A frame of 8 x 6 pixels on disk, to be spoilt by the tests.
class Frame : public testing::Test {
 protected:
  Frame() {
    calibration.width = 8;
    calibration.height = 6;
    entry.index = 3;
    entry.timestamp = 1.25;
    entry.rgb = folder.path() / "rgb.png";
    entry.depth = folder.path() / "depth.png";
    cv::imwrite(entry.rgb.string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar(10, 20, 30)));
    cv::Mat depth(6, 8, CV_16UC1, cv::Scalar(10000));
    depth.at<std::uint16_t>(0, 0) = 0;
    depth.at<std::uint16_t>(5, 7) = 65535;
    cv::imwrite(entry.depth.string(), depth);
  }

  std::string loadError() const {
    return messageOf<std::runtime_error>([&] { loadFrame(entry, calibration); });
  }
  // Cuts a file to its first bytes.
  static void truncate(const std::filesystem::path& file, std::uintmax_t removed) {
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - removed);
  }

  TemporaryFolder folder;
  CameraCalibration calibration;
  FrameEntry entry;
};

TEST_F(Frame, HasMetresAndGrey) {
  const RgbdFrame frame = loadFrame(entry, calibration);
  EXPECT_EQ(frame.index, 3U);
  EXPECT_EQ(frame.timestamp, 1.25);
  ASSERT_EQ(frame.bgr.type(), CV_8UC3);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(2, 2), cv::Vec3b(10, 20, 30));
  ASSERT_EQ(frame.gray.type(), CV_8UC1);
  // ITU-R BT.601: 0.114 * 10 + 0.587 * 20 + 0.299 * 30 = 21.85
  EXPECT_EQ(frame.gray.at<std::uint8_t>(2, 2), 22);
  ASSERT_EQ(frame.depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(2, 2), 2.0f);
  EXPECT_EQ(frame.depth.at<float>(0, 0), 0.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 7), 13.107f);
}

TEST_F(Frame, TheDepthFactorIsTheCalibrations) {
  calibration.depth_factor = 1000.0;
  EXPECT_FLOAT_EQ(loadFrame(entry, calibration).depth.at<float>(2, 2), 10.0f);
}

TEST_F(Frame, DepthThatIsNowhereMeasuredIsNoError) {
  cv::imwrite(entry.depth.string(), cv::Mat::zeros(6, 8, CV_16UC1));
  EXPECT_EQ(cv::countNonZero(loadFrame(entry, calibration).depth), 0);
}

TEST_F(Frame, GreyAndTransparentImagesAreColourImagesToo) {
  cv::imwrite(entry.rgb.string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(77)));
  EXPECT_EQ(loadFrame(entry, calibration).bgr.at<cv::Vec3b>(1, 1), cv::Vec3b(77, 77, 77));
  cv::imwrite(entry.rgb.string(), cv::Mat(6, 8, CV_8UC4, cv::Scalar(1, 2, 3, 128)));
  EXPECT_EQ(loadFrame(entry, calibration).bgr.at<cv::Vec3b>(1, 1), cv::Vec3b(1, 2, 3));
}

TEST_F(Frame, AMissingFileIsNamed) {
  std::filesystem::remove(entry.depth);
  EXPECT_TRUE(mentions(loadError(), {entry.depth.string(), "no such file"}));
  std::filesystem::remove(entry.rgb);
  EXPECT_TRUE(mentions(loadError(), {entry.rgb.string(), "no such file"}));
}

TEST_F(Frame, ATruncatedPngIsNamedWhereverItWasCut) {
  const std::uintmax_t size = std::filesystem::file_size(entry.depth);
  for (const std::uintmax_t removed : {std::uintmax_t{1}, std::uintmax_t{12}, size / 2, size - 9}) {
    const TemporaryFolder other;
    FrameEntry cut = entry;
    cut.depth = other.path() / "cut.png";
    std::filesystem::copy_file(entry.depth, cut.depth);
    truncate(cut.depth, removed);
    EXPECT_TRUE(
        mentions(messageOf<std::runtime_error>([&] { loadFrame(cut, calibration); }),
                 {cut.depth.string(), "truncated PNG", std::to_string(size - removed) + " bytes"}));
  }
  truncate(entry.rgb, 4);
  EXPECT_TRUE(mentions(loadError(), {entry.rgb.string(), "truncated PNG"}));
}

TEST_F(Frame, AnEmptyFileOrNoImageIsNamed) {
  folder.write("rgb.png", "");
  EXPECT_TRUE(mentions(loadError(), {entry.rgb.string(), "is empty"}));
  folder.write("rgb.png", "this is text, not an image\n");
  EXPECT_TRUE(mentions(loadError(), {entry.rgb.string(), "damaged, or no image"}));
}

TEST_F(Frame, DepthOfAnotherTypeIsNamedWithWhatItHas) {
  cv::imwrite(entry.depth.string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(9)));
  EXPECT_TRUE(mentions(loadError(), {entry.depth.string(), "1 channel of 8 bits"}));
  cv::imwrite(entry.depth.string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar(9, 9, 9)));
  EXPECT_TRUE(mentions(loadError(), {entry.depth.string(), "3 channels of 8 bits"}));
}

TEST_F(Frame, SwappedColourAndDepthAreSuspected) {
  std::swap(entry.rgb, entry.depth);
  EXPECT_TRUE(
      mentions(loadError(), {entry.rgb.string(), "1 channel of 16 bits", "depth swapped?"}));
}

TEST_F(Frame, AnotherSizeThanTheCalibrationsIsNamed) {
  cv::imwrite(entry.depth.string(), cv::Mat::zeros(3, 4, CV_16UC1));
  EXPECT_TRUE(mentions(loadError(), {entry.depth.string(), "4 x 3", "8 x 6"}));
  calibration.width = 640;
  calibration.height = 480;
  EXPECT_TRUE(mentions(loadError(), {entry.rgb.string(), "8 x 6", "640 x 480"}));
}

TEST_F(Frame, WithoutDistortionRectifyingSharesTheImages) {
  const RgbdFrame frame = loadFrame(entry, calibration);
  const RgbdFrame rectified = rectify(frame, Rectifier(calibration));
  EXPECT_EQ(rectified.bgr.data, frame.bgr.data);
  EXPECT_EQ(rectified.gray.data, frame.gray.data);
  EXPECT_EQ(rectified.depth.data, frame.depth.data);
}

TEST_F(Frame, RectifyingKeepsTypesTimeAndFlatParts) {
  calibration.pinhole = {8.0, 8.0, 3.5, 2.5};
  calibration.distortion = {0.05, 0.0, 0.0, 0.0, 0.0};
  const RgbdFrame rectified = rectify(loadFrame(entry, calibration), Rectifier(calibration));
  EXPECT_EQ(rectified.index, 3U);
  EXPECT_EQ(rectified.timestamp, 1.25);
  EXPECT_EQ(rectified.bgr.at<cv::Vec3b>(2, 3), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(rectified.gray.at<std::uint8_t>(2, 3), 22);
  EXPECT_FLOAT_EQ(rectified.depth.at<float>(2, 3), 2.0f);
}

TEST(RealClip, EveryFrameLoads) {
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50");
  const CameraCalibration calibration = loadCamera("tum3");
  for (const FrameEntry& entry :
       listFrames(test::sharedPath("data/fr3_walking_halfsphere_first50"))) {
    const RgbdFrame frame = loadFrame(entry, calibration);
    double least = 0.0;
    double most = 0.0;
    cv::minMaxLoc(frame.depth, &least, &most);
    EXPECT_EQ(least, 0.0);
    EXPECT_GT(most, 1.0);
    EXPECT_LT(most, 65535.0 / 5000.0);
  }
}

}  // namespace
}  // namespace hmcdyn::slam
