// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/live_source.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/videoio/registry.hpp>

#include "input/dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

constexpr int kWidth = 8;
constexpr int kHeight = 6;

/// A camera that hands out these images, and is unplugged then.
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

CameraImages imagesAt(double timestamp) {
  CameraImages images;
  images.timestamp = timestamp;
  images.color = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(10, 20, 30));
  images.depth = cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1500));
  return images;
}

class Live : public testing::Test {
 protected:
  LiveSource open(std::vector<CameraImages> images, const LiveSourceOptions& options = {}) {
    CameraCalibration calibration;
    calibration.width = kWidth;
    calibration.height = kHeight;
    return {std::make_unique<FakeCamera>(std::move(images)), calibration,
            [this](const std::string& line) { reports_.push_back(line); }, options};
  }
  static std::vector<std::size_t> indices(LiveSource& source) {
    std::vector<std::size_t> all;
    while (const auto frame = source.next()) {
      all.push_back(frame->index);
    }
    return all;
  }

  std::vector<std::string> reports_;
};

TEST_F(Live, GivesColourGrayAndMetres) {
  LiveSource source = open({imagesAt(7.5)});
  const RgbdFrame frame = source.next().value();
  EXPECT_EQ(frame.index, 0u);
  EXPECT_EQ(frame.timestamp, 7.5);
  EXPECT_EQ(frame.bgr.type(), CV_8UC3);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(2, 3), cv::Vec3b(10, 20, 30));
  // Rec. 601: 0.114 * 10 + 0.587 * 20 + 0.299 * 30 = 21.85
  EXPECT_EQ(frame.gray.at<std::uint8_t>(2, 3), 22);
  EXPECT_EQ(frame.depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(2, 3), 1.5f);
  EXPECT_FALSE(source.expectedFrames().has_value());
  EXPECT_EQ(source.name(), "fake camera");
}

TEST_F(Live, ACopyIsHandedOutSinceTheCameraReusesItsImages) {
  CameraImages images = imagesAt(1.0);
  cv::Mat buffer = images.color;
  LiveSource source = open({images});
  const RgbdFrame frame = source.next().value();
  buffer.setTo(0);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
}

TEST_F(Live, TakesGrayImages) {
  CameraImages images = imagesAt(1.0);
  images.color = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(77));
  LiveSource source = open({images});
  const RgbdFrame frame = source.next().value();
  EXPECT_EQ(frame.gray.at<std::uint8_t>(0, 0), 77);
  EXPECT_EQ(frame.bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(77, 77, 77));
}

TEST_F(Live, FloatDepthThatIsNoneBecomesZero) {
  CameraImages images = imagesAt(1.0);
  images.depth = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(2000.0));
  images.depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  images.depth.at<float>(0, 1) = -1.0f;
  images.depth.at<float>(0, 2) = std::numeric_limits<float>::infinity();
  LiveSource source = open({images});
  const cv::Mat depth = source.next()->depth;
  EXPECT_EQ(depth.at<float>(0, 0), 0.0f);
  EXPECT_EQ(depth.at<float>(0, 1), 0.0f);
  EXPECT_EQ(depth.at<float>(0, 2), 0.0f);
  EXPECT_FLOAT_EQ(depth.at<float>(0, 3), 2.0f);
}

TEST_F(Live, UnpluggedInTheMiddleSaysSoAndEnds) {
  LiveSource source = open({imagesAt(1.0), imagesAt(2.0)});
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(mentions(source.failure(), {"fake camera", "after 2 frames", "unplugged"}));
  EXPECT_EQ(reports_, std::vector<std::string>{source.failure()});
  EXPECT_FALSE(source.next().has_value());  // it stays so, without a second report
  EXPECT_EQ(reports_.size(), 1u);
}

TEST_F(Live, FramesWithoutDepthAreDeliveredCountedAndReportedOncePerGap) {
  std::vector<CameraImages> images;
  images.reserve(6);
  for (int k = 0; k < 6; ++k) {
    images.push_back(imagesAt(k));
  }
  images[1].depth.release();                                    // the driver gave none
  images[2].depth = cv::Mat::zeros(kHeight, kWidth, CV_16UC1);  // the sensor saw nothing
  images[4].depth.release();
  LiveSource source = open(std::move(images));
  source.next();
  const RgbdFrame blind = source.next().value();
  EXPECT_EQ(blind.depth.size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(blind.depth.type(), CV_32FC1);
  EXPECT_EQ(cv::countNonZero(blind.depth), 0);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{2, 3, 4, 5}));
  EXPECT_EQ(source.counts().without_depth, 3u);
  EXPECT_EQ(source.counts().unreadable, 0u);
  ASSERT_EQ(reports_.size(), 3u);  // two gaps and the end
  EXPECT_TRUE(mentions(reports_[0], {"no depth", "frame 1"}));
  EXPECT_TRUE(mentions(reports_[1], {"no depth", "frame 4"}));
}

TEST_F(Live, LeavesOutWhatCannotBeUsedAndSaysWhy) {
  const std::vector<std::pair<CameraImages, std::vector<std::string>>> cases = [] {
    std::vector<std::pair<CameraImages, std::vector<std::string>>> all;
    CameraImages images = imagesAt(2.0);
    images.color = cv::Mat(4, 3, CV_8UC3);
    all.emplace_back(images, std::vector<std::string>{"3 x 4", "calibration says 8 x 6"});
    images = imagesAt(2.0);
    images.depth = cv::Mat(4, 3, CV_16UC1);
    all.emplace_back(images, std::vector<std::string>{"3 x 4", "registered"});
    images = imagesAt(2.0);
    images.color.release();
    all.emplace_back(images, std::vector<std::string>{"no colour image"});
    images = imagesAt(2.0);
    images.color = cv::Mat(kHeight, kWidth, CV_16UC3);
    all.emplace_back(images, std::vector<std::string>{"CV_16UC3", "CV_8UC3"});
    images = imagesAt(2.0);
    images.depth = cv::Mat(kHeight, kWidth, CV_8UC1);
    all.emplace_back(images, std::vector<std::string>{"depth", "CV_8UC1", "CV_16UC1"});
    all.emplace_back(imagesAt(1.0), std::vector<std::string>{"1.000000", "not after"});
    all.emplace_back(imagesAt(std::nan("")), std::vector<std::string>{"time stamp"});
    return all;
  }();
  for (const auto& [bad, parts] : cases) {
    reports_.clear();
    LiveSource source = open({imagesAt(1.0), bad, imagesAt(3.0)});
    EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(source.counts().taken_up, 3u);
    EXPECT_EQ(source.counts().unreadable, 1u);
    ASSERT_EQ(reports_.size(), 2u);
    for (const std::string& part : parts) {
      EXPECT_TRUE(mentions(reports_[0], {"frame 1 is left out", part}));
    }
  }
}

TEST_F(Live, ACameraOfAnotherSizeEndsTheRunWithOneReportOfTheFrames) {
  std::vector<CameraImages> images(9, imagesAt(1.0));
  for (CameraImages& wrong : images) {
    wrong.color = cv::Mat(4, 3, CV_8UC3);
  }
  LiveSourceOptions options;
  options.max_unusable = 5;
  LiveSource source = open(std::move(images), options);
  EXPECT_FALSE(source.next().has_value());
  EXPECT_EQ(source.counts().taken_up, 5u);
  EXPECT_TRUE(mentions(source.failure(), {"5 frames in a row", "calibration says 8 x 6"}));
  EXPECT_EQ(reports_.size(), 2u);
}

TEST_F(Live, GoodFramesBetweenBadOnesKeepItGoing) {
  std::vector<CameraImages> images;
  for (int k = 0; k < 12; ++k) {
    images.push_back(imagesAt(k));
    if (k % 3 != 2) {
      images.back().color.release();
    }
  }
  LiveSourceOptions options;
  options.max_unusable = 3;
  LiveSource source = open(std::move(images), options);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{2, 5, 8, 11}));
}

TEST_F(Live, RefusesWhatCannotBe) {
  LiveSourceOptions none;
  none.max_unusable = 0;
  EXPECT_THROW(open({}, none), std::invalid_argument);
  EXPECT_THROW(LiveSource(nullptr, {}, [](const std::string&) {}), std::invalid_argument);
}

TEST(OpenDepthCamera, NamesTheBackendsWhereOneIsUnknown) {
  const std::string message = messageOf<std::invalid_argument>([] {
    openDepthCamera({"webcam", 0});
  });
  EXPECT_TRUE(mentions(message, {"webcam", "openni2", "realsense"}));
  EXPECT_THROW(openDepthCamera({"openni2", -1}), std::invalid_argument);
}

TEST(OpenDepthCamera, SaysWhatIsMissingWhereThereIsNoCamera) {
  constexpr int kNobodyHasSoMany = 97;
  const std::vector<std::pair<std::string, std::string>> titles = {{"openni2", "OpenNI2"},
                                                                   {"realsense", "RealSense"}};
  for (const auto& [backend, title] : titles) {
    const std::string message = messageOf<std::runtime_error>([name = backend] {
      openDepthCamera({name, kNobodyHasSoMany});
    });
    EXPECT_TRUE(mentions(message, {title + " camera 97"}));
    EXPECT_TRUE(mentions(message, {"built without " + title}) || mentions(message, {"plugged in"}))
        << message;
  }
}

}  // namespace
}  // namespace hmcdyn::slam
