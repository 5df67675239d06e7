// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <hmcdyn/types.hpp>

extern std::vector<float> u, v, depth, distance;
extern std::vector<hmcdyn::DetectionBox> boxes;
