// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "calibrate/depth_samples.hpp"
#include "slam/input/camera/depth_correction.hpp"

namespace hmcdyn::calibrate {

struct CorrectionFitOptions {
  int rows = 7;     ///< Of nodes over the image, >= 2.
  int columns = 9;  ///< The same.
  /// Expected second difference of neighbouring nodes (1/m); the one that predicts points best
  /// which the fit has not seen is taken.
  std::vector<double> smoothness{0.0002, 0.0005, 0.001, 0.002, 0.004, 0.008};
  double scale_prior = 0.03;   ///< Standard deviation of scale - 1 before anything is measured.
  double growth_prior = 0.03;  ///< The same of a node (1/m).
  /// False: the truth's own scale is not known. It is then set to where the correction changes no
  /// depth on average.
  bool scale_known = false;
};

struct CorrectionFit {
  slam::DepthCorrection correction;
  double truth_scale = 1.0;      ///< What the samples' truth was multiplied by; 1 if scale_known.
  double smoothness = 0.0;       ///< The one taken (1/m).
  double held_out_before = 0.0;  ///< Median of |z - z_true| / z_true where no fit looked.
  double held_out_after = 0.0;   ///< The same, corrected.
  /// Squares between nodes, row by row: 1 = enough points to know. In the others the correction
  /// is the smooth continuation of its neighbours.
  std::vector<std::uint8_t> known_squares;
  std::array<double, 2> known_range{};  ///< Depths (m) that were compared; beyond, as above.
  /// By sample: depth (m) corrected by a fit that has not seen the sample's track.
  std::vector<double> held_out;
};

/// DepthCorrection from samples away from edges, by least squares, reweighted until outliers have
/// no say (Tukey's biweight). Scale and growth are told apart by range: where all points are
/// equally far, only their sum is known, and the priors divide it. Held-out figures are from two
/// fits, each on every second track.
/// @param image size of the images (px).
/// @throws std::runtime_error for fewer than 100 samples away from edges, or where there are
///   fewer than ten points in more than half of the squares between nodes.
CorrectionFit fitCorrection(const std::vector<DepthSample>& samples, cv::Size image,
                            const CorrectionFitOptions& options = {});

/// A depth (m) at a place as the correction leaves it.
double corrected(const slam::DepthCorrection& correction, double depth, double u, double v,
                 cv::Size image);

}  // namespace hmcdyn::calibrate
