// SPDX-License-Identifier: BSD-3-Clause
// One linearisation of eq. 10, collapsed: a single pass over the points gives the cost, the 6x6
// normal equations and every squared residual.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/residual.hpp"

namespace hmcdyn::detail {

/// So many points lie together, field by field.
constexpr std::size_t kBlock = 8;
using BlockField = std::array<double, kBlock>;

/// Fields that a variant does without are not read. Unused places at the end have weight 0 and
/// stand where every formula is finite.
struct PointBlock {
  // Does not write zeros that would be overwritten anyway.
  PointBlock() {}  // NOLINT(cppcoreguidelines-pro-type-member-init,modernize-use-equals-default)

  BlockField x, y, z;            ///< Map points (m).
  BlockField u, v;               ///< Pixels, measured from the principal point.
  BlockField information;        ///< 1 / sigma^2 of both pixel rows.
  BlockField weight;             ///< lambda^2; 0 leaves the point out of the sums.
  BlockField huber;              ///< Threshold (sigma); kNoHuber for none.
  BlockField third;              ///< Third row: depth (m), or right column, measured like u.
  BlockField third_information;  ///< 0 where the point has no third row.
  BlockField inverse_kappa;      ///< 1 / kappa of a suspect in the joint mode, else 0.
};

/// No residual comes near, and its square is finite.
constexpr double kNoHuber = 1e150;

/// What varies between linearisations: each combination is a kernel of its own.
struct CollapseVariant {
  DepthRow depth_row = DepthRow::kNone;
  bool huber = false;
  bool switchable = false;  ///< Some point has an inverse_kappa.

  friend bool operator==(const CollapseVariant& a, const CollapseVariant& b) {
    return a.depth_row == b.depth_row && a.huber == b.huber && a.switchable == b.switchable;
  }
};

/// With f_i = lambda_i^2 rho'(|e_i|^2), J_i = de_i/d(omega, v) as in pointResidual().
struct CollapsedSystem {
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();    ///< sum f J^T J
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();  ///< sum f J^T e
  double cost = 0.0;  ///< sum lambda^2 rho(|e|^2); infinite where a point of positive weight is
                      ///< not in front of the camera, or a sum is not finite.
};

/// Squared residuals beyond this are those of points that are not in front of the camera.
constexpr double kBehindCamera = 1e200;

/// Collapses all blocks at a pose. `squared_residuals` gets |e_i|^2 of each point, whatever its
/// weight, and more than kBehindCamera where it is not in front; it has kBlock entries a block.
CollapsedSystem collapse(const std::vector<PointBlock>& blocks, const ProjectionModel& model,
                         CollapseVariant variant, const Eigen::Matrix3d& rotation,
                         const Eigen::Vector3d& translation,
                         std::vector<double>& squared_residuals);

}  // namespace hmcdyn::detail
