// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/pose_graph.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "map/bundle_scene.hpp"
#include "se3_manifold.hpp"
#include "slam/map/relative_pose_cost.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using test::gaussian;
using test::moved;
using test::poseDistance;
using test::Random;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::Isometry3d shifted(double x, double y = 0.0, double z = 0.0) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// `n` cameras on a circle of 2 m that look outwards, in order.
std::vector<Eigen::Isometry3d> circle(int n) {
  std::vector<Eigen::Isometry3d> nodes;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / n;
    nodes.push_back(shifted(0.0, 0.0, 2.0) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  }
  return nodes;
}

PoseGraphEdge edgeBetween(const std::vector<Eigen::Isometry3d>& nodes, int from, int to) {
  PoseGraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.to_from =
      nodes[static_cast<std::size_t>(to)] * nodes[static_cast<std::size_t>(from)].inverse();
  return edge;
}

/// The nodes that the edges lead to from nodes[0], in order: dead reckoning.
std::vector<Eigen::Isometry3d> chained(const Eigen::Isometry3d& first,
                                       const std::vector<PoseGraphEdge>& edges, int n) {
  std::vector<Eigen::Isometry3d> nodes{first};
  for (int i = 0; i + 1 < n; ++i) {
    nodes.push_back(edges[static_cast<std::size_t>(i)].to_from * nodes.back());
  }
  return nodes;
}

double largestDistance(const std::vector<Eigen::Isometry3d>& a,
                       const std::vector<Eigen::Isometry3d>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, poseDistance(a[i], b[i]));
  }
  return largest;
}

/// A circle whose odometry is off by 0.5 degrees and 1 cm a step, all to one side, and a right
/// loop.
struct DriftedCircle {
  std::vector<Eigen::Isometry3d> truth = circle(40);
  PoseGraphProblem problem;

  DriftedCircle() {
    for (int i = 0; i + 1 < 40; ++i) {
      PoseGraphEdge edge = edgeBetween(truth, i, i + 1);
      edge.to_from = moved(edge.to_from, {0.0, 0.0087, 0.0}, {0.01, 0.0, 0.0});
      edge.information *= 1e4;  // 1 cm, 0.6 degrees
      problem.edges.push_back(edge);
    }
    problem.nodes = chained(truth[0], problem.edges, 40);
    PoseGraphEdge loop = edgeBetween(truth, 0, 39);
    loop.information *= 1e6;
    loop.robust = true;
    problem.edges.push_back(loop);
  }
};

// By hand: three nodes in a line, odometry 1 + 1, loop 2.3, all of one information. The surplus of
// 0.3 is shared by three springs: each takes 0.1.
TEST(PoseGraph, SharesAnErrorEvenlyOverEqualSprings) {
  PoseGraphProblem problem;
  problem.nodes = {shifted(0.0), shifted(1.0), shifted(2.0)};
  problem.edges = {edgeBetween(problem.nodes, 0, 1), edgeBetween(problem.nodes, 1, 2),
                   edgeBetween(problem.nodes, 0, 2)};
  problem.edges[2].to_from = shifted(2.3);
  const PoseGraphSolution solution = optimizePoseGraph(problem);
  EXPECT_EQ(solution.termination, PoseGraphTermination::kConverged) << solution.message;
  EXPECT_LT(poseDistance(solution.nodes[1], shifted(1.1)), 1e-6);
  EXPECT_LT(poseDistance(solution.nodes[2], shifted(2.2)), 1e-6);
  EXPECT_NEAR(solution.initial_cost, 0.09, 1e-9);
  EXPECT_NEAR(solution.final_cost, 0.03, 1e-9);
  for (const double error : solution.squared_error) {
    EXPECT_NEAR(error, 0.01, 1e-6);
  }
}

TEST(PoseGraph, FindsTheTruthFromEdgesWithoutError) {
  const std::vector<Eigen::Isometry3d> truth = circle(20);
  Random random(1);
  PoseGraphProblem problem;
  problem.gauge = 3;
  for (int i = 0; i < 20; ++i) {
    problem.edges.push_back(edgeBetween(truth, i, (i + 1) % 20));
    problem.edges.push_back(edgeBetween(truth, i, (i + 5) % 20));
    const Eigen::Vector3d turn = gaussian(random, i == 3 ? 0.0 : 0.1);
    problem.nodes.push_back(
        moved(truth[static_cast<std::size_t>(i)], turn, gaussian(random, i == 3 ? 0.0 : 0.2)));
  }
  const PoseGraphSolution solution = optimizePoseGraph(problem);
  EXPECT_EQ(solution.termination, PoseGraphTermination::kConverged) << solution.message;
  EXPECT_LT(largestDistance(solution.nodes, truth), 1e-5);
  EXPECT_EQ(solution.nodes[3].matrix(), problem.nodes[3].matrix());
}

TEST(PoseGraph, ALoopTakesMostOfADriftAway) {
  const DriftedCircle drifted;
  const PoseGraphSolution solution = optimizePoseGraph(drifted.problem);
  EXPECT_EQ(solution.termination, PoseGraphTermination::kConverged) << solution.message;
  const double before = largestDistance(drifted.problem.nodes, drifted.truth);
  EXPECT_GT(before, 0.5);
  EXPECT_LT(largestDistance(solution.nodes, drifted.truth), 0.25 * before);
  EXPECT_LT(poseDistance(solution.nodes[39], drifted.truth[39]), 0.01);
}

TEST(PoseGraph, ARobustFalseLoopAmongRightOnesDoesLittle) {
  DriftedCircle drifted;
  for (const int i : {1, 2, 3, 4}) {
    PoseGraphEdge right = edgeBetween(drifted.truth, i, 35 + i);
    right.information *= 1e6;
    right.robust = true;
    drifted.problem.edges.push_back(right);
  }
  const PoseGraphSolution expected = optimizePoseGraph(drifted.problem);
  PoseGraphEdge wrong = edgeBetween(drifted.truth, 5, 25);
  wrong.to_from = shifted(0.0, 1.0, 0.0);
  wrong.information *= 1e4;
  wrong.robust = true;
  drifted.problem.edges.push_back(wrong);
  const PoseGraphSolution robust = optimizePoseGraph(drifted.problem);
  drifted.problem.edges.back().robust = false;
  const PoseGraphSolution plain = optimizePoseGraph(drifted.problem);
  EXPECT_LT(largestDistance(robust.nodes, expected.nodes),
            0.5 * largestDistance(plain.nodes, expected.nodes));
  EXPECT_GT(robust.squared_error.back(), 12.592);  // and can be told
}

TEST(PoseGraph, APartThatNothingTiesToTheGaugeKeepsItsFirstNode) {
  PoseGraphProblem problem;
  problem.nodes = {shifted(0.0), shifted(1.0), shifted(5.0), shifted(6.0), shifted(9.0)};
  problem.edges = {edgeBetween(problem.nodes, 0, 1), edgeBetween(problem.nodes, 2, 3)};
  problem.edges[1].to_from = shifted(2.0);
  problem.edges.push_back({4, 4, shifted(1.0), Matrix6d::Identity(), false});
  const PoseGraphSolution solution = optimizePoseGraph(problem);
  EXPECT_EQ(solution.nodes[2].matrix(), problem.nodes[2].matrix());
  EXPECT_LT(poseDistance(solution.nodes[3], shifted(7.0)), 1e-6);
  EXPECT_EQ(solution.nodes[4].matrix(), problem.nodes[4].matrix());
}

TEST(PoseGraph, WithoutEdgesEverythingStays) {
  PoseGraphProblem problem;
  EXPECT_EQ(optimizePoseGraph(problem).termination, PoseGraphTermination::kNothingToDo);
  problem.nodes = {shifted(0.0), shifted(1.0)};
  const PoseGraphSolution solution = optimizePoseGraph(problem);
  EXPECT_EQ(solution.termination, PoseGraphTermination::kNothingToDo);
  EXPECT_EQ(solution.nodes[1].matrix(), problem.nodes[1].matrix());
}

TEST(PoseGraph, SameInputGivesTheSameResultBitForBit) {
  const DriftedCircle drifted;
  const PoseGraphSolution first = optimizePoseGraph(drifted.problem);
  const PoseGraphSolution second = optimizePoseGraph(drifted.problem);
  for (std::size_t i = 0; i < first.nodes.size(); ++i) {
    EXPECT_EQ(first.nodes[i].matrix(), second.nodes[i].matrix());
  }
}

TEST(PoseGraph, MistakesAreNamed) {
  const auto complaint = [](const auto& spoil) {
    return invalidArgumentOf([&] {
      PoseGraphProblem problem;
      problem.nodes = {shifted(0.0), shifted(1.0)};
      problem.edges = {edgeBetween(problem.nodes, 0, 1)};
      spoil(problem);
      optimizePoseGraph(problem);
    });
  };
  using Problem = PoseGraphProblem;
  EXPECT_EQ(complaint([](Problem& p) { p.edges[0].to = 2; }),
            "edges[0].to is 2, expected an index below 2");
  EXPECT_EQ(complaint([](Problem& p) { p.gauge = -1; }), "gauge is -1, expected an index below 2");
  EXPECT_EQ(complaint([](Problem& p) { p.edges[0].information(0, 1) = 1.0; }),
            "edges[0].information is not symmetric, expected a symmetric matrix");
  EXPECT_EQ(complaint([](Problem& p) { p.edges[0].information(2, 2) = -1.0; }),
            "edges[0].information is of the eigenvalue -1.000000, expected a positive semidefinite "
            "matrix");
  EXPECT_EQ(complaint([](Problem& p) { p.nodes[1].translation().x() = NAN; }),
            "nodes[1] is not finite, expected a rigid motion");
}

TEST(RelativePoseCost, DerivativesAgreeWithCentralDifferences) {
  Random random(2);
  Matrix6d square_root;
  for (int k = 0; k < 36; ++k) {
    square_root(k / 6, k % 6) = random.uniform(-1.0, 1.0);
  }
  for (const double turn : {0.0, 1e-6, 0.3, 2.5}) {
    const Eigen::Isometry3d from =
        moved(Eigen::Isometry3d::Identity(), {0.3, -0.5, 1.1}, {0.4, -0.2, 0.7});
    const Eigen::Isometry3d to = moved(from, {0.2, 0.1, -0.6}, {0.1, 0.9, -0.3});
    const Eigen::Isometry3d measured =
        moved(to * from.inverse(), turn * Eigen::Vector3d(0.6, -0.64, 0.48), {0.05, -0.1, 0.2});
    const RelativePoseCost cost(measured, square_root);
    const std::array<se3::PoseVector, 2> poses{se3::toPoseVector(from), se3::toPoseVector(to)};
    std::array<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>, 2> analytic;
    Eigen::Matrix<double, 6, 1> value;
    const std::array<const double*, 2> parameters{poses[0].data(), poses[1].data()};
    std::array<double*, 2> jacobians{analytic[0].data(), analytic[1].data()};
    ASSERT_TRUE(cost.Evaluate(parameters.data(), value.data(), jacobians.data()));
    for (const std::size_t block : {0U, 1U}) {
      for (int k = 0; k < 6; ++k) {
        constexpr double kDelta = 1e-6;
        std::array<Eigen::Matrix<double, 6, 1>, 2> values;
        for (const std::size_t side : {0U, 1U}) {
          Eigen::Matrix<double, 6, 1> delta = Eigen::Matrix<double, 6, 1>::Zero();
          delta(k) = side == 0 ? -kDelta : kDelta;
          std::array<se3::PoseVector, 2> stepped = poses;
          se3::Manifold().Plus(poses.at(block).data(), delta.data(), stepped.at(block).data());
          const std::array<const double*, 2> at{stepped[0].data(), stepped[1].data()};
          ASSERT_TRUE(cost.Evaluate(at.data(), values.at(side).data(), nullptr));
        }
        const Eigen::Matrix<double, 6, 1> numeric = (values[1] - values[0]) / (2.0 * kDelta);
        EXPECT_LT((analytic.at(block).col(k) - numeric).norm(), 1e-7) << turn << block << k;
      }
      EXPECT_EQ(analytic.at(block).col(6).norm(), 0.0);
    }
  }
}

}  // namespace
}  // namespace hmcdyn::slam
