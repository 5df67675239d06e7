// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/bundle_adjustment.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <utility>

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "se3_manifold.hpp"
#include "slam/map/bundle_cost.hpp"
#include "slam/map/optimization_input.hpp"
#include "slam/map/relative_pose_cost.hpp"

namespace hmcdyn::slam {
namespace {

using Mask = std::vector<std::uint8_t>;

void checkOptions(const BundleOptions& options) {
  checkModel(options.depth_error);
  requirePositive("options.huber_two_rows", options.huber_two_rows);
  requirePositive("options.huber_three_rows", options.huber_three_rows);
  requireAtLeast("options.rounds", options.rounds, 1);
  require(options.plain_rounds >= 0 && options.plain_rounds <= options.rounds,
          "options.plain_rounds", std::to_string(options.plain_rounds),
          "0..options.rounds, " + std::to_string(options.rounds));
  requirePositive("options.chi2_two_rows", options.chi2_two_rows);
  requirePositive("options.chi2_three_rows", options.chi2_three_rows);
  requirePositive("options.min_depth", options.min_depth);
  requireAtLeast("options.max_iterations", options.max_iterations, 1);
  requireNotNegative("options.function_tolerance", options.function_tolerance);
  requireAtLeast("options.max_dense_poses", options.max_dense_poses, 0);
  requireAtLeast("options.threads", options.threads, 1);
}

void checkMotions(const BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.motions.size(); ++i) {
    const BundleMotion& motion = problem.motions[i];
    const std::string name = "motions[" + std::to_string(i) + "].";
    requireIndex(name + "from", motion.from, problem.poses.size());
    requireIndex(name + "to", motion.to, problem.poses.size());
    require(motion.from != motion.to, name + "to", std::to_string(motion.to), "another than from");
    requireRigid(name + "to_from", motion.to_from);
    squareRootOf(motion.information, name + "information");
  }
}

void checkProblem(const BundleProblem& problem) {
  requirePositive("camera.fx", problem.camera.fx);
  requirePositive("camera.fy", problem.camera.fy);
  require(std::isfinite(problem.camera.cx) && std::isfinite(problem.camera.cy), "camera.cx, cy",
          "not finite", "finite");
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    requireRigid("poses[" + std::to_string(i) + "]", problem.poses[i].camera_from_world);
  }
  require(problem.depth_offsets.empty() || problem.depth_offsets.size() == problem.points.size(),
          "depth_offsets", std::to_string(problem.depth_offsets.size()) + " values",
          "none or one a point, " + std::to_string(problem.points.size()));
  for (std::size_t i = 0; i < problem.depth_offsets.size(); ++i) {
    require(std::isfinite(problem.depth_offsets[i]), "depth_offsets[" + std::to_string(i) + "]",
            std::to_string(problem.depth_offsets[i]), "a finite offset (1/m)");
  }
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    const auto good = [](float value) { return std::isfinite(value) && value >= 0.0f; };
    // The names are made only where they are needed: there are many observations.
    if (observation.pose < 0 || observation.point < 0 || !good(observation.sigma) ||
        observation.sigma == 0.0f || !good(observation.weight) ||
        static_cast<std::size_t>(observation.pose) >= problem.poses.size() ||
        static_cast<std::size_t>(observation.point) >= problem.points.size()) {
      const std::string name = "observations[" + std::to_string(i) + "].";
      requireIndex(name + "pose", observation.pose, problem.poses.size());
      requireIndex(name + "point", observation.point, problem.points.size());
      requirePositive(name + "sigma", observation.sigma);
      requireNotNegative(name + "weight", observation.weight);
    }
  }
}

/// An observation that may take part: finite and of positive weight.
struct Candidate {
  std::size_t index = 0;  ///< In the caller's observations.
  std::size_t pose = 0;
  std::size_t point = 0;
  double weight = 1.0;
  BundleMeasurement measurement;
};

bool isFinite(const BundleObservation& observation, const Eigen::Vector3d& point) {
  return std::isfinite(observation.u) && std::isfinite(observation.v) && point.allFinite();
}

std::vector<Candidate> collect(const BundleProblem& problem, const BundleOptions& options,
                               std::size_t& not_finite) {
  std::vector<Candidate> candidates;
  candidates.reserve(problem.observations.size());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    if (!isFinite(observation, problem.points[static_cast<std::size_t>(observation.point)])) {
      ++not_finite;
    } else if (observation.weight > 0.0f) {
      candidates.push_back({i, static_cast<std::size_t>(observation.pose),
                            static_cast<std::size_t>(observation.point), observation.weight,
                            measurementOf(observation, options)});
    }
  }
  return candidates;
}

/// The unknowns in the form in which Ceres moves them.
struct State {
  std::vector<se3::PoseVector> poses;
  std::vector<PointVector> points;
};

/// How many rows of a measurement are of use at a point in the camera's frame: all within the test
/// of all; else the two of the pixel within theirs; else none. Without `chi2` all in front of the
/// camera.
std::uint8_t usableRows(const BundleMeasurement& measurement, const BundleModel& model,
                        const Eigen::Vector3d& in_camera, double depth_offset,
                        const BundleOptions& options, bool chi2) {
  if (!(in_camera.z() >= model.min_depth)) {
    return 0;
  }
  const auto all = static_cast<std::uint8_t>(measurement.rows);
  if (!chi2) {
    return all;
  }
  const Eigen::Vector3d e = bundleResidual(measurement, model, in_camera, depth_offset);
  if (measurement.rows == 3 && e.squaredNorm() <= options.chi2_three_rows) {
    return all;
  }
  return e.head<2>().squaredNorm() <= options.chi2_two_rows ? 2 : 0;
}

/// Rows of each candidate that agree with the state.
Mask choose(const std::vector<Candidate>& candidates, const State& state, const BundleModel& model,
            const BundleOptions& options, bool chi2) {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(state.poses.size());
  for (const se3::PoseVector& pose : state.poses) {
    poses.push_back(se3::toIsometry(pose));
  }
  Mask mask;
  mask.reserve(candidates.size());
  for (const Candidate& candidate : candidates) {
    const PointVector& point = state.points[candidate.point];
    const Eigen::Vector3d p = poses[candidate.pose] * point.head<3>();
    mask.push_back(usableRows(candidate.measurement, model, p, point[3], options, chi2));
  }
  return mask;
}

/// What a round may move.
struct Freedom {
  Mask active;     ///< One entry a candidate: its rows that count.
  Mask free_pose;  ///< One entry a pose.
  std::size_t observations = 0;
  std::size_t free_poses = 0;
};

Freedom freedomOf(const BundleProblem& problem, const std::vector<Candidate>& candidates,
                  Mask active) {
  std::vector<int> rows(problem.points.size(), 0);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    rows[candidates[i].point] += active[i];
  }
  Freedom freedom{std::move(active), Mask(problem.poses.size(), 0)};
  std::vector<int> seen(problem.poses.size(), 0);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    // Two rows for three unknowns: the point is free to run along its ray.
    if (rows[candidates[i].point] < 3) {
      freedom.active[i] = 0;
    }
    const int counts = freedom.active[i] != 0 ? 1 : 0;
    seen[candidates[i].pose] += counts;
    freedom.observations += static_cast<std::size_t>(counts);
  }
  constexpr int kFewestPoints = 3;
  bool anchored = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    anchored = anchored || (problem.poses[i].fixed && seen[i] > 0);
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (problem.poses[i].fixed || seen[i] < kFewestPoints) {
      continue;
    }
    freedom.free_pose[i] = anchored ? 1 : 0;
    freedom.free_poses += freedom.free_pose[i];
    anchored = true;  // if nothing was, the first one is it
  }
  return freedom;
}

/// Ends the solver where the caller asks for it.
class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::atomic<bool>* stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return *stop_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::atomic<bool>* stop_;
};

/// Losses are shared where weights are equal: most are 1.
class Losses {
 public:
  Losses(const BundleOptions& options, bool robust)
      : two_(options.huber_two_rows), three_(options.huber_three_rows), robust_(robust) {}

  ceres::LossFunction* of(int rows, double weight) {
    ceres::LossFunction* loss = nullptr;
    if (robust_) {
      loss = rows == 3 ? &three_ : &two_;
    }
    if (weight == 1.0) {
      return loss;
    }
    scaled_.push_back(
        std::make_unique<ceres::ScaledLoss>(loss, weight * weight, ceres::DO_NOT_TAKE_OWNERSHIP));
    return scaled_.back().get();
  }

 private:
  ceres::HuberLoss two_;
  ceres::HuberLoss three_;
  bool robust_;
  std::vector<std::unique_ptr<ceres::LossFunction>> scaled_;
};

/// Of a point's depth offset (1/m), by the first of its observations.
double offsetSigma(const BundleMeasurement& measurement, const DepthErrorModel& model) {
  constexpr double kHeld = 1e-6;       // 1/m: a camera without a systematic error has no offset
  constexpr double kUsualDepth = 2.0;  // m: of a point without any depth its offset does not matter
  const double depth = measurement.rows == 3 ? measurement.observed.z() : kUsualDepth;
  return std::max(kHeld, systematicDepthError(depth, model) / (depth * depth));
}

ceres::Solver::Options solverOptions(const BundleOptions& options, std::size_t free_poses) {
  ceres::Solver::Options solver;
  const bool dense = free_poses <= static_cast<std::size_t>(options.max_dense_poses);
  solver.linear_solver_type = dense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = options.threads;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  return solver;
}

/// One optimisation over the active observations.
ceres::Solver::Summary solveRound(const std::vector<Candidate>& candidates, const Freedom& freedom,
                                  const std::vector<BundleMotion>& motions,
                                  const BundleModel& model, const BundleOptions& options,
                                  bool robust, State& state) {
  std::deque<BundleCost> costs;  // outlives the problem, as the losses do
  std::deque<DepthOffsetPrior> offset_priors;
  std::deque<RelativePoseCost> motion_costs;
  Losses losses(options, robust);
  se3::Manifold manifold;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  se3::keepManifold(ownership);
  ceres::Problem problem(ownership);
  ceres::Solver::Options solver = solverOptions(options, freedom.free_poses);
  auto* ordering = new ceres::ParameterBlockOrdering;
  solver.linear_solver_ordering.reset(ordering);

  Mask known_pose(state.poses.size(), 0);
  Mask known_point(state.points.size(), 0);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (freedom.active[i] == 0) {
      continue;
    }
    const Candidate& candidate = candidates[i];
    double* pose = state.poses[candidate.pose].data();
    double* point = state.points[candidate.point].data();
    if (known_pose[candidate.pose] == 0) {
      known_pose[candidate.pose] = 1;
      problem.AddParameterBlock(pose, se3::kPoseSize, &manifold);
      ordering->AddElementToGroup(pose, 1);
      if (freedom.free_pose[candidate.pose] == 0) {
        problem.SetParameterBlockConstant(pose);
      }
    }
    BundleMeasurement measurement = candidate.measurement;
    measurement.rows = freedom.active[i];
    costs.emplace_back(measurement, model);
    problem.AddResidualBlock(&costs.back(), losses.of(measurement.rows, candidate.weight), pose,
                             point);
    if (known_point[candidate.point] == 0) {
      known_point[candidate.point] = 1;
      ordering->AddElementToGroup(point, 0);
      offset_priors.emplace_back(offsetSigma(candidate.measurement, options.depth_error));
      problem.AddResidualBlock(&offset_priors.back(), nullptr, point);
    }
  }
  for (const BundleMotion& motion : motions) {
    const auto from = static_cast<std::size_t>(motion.from);
    const auto to = static_cast<std::size_t>(motion.to);
    if (known_pose[from] != 0 && known_pose[to] != 0) {
      motion_costs.emplace_back(motion.to_from, squareRootOf(motion.information, "information"));
      problem.AddResidualBlock(&motion_costs.back(), nullptr, state.poses[from].data(),
                               state.poses[to].data());
    }
  }
  StopCallback callback(options.stop);
  if (options.stop != nullptr) {
    solver.callbacks.push_back(&callback);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return summary;
}

/// Points that were given as NaN do not count: no candidate names them.
bool allFinite(const State& state, const std::vector<Candidate>& candidates) {
  return std::all_of(candidates.begin(), candidates.end(), [&state](const Candidate& candidate) {
    return state.poses[candidate.pose].allFinite() && state.points[candidate.point].allFinite();
  });
}

BundleSolution ended(BundleSolution solution, BundleTermination why, const std::string& account) {
  solution.termination = why;
  solution.message = std::string(toString(why)) + ": " + account;
  return solution;
}

/// Takes over a state, and says which observations agree with it.
void adopt(BundleSolution& solution, const State& state, const Freedom& freedom,
           const std::vector<Candidate>& candidates, const Mask& inliers) {
  for (std::size_t i = 0; i < state.poses.size(); ++i) {
    if (freedom.free_pose[i] != 0) {  // the others not even by the rounding of a quaternion
      solution.poses[i] = se3::toIsometry(state.poses[i]);
    }
  }
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    solution.points[i] = state.points[i].head<3>();
    solution.depth_offsets[i] = state.points[i][3];
  }
  solution.used = freedom.observations;
  solution.inliers = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    solution.inlier[candidates[i].index] = inliers[i] != 0 ? 1 : 0;
    solution.inliers += inliers[i] != 0 ? 1 : 0;
  }
}

bool isStopped(const BundleOptions& options) { return options.stop != nullptr && *options.stop; }

BundleSolution runRounds(const BundleProblem& problem, const std::vector<Candidate>& candidates,
                         const BundleModel& model, const BundleOptions& options, State state,
                         BundleSolution solution) {
  const BundleSolution given = solution;
  Mask chosen = choose(candidates, state, model, options, false);
  bool converged = false;
  std::string account = "no observation can be used";
  for (int round = 0; round < options.rounds; ++round) {
    const Freedom freedom = freedomOf(problem, candidates, chosen);
    if (freedom.observations == 0) {
      break;
    }
    const bool robust = round < options.rounds - options.plain_rounds;
    const ceres::Solver::Summary summary =
        solveRound(candidates, freedom, problem.motions, model, options, robust, state);
    // The first entry is the evaluation at the start.
    solution.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    if (!summary.IsSolutionUsable() || !std::isfinite(summary.final_cost) ||
        !allFinite(state, candidates)) {
      return ended(given, BundleTermination::kNumericalFailure, summary.message);
    }
    if (++solution.rounds == 1) {
      solution.initial_cost = 2.0 * summary.initial_cost;  // Ceres halves the sum
    }
    solution.final_cost = 2.0 * summary.final_cost;
    converged = summary.termination_type == ceres::CONVERGENCE;
    account = summary.message;
    chosen = choose(candidates, state, model, options, true);
    adopt(solution, state, freedom, candidates, chosen);
    if (isStopped(options)) {
      return ended(std::move(solution), BundleTermination::kStopped, account);
    }
  }
  if (solution.rounds == 0) {
    return ended(std::move(solution), BundleTermination::kNothingToDo, account);
  }
  return ended(std::move(solution),
               converged ? BundleTermination::kConverged : BundleTermination::kIterationLimit,
               account);
}

}  // namespace

const char* toString(BundleTermination termination) noexcept {
  switch (termination) {
    case BundleTermination::kConverged:
      return "converged";
    case BundleTermination::kIterationLimit:
      return "iteration limit";
    case BundleTermination::kStopped:
      return "stopped";
    case BundleTermination::kNothingToDo:
      return "nothing to do";
    case BundleTermination::kNumericalFailure:
      return "numerical failure";
  }
  return "invalid";
}

BundleSolution adjustBundle(const BundleProblem& problem, const BundleOptions& options) {
  checkOptions(options);
  checkProblem(problem);
  checkMotions(problem);
  const BundleModel model{problem.camera, options.min_depth};

  BundleSolution solution;
  State state;
  for (const BundlePose& pose : problem.poses) {
    solution.poses.push_back(pose.camera_from_world);
    state.poses.push_back(se3::toPoseVector(pose.camera_from_world));
  }
  solution.points = problem.points;
  solution.depth_offsets = problem.depth_offsets;
  solution.depth_offsets.resize(problem.points.size(), 0.0);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    PointVector point;
    point << problem.points[i], solution.depth_offsets[i];
    state.points.push_back(point);
  }
  solution.inlier.assign(problem.observations.size(), 0);
  const std::vector<Candidate> candidates = collect(problem, options, solution.not_finite);
  if (isStopped(options)) {
    return ended(std::move(solution), BundleTermination::kStopped, "before the first step");
  }
  return runRounds(problem, candidates, model, options, std::move(state), std::move(solution));
}

}  // namespace hmcdyn::slam
