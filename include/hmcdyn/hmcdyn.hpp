// SPDX-License-Identifier: BSD-3-Clause
// Everything, in the order in which a frame's data flows.
#pragma once

// clang-format off
#include <hmcdyn/version.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/plain_matrix.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/steps/optical_flow.hpp>
#include <hmcdyn/steps/fundamental.hpp>
#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/steps/ego_motion.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/steps/clustering.hpp>
#include <hmcdyn/steps/cluster_filter.hpp>
#include <hmcdyn/steps/weights.hpp>
#include <hmcdyn/peers/peer_rules.hpp>
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/votes/surface_depth.hpp>
#include <hmcdyn/votes/motion_belief.hpp>
#include <hmcdyn/votes/belief_verdict.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/steps/box_carrier.hpp>
#include <hmcdyn/compact.hpp>
#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/pose_refinement.hpp>
// clang-format on
