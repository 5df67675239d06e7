// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::synthesize {

/// Blue, green and red of a pixel in the lower three bytes.
using PackedColor = std::uint32_t;

/// A picture that repeats in both directions, with a pyramid of halved copies: the renderer reads
/// the copy whose texels are about as large as a pixel, so that far surfaces do not flicker.
class Texture {
 public:
  Texture() = default;
  /// @param picture 8-bit BGR, any size; resampled to powers of two of at most `max_size` (px).
  explicit Texture(const cv::Mat& picture, int max_size = 2048);

  int width() const { return levels_.empty() ? 0 : levels_.front().width; }
  int height() const { return levels_.empty() ? 0 : levels_.front().height; }
  int levelCount() const { return static_cast<int>(levels_.size()); }

  /// Bilinear sample. (0, 0) is the picture's upper left corner, (1, 1) the lower right one.
  PackedColor sample(float u, float v, int level) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const float x = u * static_cast<float>(l.width) - 0.5f;
    const float y = v * static_cast<float>(l.height) - 0.5f;
    const int x_floor = static_cast<int>(x) - (x < 0.0f ? 1 : 0);
    const int y_floor = static_cast<int>(y) - (y < 0.0f ? 1 : 0);
    const auto wx = static_cast<std::uint32_t>((x - static_cast<float>(x_floor)) * 16.0f);
    const auto wy = static_cast<std::uint32_t>((y - static_cast<float>(y_floor)) * 16.0f);
    const int x0 = x_floor & (l.width - 1);
    const int x1 = (x_floor + 1) & (l.width - 1);
    const PackedColor* texels = texels_.data() + l.start;
    const PackedColor* row0 = texels + ((y_floor & (l.height - 1)) << l.width_bits);
    const PackedColor* row1 = texels + (((y_floor + 1) & (l.height - 1)) << l.width_bits);
    const std::uint32_t w11 = wx * wy;
    const std::uint32_t w01 = wx * 16U - w11;
    const std::uint32_t w10 = wy * 16U - w11;
    const std::uint32_t w00 = 256U - w11 - w01 - w10;
    return blend(row0[x0], row0[x1], row1[x0], row1[x1], w00, w01, w10, w11);
  }

 private:
  struct Level {
    std::size_t start = 0;
    int width = 0;
    int height = 0;
    int width_bits = 0;
  };

  /// Two channels in one multiplication each; the weights add up to 256.
  static PackedColor blend(PackedColor a, PackedColor b, PackedColor c, PackedColor d,
                           std::uint32_t wa, std::uint32_t wb, std::uint32_t wc, std::uint32_t wd) {
    constexpr std::uint32_t kOuter = 0x00ff00ffU;
    constexpr std::uint32_t kInner = 0x0000ff00U;
    const std::uint32_t outer =
        (a & kOuter) * wa + (b & kOuter) * wb + (c & kOuter) * wc + (d & kOuter) * wd + 0x00800080U;
    const std::uint32_t inner = ((a & kInner) >> 8U) * wa + ((b & kInner) >> 8U) * wb +
                                ((c & kInner) >> 8U) * wc + ((d & kInner) >> 8U) * wd + 0x80U;
    return ((outer >> 8U) & kOuter) | (inner & kInner);
  }

  std::vector<PackedColor> texels_;
  std::vector<Level> levels_;
};

/// Textures by number. Painters are collected first and run together, because painting is the
/// slowest part of building a scene and every picture is independent of the others.
class TextureLibrary {
 public:
  using Painter = std::function<cv::Mat()>;

  /// @return the texture's number.
  int add(Painter painter);
  /// Paints everything that was added. @param threads at least 1; the result does not depend on it.
  void paint(int threads, int max_size);

  const Texture& operator[](int index) const { return textures_[static_cast<std::size_t>(index)]; }
  std::size_t size() const { return painters_.size(); }

 private:
  std::vector<Painter> painters_;
  std::vector<Texture> textures_;
};

}  // namespace hmcdyn::synthesize
