// SPDX-License-Identifier: BSD-3-Clause
// The motion mask at 640x480 against what one would write with OpenCV alone: warp one earlier depth
// image into the present view, compare, clean up by morphology, keep large components. That knows
// one earlier frame, no memory and no kind; it is the least that gives a mask.
#include <cmath>
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <hmcdyn/motion_mask.hpp>

namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr std::size_t kFrames = 256;  // different inputs in rotation: 8.5 s of video
constexpr hmcdyn::PinholeCamera kCamera{525.0, 525.0, 319.5, 239.5};

struct Frame {
  double timestamp;
  double camera_x;
  cv::Mat depth;
  cv::Mat gray;
};

/// A wall at 3 m, a floor, and two boards of a person's size at 1.5 and 2 m that go to and fro
/// before a camera that does, too; noise and holes as of a depth camera.
Frame makeFrame(std::size_t index, cv::RNG& random) {
  const double t = static_cast<double>(index) / 30.0;
  Frame frame{t, 0.1 * std::sin(t), cv::Mat(kHeight, kWidth, CV_32FC1),
              cv::Mat(kHeight, kWidth, CV_8UC1)};
  const double board[] = {0.6 * std::sin(1.3 * t) - 0.4, 0.7 * std::cos(0.9 * t)};
  const double board_z[] = {1.5, 2.0};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double x = (u - kCamera.cx) / kCamera.fx;
      const double y = (v - kCamera.cy) / kCamera.fy;
      double z = y > 0.3 ? std::min(3.0, 0.9 / y) : 3.0;
      double shift = 0.0;
      for (int k = 1; k >= 0; --k) {
        const double beside = frame.camera_x + x * board_z[k] - board[k];
        if (std::abs(beside) < 0.25 && y * board_z[k] > -0.5) {
          z = board_z[k];
          shift = board[k];
        }
      }
      frame.gray.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(
          128 + 60 * std::sin(40 * (frame.camera_x + x * z - shift)) * std::cos(35 * y * z));
      const double noisy = z + random.gaussian(0.001 + 0.0014 * z * z);
      frame.depth.at<float>(v, u) = random.uniform(0, 100) < 3 ? 0.0f : static_cast<float>(noisy);
    }
  }
  return frame;
}

const std::vector<Frame>& frames() {
  static const std::vector<Frame> all = [] {
    cv::RNG random(1);
    std::vector<Frame> made;
    for (std::size_t k = 0; k < kFrames; ++k) {
      made.push_back(makeFrame(k, random));
    }
    return made;
  }();
  return all;
}

void ours(benchmark::State& state) {
  cv::setNumThreads(1);
  hmcdyn::MotionMaskEstimator estimator(kCamera);
  std::size_t k = 0;
  for (auto _ : state) {
    const Frame& frame = frames()[k % kFrames];
    hmcdyn::MotionMaskFrame input;
    // the stamps go on where the images start again
    input.timestamp = static_cast<double>(k) / 30.0;
    input.depth = frame.depth;
    input.gray = frame.gray;
    input.camera_from_world.matrix(0, 3) = -frame.camera_x;
    benchmark::DoNotOptimize(estimator.update(input).label.data);
    ++k;
  }
}
BENCHMARK(ours)->Unit(benchmark::kMillisecond);

/// Present pixels in the earlier camera, by the motion: maps for cv::remap, and the depth there.
struct Warp {
  cv::Mat u{kHeight, kWidth, CV_32FC1};
  cv::Mat v{kHeight, kWidth, CV_32FC1};
};

void plainOpenCv(benchmark::State& state) {
  cv::setNumThreads(1);
  Warp warp;
  cv::Mat rays(kHeight, kWidth, CV_32FC1);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      rays.at<float>(v, u) = static_cast<float>(u);
      warp.v.at<float>(v, u) = static_cast<float>(v);  // the camera moves along x only
    }
  }
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {7, 7});
  std::size_t k = 0;
  for (auto _ : state) {
    const Frame& now = frames()[k % kFrames];
    const Frame& before = frames()[(k + kFrames - 6) % kFrames];
    cv::Mat inverse;
    cv::divide(kCamera.fx * (now.camera_x - before.camera_x), now.depth, inverse);
    warp.u = rays + inverse;
    cv::Mat there;
    cv::remap(before.depth, there, warp.u, warp.v, cv::INTER_NEAREST);
    cv::Mat tolerance;
    cv::multiply(now.depth, now.depth, tolerance, 0.016);
    cv::Mat mask = (there - now.depth > tolerance + 0.02) & (now.depth > 0) & (there > 0);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, kernel);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, kernel);
    cv::Mat labels;
    cv::Mat statistics;
    cv::Mat centroids;
    const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids, 4);
    std::vector<std::uint8_t> keep(static_cast<std::size_t>(count), 0);
    for (int c = 1; c < count; ++c) {
      keep[static_cast<std::size_t>(c)] =
          statistics.at<int>(c, cv::CC_STAT_AREA) > 0.003 * kWidth * kHeight ? 255 : 0;
    }
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        mask.at<std::uint8_t>(v, u) = keep[static_cast<std::size_t>(labels.at<int>(v, u))];
      }
    }
    benchmark::DoNotOptimize(mask.data);
    ++k;
  }
}
BENCHMARK(plainOpenCv)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
