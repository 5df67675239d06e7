// SPDX-License-Identifier: BSD-3-Clause
// The collapsed linearisation against the plain sum over the points, and its square root. Built
// twice: with the vector lanes, and with one double a lane.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/kernel.hpp"
#include "pose/residual.hpp"
#include "pose/square_root.hpp"
#include "pose_scene.hpp"

namespace hmcdyn::detail {
namespace {

using test::gaussian3;
using test::moved;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Jacobian = Eigen::Matrix<double, 7, 6>;

struct KernelPoint {
  PointMeasurement measurement;
  double weight = 1.0;
  double huber = 1.0;
  double kappa = 0.0;  // 0: not switchable
};

struct KernelCase {
  ProjectionModel model;
  CollapseVariant variant;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<KernelPoint> points;
};

/// Points in front of a random camera, one in five an outlier; of the others' weights one in six
/// is zero. With a third row, every third point goes without.
KernelCase randomKernelCase(std::mt19937& random, CollapseVariant variant, std::size_t points) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  KernelCase one;
  one.model = {{500.0, 400.0, 320.0, 240.0}, variant.depth_row, 40.0, 0.05};
  one.variant = variant;
  one.pose = moved(Eigen::Isometry3d::Identity(), gaussian3(random, 1.0), gaussian3(random, 2.0));
  for (std::size_t i = 0; i < points; ++i) {
    KernelPoint point;
    const Eigen::Vector3d p = gaussian3(random, 0.5) + Eigen::Vector3d(0.0, 0.0, 3.0);
    const double sigma = 0.5 + uniform(random);
    point.measurement.world = one.pose.inverse() * p;
    point.measurement.observed << one.model.camera.project(p), 0.0;
    point.measurement.observed += gaussian3(random, i % 5 == 0 ? 20.0 : 1.0);
    point.measurement.inverse_sigma << 1.0 / sigma, 1.0 / sigma, 0.0;
    point.measurement.observed.z() = 0.0;
    if (variant.depth_row != DepthRow::kNone && i % 3 != 0) {
      point.measurement.rows = 3;
      const bool depth = variant.depth_row == DepthRow::kDepth;
      point.measurement.observed.z() =
          depth ? p.z() + 0.02 * uniform(random)
                : point.measurement.observed.x() - 40.0 / p.z() + uniform(random);
      point.measurement.inverse_sigma.z() = depth ? 60.0 : 1.0 / sigma;
    }
    point.weight = i % 6 == 5 ? 0.0 : uniform(random);
    point.huber = variant.huber ? 1.0 + uniform(random) : kNoHuber;
    if (variant.switchable && i % 2 == 0) {
      point.kappa = 5.0;
      point.huber = kNoHuber;
    }
    one.points.push_back(point);
  }
  return one;
}

std::vector<PointBlock> blocksOf(const KernelCase& one) {
  std::vector<PointBlock> blocks((one.points.size() + kBlock - 1) / kBlock);
  for (std::size_t i = 0; i < blocks.size() * kBlock; ++i) {
    KernelPoint point;
    point.measurement.world.z() = 1.0;
    point.weight = 0.0;
    if (i < one.points.size()) {
      point = one.points[i];
    }
    PointBlock& block = blocks[i / kBlock];
    const std::size_t k = i % kBlock;
    const PointMeasurement& m = point.measurement;
    block.x[k] = m.world.x();
    block.y[k] = m.world.y();
    block.z[k] = m.world.z();
    block.u[k] = m.observed.x() - one.model.camera.cx;
    block.v[k] = m.observed.y() - one.model.camera.cy;
    block.information[k] = m.inverse_sigma.x() * m.inverse_sigma.x();
    block.weight[k] = point.weight * point.weight;
    block.huber[k] = point.huber;
    block.third[k] = m.observed.z();
    if (one.model.depth_row == DepthRow::kDisparity) {
      block.third[k] -= one.model.camera.cx;
    }
    block.third_information[k] = m.inverse_sigma.z() * m.inverse_sigma.z();
    block.inverse_kappa[k] = point.kappa > 0.0 ? 1.0 / point.kappa : 0.0;
  }
  return blocks;
}

CollapsedSystem collapseAt(const KernelCase& one, const Eigen::Isometry3d& pose,
                           std::vector<double>& squared) {
  const std::vector<PointBlock> blocks = blocksOf(one);
  squared.assign(blocks.size() * kBlock, -1.0);
  return collapse(blocks, one.model, one.variant, pose.linear(), pose.translation(), squared);
}

/// rho and rho' of a point, from their definitions.
std::pair<double, double> lossOf(const KernelPoint& point, double s) {
  if (point.kappa > 0.0) {
    return {point.kappa * s / (point.kappa + s), std::pow(point.kappa / (point.kappa + s), 2)};
  }
  if (std::sqrt(s) > point.huber) {
    return {2.0 * point.huber * std::sqrt(s) - point.huber * point.huber,
            point.huber / std::sqrt(s)};
  }
  return {s, 1.0};
}

CollapsedSystem plainSum(const KernelCase& one) {
  CollapsedSystem system;
  for (const KernelPoint& point : one.points) {
    const auto at_pose =
        pointResidual(point.measurement, one.model, one.pose.linear(), one.pose.translation());
    const auto [rho, slope] = lossOf(point, at_pose->residual.squaredNorm());
    const double factor = point.weight * point.weight * slope;
    system.normal += factor * at_pose->jacobian.transpose() * at_pose->jacobian;
    system.gradient += factor * at_pose->jacobian.transpose() * at_pose->residual;
    system.cost += point.weight * point.weight * rho;
  }
  return system;
}

class Collapse : public ::testing::TestWithParam<CollapseVariant> {};

TEST_P(Collapse, IsThePlainSumOverThePoints) {
  std::mt19937 random(11);
  for (const std::size_t points : {1U, 7U, 8U, 9U, 63U, 64U, 65U, 200U}) {
    const KernelCase one = randomKernelCase(random, GetParam(), points);
    std::vector<double> squared;
    const CollapsedSystem system = collapseAt(one, one.pose, squared);
    const CollapsedSystem expected = plainSum(one);
    EXPECT_TRUE(system.normal.isApprox(expected.normal, 1e-12)) << points;
    EXPECT_TRUE(system.normal.isApprox(system.normal.transpose(), 0.0)) << points;
    EXPECT_LT((system.gradient - expected.gradient).norm(),
              1e-12 * std::sqrt(expected.normal.trace() * expected.cost))
        << points;
    EXPECT_NEAR(system.cost, expected.cost, 1e-12 * expected.cost) << points;
    for (std::size_t i = 0; i < points; ++i) {
      const double s = pointResidual(one.points[i].measurement, one.model, one.pose.linear(),
                                     one.pose.translation())
                           ->residual.squaredNorm();
      EXPECT_NEAR(squared[i], s, 1e-9 * (1.0 + s)) << i;
    }
  }
}

TEST_P(Collapse, HasTheGradientOfItsCost) {
  std::mt19937 random(12);
  const KernelCase one = randomKernelCase(random, GetParam(), 100);
  std::vector<double> squared;
  const CollapsedSystem system = collapseAt(one, one.pose, squared);
  for (int k = 0; k < 6; ++k) {
    constexpr double kStep = 1e-6;
    const Vector6d step = kStep * Vector6d::Unit(k);
    const auto costAt = [&](const Vector6d& delta) {
      return collapseAt(one, moved(one.pose, delta.head<3>(), delta.tail<3>()), squared).cost;
    };
    const double slope = (costAt(step) - costAt(-step)) / (2.0 * kStep);
    EXPECT_NEAR(2.0 * system.gradient[k], slope, 1e-5 * system.gradient.norm()) << k;
  }
}

TEST_P(Collapse, PointBehindTheCameraCountsOnlyWithWeight) {
  std::mt19937 random(13);
  KernelCase one = randomKernelCase(random, GetParam(), 30);
  std::vector<double> squared;
  one.points[3].weight = 0.0;
  const CollapsedSystem before = collapseAt(one, one.pose, squared);
  one.points[3].measurement.world = one.pose.inverse() * Eigen::Vector3d(0.1, 0.2, 0.04);
  const CollapsedSystem without = collapseAt(one, one.pose, squared);
  EXPECT_EQ(without.normal, before.normal);
  EXPECT_EQ(without.gradient, before.gradient);
  EXPECT_EQ(without.cost, before.cost);
  // What follows the points only fills the last block, and may lie anywhere.
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_EQ(squared[i] > kBehindCamera, i == 3) << i << ": " << squared[i];
  }

  one.points[3].weight = 1e-6;
  EXPECT_EQ(collapseAt(one, one.pose, squared).cost, std::numeric_limits<double>::infinity());
}

TEST_P(Collapse, ValuesThatOverflowGiveAnInfiniteCost) {
  std::mt19937 random(14);
  KernelCase one = randomKernelCase(random, GetParam(), 30);
  one.model.camera.fx = 1e200;
  std::vector<double> squared;
  EXPECT_EQ(collapseAt(one, one.pose, squared).cost, std::numeric_limits<double>::infinity());
}

TEST_P(Collapse, SquareRootIsTheSameLeastSquaresProblem) {
  std::mt19937 random(15);
  for (const std::size_t points : {3U, 10U, 100U}) {
    const KernelCase one = randomKernelCase(random, GetParam(), points);
    std::vector<double> squared;
    const CollapsedSystem system = collapseAt(one, one.pose, squared);
    Jacobian jacobian;
    const Vector7d residuals = squareRootOf(system, jacobian);
    EXPECT_TRUE((jacobian.transpose() * jacobian).isApprox(system.normal, 1e-10)) << points;
    EXPECT_LT((jacobian.transpose() * residuals - system.gradient).norm(),
              1e-9 * system.gradient.norm())
        << points;
    EXPECT_NEAR(residuals.squaredNorm(), system.cost, 1e-9 * system.cost) << points;
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, Collapse,
                         ::testing::Values(CollapseVariant{DepthRow::kNone, false, false},
                                           CollapseVariant{DepthRow::kNone, true, false},
                                           CollapseVariant{DepthRow::kNone, false, true},
                                           CollapseVariant{DepthRow::kNone, true, true},
                                           CollapseVariant{DepthRow::kDepth, false, false},
                                           CollapseVariant{DepthRow::kDepth, true, false},
                                           CollapseVariant{DepthRow::kDepth, false, true},
                                           CollapseVariant{DepthRow::kDepth, true, true},
                                           CollapseVariant{DepthRow::kDisparity, false, false},
                                           CollapseVariant{DepthRow::kDisparity, true, false},
                                           CollapseVariant{DepthRow::kDisparity, false, true},
                                           CollapseVariant{DepthRow::kDisparity, true, true}),
                         [](const auto& one) {
                           const CollapseVariant& variant = one.param;
                           const std::string row = variant.depth_row == DepthRow::kNone ? "pixels"
                                                   : variant.depth_row == DepthRow::kDepth
                                                       ? "depth"
                                                       : "disparity";
                           return row + (variant.huber ? "_huber" : "") +
                                  (variant.switchable ? "_switchable" : "");
                         });

TEST(SquareRoot, OfASingularSystemLeavesItsNullSpaceOut) {
  // H = B^T B with B of four rows, g = B^T r: what four residuals would give.
  const Eigen::Matrix<double, 4, 6> b = [] {
    std::mt19937 random(16);
    std::normal_distribution<double> normal(0.0, 1.0);
    Eigen::Matrix<double, 4, 6> m;
    m = m.unaryExpr([&](double) { return normal(random); });
    m.leftCols<3>() *= 1000.0;  // radians weigh more than metres
    return m;
  }();
  const Eigen::Vector4d r(1.0, -2.0, 0.5, 3.0);
  const CollapsedSystem system{b.transpose() * b, b.transpose() * r, r.squaredNorm() + 5.0};
  Jacobian jacobian;
  const Vector7d residuals = squareRootOf(system, jacobian);
  EXPECT_TRUE((jacobian.transpose() * jacobian).isApprox(system.normal, 1e-9));
  EXPECT_TRUE((jacobian.transpose() * residuals).isApprox(system.gradient, 1e-7));
  EXPECT_NEAR(residuals.squaredNorm(), system.cost, 1e-7 * system.cost);
  EXPECT_EQ(Eigen::FullPivLU<Matrix6d>(jacobian.transpose() * jacobian).setThreshold(1e-9).rank(),
            4);
}

TEST(SquareRoot, OfNothingIsTheCostAlone) {
  const CollapsedSystem system{Matrix6d::Zero(), Vector6d::Zero(), 9.0};
  Jacobian jacobian;
  const Vector7d residuals = squareRootOf(system, jacobian);
  EXPECT_TRUE(jacobian.isZero(0.0));
  EXPECT_EQ(residuals, (3.0 * Vector7d::Unit(6)).eval());
}

}  // namespace
}  // namespace hmcdyn::detail
