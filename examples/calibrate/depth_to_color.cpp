// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/depth_to_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "calibrate/correction_fit.hpp"

namespace hmcdyn::calibrate {
namespace {

constexpr double kCutOff = 3.0;  // standard deviations

/// The candidates: shifts in both directions and delays, counted from 0 along each axis.
struct Grid {
  int shifts = 0;
  int delays = 0;
  double shift_step = 0.0;
  double delay_step = 0.0;

  explicit Grid(const DepthToColorOptions& o)
      : shifts(2 * cvRound(o.largest_shift / o.shift_step) + 1),
        delays(2 * cvRound(o.largest_delay / o.delay_step) + 1),
        shift_step(o.shift_step),
        delay_step(o.delay_step) {}

  std::size_t size() const { return static_cast<std::size_t>(shifts * shifts * delays); }
  std::size_t index(int x, int y, int delay) const {
    return static_cast<std::size_t>((delay * shifts + y) * shifts + x);
  }
  // Both counts are odd: the one in the middle is 0.
  double shift(int i) const { return (i - 0.5 * (shifts - 1)) * shift_step; }
  double delay(int i) const { return (i - 0.5 * (delays - 1)) * delay_step; }
};

bool hasContrast(const cv::Mat& depth, const DepthSample& s, const DepthToColorOptions& o) {
  const int x_reach = cvCeil(o.largest_shift + std::abs(s.flow_u) * o.largest_delay) + 1;
  const int y_reach = cvCeil(o.largest_shift + std::abs(s.flow_v) * o.largest_delay) + 1;
  const cv::Rect window(cvRound(s.u) - x_reach, cvRound(s.v) - y_reach, 2 * x_reach + 1,
                        2 * y_reach + 1);
  if ((window & cv::Rect(0, 0, depth.cols, depth.rows)) != window) {
    return false;
  }
  const cv::Mat part = depth(window);
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(part, &low, &high, nullptr, nullptr, part > 0.0f);
  return low > 0.0 && high - low > o.least_contrast * low;
}

/// Adds a sample's costs at all candidates. A hole says neither yes nor no: it costs as much as the
/// sample's other candidates do on average.
void addCosts(std::vector<float>& costs, const Grid& grid, const cv::Mat& depth,
              const DepthSample& s, const slam::DepthCorrection& correction, double truth_scale,
              double deviation) {
  std::vector<float> own(grid.size(), -1.0f);
  float sum = 0.0f;
  float known = 0.0f;
  for (int delay = 0; delay < grid.delays; ++delay) {
    const double time = grid.delay(delay);
    const double truth = truth_scale * (s.truth + time * s.approach);
    for (int y = 0; y < grid.shifts; ++y) {
      for (int x = 0; x < grid.shifts; ++x) {
        const double u = s.u - grid.shift(x) + time * s.flow_u;
        const double v = s.v - grid.shift(y) + time * s.flow_v;
        const auto measured = static_cast<double>(depthAt(depth, u, v));
        if (measured > 0.0) {
          const double z = corrected(correction, measured, u, v, depth.size());
          const double error = (z - truth) / (kCutOff * deviation * truth);
          float& cost = own[grid.index(x, y, delay)];
          cost = static_cast<float>(std::min(1.0, error * error));
          sum += cost;
          known += 1.0f;
        }
      }
    }
  }
  for (std::size_t i = 0; i < own.size() && known > 0.0f; ++i) {
    costs[i] += own[i] >= 0.0f ? own[i] : sum / known;
  }
}

/// Where a parabola through three values has its minimum, from the middle one (steps).
double parabola(float before, float at, float after) {
  const float bend = before - 2.0f * at + after;
  return bend > 0.0f ? std::clamp(0.5 * static_cast<double>((before - after) / bend), -0.5, 0.5)
                     : 0.0;
}

struct Minimum {
  std::array<double, 3> value{};  // shift_u, shift_v (px), delay (s)
  std::array<bool, 3> at_border{};
};

Minimum minimumOf(const std::vector<float>& costs, const Grid& grid) {
  const auto best = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  const int x = best % grid.shifts;
  const int y = best / grid.shifts % grid.shifts;
  const int delay = best / (grid.shifts * grid.shifts);
  const auto refined = [&](int at, int count, auto cost) {
    const bool border = at == 0 || at == count - 1;
    return std::make_pair(border ? 0.0 : parabola(cost(at - 1), cost(at), cost(at + 1)), border);
  };
  const auto along_x =
      refined(x, grid.shifts, [&](int i) { return costs[grid.index(i, y, delay)]; });
  const auto along_y =
      refined(y, grid.shifts, [&](int i) { return costs[grid.index(x, i, delay)]; });
  const auto along_time =
      refined(delay, grid.delays, [&](int i) { return costs[grid.index(x, y, i)]; });
  return {{grid.shift(x) + along_x.first * grid.shift_step,
           grid.shift(y) + along_y.first * grid.shift_step,
           grid.delay(delay) + along_time.first * grid.delay_step},
          {along_x.second, along_y.second, along_time.second}};
}

std::array<double, 3> bootstrapDeviations(const std::vector<std::vector<float>>& by_track,
                                          const Grid& grid, const DepthToColorOptions& options) {
  std::mt19937_64 random(options.seed);
  std::array<double, 3> sum{};
  std::array<double, 3> squares{};
  for (int i = 0; i < options.resamplings; ++i) {
    std::vector<float> costs(grid.size(), 0.0f);
    for (std::size_t k = 0; k < by_track.size(); ++k) {
      const std::vector<float>& drawn = by_track[random() % by_track.size()];
      std::transform(costs.begin(), costs.end(), drawn.begin(), costs.begin(), std::plus<>());
    }
    const Minimum minimum = minimumOf(costs, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sum[axis] += minimum.value[axis];
      squares[axis] += minimum.value[axis] * minimum.value[axis];
    }
  }
  std::array<double, 3> deviations{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double mean = sum[axis] / options.resamplings;
    deviations[axis] = std::sqrt(std::max(0.0, squares[axis] / options.resamplings - mean * mean));
  }
  return deviations;
}

}  // namespace

DepthToColor depthToColor(const std::vector<CalibrationImage>& images,
                          const std::vector<DepthSample>& samples,
                          const slam::DepthCorrection& correction, double truth_scale,
                          double deviation, const DepthToColorOptions& options) {
  const Grid grid(options);
  DepthToColor result;
  std::vector<std::vector<float>> by_track;
  int track = -1;
  for (const DepthSample& s : samples) {
    const cv::Mat& depth = images[static_cast<std::size_t>(s.image)].depth;
    if (!hasContrast(depth, s, options)) {
      continue;
    }
    if (s.track != track) {
      track = s.track;
      by_track.emplace_back(grid.size(), 0.0f);
    }
    ++result.samples;
    addCosts(by_track.back(), grid, depth, s, correction, truth_scale, deviation);
  }
  if (result.samples < options.least_samples) {
    return result;
  }
  std::vector<float> costs(grid.size(), 0.0f);
  for (const auto& of_track : by_track) {
    std::transform(costs.begin(), costs.end(), of_track.begin(), costs.begin(), std::plus<>());
  }
  const Minimum minimum = minimumOf(costs, grid);
  const std::array<double, 3> deviations = bootstrapDeviations(by_track, grid, options);
  const auto estimate = [&](std::size_t axis, double largest) {
    return Estimate{minimum.value[axis], deviations[axis],
                    !minimum.at_border[axis] && deviations[axis] <= largest};
  };
  result.shift_u = estimate(0, options.shift_deviation);
  result.shift_v = estimate(1, options.shift_deviation);
  result.delay = estimate(2, options.delay_deviation);
  return result;
}

}  // namespace hmcdyn::calibrate
