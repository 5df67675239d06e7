// SPDX-License-Identifier: BSD-3-Clause
// Surface depths and beliefs with arbitrary depth images and arrays.
#include <stdexcept>
#include <utility>
#include <vector>

#include <hmcdyn/motion_belief.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloats;
using hmcdyn::fuzz::require;

hmcdyn::MotionBelief anyMemory(FuzzedDataProvider& data) {
  const auto n = data.ConsumeIntegralInRange<std::size_t>(0, 40);
  hmcdyn::MotionBelief memory;
  memory.u = anyFloats(data, n, 0.0f, 100.0f);
  memory.v = anyFloats(data, n, 0.0f, 100.0f);
  memory.depth = anyFloats(data, n, 0.0f, 6.0f);
  for (std::size_t i = 0; i < n; ++i) {  // in the range that MotionBelief documents
    memory.belief.push_back(data.ConsumeBool() ? data.ConsumeProbability<float>() : hmcdyn::kNaN);
    memory.weight.push_back(data.ConsumeProbability<float>());
  }
  return memory;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const int width = data.ConsumeIntegralInRange<int>(1, 24);
  const int height = data.ConsumeIntegralInRange<int>(1, 24);
  const auto stride = static_cast<std::size_t>(width);
  const std::vector<float> image =
      anyFloats(data, stride * static_cast<std::size_t>(height), 0.0f, 6.0f);
  const hmcdyn::KeyPoints points = hmcdyn::fuzz::anyPoints(data, 60);
  const std::size_t n = points.size();
  const std::vector<float> distance = anyFloats(data, n, 0.0f, 4.0f);
  const std::vector<float> earlier_u = anyFloats(data, n, 0.0f, 100.0f);
  const std::vector<float> earlier_v = anyFloats(data, n, 0.0f, 100.0f);
  const hmcdyn::MotionBelief memory = anyMemory(data);
  std::vector<std::uint8_t> in_box;
  hmcdyn::FilterStageResult stage;
  for (std::size_t i = 0; i < n; ++i) {
    in_box.push_back(data.ConsumeBool() ? 1 : 0);
    stage.label.push_back(static_cast<hmcdyn::PointLabel>(data.ConsumeIntegralInRange<int>(0, 3)));
    stage.weight.push_back(data.ConsumeProbability<float>());
    stage.cluster.push_back(hmcdyn::kNoise);
  }
  try {
    hmcdyn::MotionBeliefWorkspace workspace;
    workspace.surface = surfaceDepths(hmcdyn::DepthImageView{image.data(), width, height, stride},
                                      points.u, points.v);
    hmcdyn::MotionBeliefInput input;
    input.points = points.view();
    input.distance = distance;
    input.label = stage.label;
    input.in_box = in_box;
    input.earlier_u = earlier_u;
    input.earlier_v = earlier_v;
    const hmcdyn::MotionBelief belief = updateMotionBelief(input, memory, {}, workspace);
    for (std::size_t i = 0; i < n; ++i) {
      const float moving = belief.belief[i];
      require(std::isnan(moving) || (moving >= 0.0f && moving <= 1.0f), "beliefs in [0, 1] or NaN");
      require(belief.weight[i] >= 0.0f && belief.weight[i] <= 1.0f, "their weights in [0, 1]");
    }
    const hmcdyn::FilterStageResult result =
        applyMotionBelief(belief, in_box, workspace.surface.is_dragged, std::move(stage));
    for (const float weight : result.weight) {
      require(weight >= 0.0f && weight <= 1.0f, "weights in [0, 1]");
    }
  } catch (const std::invalid_argument&) {  // as documented
  }
  return 0;
}
