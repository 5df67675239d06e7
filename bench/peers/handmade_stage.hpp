// SPDX-License-Identifier: BSD-3-Clause
// The filter stage as one writes it over OpenCV: cv::computeCorrespondEpilines for the distances,
// somebody's clustering, plain loops for the rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <hmcdyn/filter_stage.hpp>

namespace hmcdyn::bench {

/// What the stage takes.
struct StageInput {
  cv::Matx33d fundamental;
  std::vector<cv::Point2f> earlier;
  std::vector<cv::Point2f> current;
  std::vector<float> depth;  ///< (m)
  std::vector<DetectionBox> boxes;
};

/// Keeps its memory from call to call. `Cluster` takes scaled points of a box and an array of as
/// many labels to write, -1 = noise, and returns the number of clusters.
template <class Cluster>
class HandmadeStage {
 public:
  HandmadeStage(const FilterStageOptions& options, Cluster cluster)
      : options_(options), cluster_(std::move(cluster)) {}

  /// The number of dynamic points.
  std::size_t filter(const StageInput& input) {
    const std::size_t n = input.current.size();
    cv::computeCorrespondEpilines(input.earlier, 1, input.fundamental, lines_);
    distance_.resize(n);
    float sum = 0.0f;
    for (std::size_t i = 0; i < n; ++i) {  // OpenCV's lines have unit normals
      distance_[i] = std::abs(lines_[i][0] * input.current[i].x +
                              lines_[i][1] * input.current[i].y + lines_[i][2]);
      sum += distance_[i];
    }
    mean_distance_ = sum / static_cast<float>(n);
    dynamic_.assign(n, 0);
    weight_.assign(n, 1.0f);
    for (const DetectionBox& box : input.boxes) {
      filterBox(input, box);
    }
    return static_cast<std::size_t>(std::count(dynamic_.begin(), dynamic_.end(), 1));
  }

 private:
  struct Summary {
    std::size_t points = 0;
    float distance = 0.0f, depth = 0.0f, min_depth = 1e9f, max_depth = 0.0f;
    bool is_dynamic = false;
  };

  void filterBox(const StageInput& input, const DetectionBox& box) {
    const float threshold = box.class_id == options_.boxes.person_class_id
                                ? options_.boxes.person_distance_threshold
                                : options_.boxes.distance_threshold;
    members_.clear();
    points_.clear();
    std::size_t moving = 0;
    for (std::size_t i = 0; i < input.current.size(); ++i) {
      if (box.contains(input.current[i].x, input.current[i].y)) {
        members_.push_back(i);
        points_.emplace_back(options_.clustering.depth_scale * input.depth[i],
                             options_.clustering.distance_scale * distance_[i]);
        moving += distance_[i] > threshold ? 1 : 0;
      }
    }
    if (static_cast<float>(moving) <=
        options_.boxes.dynamic_ratio * static_cast<float>(members_.size())) {
      return;
    }
    const int clusters = cluster_(points_, labels_);
    summarize(input, clusters);
    const Summary* const strongest = judge();
    weigh(input, threshold, strongest);
  }

  void summarize(const StageInput& input, int clusters) {
    summaries_.assign(static_cast<std::size_t>(clusters), Summary{});
    for (std::size_t k = 0; k < members_.size(); ++k) {
      if (labels_[k] >= 0) {
        Summary& summary = summaries_[static_cast<std::size_t>(labels_[k])];
        const float depth = input.depth[members_[k]];
        ++summary.points;
        summary.distance += distance_[members_[k]];
        summary.depth += depth;
        summary.min_depth = std::min(summary.min_depth, depth);
        summary.max_depth = std::max(summary.max_depth, depth);
      }
    }
  }

  const Summary* judge() {
    const ClusterFilterOptions& options = options_.cluster_filter;
    Summary* strongest = nullptr;
    for (Summary& summary : summaries_) {
      summary.distance /= static_cast<float>(std::max<std::size_t>(summary.points, 1));
      summary.depth /= static_cast<float>(std::max<std::size_t>(summary.points, 1));
      if (summary.points >= static_cast<std::size_t>(options.min_cluster_size) &&
          summary.distance >= options.min_strongest_distance &&
          (strongest == nullptr || summary.distance > strongest->distance)) {
        strongest = &summary;
      }
    }
    if (strongest != nullptr) {
      const float screening =
          std::max(options.screening_ratio * mean_distance_, options.screening_floor);
      for (Summary& summary : summaries_) {
        summary.is_dynamic =
            summary.distance > screening || std::abs(summary.depth - strongest->depth) <
                                                strongest->max_depth - strongest->min_depth;
      }
      strongest->is_dynamic = true;
    }
    return strongest;
  }

  void weigh(const StageInput& input, float threshold, const Summary* strongest) {
    float mean = 0.0f;
    for (const std::size_t i : members_) {
      mean += input.depth[i];
    }
    mean /= static_cast<float>(members_.size());
    float variance = 0.0f;
    for (const std::size_t i : members_) {
      variance += (input.depth[i] - mean) * (input.depth[i] - mean);
    }
    variance /= static_cast<float>(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const std::size_t i = members_[k];
      const bool moves =
          (labels_[k] >= 0 && summaries_[static_cast<std::size_t>(labels_[k])].is_dynamic) ||
          distance_[i] > threshold;
      if (moves) {
        dynamic_[i] = 1;
        weight_[i] = 0.0f;
      } else if (strongest != nullptr) {
        const float difference = input.depth[i] - strongest->depth;
        weight_[i] =
            std::min(weight_[i], 1.0f - std::exp(-0.5f * difference * difference / variance));
      }
    }
  }

  FilterStageOptions options_;
  Cluster cluster_;
  std::vector<cv::Vec3f> lines_;
  std::vector<float> distance_, weight_;
  std::vector<unsigned char> dynamic_;
  std::vector<std::size_t> members_;
  std::vector<cv::Point2f> points_;
  std::vector<int> labels_;
  std::vector<Summary> summaries_;
  float mean_distance_ = 0.0f;
};

}  // namespace hmcdyn::bench
