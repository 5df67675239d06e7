// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/feature_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::calibrate {
namespace {

/// Random blobs, moved by a fraction of a pixel from image to image.
std::vector<cv::Mat> movedImages(int count, cv::Point2d step) {
  cv::RNG random(4);
  cv::Mat texture(320, 400, CV_8UC1);
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {0, 0}, 3.0);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i) {
    const cv::Matx23d shift(1.0, 0.0, -40.0 + i * step.x, 0.0, 1.0, -40.0 + i * step.y);
    cv::Mat image;
    cv::warpAffine(texture, image, shift, {320, 240}, cv::INTER_CUBIC);
    images.push_back(image);
  }
  return images;
}

TEST(FeatureTracks, FollowPointsToAFractionOfAPixel) {
  const cv::Point2d step(2.3, -1.4);
  const std::vector<Track> tracks = featureTracks(movedImages(6, step));
  int whole = 0;
  std::vector<double> errors;
  for (const Track& track : tracks) {
    whole += track.size() == 6 ? 1 : 0;
    for (std::size_t i = 1; i < track.size(); ++i) {
      const cv::Point2f moved = track[i].pixel - track[0].pixel;
      const int images = track[i].image - track[0].image;
      ASSERT_GT(images, 0) << "an image sees a point once";
      errors.push_back(std::hypot(static_cast<double>(moved.x) - images * step.x,
                                  static_cast<double>(moved.y) - images * step.y));
    }
  }
  EXPECT_GT(whole, 50);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);
}

TEST(FeatureTracks, PixelsAreCentredAtWholeNumbers) {
  // Given an image and the same turned by 180 degrees, a point at u is at 319 - u then. Whatever is
  // added to both, as cv::SIFT adds 0.25, shows twice in their sum.
  std::vector<cv::Mat> images = movedImages(1, {0.0, 0.0});
  images.emplace_back();
  cv::rotate(images[0], images[1], cv::ROTATE_180);
  std::vector<float> columns;
  std::vector<float> rows;
  for (const Track& track : featureTracks(images)) {
    columns.push_back(track[0].pixel.x + track[1].pixel.x - 319.0f);
    rows.push_back(track[0].pixel.y + track[1].pixel.y - 239.0f);
  }
  ASSERT_GT(columns.size(), 30U);
  std::sort(columns.begin(), columns.end());
  std::sort(rows.begin(), rows.end());
  EXPECT_NEAR(columns[columns.size() / 2], 0.0f, 0.1f);
  EXPECT_NEAR(rows[rows.size() / 2], 0.0f, 0.1f);
}

TEST(FeatureTracks, BlankImagesHaveNone) {
  const std::vector<cv::Mat> images(3, cv::Mat(240, 320, CV_8UC1, cv::Scalar(90)));
  EXPECT_TRUE(featureTracks(images).empty());
  EXPECT_TRUE(featureTracks({}).empty());
}

TEST(FeatureTracks, RefusesOptionsOutOfRange) {
  TrackOptions options;
  options.gaps = {1, 0};
  EXPECT_THROW(featureTracks({}, options), std::invalid_argument);
  options = {};
  options.least_matches = 4;
  EXPECT_THROW(featureTracks({}, options), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::calibrate
