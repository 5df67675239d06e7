// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/texture.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "synthesize/parallel.hpp"

namespace hmcdyn::synthesize {
namespace {

int powerOfTwoNear(int length, int max_size) {
  int power = 4;
  while (power * 3 / 2 < length && power < max_size) {
    power *= 2;
  }
  return power;
}

int bitsOf(int power_of_two) {
  int bits = 0;
  while ((1 << bits) < power_of_two) {
    ++bits;
  }
  return bits;
}

void append(const cv::Mat& picture, std::vector<PackedColor>& texels) {
  for (int y = 0; y < picture.rows; ++y) {
    const auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      texels.push_back(static_cast<PackedColor>(row[x][0]) |
                       static_cast<PackedColor>(row[x][1]) << 8U |
                       static_cast<PackedColor>(row[x][2]) << 16U);
    }
  }
}

}  // namespace

Texture::Texture(const cv::Mat& picture, int max_size) {
  if (picture.empty() || picture.type() != CV_8UC3) {
    throw std::invalid_argument("Texture: picture is empty or of type " +
                                std::to_string(picture.type()) + ", expected 8-bit BGR");
  }
  const cv::Size size(powerOfTwoNear(picture.cols, max_size),
                      powerOfTwoNear(picture.rows, max_size));
  cv::Mat level;
  cv::resize(picture, level, size, 0.0, 0.0,
             size.area() < picture.size().area() ? cv::INTER_AREA : cv::INTER_LINEAR);
  while (true) {
    levels_.push_back({texels_.size(), level.cols, level.rows, bitsOf(level.cols)});
    append(level, texels_);
    if (level.cols == 1 && level.rows == 1) {
      break;
    }
    cv::Mat half;
    cv::resize(level, half, {std::max(1, level.cols / 2), std::max(1, level.rows / 2)}, 0.0, 0.0,
               cv::INTER_AREA);
    level = half;
  }
}

int TextureLibrary::add(Painter painter) {
  painters_.push_back(std::move(painter));
  return static_cast<int>(painters_.size()) - 1;
}

void TextureLibrary::paint(int threads, int max_size) {
  textures_.resize(painters_.size());
  parallelFor(painters_.size(), threads,
              [&](std::size_t i) { textures_[i] = Texture(painters_[i](), max_size); });
}

}  // namespace hmcdyn::synthesize
