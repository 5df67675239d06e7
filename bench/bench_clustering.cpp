// SPDX-License-Identifier: BSD-3-Clause
// Density clustering of a box's points against what one would take instead, and against sorting and
// copying as many numbers. Each peer gets its points in its own form, ready made.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include <hmcdyn/steps/clustering.hpp>

#include "peers/nanoflann_dbscan.hpp"
#include "support/box_points.hpp"
#ifdef HMCDYN_BENCH_OPEN3D
#include "peers/open3d_dbscan.hpp"
#endif
#ifdef HMCDYN_BENCH_PCL
#include "peers/pcl_clusters.hpp"
#endif

namespace hmcdyn::bench {
namespace {

std::vector<float> scaled(const std::vector<float>& values, float scale) {
  std::vector<float> result(values);
  for (float& value : result) {
    value *= scale;
  }
  return result;
}

/// Calls `work(input)` with one input after the other; `prepare` makes a peer's form of a box.
template <class Prepare, class Work>
void rotate(benchmark::State& state, std::size_t n, Prepare&& prepare, Work&& work) {
  std::vector<decltype(prepare(BoxPoints()))> inputs;
  for (const BoxPoints& box : makeInputs(n)) {
    inputs.push_back(prepare(box));
  }
  std::size_t k = 0;
  for (auto _ : state) {
    work(inputs[k]);
    k = k + 1 < inputs.size() ? k + 1 : 0;
  }
  state.SetComplexityN(static_cast<std::int64_t>(n));
}

void clusterWithHmcdyn(benchmark::State& state, std::size_t n) {
  const ClusteringOptions options = clusteringOptionsFor(n);
  ClusteringWorkspace workspace;
  rotate(
      state, n, [](const BoxPoints& box) { return box; },
      [&](const BoxPoints& box) {
        benchmark::DoNotOptimize(
            clusterBox(box.depth, box.distance, options, workspace).label.data());
      });
}

void sortFloats(benchmark::State& state, std::size_t n) {
  std::vector<float> sorted(n);
  rotate(
      state, n, [](const BoxPoints& box) { return box.depth; },
      [&](const std::vector<float>& values) {
        std::memcpy(sorted.data(), values.data(), n * sizeof(float));
        std::sort(sorted.begin(), sorted.end());
        benchmark::DoNotOptimize(sorted.data());
      });
}

void copyFloats(benchmark::State& state, std::size_t n) {
  std::vector<float> copy(n);
  rotate(
      state, n, [](const BoxPoints& box) { return box.depth; },
      [&](const std::vector<float>& values) {
        std::memcpy(copy.data(), values.data(), n * sizeof(float));
        benchmark::DoNotOptimize(copy.data());
      });
}

/// nanoflann's own default sorts what a search finds, which no DBSCAN needs.
void clusterWithNanoflann(benchmark::State& state, std::size_t n, bool sorted) {
  const ClusteringOptions options = clusteringOptionsFor(n);
  NanoflannDbscan dbscan(sorted);
  rotate(
      state, n,
      [&](const BoxPoints& box) {
        std::vector<Point2> points;
        for (std::size_t i = 0; i < box.depth.size(); ++i) {
          points.push_back(
              {options.depth_scale * box.depth[i], options.distance_scale * box.distance[i]});
        }
        return points;
      },
      [&](const std::vector<Point2>& points) {
        benchmark::DoNotOptimize(
            dbscan.cluster(points, options.epsilon, options.min_points).data());
      });
}

void partitionWithOpencv(benchmark::State& state, std::size_t n) {
  const ClusteringOptions options = clusteringOptionsFor(n);
  const float squared_radius = options.epsilon * options.epsilon;
  std::vector<int> labels;
  rotate(
      state, n,
      [&](const BoxPoints& box) {
        std::vector<cv::Point2f> points;
        for (std::size_t i = 0; i < box.depth.size(); ++i) {
          points.emplace_back(options.depth_scale * box.depth[i],
                              options.distance_scale * box.distance[i]);
        }
        return points;
      },
      [&](const std::vector<cv::Point2f>& points) {
        benchmark::DoNotOptimize(cv::partition(
            points, labels, [squared_radius](const cv::Point2f& a, const cv::Point2f& b) {
              const cv::Point2f difference = a - b;
              return difference.dot(difference) <= squared_radius;
            }));
      });
}

#ifdef HMCDYN_BENCH_OPEN3D
void clusterWithOpen3d(benchmark::State& state, std::size_t n) {
  const ClusteringOptions options = clusteringOptionsFor(n);
  rotate(
      state, n,
      [&](const BoxPoints& box) {
        return Open3dCloud(scaled(box.depth, options.depth_scale),
                           scaled(box.distance, options.distance_scale));
      },
      [&](const Open3dCloud& cloud) {
        benchmark::DoNotOptimize(cloud
                                     .cluster(static_cast<double>(options.epsilon),
                                              static_cast<std::size_t>(options.min_points))
                                     .data());
      });
}
#endif

#ifdef HMCDYN_BENCH_PCL
void clusterWithPcl(benchmark::State& state, std::size_t n) {
  const ClusteringOptions options = clusteringOptionsFor(n);
  rotate(
      state, n,
      [&](const BoxPoints& box) {
        return PclCloud(scaled(box.depth, options.depth_scale),
                        scaled(box.distance, options.distance_scale));
      },
      [&](const PclCloud& cloud) {
        benchmark::DoNotOptimize(
            cloud.cluster(static_cast<double>(options.epsilon), options.min_points).data());
      });
}
#endif

void registerAll() {
  const auto add = [](const char* who, std::size_t n, auto function) {
    benchmark::RegisterBenchmark(("clustering/" + std::to_string(n) + "/" + who).c_str(), function,
                                 n)
        ->Unit(benchmark::kMicrosecond);
  };
  for (const std::size_t n : {50, 100, 200, 500, 1000, 10000, 31623, 100000, 316228, 1000000}) {
    add("hmcdyn", n, clusterWithHmcdyn);
    add("sort", n, sortFloats);
    add("copy", n, copyFloats);
    add("nanoflann", n, [](benchmark::State& state, std::size_t points) {
      clusterWithNanoflann(state, points, false);
    });
    add("nanoflann_sorted", n, [](benchmark::State& state, std::size_t points) {
      clusterWithNanoflann(state, points, true);
    });
    if (n <= 1000) {  // it compares all pairs
      add("cv_partition", n, partitionWithOpencv);
    }
#ifdef HMCDYN_BENCH_OPEN3D
    add("open3d", n, clusterWithOpen3d);
#endif
#ifdef HMCDYN_BENCH_PCL
    add("pcl", n, clusterWithPcl);
#endif
  }
}

}  // namespace
}  // namespace hmcdyn::bench

int main(int argc, char** argv) {
  hmcdyn::bench::registerAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
