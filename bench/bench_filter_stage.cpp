// SPDX-License-Identifier: BSD-3-Clause
// The whole filter stage (distances, box test, clustering, cluster filter, weights) on 1000 key
// points with 5 moving boxes of 100, against the same by hand over OpenCV and a peer's clustering.
// A peer whose verdicts differ by more than 5 % of the key points is an error, not a figure.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/steps/epipolar.hpp>

#include "peers/handmade_stage.hpp"
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

constexpr std::size_t kFrames = 256;
constexpr std::size_t kBoxes = 5;
constexpr std::size_t kPointsInBox = 100;
constexpr std::size_t kPointsOutside = 500;

/// A pair of pixels at the given distance from each other's epipolar line.
void addPoint(StageInput& frame, double u, double v, double depth, double distance) {
  // Given the current pixel q: the earlier one lies on the line of q, moved off by a little; what
  // counts is |F p . q| / |(F p)_xy|, so p is searched along q's normal.
  const cv::Matx33d& f = frame.fundamental;
  const auto distanceOf = [&](const cv::Vec3d& p, const cv::Vec3d& q) {
    const cv::Vec3d line = f * p;
    return line.dot(q) / std::hypot(line[0], line[1]);
  };
  const cv::Vec3d p(u - 6.0, v + 2.0, 1.0);
  const cv::Vec3d line = f * p;
  const double norm = std::hypot(line[0], line[1]);
  const cv::Vec3d q(u, v, 1.0);
  const double move = distance - distanceOf(p, q);
  frame.earlier.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]));
  frame.current.emplace_back(static_cast<float>(u + move * line[0] / norm),
                             static_cast<float>(v + move * line[1] / norm));
  frame.depth.push_back(static_cast<float>(depth));
}

/// Boxes side by side in the lower part of a 640 x 480 image, the other points above them, all in
/// random order.
StageInput makeFrame(Random& random) {
  StageInput frame;
  // A camera that moved along (1, a, b): F = [t]x over pixels of focal length 525.
  const double a = random.uniform(-0.3, 0.3), b = random.uniform(-0.2, 0.2);
  const cv::Matx33d k_inverse(1.0 / 525.0, 0, -320.0 / 525.0, 0, 1.0 / 525.0, -240.0 / 525.0, 0, 0,
                              1);
  frame.fundamental = k_inverse.t() * cv::Matx33d(0, -b, a, b, 0, -1, -a, 1, 0) * k_inverse;
  std::vector<BoxPoints> boxes;
  for (std::size_t k = 0; k < kBoxes; ++k) {
    const auto x = static_cast<float>(20 + 122 * k);
    frame.boxes.push_back({x, 130.0f, x + 110.0f, 460.0f, kPersonClassId, 0.9f});
    boxes.push_back(makeBoxPoints(kPointsInBox, random));
  }
  std::vector<std::size_t> left(kBoxes, kPointsInBox);
  left.push_back(kPointsOutside);
  for (std::size_t rest = kBoxes * kPointsInBox + kPointsOutside; rest > 0; --rest) {
    auto draw = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(rest)));
    std::size_t where = 0;
    while (draw >= left[where]) {
      draw -= left[where++];
    }
    --left[where];
    if (where == kBoxes) {
      addPoint(frame, random.uniform(20.0, 620.0), random.uniform(10.0, 115.0),
               random.uniform(3.0, 4.0), random.uniform(0.0, 0.5));
    } else {
      const double x = 20.0 + 122.0 * static_cast<double>(where);
      addPoint(frame, x + random.uniform(21.0, 89.0), random.uniform(151.0, 439.0),
               static_cast<double>(boxes[where].depth[left[where]]),
               static_cast<double>(boxes[where].distance[left[where]]));
    }
  }
  return frame;
}

FilterStageOptions stageOptions() {
  FilterStageOptions options;
  options.rule = FilterRule::kHmc;
  options.clustering = clusteringOptionsFor(kPointsInBox);
  return options;
}

/// The library's form of a frame.
struct OurInput {
  Eigen::Matrix3d fundamental;
  std::vector<float> earlier_u, earlier_v, u, v, depth;
  std::vector<DetectionBox> boxes;
};

OurInput ourFormOf(const StageInput& frame) {
  OurInput ours;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      ours.fundamental(row, column) = frame.fundamental(row, column);
    }
  }
  for (std::size_t i = 0; i < frame.current.size(); ++i) {
    ours.earlier_u.push_back(frame.earlier[i].x);
    ours.earlier_v.push_back(frame.earlier[i].y);
    ours.u.push_back(frame.current[i].x);
    ours.v.push_back(frame.current[i].y);
  }
  ours.depth = frame.depth;
  ours.boxes = frame.boxes;
  return ours;
}

class OurStage {
 public:
  std::size_t filter(const OurInput& frame) {
    distance_ =
        epipolarDistances(frame.fundamental, {frame.earlier_u, frame.earlier_v, frame.u, frame.v},
                          std::move(distance_));
    return filterKeyPoints({frame.u, frame.v, frame.depth}, distance_, frame.boxes, options_,
                           workspace_)
        .frame.dynamic;
  }

 private:
  FilterStageOptions options_ = stageOptions();
  std::vector<float> distance_;
  FilterStageWorkspace workspace_;
};

std::vector<StageInput> makeFrames() {
  Random random(7);
  std::vector<StageInput> frames;
  for (std::size_t k = 0; k < kFrames; ++k) {
    frames.push_back(makeFrame(random));
  }
  return frames;
}

void stageOfHmcdyn(benchmark::State& state) {
  std::vector<OurInput> frames;
  for (const StageInput& frame : makeFrames()) {
    frames.push_back(ourFormOf(frame));
  }
  OurStage stage;
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(stage.filter(frames[k++ % kFrames]));
  }
}

/// Throws nothing away silently: a peer must find about the same dynamic points.
template <class Cluster>
void runHandmade(benchmark::State& state, Cluster cluster) {
  const std::vector<StageInput> frames = makeFrames();
  HandmadeStage<Cluster> stage(stageOptions(), std::move(cluster));
  OurStage ours;
  for (const StageInput& frame : frames) {
    const auto expected = static_cast<double>(ours.filter(ourFormOf(frame)));
    const auto found = static_cast<double>(stage.filter(frame));
    if (std::abs(found - expected) > 0.05 * static_cast<double>(frame.current.size())) {
      state.SkipWithError("the peer's verdicts differ");
      return;
    }
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(stage.filter(frames[k++ % kFrames]));
  }
}

using Points = std::vector<cv::Point2f>;

int largestLabel(const std::vector<int>& labels) {
  return labels.empty() ? -1 : *std::max_element(labels.begin(), labels.end());
}

void stageOfPartition(benchmark::State& state) {
  const float epsilon = stageOptions().clustering.epsilon;
  runHandmade(state, [squared = epsilon * epsilon](const Points& points, std::vector<int>& labels) {
    return cv::partition(points, labels, [squared](const cv::Point2f& a, const cv::Point2f& b) {
      const cv::Point2f difference = a - b;
      return difference.dot(difference) <= squared;
    });
  });
}

void stageOfNanoflann(benchmark::State& state) {
  const ClusteringOptions options = stageOptions().clustering;
  const auto dbscan = std::make_shared<NanoflannDbscan>();
  const auto own_form = std::make_shared<std::vector<Point2>>();
  runHandmade(state, [=](const Points& points, std::vector<int>& labels) {
    own_form->clear();
    for (const cv::Point2f& point : points) {
      own_form->push_back({point.x, point.y});
    }
    labels = dbscan->cluster(*own_form, options.epsilon, options.min_points);
    return largestLabel(labels) + 1;
  });
}

#if defined(HMCDYN_BENCH_OPEN3D) || defined(HMCDYN_BENCH_PCL)
/// A peer with a cloud of its own, made from the points of a box.
template <class Cloud, class MinPoints>
void stageOfCloud(benchmark::State& state) {
  const ClusteringOptions options = stageOptions().clustering;
  runHandmade(state, [options](const Points& points, std::vector<int>& labels) {
    std::vector<float> x, y;
    for (const cv::Point2f& point : points) {
      x.push_back(point.x);
      y.push_back(point.y);
    }
    labels = Cloud(x, y).cluster(static_cast<double>(options.epsilon),
                                 static_cast<MinPoints>(options.min_points));
    return largestLabel(labels) + 1;
  });
}
#endif

BENCHMARK(stageOfHmcdyn)->Name("filter_stage/1000/hmcdyn")->Unit(benchmark::kMicrosecond);
BENCHMARK(stageOfPartition)->Name("filter_stage/1000/cv_partition")->Unit(benchmark::kMicrosecond);
BENCHMARK(stageOfNanoflann)->Name("filter_stage/1000/nanoflann")->Unit(benchmark::kMicrosecond);
#ifdef HMCDYN_BENCH_OPEN3D
BENCHMARK(stageOfCloud<Open3dCloud, std::size_t>)
    ->Name("filter_stage/1000/open3d")
    ->Unit(benchmark::kMicrosecond);
#endif
#ifdef HMCDYN_BENCH_PCL
BENCHMARK(stageOfCloud<PclCloud, int>)
    ->Name("filter_stage/1000/pcl")
    ->Unit(benchmark::kMicrosecond);
#endif

}  // namespace
}  // namespace hmcdyn::bench

BENCHMARK_MAIN();
