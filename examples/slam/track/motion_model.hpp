// SPDX-License-Identifier: BSD-3-Clause
// What a hand that holds a camera can do from one frame to the next.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmcdyn::slam {

/// White acceleration of an axis: over dt seconds the velocity changes by sqrt(density dt) (s.d.).
struct MotionModelOptions {
  // A third above the liveliest of five recordings of TUM's fr3 (a test measures them).
  double acceleration_density = 0.02;  ///< Of the translation (m^2/s^3): 0.7 mm in 1/30 s.
  double angular_density = 2.0;        ///< Of the rotation (rad^2/s^3): 7 mrad in 1/30 s.
  double max_gap = 0.5;  ///< After a longer pause (s) nothing is known of the velocity.
  /// A measured pose beyond this squared Mahalanobis distance is a jerk that the model does not
  /// know: it stands as measured. The default is the 99.9 % quantile of chi2(6).
  double gate = 22.46;
};

/// @throws std::invalid_argument naming the first option out of range.
void checkOptions(const MotionModelOptions& options);

/// Where a camera is expected, before it is measured.
struct MotionPrediction {
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  /// Of (rotation vector (rad), translation (m)) in the camera's frame, as refinePose() has it;
  /// none where no velocity is known, and the pose is the last one.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;
};

/// Constant velocity with white acceleration on SE(3), as an extended Kalman filter. Steps are
/// delta = (rotation vector (rad), translation (m)) in the camera's frame, as refinePose() has
/// them. What few or far points leave open (turning against moving sideways), the motion before
/// knows; where many points are seen, they decide.
class MotionModel {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  explicit MotionModel(const MotionModelOptions& options = {});

  /// Nothing before the first pose.
  std::optional<MotionPrediction> predict(double timestamp) const;

  struct Update {
    Eigen::Isometry3d camera_from_world;  ///< By measurement and motion together.
    bool fused = false;                   ///< No: as measured, for the model did not expect it.
  };

  /// Takes a measured pose up.
  /// @param covariance of the measured pose, as refinePose() gives it; none = unknown, and the pose
  /// stands as measured.
  Update update(double timestamp, const Eigen::Isometry3d& camera_from_world,
                const std::optional<Matrix6>& covariance);

  /// The world was moved under the camera (a map correction); its velocity stays.
  void relocate(const Eigen::Isometry3d& camera_from_world);

  /// Nothing is known any more.
  void reset();

 private:
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  struct State {
    double timestamp = 0.0;
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
    Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();  ///< (rad/s, m/s)
    Matrix12 covariance = Matrix12::Zero();  ///< Of (delta, velocity).
  };

  bool inReach(double timestamp) const;
  State predicted(double timestamp) const;
  void begin(double timestamp, const Eigen::Isometry3d& camera_from_world,
             const std::optional<Matrix6>& covariance);

  MotionModelOptions options_;
  std::optional<State> state_;
};

}  // namespace hmcdyn::slam
