// SPDX-License-Identifier: BSD-3-Clause
// Clusters of arbitrary points and options: the fast ways give what the general one gives.
#include <stdexcept>
#include <utility>
#include <vector>

#include <hmcdyn/steps/clustering.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloat;
using hmcdyn::fuzz::require;

hmcdyn::ClusteringOptions anyOptions(FuzzedDataProvider& data) {
  hmcdyn::ClusteringOptions options;
  options.epsilon = anyFloat(data, 0.0f, 1.0f);
  options.min_points = data.ConsumeIntegralInRange<int>(0, 12);
  if (data.ConsumeBool()) {
    options.depth_scale = anyFloat(data, 0.1f, 2.0f);
    options.distance_scale = anyFloat(data, 0.01f, 1.0f);
    options.order = data.ConsumeBool() ? anyFloat(data, 1.0f, 4.0f) : 2.0f;
  }
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const hmcdyn::ClusteringOptions options = anyOptions(data);
  hmcdyn::KeyPoints points = hmcdyn::fuzz::anyPoints(data, 60);
  hmcdyn::fuzz::addCrowd(data, 320, points);
  // On whole numbers many distances are equal.
  if (data.ConsumeBool()) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points.u[i] = std::round(points.u[i]);
      points.depth[i] = std::round(8.0f * points.depth[i]) / 8.0f;
    }
  }
  const auto n = static_cast<Eigen::Index>(points.size());
  static hmcdyn::ClusteringWorkspace used;  // what earlier inputs left in it must not matter
  try {
    const hmcdyn::Clustering boxed =
        clusterBox(points.depth, points.u, options, used);  // as the filter stage calls it
    require(boxed.label.size() == points.size(), "a label a point");
    for (std::size_t i = 0; i < points.size(); ++i) {
      require(boxed.is_core[i] == 0 || boxed.label[i] != hmcdyn::kNoise,
              "core points are no noise");
    }

    Eigen::MatrixXf columns(2, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      columns.col(i) << points.depth[k], points.u[k];
    }
    const hmcdyn::Clustering fast = densityClusters(columns, options, used);
    // A third coordinate that is 0 for all changes no distance, and leads past the fast ways.
    Eigen::MatrixXf in_space = Eigen::MatrixXf::Zero(3, n);
    in_space.topRows(2) = columns;
    const hmcdyn::Clustering general = densityClusters(in_space, options, used);
    require(fast.label == general.label && fast.is_core == general.is_core,
            "in the plane as in space");
  } catch (const std::invalid_argument&) {  // as documented
  }
  return 0;
}
