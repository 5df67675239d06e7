// SPDX-License-Identifier: BSD-3-Clause
// Everything, in the order in which a frame's data flows.
#pragma once

// clang-format off
#include <hmcdyn/version.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/plain_matrix.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/optical_flow.hpp>
#include <hmcdyn/fundamental.hpp>
#include <hmcdyn/epipolar.hpp>
#include <hmcdyn/ego_motion.hpp>
#include <hmcdyn/box_dynamism.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/clustering.hpp>
#include <hmcdyn/cluster_filter.hpp>
#include <hmcdyn/weights.hpp>
#include <hmcdyn/peer_rules.hpp>
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/surface_depth.hpp>
#include <hmcdyn/motion_belief.hpp>
#include <hmcdyn/belief_verdict.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/box_carrier.hpp>
#include <hmcdyn/compact.hpp>
#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/pose_refinement.hpp>
// clang-format on
