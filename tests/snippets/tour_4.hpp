// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/dynamic_feature_filter.hpp>

extern const hmcdyn::DynamicFeatureFilterResult result;
extern std::vector<float> map_x, map_y, map_z, u, v;
extern hmcdyn::PinholeCamera camera;
extern Eigen::Isometry3d predicted_camera_from_world, camera_from_world;
