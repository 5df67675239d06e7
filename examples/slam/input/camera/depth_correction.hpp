// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// Takes out what a depth camera gets wrong in every frame alike:
///   z_true = z (scale + growth(u, v) z),
/// a wrong focal length or baseline and, to first order, a wrong disparity that changes over the
/// image (Khoshelham and Elberink 2012; Herrera, Kannala and Heikkila 2012). `growth` is bilinear
/// between nodes that divide the way between the outermost pixel centres evenly.
struct DepthCorrection {
  double scale = 1.0;          ///< Above 0.
  int rows = 0;                ///< Of nodes; 0 = growth is 0 everywhere, else at least 2.
  int columns = 0;             ///< The same.
  std::vector<double> growth;  ///< rows x columns, row by row (1/m).
};

/// True where nothing is taken out.
bool isIdentity(const DepthCorrection& correction);

/// @throws std::invalid_argument naming the field: a scale that is not above 0, a grid of one row
/// or column, another number of nodes than rows x columns, a node that is not finite.
void checkCorrection(const DepthCorrection& correction);

/// The nodes around a pixel of an image and their weights, which sum to 1: growth(u, v) is the sum
/// of weight times node. Pixels outside count as on the border.
struct GridWeights {
  std::array<int, 4> node{};       ///< Indices into DepthCorrection::growth.
  std::array<double, 4> weight{};  ///< 0..1.
};
/// @param rows, columns at least 2. @param image of at least 2 x 2 pixels.
GridWeights gridWeights(int rows, int columns, double u, double v, cv::Size image);

/// growth(u, v) (1/m) in an image of that size.
double growthAt(const DepthCorrection& correction, double u, double v, cv::Size image);

/// A depth image without what the correction knows.
/// @param depth CV_32FC1 (m), 0 = none. @return of the same size and type; 0 where there was none
/// or the correction leaves nothing above 0. Shares its pixels with the argument where there is
/// nothing to correct.
/// @throws std::invalid_argument for another type, fewer than 2 x 2 pixels, or as
/// checkCorrection().
cv::Mat correctDepth(const cv::Mat& depth, const DepthCorrection& correction);

}  // namespace hmcdyn::slam
