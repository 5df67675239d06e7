// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibrate/triangulation.hpp"

namespace hmcdyn::calibrate {

/// A measured depth and what triangulation says it should have been.
struct DepthSample {
  int track = 0;          ///< Which point of the scene.
  int image = 0;          ///< Index of the image.
  double u = 0.0;         ///< Column (px).
  double v = 0.0;         ///< Row (px).
  double measured = 0.0;  ///< Depth at the nearest pixel (m), > 0.
  double truth = 0.0;     ///< Triangulated depth (m), > 0.
  double sigma = 0.0;     ///< Standard deviation of `truth`, the poses taken for true (m).
  double flow_u = 0.0;    ///< The point's motion in the image (px/s).
  double flow_v = 0.0;    ///< The same (px/s).
  double approach = 0.0;  ///< Change of its depth (m/s).
  bool at_edge = false;   ///< Depth jumps, or is missing, within two pixels.
};

struct SampleOptions {
  double largest_sigma = 0.01;  ///< Points triangulated worse have no say (share of depth), > 0.
  double edge_jump = 0.04;      ///< Larger relative differences of depth are an edge.
};

/// The depths of all triangulated points in all images that see them, by track, then image.
std::vector<DepthSample> depthSamples(const std::vector<CalibrationImage>& images,
                                      const Triangulation& triangulation,
                                      const PinholeCamera& camera,
                                      const SampleOptions& options = {});

}  // namespace hmcdyn::calibrate
