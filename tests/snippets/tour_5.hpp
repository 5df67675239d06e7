// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <hmcdyn/filter_stage.hpp>

struct Frame {
  hmcdyn::KeyPoints points;
  std::vector<float> distance;
  std::vector<hmcdyn::DetectionBox> boxes;
};
extern std::vector<Frame> frames;
extern std::vector<float> depth, distance;
void consume(const hmcdyn::FilterStageResult& result);
void consume(const std::vector<int>& labels);
