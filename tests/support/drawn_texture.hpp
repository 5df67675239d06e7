// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::test {

/// Blobs of several sizes that corners are found on.
inline cv::Mat makeTexture(cv::Size size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat texture = cv::Mat::zeros(size, CV_32F);
  for (const double blur : {1.5, 3.0, 6.0}) {
    cv::Mat noise(size, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 45.0 * blur);
    cv::GaussianBlur(noise, noise, cv::Size(), blur);
    texture += noise;
  }
  cv::Mat gray;
  texture += 128.0;
  texture.convertTo(gray, CV_8U);
  return gray;
}

}  // namespace hmcdyn::test
