// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// A key frame of a bundle adjustment.
struct BundlePose {
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  bool fixed = false;  ///< Stays as it is: it holds the map in its place.
};

/// A point as a key frame saw it.
struct BundleObservation {
  int pose = 0;              ///< Index of the key frame.
  int point = 0;             ///< Index of the point.
  float u = 0.0f;            ///< Column (px), of the undistorted image.
  float v = 0.0f;            ///< Row (px), of the undistorted image.
  float sigma = 1.0f;        ///< Standard deviation of a pixel coordinate (px), > 0.
  float depth = 0.0f;        ///< Depth (m); 0, negative or NaN = none.
  float weight = 1.0f;       ///< lambda of eq. 7, >= 0. 0 leaves the observation out.
  float depth_sigma = 0.0f;  ///< Standard deviation of the depth (m), 0 = relativeDepthError().
};

/// What is known of the way from one key frame to another, besides what they see: the camera's
/// motion between them.
struct BundleMotion {
  int from = 0;  ///< Index of a key frame.
  int to = 0;    ///< Index of another.
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();
  /// Inverse covariance of (rotation vector (rad), translation (m)) in the camera's frame of `to`.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
};

/// Key frames, points and what the first saw of the second: a copy, so that it can be solved beside
/// a map that goes on changing.
struct BundleProblem {
  PinholeCamera camera;
  std::vector<BundlePose> poses;
  std::vector<Eigen::Vector3d> points;  ///< World (m).
  /// One a point (1/m): a camera at depth z measures z + offset z^2. Empty = all 0.
  std::vector<double> depth_offsets;
  std::vector<BundleObservation> observations;
  std::vector<BundleMotion> motions;  ///< May be empty.
};

struct BundleOptions {
  DepthErrorModel depth_error;  ///< Of the camera.

  double huber_two_rows = std::sqrt(5.991);    ///< Huber's threshold without a depth (sigma).
  double huber_three_rows = std::sqrt(7.815);  ///< Huber's threshold with a depth (sigma).
  int rounds = 2;                ///< Optimisations, each followed by a new choice of inliers; >= 1.
  int plain_rounds = 1;          ///< How many of the last ones go without robust loss, 0..rounds.
  double chi2_two_rows = 5.991;  ///< Inlier up to this squared residual: 95 % of chi2(2).
  double chi2_three_rows = 7.815;  ///< The same with a depth: 95 % of chi2(3).

  double min_depth = 0.05;           ///< Nearer points (m) count as behind the camera; > 0.
  int max_iterations = 10;           ///< Levenberg-Marquardt steps a round; >= 1.
  double function_tolerance = 1e-5;  ///< Stops at a smaller relative change of the cost.
  int max_dense_poses = 60;  ///< Free key frames up to which the reduced system is kept dense.
  int threads = 1;           ///< Of Ceres. The result is the same bit for bit only with 1.
  const std::atomic<bool>* stop = nullptr;  ///< Looked at before each step: true ends early.
};

/// Why a bundle adjustment ended.
enum class BundleTermination : std::uint8_t {
  kConverged,         ///< The tolerance was met in the last round.
  kIterationLimit,    ///< The last round ended at max_iterations.
  kStopped,           ///< options.stop was set; what was reached until then is in the solution.
  kNothingToDo,       ///< No observation could be used; poses and points are as given.
  kNumericalFailure,  ///< The solver gave up; poses and points are as given.
};

/// "converged", "iteration limit", "stopped", "nothing to do" or "numerical failure".
const char* toString(BundleTermination termination) noexcept;

struct BundleSolution {
  std::vector<Eigen::Isometry3d> poses;  ///< camera_from_world, as many as given.
  std::vector<Eigen::Vector3d> points;   ///< World (m), as many as given.
  std::vector<double> depth_offsets;     ///< One a point (1/m), see BundleProblem.
  /// Per observation: 1 = finite, weight > 0, in front of its camera, and its unweighted squared
  /// residual at `poses` and `points` is within 95 % of chi2, with its depth or without it.
  std::vector<std::uint8_t> inlier;
  std::size_t inliers = 0;     ///< Ones in `inlier`.
  std::size_t used = 0;        ///< Observations of the last round.
  std::size_t not_finite = 0;  ///< Observations left out for a NaN or infinity in them or their
                               ///< point.
  double initial_cost = 0.0;   ///< Cost at the start, over the observations of the first round.
  double final_cost = 0.0;     ///< Cost at the end, over those of the last round.
  int rounds = 0;              ///< Optimisations that ran.
  int iterations = 0;          ///< Levenberg-Marquardt steps, over all rounds.
  BundleTermination termination = BundleTermination::kNothingToDo;
  std::string message;  ///< `termination` in words, with the solver's own account.
};

/// Key frames and points together, from where they were seen.
///
/// Minimises sum lambda^2 rho(|e|^2), e = Q^-1/2 (z - h(R X + t)), the cost of refinePose() with
/// DepthRow::kDepth, plus d^T information d of each motion, d as in optimizePoseGraph(), over the
/// poses that are not fixed and all points, by Levenberg-Marquardt with the points eliminated first
/// (Schur complement). The first rounds are robust; after each, the observations that contradict
/// the result are left out, and others may come back. Where only the depth contradicts, only its
/// row is left out.
///
/// The depths of one point are not independent evidence: what is systematic in them
/// (DepthErrorModel) its views share. So each point has a fourth unknown, the offset of its depths,
/// with the systematic error as its prior: z + offset z^2 is measured at depth z, as a wrong
/// disparity does. Views of a point thus hold each other in place as well as the noise allows, and
/// the world's scale only as well as the systematic error does.
///
/// What cannot be determined stays where it is: a point with a single observation without depth, a
/// pose with fewer than three usable observations, what no usable observation names. An
/// observation from behind its camera takes no part in the round. Without a fixed pose among
/// those that are used, the first of them is held.
///
/// A motion counts where both its key frames have usable observations.
///
/// @throws std::invalid_argument for an index outside its array, an information that is not
///   symmetric and positive semidefinite, a sigma that is not positive and
///   finite, a weight that is negative or not finite, a pose that is not a finite rigid motion,
///   focal lengths that are not positive, options out of their range.
BundleSolution adjustBundle(const BundleProblem& problem, const BundleOptions& options = {});

}  // namespace hmcdyn::slam
