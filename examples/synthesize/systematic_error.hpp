// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>

#include <opencv2/core.hpp>

namespace hmcdyn::synthesize {

/// How wrong a camera is in every frame of a scene alike. All 0 = not at all.
struct SystematicErrorOptions {
  double scale = 0.005;        ///< Standard deviation of the depth's scale error (share).
  double quadratic = 0.010;    ///< RMS over the image of the error that grows with z^2 (1/m).
  double shift_least = 0.3;    ///< Least length of the registration's shift (px).
  double shift_largest = 2.0;  ///< Largest length of it (px).
};

/// The systematic error of one camera: z_measured = z (1 + scale) + quadratic(u, v) z^2, which to
/// first order is a wrong focal length or baseline and a wrong disparity, the latter with a
/// distortion of the depth image (Khoshelham and Elberink 2012; Herrera, Kannala and Heikkila
/// 2012).
struct SystematicError {
  double scale = 0.0;  ///< Share of the depth.
  cv::Mat quadratic;   ///< CV_32FC1 of the image's size (1/m); empty = 0 everywhere.
  cv::Point2d shift;   ///< Depth pixel (u, v) shows what colour shows at (u, v) + shift (px).

  /// Depth (m) that the camera measures at a pixel within the image where the truth is z (m).
  double biased(double z, int u, int v) const {
    const double growth = quadratic.empty() ? 0.0 : static_cast<double>(quadratic.at<float>(v, u));
    return z * (1.0 + scale + growth * z);
  }
};

/// Draws a camera. The quadratic part is a sum of the nine cosines of up to two half waves over
/// width and height, of normal amplitudes that fall with the frequency, brought to the RMS of the
/// options; scale is normal, the shift uniform in length and direction.
/// @throws std::invalid_argument where an option is negative or not finite, or the shift's limits
/// are the wrong way round.
SystematicError drawSystematicError(const SystematicErrorOptions& options, cv::Size size,
                                    std::uint64_t seed);

/// Writes the error as YAML: `scale_error`, `registration_shift: [x, y]` (px), and
/// `quadratic_error: {rows, columns, values}` (1/m), row by row, at nodes that divide the distance
/// between the outermost pixel centres evenly.
/// @throws std::runtime_error where the file cannot be written.
void writeSystematicError(const SystematicError& error, const std::filesystem::path& file);

}  // namespace hmcdyn::synthesize
