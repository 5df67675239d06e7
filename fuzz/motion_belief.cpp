// SPDX-License-Identifier: BSD-3-Clause
// Surface depths and beliefs with arbitrary depth images, arrays and options: the steps of
// judgeByBelief(), in its order.
#include <stdexcept>
#include <utility>
#include <vector>

#include <hmcdyn/votes/belief_verdict.hpp>
#include <hmcdyn/votes/motion_belief.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloat;
using hmcdyn::fuzz::anyFloats;
using hmcdyn::fuzz::require;
using hmcdyn::fuzz::same;

struct Options {
  hmcdyn::SurfaceDepthOptions surface;
  hmcdyn::MotionBeliefOptions belief;
  hmcdyn::BeliefVerdictOptions verdict;
};

Options anyOptions(FuzzedDataProvider& data) {
  Options options;
  if (data.ConsumeBool()) {
    options.surface.own_radius = data.ConsumeIntegralInRange<int>(-1, 26);
    options.surface.own_share = anyFloat(data, 0.1f, 1.0f);
    options.surface.wide_radius = data.ConsumeIntegralInRange<int>(-1, 51);
    options.surface.enclosed_share = anyFloat(data, 0.1f, 1.0f);
    options.surface.behind_share = anyFloat(data, 0.1f, 1.0f);
    options.surface.flow_radius = data.ConsumeIntegralInRange<int>(-1, 251);
    options.surface.gap_floor = anyFloat(data, 0.0f, 1.0f);
    options.surface.gap_quadratic = anyFloat(data, 0.0f, 1.0f);
  }
  if (data.ConsumeBool()) {
    options.belief.sigma = anyFloat(data, 1.0f, 100.0f);
    options.belief.memory_sigma = anyFloat(data, 1.0f, 100.0f);
    options.belief.depth_sigma_floor = anyFloat(data, 0.01f, 1.0f);
    options.belief.depth_sigma_quadratic = anyFloat(data, 0.0f, 1.0f);
    options.belief.still_distance = anyFloat(data, 0.0f, 1.0f);
    options.belief.moving_distance = anyFloat(data, 1.0f, 3.0f);
    options.belief.dynamic_evidence = anyFloat(data, 0.0f, 1.0f);
    options.belief.quiet_weight = anyFloat(data, 0.0f, 1.0f);
    options.belief.inferred_weight = anyFloat(data, 0.0f, 1.0f);
    options.belief.unmeasured_depth = anyFloat(data, 1.0f, 10.0f);
    options.belief.min_weight = anyFloat(data, 0.01f, 1.0f);
    options.belief.memory_gain = anyFloat(data, 0.0f, 4.0f);
    options.belief.memory_decay = anyFloat(data, 0.0f, 1.0f);
    options.belief.weight_cap = anyFloat(data, 0.1f, 30.0f);
    options.belief.dynamic_belief = anyFloat(data, 0.0f, 1.0f);
    options.belief.certain_weight = anyFloat(data, 0.0f, 1.0f);
    options.verdict.dragged_weight = anyFloat(data, 0.0f, 1.0f);
  }
  return options;
}

struct Frame {
  int width = 0;
  int height = 0;
  std::vector<float> image;
  hmcdyn::KeyPoints points;
  std::vector<float> distance, earlier_u, earlier_v;
  std::vector<std::uint8_t> in_box;
  hmcdyn::FilterStageResult stage;
};

Frame anyFrame(FuzzedDataProvider& data) {
  Frame frame;
  frame.width = data.ConsumeIntegralInRange<int>(1, 24);
  frame.height = data.ConsumeIntegralInRange<int>(1, 24);
  frame.image = anyFloats(data, static_cast<std::size_t>(frame.width * frame.height), 0.0f, 6.0f);
  frame.points = hmcdyn::fuzz::anyPoints(data, 60);
  const std::size_t n = frame.points.size();
  frame.distance = anyFloats(data, n, 0.0f, 4.0f);
  if (data.ConsumeBool()) {
    frame.earlier_u = anyFloats(data, n, 0.0f, 100.0f);
    frame.earlier_v = anyFloats(data, n, 0.0f, 100.0f);
  }
  for (std::size_t i = 0; i < n; ++i) {  // as the stage before gives it: dynamic weighs nothing
    const auto label = static_cast<hmcdyn::PointLabel>(data.ConsumeIntegralInRange<int>(0, 3));
    const bool is_dynamic = label == hmcdyn::PointLabel::kDynamic;
    frame.in_box.push_back(data.ConsumeBool() ? 1 : 0);
    frame.stage.label.push_back(label);
    frame.stage.weight.push_back(is_dynamic ? 0.0f : data.ConsumeProbability<float>());
    frame.stage.cluster.push_back(hmcdyn::kNoise);
  }
  return frame;
}

void checkResult(const hmcdyn::FilterStageResult& result) {
  std::size_t dynamic = 0;
  for (std::size_t i = 0; i < result.label.size(); ++i) {
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
  const Options options = anyOptions(data);
  const hmcdyn::MotionBelief memory = hmcdyn::fuzz::anyMemory(data);
  const Frame frame = anyFrame(data);
  hmcdyn::MotionBeliefInput input;
  input.points = frame.points.view();
  input.distance = frame.distance;
  input.label = frame.stage.label;
  input.in_box = frame.in_box;
  input.earlier_u = frame.earlier_u;
  input.earlier_v = frame.earlier_v;
  const hmcdyn::DepthImageView image{frame.image.data(), frame.width, frame.height,
                                     static_cast<std::size_t>(frame.width)};
  static hmcdyn::MotionBeliefWorkspace used;  // what earlier inputs left in it must not matter
  hmcdyn::MotionBeliefWorkspace fresh;
  const auto believe = [&](hmcdyn::MotionBeliefWorkspace& workspace) {
    workspace.surface = surfaceDepths(image, frame.points.u, frame.points.v, options.surface,
                                      std::move(workspace.surface));
    return updateMotionBelief(input, memory, options.belief, workspace);
  };
  hmcdyn::MotionBelief belief;
  try {
    belief = believe(fresh);
  } catch (const std::invalid_argument&) {  // as documented
    return 0;
  }
  const hmcdyn::MotionBelief again = believe(used);
  require(same(again.belief, belief.belief) && same(again.weight, belief.weight),
          "the same input gives the same beliefs");
  try {
    // Throws for a belief or weight out of range, and for nothing else but this option: the next
    // frame takes such a belief for its memory.
    checkResult(applyMotionBelief(belief, fresh.surface.is_dragged, frame.stage, options.belief,
                                  options.verdict));
  } catch (const std::invalid_argument&) {
    const float weight = options.verdict.dragged_weight;
    require(!(weight >= 0.0f && weight <= 1.0f), "a belief is one that the next step takes");
  }
  return 0;
}
