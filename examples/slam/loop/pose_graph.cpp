// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/pose_graph.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "se3_manifold.hpp"
#include "slam/map/optimization_input.hpp"
#include "slam/map/relative_pose_cost.hpp"

namespace hmcdyn::slam {
namespace {

using se3::Matrix6d;

void checkInput(const PoseGraphProblem& problem, const PoseGraphOptions& options) {
  requirePositive("options.huber", options.huber);
  requireAtLeast("options.max_iterations", options.max_iterations, 1);
  requireNotNegative("options.function_tolerance", options.function_tolerance);
  requireNotNegative("options.parameter_tolerance", options.parameter_tolerance);
  requireAtLeast("options.threads", options.threads, 1);
  if (!problem.nodes.empty()) {
    requireIndex("gauge", problem.gauge, problem.nodes.size());
  }
  for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
    requireRigid("nodes[" + std::to_string(i) + "]", problem.nodes[i]);
  }
  for (std::size_t k = 0; k < problem.edges.size(); ++k) {
    const std::string name = "edges[" + std::to_string(k) + "].";
    requireIndex(name + "from", problem.edges[k].from, problem.nodes.size());
    requireIndex(name + "to", problem.edges[k].to, problem.nodes.size());
    requireRigid(name + "to_from", problem.edges[k].to_from);
  }
}

/// One node of each connected part: the gauge in its own, the first in the others.
std::vector<int> anchorsOf(const PoseGraphProblem& problem) {
  std::vector<int> part(problem.nodes.size());
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&part](int node) {
    while (part[static_cast<std::size_t>(node)] != node) {
      int& parent = part[static_cast<std::size_t>(node)];
      parent = part[static_cast<std::size_t>(parent)];  // halves the path
      node = parent;
    }
    return node;
  };
  for (const PoseGraphEdge& edge : problem.edges) {
    const int a = root(edge.from);
    const int b = root(edge.to);
    part[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<int> anchors;
  for (int node = 0; node < static_cast<int>(part.size()); ++node) {
    if (root(node) == node) {
      anchors.push_back(node == root(problem.gauge) ? problem.gauge : node);
    }
  }
  return anchors;
}

ceres::Solver::Options solverOptions(const PoseGraphOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = options.threads;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  return solver;
}

void measureErrors(const PoseGraphProblem& problem, PoseGraphSolution& solution) {
  for (const PoseGraphEdge& edge : problem.edges) {
    const Eigen::Isometry3d error = solution.nodes[static_cast<std::size_t>(edge.to)] *
                                    solution.nodes[static_cast<std::size_t>(edge.from)].inverse() *
                                    edge.to_from.inverse();
    const se3::Vector6d d = se3::stepOf(error);
    solution.squared_error.push_back(d.dot(edge.information * d));
  }
}

}  // namespace

const char* toString(PoseGraphTermination termination) noexcept {
  switch (termination) {
    case PoseGraphTermination::kConverged:
      return "converged";
    case PoseGraphTermination::kIterationLimit:
      return "iteration limit";
    case PoseGraphTermination::kNothingToDo:
      return "nothing to do";
    case PoseGraphTermination::kNumericalFailure:
      return "numerical failure";
  }
  return "invalid";
}

PoseGraphSolution optimizePoseGraph(const PoseGraphProblem& problem,
                                    const PoseGraphOptions& options) {
  checkInput(problem, options);
  std::vector<se3::PoseVector> poses;
  for (const Eigen::Isometry3d& node : problem.nodes) {
    poses.push_back(se3::toPoseVector(node));
  }
  ceres::Problem graph;
  for (std::size_t k = 0; k < problem.edges.size(); ++k) {
    const PoseGraphEdge& edge = problem.edges[k];
    const Matrix6d square_root =
        squareRootOf(edge.information, "edges[" + std::to_string(k) + "].information");
    if (edge.from != edge.to) {
      graph.AddResidualBlock(new RelativePoseCost(edge.to_from, square_root),
                             edge.robust ? new ceres::HuberLoss(options.huber) : nullptr,
                             poses[static_cast<std::size_t>(edge.from)].data(),
                             poses[static_cast<std::size_t>(edge.to)].data());
    }
  }
  PoseGraphSolution solution;
  solution.nodes = problem.nodes;
  solution.message = toString(solution.termination);
  if (graph.NumResidualBlocks() == 0) {
    measureErrors(problem, solution);
    return solution;
  }
  for (se3::PoseVector& pose : poses) {
    graph.AddParameterBlock(pose.data(), se3::kPoseSize, new se3::Manifold);
  }
  for (const int anchor : anchorsOf(problem)) {
    graph.SetParameterBlockConstant(poses[static_cast<std::size_t>(anchor)].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(options), &graph, &summary);

  const bool usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost) &&
                      std::all_of(poses.begin(), poses.end(),
                                  [](const se3::PoseVector& pose) { return pose.allFinite(); });
  solution.termination = !usable ? PoseGraphTermination::kNumericalFailure
                         : summary.termination_type == ceres::CONVERGENCE
                             ? PoseGraphTermination::kConverged
                             : PoseGraphTermination::kIterationLimit;
  solution.message = std::string(toString(solution.termination)) + ": " + summary.message;
  solution.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  solution.initial_cost = 2.0 * summary.initial_cost;  // Ceres halves the sum
  solution.final_cost = 2.0 * summary.final_cost;
  for (std::size_t i = 0; usable && i < poses.size(); ++i) {
    // Those that stayed, not even by the rounding of a quaternion.
    if (!graph.IsParameterBlockConstant(poses[i].data())) {
      solution.nodes[i] = se3::toIsometry(poses[i]);
    }
  }
  measureErrors(problem, solution);
  return solution;
}

}  // namespace hmcdyn::slam
