// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>

#include "features/texture.hpp"

namespace hmcdyn::slam {
namespace {

// The circle of FAST, clockwise from the top.
const std::array<cv::Point, 16> kCircle{{{0, -3},
                                         {1, -3},
                                         {2, -2},
                                         {3, -1},
                                         {3, 0},
                                         {3, 1},
                                         {2, 2},
                                         {1, 3},
                                         {0, 3},
                                         {-1, 3},
                                         {-2, 2},
                                         {-3, 1},
                                         {-3, 0},
                                         {-3, -1},
                                         {-2, -2},
                                         {-1, -3}}};

cv::Rect inside(const cv::Mat& image, int margin) {
  return {margin, margin, image.cols - 2 * margin, image.rows - 2 * margin};
}

/// Straight from the definition: every arc of 9, every pixel.
int scoreByDefinition(const cv::Mat& image, int x, int y) {
  int best = 0;
  for (const int sign : {1, -1}) {
    for (int start = 0; start < 16; ++start) {
      int smallest = 255;
      for (int i = 0; i < 9; ++i) {
        const cv::Point p = kCircle[static_cast<std::size_t>((start + i) % 16)];
        const int difference = image.at<uchar>(y + p.y, x + p.x) - image.at<uchar>(y, x);
        smallest = std::min(smallest, sign * difference);
      }
      best = std::max(best, smallest);
    }
  }
  return best;
}

/// A grey image with an arc of `length` circle pixels brighter by `contrast` around (20, 20).
cv::Mat arcImage(int length, int contrast) {
  cv::Mat image(41, 41, CV_8U, cv::Scalar(100));
  for (int i = 0; i < length; ++i) {
    image.at<uchar>(cv::Point(20, 20) + kCircle[static_cast<std::size_t>(i + 13) % 16]) =
        static_cast<uchar>(100 + contrast);
  }
  return image;
}

TEST(FastScores, AnArcOfNineMakesACornerOfItsContrast) {
  const cv::Mat nine = arcImage(9, 50);
  EXPECT_EQ(fastScores(nine, inside(nine, 3), 20, {}).at<uchar>(20, 20), 50);
  EXPECT_EQ(fastScores(nine, inside(nine, 3), 49, {}).at<uchar>(20, 20), 50);
  EXPECT_EQ(fastScores(nine, inside(nine, 3), 50, {}).at<uchar>(20, 20), 0) << "not above";
}

TEST(FastScores, AnArcOfEightMakesNone) {
  const cv::Mat eight = arcImage(8, 50);
  EXPECT_EQ(fastScores(eight, inside(eight, 3), 7, {}).at<uchar>(20, 20), 0);
}

TEST(FastScores, DarkArcsCountLikeBrightOnes) {
  const cv::Mat dark = arcImage(9, -60);
  EXPECT_EQ(fastScores(dark, inside(dark, 3), 20, {}).at<uchar>(20, 20), 60);
}

TEST(FastScores, AgreeWithTheDefinitionEverywhere) {
  // Noise has corners of every kind, and values at both ends of the range.
  for (const cv::Size size : {cv::Size(22, 9), cv::Size(61, 47), cv::Size(80, 30)}) {
    cv::Mat image(size, CV_8U);
    cv::RNG random(11);
    random.fill(image, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(image, image, cv::Size(5, 5), 2.0);
    for (const int threshold : {1, 7, 20}) {
      const cv::Mat scores = fastScores(image, inside(image, 3), threshold, {});
      for (int y = 3; y < image.rows - 3; ++y) {
        for (int x = 3; x < image.cols - 3; ++x) {
          const int score = scoreByDefinition(image, x, y);
          ASSERT_EQ(scores.at<uchar>(y, x), score > threshold ? score : 0) << x << ", " << y;
        }
      }
    }
  }
}

TEST(FastScores, AUsedBufferDoesNotShowThrough) {
  const cv::Mat image = arcImage(9, 50);
  const cv::Mat fresh = fastScores(image, inside(image, 3), 20, {});
  const cv::Mat reused =
      fastScores(image, inside(image, 3), 20, cv::Mat(image.size(), CV_8U, cv::Scalar(255)));
  EXPECT_EQ(cv::norm(fresh(inside(image, 3)), reused(inside(image, 3)), cv::NORM_L1), 0.0);
}

TEST(LocalMaxima, APlateauCountsOnceAtItsFirstPixel) {
  cv::Mat scores(30, 40, CV_8U, cv::Scalar(0));
  scores.at<uchar>(10, 10) = 30;  // plateau of three
  scores.at<uchar>(10, 11) = 30;
  scores.at<uchar>(11, 11) = 30;
  scores.at<uchar>(20, 25) = 9;  // beside a larger one
  scores.at<uchar>(21, 26) = 12;
  const std::vector<Corner> corners = localMaxima(scores, inside(scores, 1));
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_EQ(cv::Point(corners[0].x, corners[0].y), cv::Point(10, 10));
  EXPECT_EQ(cv::Point(corners[1].x, corners[1].y), cv::Point(26, 21));
  EXPECT_EQ(corners[0].score, 30);
  EXPECT_EQ(corners[0].strength, 4 * 30 + 2 * 30 + 30);
  EXPECT_EQ(corners[1].strength, 4 * 12 + 9);
}

TEST(LocalMaxima, AreFoundOnceEachUpToTheRegionsEdges) {
  // Widths that are no multiple of a vector's: the blocks at the right end overlap.
  for (int width = 17; width < 60; ++width) {
    cv::Mat scores(9, width + 2, CV_8U, cv::Scalar(0));
    int expected = 0;
    for (int x = 1; x <= width; x += 2, ++expected) {
      scores.at<uchar>(4, x) = static_cast<uchar>(20 + x);
    }
    const std::vector<Corner> corners = localMaxima(scores, {1, 1, width, 7});
    ASSERT_EQ(static_cast<int>(corners.size()), expected) << width;
    for (int i = 0; i < expected; ++i) {
      ASSERT_EQ(corners[static_cast<std::size_t>(i)].x, 1 + 2 * i);
    }
  }
}

TEST(LocalMaxima, HoldEveryCornerThatOpenCvFinds) {
  const cv::Mat image = test::texture({320, 240}, 3, 400);
  const std::vector<Corner> corners =
      localMaxima(fastScores(image, inside(image, 3), 20, {}), inside(image, 4));
  std::vector<cv::KeyPoint> reference;
  cv::FAST(image, reference, 20, true);
  int compared = 0;
  for (const cv::KeyPoint& key_point : reference) {
    const cv::Point p(cvRound(key_point.pt.x), cvRound(key_point.pt.y));
    if (inside(image, 4).contains(p)) {
      ++compared;
      EXPECT_TRUE(std::any_of(corners.begin(), corners.end(), [&](const Corner& c) {
        // OpenCV's response is the largest threshold at which the corner still exists.
        return c.x == p.x && c.y == p.y && c.score == cvRound(key_point.response) + 1;
      })) << p;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(SubPixelOffset, FindsTheVertexOfAParaboloid) {
  for (const cv::Point2d vertex :
       {cv::Point2d(0.3, -0.2), cv::Point2d(-0.45, 0.0), cv::Point2d(0.1, 0.4)}) {
    cv::Mat scores(3, 3, CV_8U);
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        scores.at<uchar>(y + 1, x + 1) = cv::saturate_cast<uchar>(
            240.0 - 40.0 * (std::pow(x - vertex.x, 2) + std::pow(y - vertex.y, 2)));
      }
    }
    const cv::Point2f offset = subPixelOffset(scores, 1, 1);
    EXPECT_NEAR(offset.x, vertex.x, 0.01);
    EXPECT_NEAR(offset.y, vertex.y, 0.01);
  }
}

TEST(SubPixelOffset, StaysWithinHalfAPixel) {
  const cv::Mat edge = (cv::Mat_<uchar>(3, 3) << 0, 50, 50, 0, 50, 50, 0, 50, 50);
  EXPECT_FLOAT_EQ(subPixelOffset(edge, 1, 1).x, 0.5f);
  EXPECT_FLOAT_EQ(subPixelOffset(edge, 1, 1).y, 0.0f) << "no curvature, no offset";
}

}  // namespace
}  // namespace hmcdyn::slam
