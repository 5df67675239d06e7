// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <hmcdyn/depth_error.hpp>

#include "calibrate/depth_samples.hpp"

namespace hmcdyn::calibrate {

/// The errors of depths within a range.
struct RangeStatistics {
  double nearest = 0.0;     ///< (m)
  double farthest = 0.0;    ///< (m)
  double middle = 0.0;      ///< Median of the depths (m).
  std::size_t count = 0;    ///< Samples.
  double bias = 0.0;        ///< Median of z - z_true (m).
  double total = 0.0;       ///< 68th percentile of |z - z_true| (m).
  double noise = 0.0;       ///< What changes between neighbouring images (m).
  double systematic = 0.0;  ///< What does not: total^2 - noise^2 - triangulation^2, rooted (m).
};

/// The same by a third of the image in each direction, all ranges together, as shares of z_true; of
/// samples away from edges: at one, a sample may be of what is beside the point.
struct RegionStatistics {
  int row = 0;            ///< 0..2
  int column = 0;         ///< 0..2
  std::size_t count = 0;  ///< Samples.
  double bias = 0.0;      ///< Median of z / z_true - 1.
  double total = 0.0;     ///< 68th percentile of |z / z_true - 1|.
};

struct ErrorStatistics {
  std::vector<RangeStatistics> ranges;    ///< Those with enough samples, by distance.
  std::vector<RegionStatistics> regions;  ///< Those with enough samples, row by row.
  double at_edges = 0.0;   ///< 68th percentile of |z - z_true| / z_true^2 at edges (1/m); 0 = none.
  double elsewhere = 0.0;  ///< The same away from edges (1/m).
  std::size_t edges = 0;   ///< Samples at edges.
};

struct StatisticsOptions {
  double range_step = 0.5;       ///< Width of a range (m), > 0.
  std::size_t least_count = 50;  ///< Samples that make a range or region.
};

/// Errors of depths, which may have been corrected. Noise is the spread (the 68th
/// percentile over the square root of 2) of the difference of a track's errors in neighbouring
/// images: what both share is gone from it. Ranges count all samples, as a tracker
/// meets them, edges included; regions do not, so that they tell of the camera.
/// @param depths of the samples (m), as many. @param truth_scale multiplies the samples' truth.
ErrorStatistics errorStatistics(const std::vector<DepthSample>& samples,
                                const std::vector<double>& depths, double truth_scale,
                                cv::Size image, const StatisticsOptions& options = {});

/// The model that fits the ranges' noise and systematic error, by least squares in units of
/// their totals, with no field below 0.
/// @throws std::runtime_error without a range.
DepthErrorModel fitModel(const std::vector<RangeStatistics>& ranges);

/// The value below which `share` (0..1) of the values lie; 0 of none.
double percentile(std::vector<double> values, double share);

}  // namespace hmcdyn::calibrate
