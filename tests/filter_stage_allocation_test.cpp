// SPDX-License-Identifier: BSD-3-Clause
// The filter stage allocates nothing once its workspace has seen frames of the kind. This
// executable replaces the global operator new, so that every allocation counts.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/steps/epipolar.hpp>

#include "counting_allocator.hpp"
#include "filter_options.hpp"
#include "random.hpp"
#include "random_frame.hpp"

namespace hmcdyn {
namespace {

using test::allocations;
using test::fixedStageOptions;
using test::Frame;
using test::Random;

std::vector<Frame> makeFrames() {
  Random random(61);
  std::vector<Frame> frames;
  for (int k = 0; k < 40; ++k) {
    frames.push_back(test::makeFrame(random));
  }
  return frames;
}

class Allocations : public ::testing::TestWithParam<FilterRule> {};

TEST_P(Allocations, NoneOnceTheWorkspaceHasSeenTheFrames) {
  const std::vector<Frame> frames = makeFrames();
  const FilterStageOptions options = fixedStageOptions(GetParam());
  FilterStageWorkspace workspace;
  const auto filterAll = [&] {
    const std::size_t before = allocations();
    std::size_t dynamic = 0;
    for (const Frame& frame : frames) {
      dynamic +=
          filterKeyPoints(frame.points.view(), frame.distance, frame.boxes, options, workspace)
              .frame.dynamic;
    }
    return std::pair(allocations() - before, dynamic);
  };
  // Given a first round, in which the memory grows (so the count works)
  const auto [first_allocations, first_dynamic] = filterAll();
  EXPECT_GT(first_allocations, 0U);
  // Frames of other sizes and numbers of boxes in between do no harm either
  filterAll();
  const auto [later_allocations, later_dynamic] = filterAll();
  EXPECT_EQ(later_allocations, 0U);
  EXPECT_EQ(later_dynamic, first_dynamic);
}

INSTANTIATE_TEST_SUITE_P(Rules, Allocations, ::testing::ValuesIn(kFilterRules),
                         [](const ::testing::TestParamInfo<FilterRule>& rule) {
                           return std::string(toString(rule.param));
                         });

TEST(Allocations, NoneInTheDistances) {
  const std::vector<float> pixels(1000, 1.5f);
  std::vector<float> distance;
  TwoViewModel model;
  for (const TwoViewModelKind kind : {TwoViewModelKind::kFundamental, TwoViewModelKind::kHomography,
                                      TwoViewModelKind::kIdentity, TwoViewModelKind::kNone}) {
    model.kind = kind;
    distance = modelDistances(model, {pixels, pixels, pixels, pixels}, std::move(distance));
    const std::size_t before = allocations();
    distance = modelDistances(model, {pixels, pixels, pixels, pixels}, std::move(distance));
    EXPECT_EQ(allocations(), before) << toString(kind);
  }
}

TEST(Allocations, NoneInTheClusteringOfManyPoints) {
  Random random(62);
  std::vector<float> depth, distance;
  for (int i = 0; i < 3000; ++i) {
    depth.push_back(random.uniformFloat(1.0, 4.0));
    distance.push_back(random.uniformFloat(0.0, 5.0));
  }
  ClusteringWorkspace workspace;
  ClusteringOptions options;
  options.order = 2.0f;
  clusterBox(depth, distance, options, workspace);
  const std::size_t before = allocations();
  EXPECT_GT(clusterBox(depth, distance, options, workspace).clusters, 0);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace hmcdyn
