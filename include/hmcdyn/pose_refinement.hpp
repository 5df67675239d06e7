// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/plain_matrix.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/span.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// What joins a point's two pixel rows where the point has a depth.
enum class DepthRow : std::uint8_t {
  kNone,       ///< Nothing: two rows.
  kDepth,      ///< (z_observed - z) / sigma_z, in metres before the division.
  kDisparity,  ///< Column in a right camera, u - bf / z, with the pixels' sigma: the stereo row
               ///< that RGB-D systems borrow (ORB-SLAM2, Mur-Artal and Tardos 2017). It suits
               ///< depths from a stereo pair; those of a depth camera say more through kDepth,
               ///< as their error is not a pixel's and u would be counted twice.
};

/// How a residual grows into a cost.
enum class RobustLoss : std::uint8_t {
  kNone,   ///< As its square.
  kHuber,  ///< The same up to a threshold, beyond it linear (Huber 1964).
};

/// What becomes of the weights 0 < lambda < 1 of suspect points.
enum class WeightMode : std::uint8_t {
  kFixed,  ///< They stay as given.
  kJoint,  ///< They are optimised with the pose, held by a prior: see refinePose().
};

/// Who minimises. Both find the same minimum, and both leave the trust region to Ceres; they differ
/// in time and, in the last digits that the tolerances leave open, in the result.
enum class PoseSolver : std::uint8_t {
  kCollapsed,  ///< ceres::TinySolver on seven residuals a linearisation, into which one
               ///< vectorised pass over the points collapses the rest: some tens of times faster.
  kCeresProblem,  ///< ceres::Solver on one residual block a point: the yardstick.
};

/// Map points and where the frame saw them: structure of arrays, borrowed. x, y, z, u and v have
/// one size; the others have that size or are empty.
struct PoseObservations {
  Span<const float> x;       ///< Map points Z_i in the world's frame (m), taken as exact: x,
  Span<const float> y;       ///< y,
  Span<const float> z;       ///< z.
  Span<const float> u;       ///< Observed pixels z_i, of the undistorted image: columns (px),
  Span<const float> v;       ///< rows (px).
  Span<const float> sigma;   ///< Standard deviation of a pixel coordinate (px), > 0; empty = 1.
  Span<const float> depth;   ///< Observed depths (m); 0, negative or NaN = none; empty = none.
  Span<const float> weight;  ///< lambda_i of eq. 7, 0..1; empty = 1. 0 leaves the point out.
  /// Standard deviation of a depth (m), > 0; empty = by PoseRefinementOptions::depth_error. Only
  /// for DepthRow::kDepth.
  Span<const float> depth_sigma = {};

  /// N, the number of observations.
  std::size_t size() const noexcept { return x.size(); }
};

/// What is minimised, by whom, and when it ends.
struct PoseRefinementOptions {
  DepthRow depth_row = DepthRow::kNone;  ///< Of points with a depth.
  /// sigma_z of a depth without one of its own: depthError(), noise and systematic error together,
  /// since nothing is known of where the map points come from.
  DepthErrorModel depth_error;
  double baseline_fx = 40.0;  ///< bf of the virtual right camera (px m); 40 suits a Kinect.

  RobustLoss loss = RobustLoss::kHuber;        ///< Of the rounds before the plain ones.
  double huber_two_rows = std::sqrt(5.991);    ///< Threshold without a depth row (sigma).
  double huber_three_rows = std::sqrt(7.815);  ///< Threshold with a depth row (sigma).

  int rounds = 4;                ///< Optimisations, each followed by a new choice of inliers; >= 1.
  int plain_rounds = 1;          ///< How many of the last ones go without robust loss, 0..rounds.
  double chi2_two_rows = 5.991;  ///< Inlier up to this squared residual: 95 % of chi2(2).
  double chi2_three_rows = 7.815;  ///< The same with a depth row: 95 % of chi2(3).

  WeightMode weight_mode = WeightMode::kFixed;  ///< Of suspect points.
  double kappa = 10.0;  ///< Strength of the prior on a weight: a residual of sqrt(kappa) sigma
                        ///< halves it. > 0; only for WeightMode::kJoint.

  double min_depth = 0.05;            ///< Nearer points (m) count as behind the camera; >= 0.
  int max_iterations = 20;            ///< Levenberg-Marquardt steps a round; >= 1.
  double function_tolerance = 1e-8;   ///< Stops at a smaller relative change of the cost, or
                                      ///< (kCollapsed) where the linear model promises a smaller.
  double gradient_tolerance = 1e-10;  ///< Stops at a smaller largest gradient entry.
  double parameter_tolerance = 1e-9;  ///< Stops at a smaller relative step: relative to the sum
                                      ///< of the round's steps (kCollapsed) or to the pose.

  PoseSolver solver = PoseSolver::kCollapsed;  ///< Who minimises.
};

/// Why the refinement stopped. The first two come with a refined pose, the others with the initial
/// one.
enum class PoseRefinementTermination : std::uint8_t {
  kConverged,         ///< A tolerance was met in the last round.
  kIterationLimit,    ///< The last round ended at max_iterations.
  kTooFewPoints,      ///< Fewer than 3 usable points.
  kTooFewInliers,     ///< Fewer than 3 points agree with the pose that was found.
  kNumericalFailure,  ///< The solver gave up, or its pose was not finite.
};

/// "converged", "iteration limit", "too few points", "too few inliers" or "numerical failure".
const char* toString(PoseRefinementTermination termination) noexcept;

/// The refined pose, and how far it can be trusted.
struct PoseRefinementResult {
  /// Refined pose; the initial one, untouched, unless succeeded().
  Pose camera_from_world;
  /// Covariance of delta = (rotation vector (rad), translation (m)), in this order, that leads
  /// from the estimate to the truth by a motion in the camera's frame:
  /// T_true = (Exp(omega), v) * camera_from_world. It is the inverse of
  /// H = sum lambda_i^2 rho'(|e_i|^2) J_i^T J_i over the points of the last round, e whitened:
  /// sigma is taken at its word, lambda_i as an observation of standard deviation sigma_i /
  /// lambda_i. The outlier rounds drop good points too and make it optimistic: with 1 px of noise
  /// on 100 points the squared errors are 17 % larger than it says. None where the points leave a
  /// direction undetermined (H singular) or without a refined pose.
  std::optional<PlainMatrix<6, 6>> covariance;

  std::vector<std::uint8_t> inlier;  ///< Per point: 1 = in front of the camera, weight > 0, and
                                     ///< its unweighted squared residual within 95 % of chi2.
  std::size_t inliers = 0;           ///< Ones in `inlier`.
  std::size_t usable_points = 0;     ///< Finite, weight > 0, in front of the initial camera.
  std::size_t skipped_points = 0;    ///< With a NaN or infinite coordinate: frame data, left out.
  /// Per point: the weight given, or after WeightMode::kJoint the refined weight of a suspect.
  std::vector<float> weight;

  int rounds = 0;             ///< Optimisations that ran (they end early when nothing changes).
  int iterations = 0;         ///< Levenberg-Marquardt steps, over all rounds.
  double initial_cost = 0.0;  ///< Cost at the initial pose, over the points of the first round.
  double final_cost = 0.0;    ///< Cost at the refined pose, over the points of the last round.
  /// Why it stopped.
  PoseRefinementTermination termination = PoseRefinementTermination::kTooFewPoints;
  std::string message;  ///< `termination` in words, with the solver's own account.

  /// True where camera_from_world is a refined pose.
  bool succeeded() const noexcept {
    return termination == PoseRefinementTermination::kConverged ||
           termination == PoseRefinementTermination::kIterationLimit;
  }
};

/// Camera pose from weighted map points by Levenberg-Marquardt on SE(3): eq. 9-10.
///
/// Minimises  sum lambda_i^2 rho(|e_i|^2),  e_i = Q_i^-1/2 (z_i - h(R Z_i + t)).
///
/// Without robust loss that is eq. 10. With it the weight stands outside: a small weight lessens
/// what a point has to say, and hides it neither from the Huber threshold nor from the outlier
/// test, both of which look at e_i alone. Scaling all weights by c scales the cost by c^2 and
/// leaves the pose alone.
///
/// Each round optimises over the current inliers (the first: over all usable points) from where
/// the last one ended, then chooses the inliers anew among all points, so that a point can come
/// back. No step is taken that would bring a point of the current round behind the camera.
///
/// Eq. 10 as printed takes the minimum over the lambda_i as well, and that is lambda_i = 0: all
/// points ignored at no cost. So WeightMode::kJoint adds to each suspect a prior around the
/// weight given, as switchable constraints do (Suenderhauf and Protzel 2012):
///   lambda_i^2 |e_i|^2 + kappa (lambda_i - lambda0_i)^2,  0 <= lambda_i <= 1.
/// For a given pose its minimum over lambda_i is lambda0_i kappa / (kappa + |e_i|^2), always
/// within the bounds, which leaves lambda0_i^2 kappa |e_i|^2 / (kappa + |e_i|^2): the Geman-McClure
/// loss. The weights are eliminated this way, exactly; the minimum is that of the joint problem.
/// This loss takes the place of Huber's for suspects. It is an insurance, and off by default: over
/// 300 synthetic frames (180 suspects with weights that know nothing, 20 points beyond suspicion,
/// 1 px of noise) it lowers the RMSE of the translation from 13 to 2.7 mm where 108 suspects move
/// by 10 px, from 6.6 to 4.0 mm where they move by 4 px, and raises it from 1.6 to 1.8 mm where
/// none moves.
///
/// One thread, no state, the same result bit for bit for the same input.
///
/// @param initial camera_from_world to start from, e.g. the motion model's prediction.
/// @throws std::invalid_argument for arrays of unequal sizes, a weight that is negative or not
///   finite, a sigma that is not positive and finite, DepthRow without a depth array, an initial
///   pose that is not finite or not a rigid motion, focal lengths that are not positive, options
///   out of their range. Everything else comes back in the result.
PoseRefinementResult refinePose(const PoseObservations& observations, const PinholeCamera& camera,
                                const Pose& initial, const PoseRefinementOptions& options = {});

namespace detail {
class CollapsedPoseProblem;
}

/// Buffers that refinePose() reuses from one call to the next. What it holds between calls has no
/// influence on results. One thread at a time.
class PoseRefinementWorkspace {
 public:
  PoseRefinementWorkspace();   ///< Holds nothing yet.
  ~PoseRefinementWorkspace();  ///< Frees the buffers.
  PoseRefinementWorkspace(const PoseRefinementWorkspace&) = delete;
  PoseRefinementWorkspace& operator=(const PoseRefinementWorkspace&) = delete;
  /// Takes the buffers over; `other` may be assigned to or destroyed only.
  PoseRefinementWorkspace(PoseRefinementWorkspace&& other) noexcept;
  /// The same.
  PoseRefinementWorkspace& operator=(PoseRefinementWorkspace&& other) noexcept;

 private:
  friend PoseRefinementResult refinePose(const PoseObservations& observations,
                                         const PinholeCamera& camera, const Pose& initial,
                                         const PoseRefinementOptions& options,
                                         PoseRefinementWorkspace& workspace);
  std::unique_ptr<detail::CollapsedPoseProblem> problem_;
};

/// The same for callers that refine every frame: once the workspace has seen as many points, only
/// the result's own arrays and message are allocated.
PoseRefinementResult refinePose(const PoseObservations& observations, const PinholeCamera& camera,
                                const Pose& initial, const PoseRefinementOptions& options,
                                PoseRefinementWorkspace& workspace);

}  // namespace hmcdyn
