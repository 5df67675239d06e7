// SPDX-License-Identifier: BSD-3-Clause
// Everything, in the order in which a frame's data flows.
#pragma once

#include <hmcdyn/box_dynamism.hpp>
#include <hmcdyn/cluster_filter.hpp>
#include <hmcdyn/clustering.hpp>
#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/ego_motion.hpp>
#include <hmcdyn/epipolar.hpp>
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/fundamental.hpp>
#include <hmcdyn/optical_flow.hpp>
#include <hmcdyn/peer_rules.hpp>
#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/weights.hpp>
