// SPDX-License-Identifier: BSD-3-Clause
// The filter call with arbitrary arrays, boxes, memberships and options.
#include <algorithm>
#include <stdexcept>
#include <vector>

#include <hmcdyn/filter_stage.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloat;
using hmcdyn::fuzz::require;

hmcdyn::FilterStageOptions anyOptions(FuzzedDataProvider& data) {
  hmcdyn::FilterStageOptions options;
  options.rule = data.PickValueInArray(hmcdyn::kFilterRules);
  if (data.ConsumeBool()) {
    options.boxes.dynamic_ratio = anyFloat(data, 0.0f, 1.0f);
    options.clustering.epsilon = anyFloat(data, 0.0f, 1.0f);
    options.clustering.min_points = data.ConsumeIntegralInRange<int>(-1, 12);
    options.clustering.order = anyFloat(data, 0.5f, 4.0f);
    options.clustering.depth_scale = anyFloat(data, 0.0f, 2.0f);
    options.clustering.distance_scale = anyFloat(data, 0.0f, 2.0f);
    options.cluster_filter.min_cluster_size = data.ConsumeIntegralInRange<int>(-1, 12);
    options.cluster_filter.screening_ratio = anyFloat(data, 0.0f, 2.0f);
    options.cluster_filter.place_unmatched_by_depth = data.ConsumeBool();
    options.weights.without_depth = anyFloat(data, 0.0f, 1.0f);
    options.depth_ransac.seed = data.ConsumeIntegral<std::uint8_t>();
  }
  return options;
}

hmcdyn::BoxMembership anyMembership(FuzzedDataProvider& data, std::size_t points) {
  hmcdyn::BoxMembership membership;
  const auto listed = data.ConsumeIntegralInRange<std::size_t>(0, 2 * points);
  for (std::size_t k = 0; k < listed; ++k) {
    membership.indices.push_back(
        data.ConsumeIntegralInRange<std::uint32_t>(0, static_cast<std::uint32_t>(points)));
  }
  const auto offsets = data.ConsumeIntegralInRange<std::size_t>(0, 7);
  for (std::size_t k = 0; k < offsets; ++k) {
    membership.offsets.push_back(data.ConsumeIntegralInRange<std::size_t>(0, listed + 1));
  }
  if (data.ConsumeBool() && offsets > 0) {  // else most would be refused
    std::sort(membership.offsets.begin(), membership.offsets.end());
    membership.offsets.front() = 0;
    membership.offsets.back() = listed;
  }
  return membership;
}

void checkResult(const hmcdyn::FilterStageResult& result, std::size_t n, std::size_t boxes) {
  require(result.label.size() == n && result.weight.size() == n && result.cluster.size() == n,
          "N labels, weights and clusters");
  require(result.boxes.size() == boxes, "one decision a box");
  std::size_t dynamic = 0;
  for (std::size_t i = 0; i < n; ++i) {
    require(result.weight[i] >= 0.0f && result.weight[i] <= 1.0f, "weights in [0, 1]");
    const bool is_dynamic = result.label[i] == hmcdyn::PointLabel::kDynamic;
    require(!is_dynamic || result.weight[i] == 0.0f, "dynamic points weigh nothing");
    dynamic += is_dynamic ? 1 : 0;
  }
  require(result.frame.dynamic == dynamic, "the frame's count of dynamic points");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const hmcdyn::FilterStageOptions options = anyOptions(data);
  const std::vector<hmcdyn::DetectionBox> boxes = hmcdyn::fuzz::anyBoxes(data, 6);
  const bool by_membership = data.ConsumeBool();
  hmcdyn::KeyPoints points = hmcdyn::fuzz::anyPoints(data, 150);
  std::vector<float> distance = hmcdyn::fuzz::anyFloats(data, points.size(), 0.0f, 4.0f);
  hmcdyn::fuzz::addCrowd(data, 320, points);  // their distances repeat with a short period
  const std::vector<float> of_crowd =
      hmcdyn::fuzz::anyFloats(data, data.ConsumeIntegralInRange<std::size_t>(1, 8), 0.0f, 4.0f);
  for (std::size_t k = 0; distance.size() < points.size(); ++k) {
    distance.push_back(of_crowd[k % of_crowd.size()]);
  }
  const hmcdyn::BoxMembership membership =
      by_membership ? anyMembership(data, points.size()) : hmcdyn::BoxMembership{};
  static hmcdyn::FilterStageWorkspace used;  // what earlier inputs left in it must not matter
  hmcdyn::FilterStageWorkspace fresh;
  const auto filter = [&](hmcdyn::FilterStageWorkspace& workspace) {
    return by_membership
               ? filterKeyPoints(points.view(), distance, boxes, membership, options, workspace)
               : filterKeyPoints(points.view(), distance, boxes, options, workspace);
  };
  try {
    const hmcdyn::FilterStageResult result = filter(fresh);
    checkResult(result, points.size(), boxes.size());
    const hmcdyn::FilterStageResult again = filter(used);
    require(again.label == result.label && again.weight == result.weight &&
                again.cluster == result.cluster,
            "the same input gives the same result");
  } catch (const std::invalid_argument&) {  // as documented
  }
  return 0;
}
