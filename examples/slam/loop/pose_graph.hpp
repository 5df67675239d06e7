// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmcdyn::slam {

/// What is known of two nodes' relative pose.
struct PoseGraphEdge {
  int from = 0;
  int to = 0;
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();  ///< Camera `to` from camera `from`.
  /// Of delta = (rotation vector (rad), translation (m)), a motion in the frame of `to` that leads
  /// from to_from to the truth; symmetric, positive semidefinite.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
  bool robust = false;  ///< May be wrong: Huber's loss. For loops, not for odometry.
};

struct PoseGraphProblem {
  std::vector<Eigen::Isometry3d> nodes;  ///< camera_from_world, where to start from.
  std::vector<PoseGraphEdge> edges;
  int gauge = 0;  ///< The node that stays.
};

struct PoseGraphOptions {
  double huber = std::sqrt(12.592);   ///< Threshold of robust edges (sigma): 95 % of chi2(6).
  int max_iterations = 50;            ///< Levenberg-Marquardt steps; >= 1.
  double function_tolerance = 1e-8;   ///< Stops at a smaller relative change of the cost.
  double parameter_tolerance = 1e-9;  ///< Stops at a smaller relative step.
  int threads = 1;                    ///< Of Ceres. The same result bit for bit only with 1.
};

/// Why a pose graph optimisation ended.
enum class PoseGraphTermination : std::uint8_t {
  kConverged,
  kIterationLimit,
  kNothingToDo,       ///< No edge, or none that ties a node to another; nodes are as given.
  kNumericalFailure,  ///< The solver gave up; nodes are as given.
};

/// "converged", "iteration limit", "nothing to do" or "numerical failure".
const char* toString(PoseGraphTermination termination) noexcept;

struct PoseGraphSolution {
  std::vector<Eigen::Isometry3d> nodes;  ///< camera_from_world, as many as given.
  std::vector<double> squared_error;  ///< Per edge, at `nodes` (sigma^2): chi2(6) if it is right.
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  PoseGraphTermination termination = PoseGraphTermination::kNothingToDo;
  std::string message;  ///< `termination` in words, with the solver's own account.
};

/// Nodes that agree best with what is known of their relative poses.
///
/// Minimises sum rho(d^T I d), d = (Log R, t) of T_to T_from^-1 to_from^-1, by Levenberg-Marquardt
/// on SE(3). The gauge node stays, and in each part of the graph that no edge ties to it, the first
/// node does. An edge from a node to itself says nothing and is left out.
///
/// @throws std::invalid_argument for an index outside the nodes, a pose that is not a finite rigid
///   motion, an information matrix that is not finite, symmetric and positive semidefinite, or
///   options out of their range.
PoseGraphSolution optimizePoseGraph(const PoseGraphProblem& problem,
                                    const PoseGraphOptions& options = {});

}  // namespace hmcdyn::slam
