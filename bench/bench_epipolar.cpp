// SPDX-License-Identifier: BSD-3-Clause
// Epipolar distances of 1000 points (eq. 3-4) against the loop that dynamic SLAM systems have: one
// cv::Point2f after the other, in double. 256 inputs in rotation.
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <benchmark/benchmark.h>
#include <opencv2/core/types.hpp>

#include <hmcdyn/steps/epipolar.hpp>

namespace {

constexpr std::size_t kInputs = 256;
constexpr std::size_t kPoints = 1000;

struct Input {
  Eigen::Matrix3d fundamental = Eigen::Matrix3d::Random();
  std::vector<float> u1, v1, u2, v2;
  std::vector<cv::Point2f> earlier, current;
};

std::vector<Input> makeInputs() {
  std::mt19937 random(1);
  const auto pixel = [&](float size) {
    return size * static_cast<float>(random()) / 4294967295.0f;
  };
  std::vector<Input> inputs(kInputs);
  for (Input& input : inputs) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      input.earlier.emplace_back(pixel(640.0f), pixel(480.0f));
      input.current.emplace_back(pixel(640.0f), pixel(480.0f));
      input.u1.push_back(input.earlier.back().x);
      input.v1.push_back(input.earlier.back().y);
      input.u2.push_back(input.current.back().x);
      input.v2.push_back(input.current.back().y);
    }
  }
  return inputs;
}

void vectorised(benchmark::State& state) {
  const std::vector<Input> inputs = makeInputs();
  std::vector<float> distance;
  std::size_t k = 0;
  for (auto _ : state) {
    const Input& input = inputs[k++ % kInputs];
    distance = hmcdyn::epipolarDistances(
        input.fundamental, {input.u1, input.v1, input.u2, input.v2}, std::move(distance));
    benchmark::DoNotOptimize(distance.data());
  }
}
BENCHMARK(vectorised)->Name("epipolar/1000/hmcdyn");

void scalarLoop(benchmark::State& state) {
  const std::vector<Input> inputs = makeInputs();
  std::vector<double> distance(kPoints);
  std::size_t k = 0;
  for (auto _ : state) {
    const Input& input = inputs[k++ % kInputs];
    const Eigen::Matrix3d& f = input.fundamental;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const cv::Point2f& p = input.earlier[i];
      const cv::Point2f& q = input.current[i];
      const double x = f(0, 0) * p.x + f(0, 1) * p.y + f(0, 2);
      const double y = f(1, 0) * p.x + f(1, 1) * p.y + f(1, 2);
      const double z = f(2, 0) * p.x + f(2, 1) * p.y + f(2, 2);
      distance[i] = std::abs(x * q.x + y * q.y + z) / std::sqrt(x * x + y * y);
    }
    benchmark::DoNotOptimize(distance.data());
  }
}
BENCHMARK(scalarLoop)->Name("epipolar/1000/scalar_loop");

}  // namespace
