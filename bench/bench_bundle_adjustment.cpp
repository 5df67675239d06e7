// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment of a local and a global map, with the reduced system dense and sparse.
#include <benchmark/benchmark.h>

#include "map/bundle_scene.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam {
namespace {

void adjust(benchmark::State& state, int poses, int points, int seen_by, int max_dense_poses) {
  const BundleProblem truth = test::makeBundleScene(1, poses, points, seen_by, 1.0).truth;
  const BundleProblem problem = test::disturbed(truth, 2, 0.005, 0.02);
  BundleOptions options;
  options.max_dense_poses = max_dense_poses;
  int iterations = 0;
  for ([[maybe_unused]] auto _ : state) {
    iterations = adjustBundle(problem, options).iterations;
  }
  state.counters["iterations"] = iterations;
  state.counters["observations"] = static_cast<double>(problem.observations.size());
}

constexpr int kDense = 1000000;

BENCHMARK_CAPTURE(adjust, local_dense, 12, 1000, 6, kDense)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(adjust, local_sparse, 12, 1000, 6, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(adjust, middle_dense, 50, 5000, 8, kDense)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(adjust, middle_sparse, 50, 5000, 8, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(adjust, global_dense, 200, 20000, 8, kDense)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(adjust, global_sparse, 200, 20000, 8, 0)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hmcdyn::slam
