// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hmcdyn/filter_stage.hpp>

namespace hmcdyn::test {

/// Every option set, so that tests of rules do not depend on tuned defaults.
inline FilterStageOptions fixedStageOptions(FilterRule rule) {
  FilterStageOptions options;
  options.rule = rule;
  options.boxes.distance_threshold = 1.0f;
  options.boxes.person_distance_threshold = 0.9f;
  options.boxes.dynamic_ratio = 0.1f;
  options.boxes.person_class_id = kPersonClassId;
  options.clustering.depth_scale = 1.0f;
  options.clustering.distance_scale = 0.05f;
  options.clustering.epsilon = 0.15f;
  options.clustering.min_points = 4;
  options.clustering.order = 2.0f;
  options.cluster_filter.min_cluster_size = 5;
  options.cluster_filter.min_strongest_distance = 0.5f;
  options.cluster_filter.screening_ratio = 1.0f;
  options.cluster_filter.screening_floor = 0.5f;
  options.cluster_filter.place_unmatched_by_depth = true;
  options.weights.without_depth = 0.25f;
  options.weights.without_anchor = 0.75f;
  options.two_threshold.outside_threshold = 1.0f;
  options.two_threshold.inside_threshold = 0.2f;
  options.two_threshold.revert_share = 0.1f;
  options.chi_square.sigma = 1.0f;
  options.chi_square.quantile = 3.8415f;
  options.depth_ransac.variance_threshold = 0.1f;
  options.depth_ransac.confidence = 0.99f;
  options.depth_ransac.max_iterations = 50;
  options.depth_ransac.seed = 1;
  return options;
}

}  // namespace hmcdyn::test
