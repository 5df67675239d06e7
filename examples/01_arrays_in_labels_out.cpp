// SPDX-License-Identifier: BSD-3-Clause
// The smallest use: a front end that already knows each key point's distance from its epipolar line
// hands over arrays, and gets a label and a weight a key point. Needs hmcdyn::core only.
#include <cstdio>
#include <vector>

#include <hmcdyn/filter_stage.hpp>

int main() {
  // Ten key points in the box of a person who walks at 2 m before a wall at 3.5 m, two outside.
  const std::vector<float> u = {310, 318, 325, 331, 340, 347, 300, 305, 355, 360, 100, 550};
  const std::vector<float> v = {150, 180, 210, 240, 270, 300, 160, 320, 170, 310, 200, 220};
  const std::vector<float> depth = {2.00f, 2.02f, 2.05f, 2.04f, 2.02f, 2.06f,
                                    3.50f, 3.52f, 3.55f, 0.00f, 3.60f, 3.40f};  // m; 0 = none
  const std::vector<float> distance = {3.1f, 2.8f, 3.0f, 3.3f, 0.4f, 2.9f,
                                       0.1f, 0.2f, 0.1f, 2.5f, 0.1f, 0.2f};  // px, eq. 4
  const std::vector<hmcdyn::DetectionBox> boxes = {{290, 140, 370, 330}};

  const hmcdyn::FilterStageResult result = hmcdyn::filterKeyPoints({u, v, depth}, distance, boxes);

  std::printf("  u    v  depth  distance  label      weight\n");
  for (std::size_t i = 0; i < u.size(); ++i) {
    std::printf("%3.0f  %3.0f  %4.1f m  %4.1f px  %-9s  %.2f\n", u[i], v[i], depth[i], distance[i],
                toString(result.label[i]), result.weight[i]);
  }
  std::printf("%zu of %zu boxes move; %zu key points dynamic, %zu suspect\n",
              result.frame.dynamic_boxes, result.frame.boxes, result.frame.dynamic,
              result.frame.suspect);
  return result.frame.dynamic == 6 ? 0 : 1;
}
