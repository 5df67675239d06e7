// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/types.hpp>

extern Eigen::Matrix3d fundamental;
extern std::vector<float> earlier_u, earlier_v, u, v, depth;
extern std::vector<std::uint8_t> keep;
extern std::vector<hmcdyn::DetectionBox> boxes;
