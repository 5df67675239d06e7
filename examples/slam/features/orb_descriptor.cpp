// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_descriptor.hpp"

#include <cmath>
#include <cstddef>

#include <opencv2/core/hal/intrin.hpp>

namespace hmcdyn::slam {
namespace {

constexpr int kCentroidRow = 2 * kCentroidRadius + 2;  // a multiple of 8 for the vector units

/// Columns of the disc: u inside, 0 outside; and 1 inside, 0 outside.
struct Disc {
  std::array<std::array<std::int16_t, kCentroidRow>, 2 * kCentroidRadius + 1> column{};
  std::array<std::array<std::int16_t, kCentroidRow>, 2 * kCentroidRadius + 1> inside{};
};

constexpr Disc makeDisc() {
  Disc disc{};
  for (int v = -kCentroidRadius; v <= kCentroidRadius; ++v) {
    for (int u = -kCentroidRadius; u <= kCentroidRadius; ++u) {
      if (u * u + v * v <= kCentroidRadius * kCentroidRadius) {
        const auto row = static_cast<std::size_t>(v + kCentroidRadius);
        const auto i = static_cast<std::size_t>(u + kCentroidRadius);
        disc.column[row][i] = static_cast<std::int16_t>(u);
        disc.inside[row][i] = 1;
      }
    }
  }
  return disc;
}

constexpr Disc kDisc = makeDisc();

/// To the nearest whole number, for |value| < 2^22, in a form that compilers vectorise.
float roundSmall(float value) {
  constexpr float kShift = 12582912.0f;  // 1.5 * 2^23: no bits are left behind the point
  return (value + kShift) - kShift;
}

}  // namespace

cv::Point2f centroidDirection(const cv::Mat& image, int x, int y) {
  int m10 = 0;
  int m01 = 0;
  for (int v = -kCentroidRadius; v <= kCentroidRadius; ++v) {
    const auto& column = kDisc.column[static_cast<std::size_t>(v + kCentroidRadius)];
    const auto& inside = kDisc.inside[static_cast<std::size_t>(v + kCentroidRadius)];
    const uchar* pixels = image.ptr<uchar>(y + v) + x - kCentroidRadius;
    int sum = 0;
    for (std::size_t i = 0; i < kCentroidRow; ++i) {
      const auto pixel = static_cast<std::int16_t>(pixels[i]);
      m10 += pixel * column[i];
      sum += pixel * inside[i];
    }
    m01 += v * sum;
  }
  if (m10 == 0 && m01 == 0) {
    return {1.0f, 0.0f};
  }
  const double norm = std::hypot(m10, m01);
  return {static_cast<float>(m10 / norm), static_cast<float>(m01 / norm)};
}

OrbDescriptor describe(const cv::Mat& smooth, int x, int y, cv::Point2f direction,
                       const OrbPattern& pattern) {
  const auto step = static_cast<float>(smooth.step);
  std::array<int, 2 * kDescriptorBits> offsets{};
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const float column = roundSmall(pattern.x[i] * direction.x - pattern.y[i] * direction.y);
    const float row = roundSmall(pattern.x[i] * direction.y + pattern.y[i] * direction.x);
    offsets[i] = static_cast<int>(row * step + column);
  }
  const uchar* centre = smooth.ptr<uchar>(y) + x;
  std::array<uchar, 2 * kDescriptorBits> samples{};
#pragma GCC unroll 8
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    samples[i] = centre[offsets[i]];
  }
  OrbDescriptor descriptor{};
  constexpr auto kLanes = static_cast<std::size_t>(cv::v_uint8x16::nlanes);
  for (std::size_t i = 0; i < kDescriptorBits; i += kLanes) {
    const cv::v_uint8x16 first = cv::v_load(samples.data() + i);
    const cv::v_uint8x16 second = cv::v_load(samples.data() + i + kDescriptorBits);
    const int bits = cv::v_signmask(first < second);
    descriptor[i / 8] = static_cast<std::uint8_t>(bits & 0xff);
    descriptor[i / 8 + 1] = static_cast<std::uint8_t>(bits >> 8);
  }
  return descriptor;
}

}  // namespace hmcdyn::slam
