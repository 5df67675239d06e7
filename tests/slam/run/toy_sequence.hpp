// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drawn_texture.hpp"

namespace hmcdyn::slam::test {

using hmcdyn::test::makeTexture;

/// A sequence in TUM format with exact truth: a camera with f = 300 px that moves to the right past
/// a wall of horizontal slabs, each at its own depth; 320x240 px, 30 frames a second.
struct ToySequence {
  int frames = 8;
  double step = 0.01;  ///< Camera's way from frame to frame (m).
  bool with_depth = true;
  std::function<double(int)> position;  ///< Camera's place at a frame (m), in place of the steps.
  /// What goes wrong at a frame: changes the colour (CV_8UC3) and depth image (CV_16U) as it likes.
  std::function<void(int, cv::Mat&, cv::Mat&)> spoil;
};

/// The time stamp of a frame (s), as it stands in the lists.
inline std::string toyStamp(int frame) { return fmt::format("{:.6f}", 1000.0 + frame / 30.0); }

inline void writeToySequence(const std::filesystem::path& folder, const ToySequence& toy = {}) {
  constexpr float kFocal = 300.0f;
  const cv::Mat texture = makeTexture({480, 240}, 5);
  std::filesystem::create_directories(folder / "rgb");
  std::filesystem::create_directories(folder / "depth");
  std::ofstream rgb(folder / "rgb.txt");
  std::ofstream depth(folder / "depth.txt");
  std::ofstream truth(folder / "groundtruth.txt");
  std::ofstream(folder / "calibration.yaml")
      << "fx: 300\nfy: 300\ncx: 159.5\ncy: 119.5\nwidth: 320\nheight: 240\ndepth_factor: 5000\n";
  for (int k = 0; k < toy.frames; ++k) {
    const double x = toy.position ? toy.position(k) : toy.step * k;
    cv::Mat image(240, 320, CV_8U);
    cv::Mat range(240, 320, CV_16U);
    for (int slab = 0; slab < 4; ++slab) {
      const float z = 1.5f + 0.5f * static_cast<float>(slab);
      const cv::Rect rows(0, 60 * slab, 320, 60);
      const cv::Matx23f shift(1, 0, -40.0f - kFocal * static_cast<float>(x) / z, 0, 1, 0);
      cv::Mat moved;
      cv::warpAffine(texture, moved, shift, image.size(), cv::INTER_CUBIC);
      moved(rows).copyTo(image(rows));
      range(rows).setTo(toy.with_depth ? z * 5000.0f : 0.0f);
    }
    const std::string stamp = toyStamp(k);
    cv::Mat color;
    cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
    if (toy.spoil) {
      toy.spoil(k, color, range);
    }
    cv::imwrite((folder / "rgb" / (stamp + ".png")).string(), color);
    cv::imwrite((folder / "depth" / (stamp + ".png")).string(), range);
    rgb << fmt::format("{0} rgb/{0}.png\n", stamp);
    depth << fmt::format("{0} depth/{0}.png\n", stamp);
    truth << fmt::format("{} {:.6f} 0 0 0 0 0 1\n", stamp, x);
  }
}

}  // namespace hmcdyn::slam::test
