// SPDX-License-Identifier: BSD-3-Clause
// Core alone: a walker at 2 m before a wall at 3.5 m, in one box.
#include <cstdio>
#include <vector>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/version.hpp>

int main() {
  const std::vector<float> u = {310, 318, 325, 331, 340, 347, 300, 305, 355, 100};
  const std::vector<float> v = {150, 180, 210, 240, 270, 300, 160, 320, 170, 200};
  const std::vector<float> depth = {2.00f, 2.02f, 2.05f, 2.04f, 2.02f,
                                    2.06f, 3.50f, 3.52f, 3.55f, 3.60f};
  const std::vector<float> distance = {3.1f, 2.8f, 3.0f, 3.3f, 3.2f, 2.9f, 0.1f, 0.2f, 0.1f, 0.1f};
  const std::vector<hmcdyn::DetectionBox> boxes = {{290, 140, 370, 330}};

  const hmcdyn::FilterStageResult result = hmcdyn::filterKeyPoints({u, v, depth}, distance, boxes);
  std::printf("hmcdyn %s: %zu of %zu key points dynamic\n", HMCDYN_VERSION_STRING,
              result.frame.dynamic, result.frame.points);
  return result.frame.dynamic == 6 ? 0 : 1;
}
