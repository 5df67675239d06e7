// SPDX-License-Identifier: BSD-3-Clause
// clustering.hpp, cluster_filter.hpp, weights.hpp
#include <hmcdyn/steps/cluster_filter.hpp>
#include <hmcdyn/steps/clustering.hpp>
#include <hmcdyn/steps/weights.hpp>

#include "bindings.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

Clustering makeClustering(const ArrayLike& label, int clusters) {
  const auto labels = column<int>(label, "label");
  Clustering clustering;
  clustering.label.assign(labels.values.begin(), labels.values.end());
  clustering.is_core.assign(clustering.label.size(), 0);
  clustering.clusters = clusters;
  return clustering;
}

Clustering clustersOf(const ArrayLike& points, const ClusteringOptions& options) {
  const py::array array = py::array::ensure(points);
  if (!array || array.ndim() != 2) {
    throw std::invalid_argument("points has another shape than (N, D); expected N points");
  }
  const auto dimensions = static_cast<std::size_t>(array.shape(1));
  const std::vector<float> rows = rowsOf(array, "points", dimensions);
  return unlocked([&] {
    const Eigen::Map<const Eigen::MatrixXf> columns(rows.data(), array.shape(1), array.shape(0));
    return densityClusters(columns, options);
  });
}

void bindWeights(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, WeightOptions);
  {
    auto type = optionsClass<DepthAnchor>(module, "DepthAnchor", commentOf("DepthAnchor"));
    HMCDYN_FIELDS_DepthAnchor(HMCDYN_OPTION);
  }
  module.def(
      "kept_point_weights",
      [](const ArrayLike& depth, const DepthAnchor& anchor, const OptionsOf<WeightOptions>& options,
         const py::kwargs& fields) {
        const auto depths = column<float>(depth, "depth");
        const auto own = optionsFrom<WeightOptions>(options, fields);
        return toNumpy(unlocked([&] { return keptPointWeights(depths.values, anchor, own); }));
      },
      py::arg("depth"), py::arg("anchor"), py::arg("options") = py::none(),
      commentOf("keptPointWeights"));
  module.def("use_soft_weights", &useSoftWeights, py::arg("points_in_dynamic_boxes"),
             py::arg("points"), py::arg("gate") = 0.6, commentOf("useSoftWeights"));
  module.def(
      "hard_weights",
      [](const ArrayLike& weights) {
        const auto own = column<float>(weights, "weights");
        return toNumpy(unlocked([&] { return hardWeights(own.values); }));
      },
      py::arg("weights"), commentOf("hardWeights"));
}

}  // namespace

void bindClusters(py::module_& module) {
  module.attr("NOISE") = kNoise;
  HMCDYN_BIND_OPTIONS(module, ClusteringOptions);
  {
    py::class_<Clustering> type(module, "Clustering", commentOf("Clustering"));
    type.def(py::init(&makeClustering), py::arg("label"), py::arg("clusters"));
    HMCDYN_FIELDS_Clustering(HMCDYN_READ_ONLY);
    type.def("__repr__", [](const py::object& self) { return textOf(self); });
  }
  module.def(
      "cluster_box",
      [](const ArrayLike& depth, const ArrayLike& distance,
         const OptionsOf<ClusteringOptions>& options, const py::kwargs& fields) {
        const auto depths = column<float>(depth, "depth");
        const auto distances = column<float>(distance, "distance");
        const auto own = optionsFrom<ClusteringOptions>(options, fields);
        return unlocked([&] { return clusterBox(depths.values, distances.values, own); });
      },
      py::arg("depth"), py::arg("distance"), py::arg("options") = py::none(),
      commentOf("clusterBox"));
  module.def(
      "density_clusters",
      [](const ArrayLike& points, const OptionsOf<ClusteringOptions>& options,
         const py::kwargs& fields) {
        return clustersOf(points, optionsFrom<ClusteringOptions>(options, fields));
      },
      py::arg("points"), py::arg("options") = py::none(),
      "Density clusters (DBSCAN, Ester et al. 1996) of points, shape (N, D), numbered by their "
      "smallest core point.\n\nSee cluster_box for what the paper clusters.");

  HMCDYN_BIND_OPTIONS(module, ClusterFilterOptions);
  HMCDYN_BIND_RESULT(module, ClusterSummary);
  HMCDYN_BIND_RESULT(module, ClusterFilterResult);
  module.def(
      "filter_clusters",
      [](const ArrayLike& depth, const ArrayLike& distance, const ArrayLike& threshold,
         const Clustering& clustering, float frame_mean_distance,
         const OptionsOf<ClusterFilterOptions>& options, const py::kwargs& fields) {
        const auto depths = column<float>(depth, "depth");
        const auto distances = column<float>(distance, "distance");
        const auto thresholds = column<float>(threshold, "threshold");
        const auto own = optionsFrom<ClusterFilterOptions>(options, fields);
        return unlocked([&] {
          return filterClusters(depths.values, distances.values, thresholds.values, clustering,
                                frame_mean_distance, own);
        });
      },
      py::arg("depth"), py::arg("distance"), py::arg("threshold"), py::arg("clustering"),
      py::arg("frame_mean_distance"), py::arg("options") = py::none(), commentOf("filterClusters"));
  bindWeights(module);
}

}  // namespace hmcdyn::python
