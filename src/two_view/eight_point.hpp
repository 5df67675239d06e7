// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace hmcdyn::internal {

/// A match in pixels: the earlier frame's pixel and the current one's.
struct Match {
  Eigen::Vector2d earlier;
  Eigen::Vector2d current;
};

/// Sampson distance (px) of a match from a fundamental matrix: first-order distance to the nearest
/// pair of pixels that satisfies eq. 2 (Luong, Faugeras 1996).
double sampsonDistance(const Eigen::Matrix3d& fundamental, const Match& match);

struct EightPointFit {
  Eigen::Matrix3d fundamental;
  /// Second smallest over smallest singular value of the normalised, unweighted system.
  double conditioning = 0.0;
};

/// Normalised eight-point algorithm (Hartley 1997) over the matches within `threshold` (px,
/// Sampson) of `start`, re-weighted so that it minimises Sampson distances; nothing with fewer than
/// 8 left, or with all of them at the epipoles.
std::optional<EightPointFit> refitFundamental(const std::vector<Match>& matches,
                                              const Eigen::Matrix3d& start, double threshold,
                                              int rounds);

}  // namespace hmcdyn::internal
