// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "slam/output/report/report.hpp"

namespace hmcdyn::test {

/// A run on a curve in the truth's world, at 30 Hz: every frame filled in, the error a slow wave,
/// four frames lost in each hundred, a key frame each tenth.
inline slam::ReportInput sampleRun(std::size_t frames) {
  slam::ReportInput input;
  input.title = "walking_xyz, hmc";
  input.stages = {"rectify", "detect", "features", "filter", "track"};
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / 30.0;
    slam::ReportFrame frame;
    frame.timestamp = 1700000000.0 + t;
    frame.truth = {0.6 * std::sin(0.9 * t), 0.4 * std::cos(0.7 * t),
                   1.3 + 0.15 * std::sin(1.7 * t)};
    frame.error = 0.006 + 0.005 * std::sin(0.8 * t);
    frame.position = frame.truth + Eigen::Vector3d(frame.error, 0.0, 0.0);
    frame.stage_ms = {0.2, 9.0 + 2.0 * std::sin(3.0 * t), 6.0, 5.0 + std::cos(t), 4.0};
    frame.static_points = 700 - i % 50;
    frame.suspect_points = 80 + i % 30;
    frame.dynamic_points = 150 + i % 40;
    frame.unmatched_points = 20;
    frame.boxes = 2;
    frame.dynamic_boxes = i % 60 < 40 ? 2 : 1;
    frame.model = i % 25 < 5 ? "homography" : "fundamental";
    frame.key_frame = i % 10 == 0;
    if (i % 100 >= 90 && i % 100 < 94) {
      frame.failure = "too few matches";
      frame.position = slam::unknownPosition();
      frame.error = std::numeric_limits<double>::quiet_NaN();
    }
    input.frames.push_back(frame);
  }
  return input;
}

}  // namespace hmcdyn::test
