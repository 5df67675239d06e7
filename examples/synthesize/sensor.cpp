// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synthesize/random.hpp"

namespace hmcdyn::synthesize {
namespace {

constexpr std::size_t kNormals = std::size_t{1} << 16U;

std::uint16_t toFileDepth(double metres) {
  const double units = std::round(metres * kDepthFactor);
  return units >= 1.0 && units <= 65535.0 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

/// Largest jump of depth to the four neighbours (m): where a surface ends.
float jumpAt(const cv::Mat& depth, int u, int v) {
  const float z = depth.at<float>(v, u);
  float jump = 0.0f;
  const auto compare = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < depth.cols && y < depth.rows) {
      jump = std::max(jump, std::abs(depth.at<float>(y, x) - z));
    }
  };
  compare(u - 1, v);
  compare(u + 1, v);
  compare(u, v - 1);
  compare(u, v + 1);
  return jump;
}

}  // namespace

Sensor::Sensor(NoiseModel model, const KinectOptions& options, cv::Size size, std::uint64_t seed)
    : model_(model), options_(options), seed_(seed) {
  if (model_ == NoiseModel::kNone) {
    return;
  }
  if (model_ == NoiseModel::kKinectSystematic) {
    systematic_ = drawSystematicError(options_.systematic, size, seed);
  }
  Random random(seed, 77);
  normals_.resize(kNormals);
  for (float& normal : normals_) {
    normal = static_cast<float>(random.normal());
  }
  vignette_.create(size, CV_16UC1);
  const double half_diagonal = 0.5 * std::hypot(size.width, size.height);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double r = std::hypot(u - 0.5 * size.width, v - 0.5 * size.height) / half_diagonal;
      vignette_.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>(std::lround(256.0 * (1.0 - options_.vignetting * r * r)));
    }
  }
}

SensorFrame Sensor::measure(const RenderedFrame& frame, std::uint64_t index, double time) const {
  if (model_ != NoiseModel::kNone) {
    return {measureColor(frame.color, index, time), measureDepth(frame, index)};
  }
  SensorFrame exact{frame.color.clone(), cv::Mat(frame.depth.size(), CV_16UC1)};
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      exact.depth.at<std::uint16_t>(v, u) =
          toFileDepth(static_cast<double>(frame.depth.at<float>(v, u)));
    }
  }
  return exact;
}

cv::Mat Sensor::measureColor(const cv::Mat& color, std::uint64_t index, double time) const {
  const double phase = 6.283 * Random(seed_, 78).uniform();
  const double gain = 1.0 + options_.exposure_swing * (0.7 * std::sin(0.9 * time + phase) +
                                                       0.3 * std::sin(2.7 * time + 2.0 * phase));
  std::array<float, 256> deviation{};
  for (std::size_t level = 0; level < deviation.size(); ++level) {
    deviation[level] =
        static_cast<float>(std::sqrt(options_.read_noise * options_.read_noise +
                                     options_.shot_noise * static_cast<double>(level)));
  }
  cv::Mat result;
  cv::GaussianBlur(color, result, {3, 3}, options_.blur);
  Random random(seed_, 1000 + index);
  const auto gain_fixed = static_cast<int>(std::lround(gain * 256.0));
  for (int v = 0; v < result.rows; ++v) {
    auto* row = result.ptr<std::uint8_t>(v);
    const auto* vignette = vignette_.ptr<std::uint16_t>(v);
    auto n = static_cast<std::size_t>(random.bits());
    for (int u = 0; u < result.cols; ++u) {
      const int factor = vignette[u] * gain_fixed;
      for (int channel = 0; channel < 3; ++channel, ++n) {
        const int level = std::min(255, (row[3 * u + channel] * factor) >> 16);
        const float noisy =
            static_cast<float>(level) + 0.5f +
            deviation[static_cast<std::size_t>(level)] * normals_[n & (kNormals - 1)];
        row[3 * u + channel] = static_cast<std::uint8_t>(std::clamp(noisy, 0.0f, 255.0f));
      }
    }
  }
  return result;
}

/// Marks what the pattern projector, to the right of the infrared camera, cannot light because
/// something nearer is in the way.
cv::Mat Sensor::shadowOf(const cv::Mat& depth) const {
  cv::Mat shadow = cv::Mat::zeros(depth.size(), CV_8UC1);
  const int margin = static_cast<int>(options_.disparity_constant / options_.min_depth) + 2;
  std::vector<float> nearest(static_cast<std::size_t>(depth.cols + margin));
  const auto columnAndDisparity = [&](int u, float z) {
    const float disparity = static_cast<float>(options_.disparity_constant) / z;
    // A point appears this far to the left in the projector's view; shifted to stay positive.
    const int column = static_cast<int>(static_cast<float>(u + margin) - disparity);
    return std::make_pair(static_cast<std::size_t>(std::max(0, column)), disparity);
  };
  for (int v = 0; v < depth.rows; ++v) {
    std::fill(nearest.begin(), nearest.end(), 0.0f);
    const auto* row = depth.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (row[u] > 0.0f) {
        const auto [column, disparity] = columnAndDisparity(u, row[u]);
        nearest[column] = std::max(nearest[column], disparity);
      }
    }
    for (int u = 0; u < depth.cols; ++u) {
      if (row[u] > 0.0f) {
        const auto [column, disparity] = columnAndDisparity(u, row[u]);
        shadow.at<std::uint8_t>(v, u) = nearest[column] > disparity + 1.5f ? 1 : 0;
      }
    }
  }
  return shadow;
}

cv::Mat Sensor::measureDepth(const RenderedFrame& frame, std::uint64_t index) const {
  const KinectOptions& o = options_;
  const cv::Mat& truth = frame.depth;
  const cv::Mat shadow = shadowOf(truth);
  Random random(seed_, 5000000 + index);
  // Disparities come from windows of several pixels, so neighbours share their error.
  constexpr float kUnitVariance = 2.586f;  // makes up for the smoothing: 1 / sum of squared weights
  cv::Mat noise(truth.size(), CV_32FC1);
  auto n = static_cast<std::size_t>(random.bits());
  for (int v = 0; v < noise.rows; ++v, n += static_cast<std::size_t>(random.bits())) {
    for (int u = 0; u < noise.cols; ++u, ++n) {
      noise.at<float>(v, u) = kUnitVariance * normals_[n & (kNormals - 1)];
    }
  }
  cv::GaussianBlur(noise, noise, {3, 3}, 0.8);

  const auto shift_u = static_cast<int>(std::lround(systematic_.shift.x));
  const auto shift_v = static_cast<int>(std::lround(systematic_.shift.y));
  cv::Mat depth = cv::Mat::zeros(truth.size(), CV_16UC1);
  for (int v = 0; v < truth.rows; ++v, n += static_cast<std::size_t>(random.bits())) {
    for (int u = 0; u < truth.cols; ++u, n += 3) {
      const auto lateral = [&](double shift, std::size_t i) {
        return static_cast<int>(std::lround(
            shift + o.lateral * static_cast<double>(normals_[(n + i) & (kNormals - 1)])));
      };
      const int x = std::clamp(u + lateral(systematic_.shift.x, 0), 0, truth.cols - 1);
      const int y = std::clamp(v + lateral(systematic_.shift.y, 1), 0, truth.rows - 1);
      const auto z = static_cast<double>(truth.at<float>(y, x));
      const auto facing = static_cast<double>(frame.facing.at<float>(y, x));
      if (z < o.min_depth || z > o.max_depth || facing < o.min_facing ||
          shadow.at<std::uint8_t>(y, x) != 0) {
        continue;
      }
      const int seen_u = std::clamp(u + shift_u, 0, truth.cols - 1);
      const int seen_v = std::clamp(v + shift_v, 0, truth.rows - 1);
      const auto& c = frame.color.at<cv::Vec3b>(seen_v, seen_u);
      const double brightness = 0.3 * c[2] + 0.5 * c[1] + 0.2 * c[0];
      const auto chance = static_cast<double>(normals_[(n + 2) & (kNormals - 1)]);
      const bool at_edge = static_cast<double>(jumpAt(truth, seen_u, seen_v)) > 0.04 + 0.03 * z;
      if (brightness + 5.0 * chance < o.dark || (at_edge && chance > 0.0)) {
        continue;
      }
      const double angle = std::acos(std::min(1.0, facing));
      const double grazing = angle / (1.5708 - std::min(angle, 1.5));
      const double beyond = z - o.axial_range;
      const double deviation = o.axial_base + o.axial_growth * beyond * beyond +
                               0.0001 / std::sqrt(z) * grazing * grazing;
      const double noisy =
          std::max(0.1, systematic_.biased(z, u, v) +
                            deviation * static_cast<double>(noise.at<float>(v, u)));
      const double disparity =
          std::round(o.disparity_constant / noisy / o.disparity_step) * o.disparity_step;
      depth.at<std::uint16_t>(v, u) = toFileDepth(o.disparity_constant / disparity);
    }
  }
  return depth;
}

}  // namespace hmcdyn::synthesize
