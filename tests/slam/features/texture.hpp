// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::test {

/// A grey image full of corners: rectangles of random size, place and brightness, smoothed a
/// little.
inline cv::Mat texture(cv::Size size, std::uint64_t seed, int rectangles = 1500) {
  cv::RNG random(seed);
  cv::Mat image(size, CV_8U, cv::Scalar(128));
  for (int i = 0; i < rectangles; ++i) {
    // Braces: in parentheses each compiler draws the four in an order of its own.
    const cv::Rect rectangle{random.uniform(-20, size.width), random.uniform(-20, size.height),
                             random.uniform(4, 60), random.uniform(4, 60)};
    cv::rectangle(image, rectangle, cv::Scalar(random.uniform(0, 256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(5, 5), 1.0);
  return image;
}

/// A grey image without flat parts: normally distributed brightness, correlated over a few pixels.
inline cv::Mat clouds(cv::Size size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat field(size, CV_32F);
  random.fill(field, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(field, field, cv::Size(0, 0), 3.0);
  cv::Mat image;
  field.convertTo(image, CV_8U, 40.0 / cv::norm(field, cv::NORM_L2) * std::sqrt(size.area()),
                  128.0);
  return image;
}

/// Sensor noise: normally distributed, standard deviation in grey levels.
inline cv::Mat withNoise(const cv::Mat& image, double deviation, std::uint64_t seed) {
  cv::Mat noise(image.size(), CV_16S);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  cv::Mat sum;
  image.convertTo(sum, CV_16S);
  sum += noise;
  sum.convertTo(sum, CV_8U);
  return sum;
}

}  // namespace hmcdyn::test
