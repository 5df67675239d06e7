// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "random.hpp"

namespace hmcdyn::test {

/// A smooth random texture that can be evaluated anywhere, so that an image shifted by a fraction
/// of a pixel is exact up to the rounding of gray values: a sum of waves of 8 to 40 pixels' length.
class Texture {
 public:
  explicit Texture(std::uint32_t seed) {
    constexpr double kTwoPi = 6.283185307179586;
    Random random(seed);
    for (Wave& wave : waves_) {
      const double frequency = kTwoPi / random.uniform(8.0, 40.0);
      const double angle = random.uniform(0.0, kTwoPi);
      wave = {frequency * std::cos(angle), frequency * std::sin(angle),
              random.uniform(0.0, kTwoPi)};
    }
  }

  /// Gray value at a pixel.
  double operator()(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      sum += std::sin(wave.along_x * x + wave.along_y * y + wave.phase);
    }
    return 128.0 + 20.0 * sum;
  }

 private:
  struct Wave {
    double along_x, along_y, phase;
  };
  std::array<Wave, 20> waves_;
};

/// 8-bit image of a function of the pixel, `gray(x, y)`.
template <class Gray>
cv::Mat drawImage(int width, int height, Gray&& gray) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(gray(static_cast<double>(x), static_cast<double>(y)));
    }
  }
  return image;
}

}  // namespace hmcdyn::test
