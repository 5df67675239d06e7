// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/pictures.hpp"

#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace hmcdyn::slam {
namespace {

std::vector<std::size_t> framesOf(const PictureReel& reel) {
  std::vector<std::size_t> frames;
  for (const FramePicture& picture : reel.pictures()) {
    frames.push_back(picture.frame);
  }
  return frames;
}

TEST(PictureReel, StaysWithinItsCapacityAndEven) {
  PictureReel reel(4);
  for (std::size_t i = 0; i < 21; ++i) {
    reel.add(i, "jpeg");
  }
  // 0-3, then at 4: 0, 2, 4; 6 fits; at 8: 0, 4, 8; 12 fits; at 16: 0, 8, 16; 20 is no multiple
  // of 8.
  EXPECT_EQ(framesOf(reel), (std::vector<std::size_t>{0, 8, 16}));
  EXPECT_TRUE(reel.wants(24));
  EXPECT_FALSE(reel.wants(20));
  EXPECT_THROW(PictureReel(1), std::invalid_argument);
}

std::vector<FramePicture> everySecond(std::size_t count) {
  std::vector<FramePicture> pictures;
  for (std::size_t i = 0; i < count; ++i) {
    pictures.push_back({2 * i, "jpeg " + std::to_string(2 * i)});
  }
  return pictures;
}

TEST(ChoosePictures, HoldTheWorstFrameAndSpreadTheOthers) {
  std::vector<ReportFrame> frames(20);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].timestamp = 100.0 + 0.5 * static_cast<double>(i);
    frames[i].error = i == 7 ? 0.25 : 0.125;
  }
  // Pictures of 0, 2, ..., 18; the worst frame's nearest, of 6 and 8, is the earlier. Of the nine
  // others the middle of each half: numbers 2 and 6 of 0, 2, 4, 8, 10, 12, 14, 16, 18.
  const std::vector<ReportPicture> chosen = choosePictures(everySecond(10), frames, 3);
  ASSERT_EQ(chosen.size(), 3U);
  EXPECT_EQ(chosen[0].jpeg, "jpeg 4");
  EXPECT_EQ(chosen[1].jpeg, "jpeg 6");
  EXPECT_EQ(chosen[2].jpeg, "jpeg 14");
  EXPECT_EQ(chosen[0].caption, "Frame 4, 2.00 s, error 125.0 mm");
  EXPECT_EQ(chosen[1].caption, "Frame 6, 3.00 s, error 125.0 mm (nearest to the largest error)");
}

TEST(ChoosePictures, TakeAllWhereThereAreFewAndNoneOfNone) {
  EXPECT_EQ(choosePictures(everySecond(3), {}, 9).size(), 3U);
  EXPECT_EQ(choosePictures(everySecond(3), {}, 0).size(), 0U);
  EXPECT_EQ(choosePictures({}, std::vector<ReportFrame>(3), 9).size(), 0U);
}

TEST(EncodeJpeg, MakesWidePicturesNarrower) {
  const cv::Mat picture(100, 400, CV_8UC3, cv::Scalar(10, 200, 30));
  const std::string jpeg = encodeJpeg(picture, 200);
  const cv::Mat bytes(1, static_cast<int>(jpeg.size()), CV_8U, const_cast<char*>(jpeg.data()));
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_COLOR);
  EXPECT_EQ(decoded.size(), cv::Size(200, 50));
  EXPECT_NEAR(decoded.at<cv::Vec3b>(25, 100)[1], 200, 4);
  EXPECT_THROW(encodeJpeg(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(encodeJpeg(picture, 0), std::invalid_argument);
  EXPECT_THROW(encodeJpeg(cv::Mat(4, 4, CV_8U)), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam
