// SPDX-License-Identifier: BSD-3-Clause
// A workspace changes no result, and saves allocations.
#include <cstddef>
#include <utility>

#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "counting_allocator.hpp"
#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

using test::allocations;
using test::disturbed;
using test::makePoseScene;
using test::moved;
using test::PoseScene;

TEST(PoseRefinementWorkspace, ChangesNoResult) {
  // Given one workspace that sees many points, few, none, depth rows, suspects, a second solver,
  PoseRefinementWorkspace workspace;
  for (const std::size_t points : {200U, 30U, 0U, 2U, 201U, 1000U, 50U}) {
    for (const DepthRow row : {DepthRow::kNone, DepthRow::kDisparity, DepthRow::kDepth}) {
      for (const WeightMode mode : {WeightMode::kJoint, WeightMode::kFixed}) {
        PoseScene scene = makePoseScene(static_cast<std::uint32_t>(91 + points), points, 1.0);
        for (std::size_t i = 0; i < points; i += 3) {
          scene.weight[i] = i % 2 == 0 ? 0.5f : 0.0f;
          scene.u[i] += 20.0f;
        }
        PoseRefinementOptions options;
        options.depth_row = row;
        options.weight_mode = mode;
        options.solver = points == 201 ? PoseSolver::kCeresProblem : PoseSolver::kCollapsed;
        // when it is used again,
        const auto reused =
            refinePose(scene.view(), scene.camera, disturbed(scene), options, workspace);
        const auto fresh = refinePose(scene.view(), scene.camera, disturbed(scene), options);
        // then nothing of what it held shows.
        EXPECT_EQ(reused.camera_from_world, fresh.camera_from_world);
        EXPECT_EQ(reused.inlier, fresh.inlier);
        EXPECT_EQ(reused.weight, fresh.weight);
        EXPECT_EQ(reused.final_cost, fresh.final_cost);
        EXPECT_EQ(reused.message, fresh.message);
      }
    }
  }
}

TEST(PoseRefinementWorkspace, MayBeMovedAndUsedOn) {
  const PoseScene scene = makePoseScene(92, 60, 1.0);
  PoseRefinementWorkspace first;
  const auto before = refinePose(scene.view(), scene.camera, disturbed(scene), {}, first);
  PoseRefinementWorkspace second = std::move(first);
  const auto moved_to = refinePose(scene.view(), scene.camera, disturbed(scene), {}, second);
  const auto moved_from =  // NOLINTNEXTLINE(bugprone-use-after-move): documented to work
      refinePose(scene.view(), scene.camera, disturbed(scene), {}, first);
  EXPECT_EQ(moved_to.camera_from_world, before.camera_from_world);
  EXPECT_EQ(moved_from.camera_from_world, before.camera_from_world);
}

TEST(PoseRefinementWorkspace, LeavesOnlyTheResultToAllocate) {
  const PoseScene scene = makePoseScene(93, 1000, 1.0);
  const Eigen::Isometry3d initial = disturbed(scene);
  PoseRefinementOptions options;
  PoseRefinementWorkspace workspace;
  refinePose(scene.view(), scene.camera, initial, options, workspace);
  const std::size_t before = allocations();
  const auto result = refinePose(scene.view(), scene.camera, initial, options, workspace);
  const std::size_t during = allocations() - before;
  ASSERT_TRUE(result.succeeded());
  // inlier, weight, and the strings of the message: at most one a round and two in the end.
  EXPECT_GE(during, 3U);
  EXPECT_LE(during, 4U + static_cast<std::size_t>(result.rounds));
}

}  // namespace
}  // namespace hmcdyn
