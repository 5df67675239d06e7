// SPDX-License-Identifier: BSD-3-Clause
// The motion mask at 640x480 against what one would write with OpenCV alone: warp one earlier depth
// image into the present view, compare, clean up by morphology, keep large components. That knows
// one earlier frame, no memory and no kind; it is the least that gives a mask. N is pixels. "iou"
// is of moving pixels with the truth, over a run of frames.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
  cv::Mat moving;  ///< The truth: 255 on a board.
};

/// A wall at 3 m, a floor, and two boards of a person's size at 1.5 and 2 m that go to and fro
/// before a camera that does, too; noise and holes as of a depth camera.
Frame makeFrame(std::size_t index, cv::RNG& random) {
  const double t = static_cast<double>(index) / 30.0;
  Frame frame{t, 0.1 * std::sin(t), cv::Mat(kHeight, kWidth, CV_32FC1),
              cv::Mat(kHeight, kWidth, CV_8UC1), cv::Mat::zeros(kHeight, kWidth, CV_8UC1)};
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
          frame.moving.at<std::uint8_t>(v, u) = 255;
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

/// Intersection over union of moving pixels, after the first frames.
template <typename MaskOf>
double meanIou(MaskOf&& mask_of) {
  constexpr std::size_t kFirst = 30;
  constexpr std::size_t kLast = 130;
  double sum = 0.0;
  for (std::size_t k = 0; k < kLast; ++k) {
    const cv::Mat moving = mask_of(k) == 255;
    const cv::Mat& truth = frames()[k].moving;
    if (k >= kFirst) {
      sum +=
          cv::countNonZero(moving & truth) / static_cast<double>(cv::countNonZero(moving | truth));
    }
  }
  return sum / static_cast<double>(kLast - kFirst);
}

const cv::Mat& update(hmcdyn::MotionMaskEstimator& estimator, std::size_t k) {
  const Frame& frame = frames()[k % kFrames];
  hmcdyn::MotionMaskFrame input;
  // the stamps go on where the images start again
  input.timestamp = static_cast<double>(k) / 30.0;
  input.depth = frame.depth;
  input.gray = frame.gray;
  input.camera_from_world.matrix(0, 3) = -frame.camera_x;
  return estimator.update(input).label;
}

void ours(benchmark::State& state) {
  cv::setNumThreads(1);
  hmcdyn::MotionMaskEstimator estimator(kCamera);
  std::size_t k = 0;
  while (k < kFrames) {
    update(estimator, k++);  // memory is full then
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(update(estimator, k++).data);
  }
  hmcdyn::MotionMaskEstimator anew(kCamera);
  state.counters["iou"] = meanIou([&](std::size_t frame) { return update(anew, frame); });
}
BENCHMARK(ours)->Name("motion_mask/307200/hmcdyn")->Unit(benchmark::kMillisecond);

const Frame& before(std::size_t k) { return frames()[(k + kFrames - 6) % kFrames]; }

/// An earlier depth as it would be measured from the present camera: by remap, and the depth that
/// the present surfaces have there.
struct Warped {
  cv::Mat earlier;
  cv::Mat expected;
};

/// For any motion of the camera: points, a rigid transform, a projection.
class AnyMotion {
 public:
  AnyMotion() : rays_(kHeight, kWidth, CV_32FC3) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        rays_.at<cv::Vec3f>(v, u) = {static_cast<float>((u - kCamera.cx) / kCamera.fx),
                                     static_cast<float>((v - kCamera.cy) / kCamera.fy), 1.0f};
      }
    }
  }
  Warped operator()(std::size_t k) {
    const Frame& now = frames()[k % kFrames];
    cv::merge(std::vector<cv::Mat>{now.depth, now.depth, now.depth}, depths_);
    cv::multiply(rays_, depths_, points_);
    const cv::Matx34d earlier_from_now(1, 0, 0, now.camera_x - before(k).camera_x,  //
                                       0, 1, 0, 0,                                  //
                                       0, 0, 1, 0);
    cv::transform(points_, points_, earlier_from_now);
    cv::split(points_, parts_);
    cv::divide(parts_[0], parts_[2], u_, kCamera.fx);
    cv::divide(parts_[1], parts_[2], v_, kCamera.fy);
    u_ += kCamera.cx;
    v_ += kCamera.cy;
    Warped warped;
    cv::remap(before(k).depth, warped.earlier, u_, v_, cv::INTER_NEAREST);
    warped.expected = parts_[2];
    return warped;
  }

 private:
  cv::Mat rays_;
  cv::Mat depths_;
  cv::Mat points_;
  std::vector<cv::Mat> parts_;
  cv::Mat u_;
  cv::Mat v_;
};

/// For a camera that is known to move sideways only, as this one does.
class SidewaysOnly {
 public:
  SidewaysOnly() : columns_(kHeight, kWidth, CV_32FC1), rows_(kHeight, kWidth, CV_32FC1) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        columns_.at<float>(v, u) = static_cast<float>(u);
        rows_.at<float>(v, u) = static_cast<float>(v);
      }
    }
  }
  Warped operator()(std::size_t k) {
    const Frame& now = frames()[k % kFrames];
    cv::divide(kCamera.fx * (now.camera_x - before(k).camera_x), now.depth, u_);
    u_ += columns_;
    Warped warped;
    cv::remap(before(k).depth, warped.earlier, u_, rows_, cv::INTER_NEAREST);
    warped.expected = now.depth;
    return warped;
  }

 private:
  cv::Mat columns_;
  cv::Mat rows_;
  cv::Mat u_;
};

/// Thresholds by depth noise, closes, opens, and keeps large components.
cv::Mat moving(const Warped& warped) {
  static const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {7, 7});
  cv::Mat tolerance;
  cv::multiply(warped.expected, warped.expected, tolerance, 0.016);
  cv::Mat mask = (warped.earlier - warped.expected > tolerance + 0.02) & (warped.expected > 0) &
                 (warped.earlier > 0);
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, kernel);  // first: depth has holes
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, kernel);
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
  return mask;
}

template <typename Warp>
void openCv(benchmark::State& state) {
  cv::setNumThreads(1);
  Warp warp;
  std::size_t k = 0;
  benchmark::DoNotOptimize(moving(warp(k++)).data);  // buffers are there then
  for (auto _ : state) {
    benchmark::DoNotOptimize(moving(warp(k++)).data);
  }
  state.counters["iou"] = meanIou([&](std::size_t frame) { return moving(warp(frame)); });
}
BENCHMARK_TEMPLATE(openCv, AnyMotion)
    ->Name("motion_mask/307200/opencv_warp")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(openCv, SidewaysOnly)
    ->Name("motion_mask/307200/opencv_sideways")
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
