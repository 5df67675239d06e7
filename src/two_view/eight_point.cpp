// SPDX-License-Identifier: BSD-3-Clause
#include "two_view/eight_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace hmcdyn::internal {
namespace {

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// Similarity that moves the points' centroid to the origin and their mean distance to sqrt 2.
template <class PixelOf>
Eigen::Matrix3d normalization(const std::vector<const Match*>& matches, PixelOf pixel_of) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Match* match : matches) {
    centre += pixel_of(*match);
  }
  centre /= static_cast<double>(matches.size());
  double mean_distance = 0.0;
  for (const Match* match : matches) {
    mean_distance += (pixel_of(*match) - centre).norm();
  }
  mean_distance /= static_cast<double>(matches.size());
  const double scale = mean_distance > 0.0 ? std::sqrt(2.0) / mean_distance : 1.0;
  Eigen::Matrix3d similarity = Eigen::Matrix3d::Identity();
  similarity(0, 0) = scale;
  similarity(1, 1) = scale;
  similarity.topRightCorner<2, 1>() = -scale * centre;
  return similarity;
}

/// 1 / gradient norm of eq. 2, which turns its algebraic residual into a Sampson distance.
double sampsonWeight(const Eigen::Matrix3d& fundamental, const Match& match) {
  const Eigen::Vector2d line_current = (fundamental * match.earlier.homogeneous()).head<2>();
  const Eigen::Vector2d line_earlier =
      (fundamental.transpose() * match.current.homogeneous()).head<2>();
  const double norm = std::sqrt(line_current.squaredNorm() + line_earlier.squaredNorm());
  return norm > 0.0 ? 1.0 / norm : 0.0;
}

Eigen::Matrix3d withRankTwo(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d singular = svd.singularValues();
  singular.z() = 0.0;
  return svd.matrixU() * singular.asDiagonal() * svd.matrixV().transpose();
}

/// Nothing where every weight vanishes (all matches at the epipoles of `weights_from`).
std::optional<EightPointFit> solve(const std::vector<const Match*>& matches,
                                   const Eigen::Matrix3d& weights_from) {
  const Eigen::Matrix3d earlier_normal =
      normalization(matches, [](const Match& match) { return match.earlier; });
  const Eigen::Matrix3d current_normal =
      normalization(matches, [](const Match& match) { return match.current; });
  Matrix9d weighted = Matrix9d::Zero();
  Matrix9d unweighted = Matrix9d::Zero();
  for (const Match* match : matches) {
    const Eigen::Vector3d p1 = earlier_normal * match->earlier.homogeneous();
    const Eigen::Vector3d p2 = current_normal * match->current.homogeneous();
    Vector9d row;
    row << p2.x() * p1, p2.y() * p1, p1;  // eq. 2, linear in F's rows
    unweighted.selfadjointView<Eigen::Lower>().rankUpdate(row);
    row *= sampsonWeight(weights_from, *match);
    weighted.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(weighted);
  if (!(eigen.eigenvalues()(8) > 0.0)) {
    return std::nullopt;
  }
  const Vector9d f = eigen.eigenvectors().col(0);
  Eigen::Matrix3d normalized;
  normalized << f.segment<3>(0).transpose(), f.segment<3>(3).transpose(),
      f.segment<3>(6).transpose();

  EightPointFit fit;
  fit.fundamental = current_normal.transpose() * withRankTwo(normalized) * earlier_normal;
  fit.fundamental /= fit.fundamental.norm();
  // Without the weights: they belong to one solution and make it look better than its rivals, so
  // that one rotation in five would pass for a translation.
  const Vector9d eigenvalues =
      Eigen::SelfAdjointEigenSolver<Matrix9d>(unweighted, Eigen::EigenvaluesOnly).eigenvalues();
  // Exact data: the smallest value is rounding, and any signal at all is well above it.
  const double rounding = std::numeric_limits<double>::epsilon() * eigenvalues(8);
  fit.conditioning = std::sqrt((std::max(eigenvalues(1), 0.0) + rounding) /
                               (std::max(eigenvalues(0), 0.0) + rounding));
  return fit;
}

}  // namespace

double sampsonDistance(const Eigen::Matrix3d& fundamental, const Match& match) {
  return std::abs(match.current.homogeneous().dot(fundamental * match.earlier.homogeneous())) *
         sampsonWeight(fundamental, match);
}

std::optional<EightPointFit> refitFundamental(const std::vector<Match>& matches,
                                              const Eigen::Matrix3d& start, double threshold,
                                              int rounds) {
  std::optional<EightPointFit> fit;
  Eigen::Matrix3d current = start;
  std::vector<const Match*> inliers;
  for (int round = 0; round < rounds; ++round) {
    inliers.clear();
    for (const Match& match : matches) {
      if (sampsonDistance(current, match) <= threshold) {
        inliers.push_back(&match);
      }
    }
    if (inliers.size() < 8) {
      return fit;
    }
    const std::optional<EightPointFit> next = solve(inliers, current);
    if (!next) {
      return fit;
    }
    fit = next;
    current = fit->fundamental;
  }
  return fit;
}

}  // namespace hmcdyn::internal
