// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/live_source.hpp"

#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

/// Hands out what it was given, then nothing, as one that was unplugged.
class FakeCamera final : public DepthCamera {
 public:
  explicit FakeCamera(std::vector<CameraImages> images) : images_(std::move(images)) {}
  std::optional<CameraImages> read() override {
    return position_ < images_.size() ? std::optional<CameraImages>(images_[position_++])
                                      : std::nullopt;
  }
  double depthUnit() const override { return 0.001; }
  std::string name() const override { return "fake camera"; }

 private:
  std::vector<CameraImages> images_;
  std::size_t position_ = 0;
};

/// 4 x 3 pixels at 1.5 m.
CameraImages good(double timestamp) {
  return {timestamp, cv::Mat(3, 4, CV_8UC3, cv::Scalar(10, 20, 30)),
          cv::Mat(3, 4, CV_16UC1, cv::Scalar(1500))};
}

class Live : public testing::Test {
 protected:
  LiveSource source(std::vector<CameraImages> images, const LiveSourceOptions& options = {}) {
    CameraCalibration calibration;
    calibration.width = 4;
    calibration.height = 3;
    return {std::make_unique<FakeCamera>(std::move(images)), calibration,
            [this](const std::string& line) { reports_.push_back(line); }, options};
  }

  std::vector<std::string> reports_;
};

TEST_F(Live, DeliversColourGrayAndDepthInMetres) {
  LiveSource live = source({good(1.0)});
  const RgbdFrame frame = live.next().value();
  EXPECT_EQ(frame.index, 0U);
  EXPECT_DOUBLE_EQ(frame.timestamp, 1.0);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(2, 3), cv::Vec3b(10, 20, 30));
  // 0.114 * 10 + 0.587 * 20 + 0.299 * 30 = 21.85
  EXPECT_EQ(frame.gray.at<std::uint8_t>(2, 3), 22);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(2, 3), 1.5f);
  EXPECT_FALSE(live.expectedFrames().has_value());
}

TEST_F(Live, FramesAreTheirOwnAndNotTheCamerasBuffers) {
  CameraImages images = good(1.0);
  LiveSource live = source({images});
  const RgbdFrame frame = live.next().value();
  images.color.setTo(0);
  images.depth.setTo(0);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  EXPECT_FLOAT_EQ(frame.depth.at<float>(0, 0), 1.5f);
}

TEST_F(Live, UnpluggedInTheMiddleIsTheEndAndSaysSo) {
  LiveSource live = source({good(1.0), good(2.0)});
  live.next();
  EXPECT_EQ(live.next().value().index, 1U);
  EXPECT_EQ(live.failure(), "");
  EXPECT_FALSE(live.next().has_value());
  EXPECT_TRUE(hmcdyn::test::mentions(live.failure(), {"fake camera", "2 frames", "unplugged"}));
  EXPECT_FALSE(live.next().has_value());  // and it stays so
  EXPECT_EQ(reports_, std::vector<std::string>{live.failure()});
}

TEST_F(Live, WithoutDepthAFrameGoesOnAndTheFirstIsReported) {
  std::vector<CameraImages> images{good(1.0), good(2.0), good(3.0), good(4.0)};
  images[1].depth.release();
  images[2].depth.setTo(0);
  LiveSource live = source(images);
  live.next();
  const RgbdFrame none = live.next().value();
  EXPECT_EQ(none.depth.size(), none.bgr.size());
  EXPECT_EQ(cv::countNonZero(none.depth), 0);
  live.next();
  EXPECT_EQ(cv::countNonZero(live.next().value().depth), 12);
  EXPECT_EQ(live.counts().without_depth, 2U);
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"no depth", "frame 1"}));
}

TEST_F(Live, DepthThatIsNoNumberOrNegativeIsNone) {
  CameraImages images = good(1.0);
  images.depth = cv::Mat(3, 4, CV_32FC1, cv::Scalar(2000.0));
  images.depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  images.depth.at<float>(0, 1) = -5.0f;
  images.depth.at<float>(0, 2) = std::numeric_limits<float>::infinity();
  LiveSource live = source({images});
  const RgbdFrame frame = live.next().value();
  for (int column = 0; column < 3; ++column) {
    EXPECT_EQ(frame.depth.at<float>(0, column), 0.0f) << column;
  }
  EXPECT_FLOAT_EQ(frame.depth.at<float>(0, 3), 2.0f);
}

TEST_F(Live, FramesThatCannotBeUsedAreLeftOutAndTheFirstOfARowIsReported) {
  std::vector<CameraImages> images{good(1.0), good(2.0), good(3.0), good(4.0)};
  images[1].color = cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(0));
  images[2].depth = cv::Mat(6, 8, CV_16UC1, cv::Scalar(1));
  LiveSource live = source(images);
  live.next();
  EXPECT_EQ(live.next().value().index, 3U);
  EXPECT_EQ(live.counts().unreadable, 2U);
  EXPECT_EQ(live.counts().taken_up, 4U);
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"frame 1", "8 x 6", "4 x 3"}));
}

TEST_F(Live, StampsThatStandStillGoBackOrAreNoNumbersAreLeftOut) {
  LiveSource live = source(
      {good(5.0), good(5.0), good(4.0), good(std::numeric_limits<double>::quiet_NaN()), good(6.0)});
  EXPECT_DOUBLE_EQ(live.next().value().timestamp, 5.0);
  EXPECT_DOUBLE_EQ(live.next().value().timestamp, 6.0);
  EXPECT_EQ(live.counts().unreadable, 3U);
}

TEST_F(Live, ACameraOfAnotherSizeEndsAfterARow) {
  std::vector<CameraImages> images{good(1.0), good(2.0), good(3.0), good(4.0)};
  for (CameraImages& image : images) {
    image.color = cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(0));
  }
  LiveSourceOptions options;
  options.max_unusable = 3;
  LiveSource live = source(images, options);
  EXPECT_FALSE(live.next().has_value());
  EXPECT_EQ(live.counts().unreadable, 3U);
  EXPECT_TRUE(hmcdyn::test::mentions(live.failure(), {"3 frames in a row", "8 x 6"}));
}

TEST_F(Live, RefusesANullCameraAndABadOption) {
  EXPECT_THROW(LiveSource(nullptr, {}, [](const std::string&) {}), std::invalid_argument);
  LiveSourceOptions options;
  options.max_unusable = 0;
  EXPECT_THROW(source({}, options), std::invalid_argument);
}

TEST(OpenDepthCamera, RefusesAnUnknownBackendAndANegativeIndex) {
  const std::string message = hmcdyn::test::messageOf<std::invalid_argument>([] {
    openDepthCamera({"webcam", 0});
  });
  EXPECT_TRUE(hmcdyn::test::mentions(message, {"webcam", "openni2", "realsense"}));
  EXPECT_THROW(openDepthCamera({"openni2", -1}), std::invalid_argument);
}

TEST(OpenDepthCamera, AMissingCameraIsNamed) {
  // No machine has a thousand cameras: not found, or OpenCV was built without the backend.
  const std::string message = hmcdyn::test::messageOf<std::runtime_error>([] {
    openDepthCamera({"openni2", 999});
  });
  EXPECT_TRUE(hmcdyn::test::mentions(message, {"OpenNI2 camera 999"}));
}

}  // namespace
}  // namespace hmcdyn::slam
