// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/motion_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "random.hpp"
#include "shared_data.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using hmcdyn::test::Random;
using Matrix6 = MotionModel::Matrix6;

constexpr double kStep = 1.0 / 30.0;  // s

Eigen::Isometry3d sideways(double x) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.0));
}

/// Standard deviation of every angle (rad) and coordinate (m).
Matrix6 certain(double sigma) { return sigma * sigma * Matrix6::Identity(); }

/// The textbook Kalman filter of one coordinate with white acceleration: the oracle.
struct ScalarFilter {
  double position = 0.0, velocity = 0.0;
  double pp = 0.0, pv = 0.0, vv = 0.0;

  void update(double dt, double density, double measured, double variance) {
    position += dt * velocity;
    pp += 2.0 * dt * pv + dt * dt * vv + density * dt * dt * dt / 3.0;
    pv += dt * vv + density * dt * dt / 2.0;
    vv += density * dt;
    const double gain_p = pp / (pp + variance);
    const double gain_v = pv / (pp + variance);
    const double innovation = measured - position;
    position += gain_p * innovation;
    velocity += gain_v * innovation;
    vv -= gain_v * pv;
    pv *= 1.0 - gain_p;
    pp *= 1.0 - gain_p;
  }
};

TEST(MotionModel, OfOneCoordinateIsTheTextbookFilter) {
  MotionModelOptions options;
  options.gate = 1e9;
  MotionModel model(options);
  ScalarFilter oracle;
  Random random(5);
  oracle.position = 0.1;
  oracle.pp = 0.01 * 0.01;
  oracle.vv = 100.0;
  model.update(0.0, sideways(0.1), certain(0.01));
  double time = 0.0;
  for (int k = 0; k < 50; ++k) {
    const double dt = random.uniform(0.01, 0.1);
    const double measured = 0.1 + 0.5 * time + random.normal(0.01);
    time += dt;
    oracle.update(dt, options.acceleration_density, measured, 0.01 * 0.01);
    const MotionModel::Update update = model.update(time, sideways(measured), certain(0.01));
    ASSERT_TRUE(update.fused);
    ASSERT_NEAR(update.camera_from_world.translation().x(), oracle.position, 1e-9) << "step " << k;
  }
}

TEST(MotionModel, ExpectsASteadyTurnToGoOn) {
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.linear() = Eigen::AngleAxisd(0.03, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).matrix();
  step.translation() << 0.01, -0.02, 0.03;
  MotionModel model;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int k = 0; k < 10; ++k) {
    model.update(k * kStep, pose, certain(1e-6));
    pose = step * pose;
  }
  const std::optional<MotionPrediction> expected = model.predict(10 * kStep);
  ASSERT_TRUE(expected && expected->covariance);
  EXPECT_LT((expected->camera_from_world.matrix() - pose.matrix()).norm(), 1e-6);
  // Twice the time, twice the way: the step is taken as one motion at constant velocity.
  const std::optional<MotionPrediction> later = model.predict(11 * kStep);
  ASSERT_TRUE(later);
  EXPECT_LT((later->camera_from_world.matrix() - (step * pose).matrix()).norm(), 2e-3);
}

TEST(MotionModel, LessensTheNoiseOfPosesThatAreUncertain) {
  Random random(3);
  double measured_square = 0.0;
  double fused_square = 0.0;
  MotionModel model;
  for (int k = 0; k < 600; ++k) {
    const double truth = 0.3 * std::sin(k * kStep);  // 0.3 m/s^2 at most
    const double measured = truth + random.normal(0.02);
    const MotionModel::Update update = model.update(k * kStep, sideways(measured), certain(0.02));
    const double error = update.camera_from_world.translation().x() - truth;
    measured_square += (measured - truth) * (measured - truth);
    fused_square += error * error;
  }
  EXPECT_LT(fused_square, 0.5 * measured_square);
}

TEST(MotionModel, AJerkStandsAsMeasured) {
  MotionModel model;
  for (int k = 0; k < 10; ++k) {
    model.update(k * kStep, sideways(0.0), certain(0.001));
  }
  const MotionModel::Update jerk = model.update(10 * kStep, sideways(0.5), certain(0.001));
  EXPECT_FALSE(jerk.fused);
  EXPECT_EQ(jerk.camera_from_world.translation().x(), 0.5);
  // From there it starts anew, with a velocity that is not known.
  const MotionModel::Update next = model.update(11 * kStep, sideways(0.52), certain(0.001));
  EXPECT_TRUE(next.fused);
  EXPECT_NEAR(next.camera_from_world.translation().x(), 0.52, 1e-4);
}

TEST(MotionModel, TimeThatStandsStillGoesBackOrLeapsTellsNothing) {
  for (const double timestamp : {1.0, 0.5, 2.0, std::nan("")}) {
    MotionModel model;
    model.update(1.0 - kStep, sideways(0.0), certain(0.001));
    model.update(1.0, sideways(0.01), certain(0.001));
    const std::optional<MotionPrediction> expected = model.predict(timestamp);
    ASSERT_TRUE(expected);
    EXPECT_FALSE(expected->covariance) << timestamp;
    EXPECT_NEAR(expected->camera_from_world.translation().x(), 0.01, 1e-3) << "the last pose";
    const MotionModel::Update update = model.update(timestamp, sideways(0.3), certain(0.001));
    EXPECT_FALSE(update.fused) << timestamp;
    EXPECT_EQ(update.camera_from_world.translation().x(), 0.3) << timestamp;
  }
}

TEST(MotionModel, WithoutCovarianceThePoseStandsAndNothingIsKnown) {
  MotionModel model;
  EXPECT_FALSE(model.predict(0.0));
  model.update(0.0, sideways(0.0), certain(0.001));
  const MotionModel::Update update = model.update(kStep, sideways(0.1), std::nullopt);
  EXPECT_FALSE(update.fused);
  EXPECT_EQ(update.camera_from_world.translation().x(), 0.1);
  EXPECT_FALSE(model.predict(2 * kStep));
}

TEST(MotionModel, KeepsItsVelocityWhenTheWorldIsMoved) {
  MotionModel model;
  for (int k = 0; k < 20; ++k) {
    model.update(k * kStep, sideways(0.01 * k), certain(1e-5));
  }
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  moved.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()).matrix();
  moved.translation() << 5.0, 6.0, 7.0;
  model.relocate(moved);
  const std::optional<MotionPrediction> expected = model.predict(20 * kStep);
  ASSERT_TRUE(expected);
  // The velocity is the camera's own: 1 cm along its x.
  EXPECT_LT((expected->camera_from_world.matrix() - (sideways(0.01) * moved).matrix()).norm(),
            1e-4);
  model.reset();
  EXPECT_FALSE(model.predict(21 * kStep));
}

TEST(MotionModel, RotationsStayRotationsOverALongRun) {
  Random random(9);
  MotionModel model;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int k = 0; k < 20000; ++k) {
    const Eigen::Vector3d turn(random.normal(0.01), random.normal(0.01), random.normal(0.01));
    pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.linear();
    pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().matrix();
    const MotionModel::Update update = model.update(k * kStep, pose, certain(0.01));
    model.relocate(update.camera_from_world);
    const Eigen::Matrix3d r = update.camera_from_world.linear();
    ASSERT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-12) << "step " << k;
  }
}

TEST(MotionModel, OptionsOutOfRangeAreNamed) {
  const auto message = [](double MotionModelOptions::*option, double value) {
    MotionModelOptions options;
    options.*option = value;
    return invalidArgumentOf([&] { MotionModel model(options); });
  };
  EXPECT_EQ(message(&MotionModelOptions::acceleration_density, 0.0),
            "MotionModelOptions::acceleration_density is 0.000000; expected a finite value > 0");
  EXPECT_NE(message(&MotionModelOptions::angular_density, -1.0), "nothing thrown");
  EXPECT_NE(message(&MotionModelOptions::max_gap, std::nan("")), "nothing thrown");
  EXPECT_NE(message(&MotionModelOptions::gate, HUGE_VAL), "nothing thrown");
}

/// One line of TUM's ground truth.
struct StampedPose {
  double timestamp = 0.0;
  Eigen::Vector3d translation;
  Eigen::Quaterniond rotation;
};

/// Between its lines, 10 ms apart, straight on; none in gaps.
std::vector<std::optional<StampedPose>> atThirtyHertz(const std::string& file) {
  std::ifstream in(file);
  std::vector<StampedPose> recorded;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    StampedPose pose;
    Eigen::Vector3d& t = pose.translation;
    Eigen::Quaterniond& q = pose.rotation;
    if (line[0] != '#' &&
        fields >> pose.timestamp >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w()) {
      recorded.push_back(pose);
    }
  }
  std::vector<std::optional<StampedPose>> even;
  std::size_t i = 0;
  for (double time = recorded.front().timestamp; time < recorded.back().timestamp; time += kStep) {
    while (recorded[i + 1].timestamp <= time) {
      ++i;
    }
    const StampedPose& a = recorded[i];
    const StampedPose& b = recorded[i + 1];
    const double gap = b.timestamp - a.timestamp;
    if (gap > 0.05) {
      even.emplace_back();
      continue;
    }
    const double share = (time - a.timestamp) / gap;
    even.push_back(StampedPose{time, a.translation + share * (b.translation - a.translation),
                               a.rotation.slerp(share, b.rotation)});
  }
  return even;
}

struct Densities {
  double translation = 0.0;  ///< (m^2/s^3)
  double rotation = 0.0;     ///< (rad^2/s^3)
};

/// The second difference of white acceleration has the variance 2/3 density dt^3 an axis.
Densities densitiesOf(const std::string& file) {
  const std::vector<std::optional<StampedPose>> poses = atThirtyHertz(file);
  Densities sum;
  double count = 0.0;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    if (!poses[i - 2] || !poses[i - 1] || !poses[i]) {
      continue;
    }
    const StampedPose& a = *poses[i - 2];
    const StampedPose& b = *poses[i - 1];
    const StampedPose& c = *poses[i];
    sum.translation += (c.translation - 2.0 * b.translation + a.translation).squaredNorm();
    const double angle =
        (a.rotation.conjugate() * b.rotation).angularDistance(b.rotation.conjugate() * c.rotation);
    sum.rotation += angle * angle;
    count += 1.0;
  }
  EXPECT_GT(count, 500.0) << file;
  const double to_density = 1.5 / std::pow(kStep, 3) / (3.0 * count);
  return {sum.translation * to_density, sum.rotation * to_density};
}

TEST(MotionModel, DensitiesAreThoseOfTheLiveliestHandHeldCamera) {
  HMCDYN_SKIP_WITHOUT_SHARED("eval/groundtruth");
  Densities largest;
  for (const char* name :
       {"sitting_static", "walk_halfsphere", "walk_rpy", "walk_static", "walk_xyz"}) {
    const Densities found = densitiesOf(
        hmcdyn::test::sharedPath(std::string("eval/groundtruth/fr3_") + name + ".txt").string());
    largest.translation = std::max(largest.translation, found.translation);
    largest.rotation = std::max(largest.rotation, found.rotation);
  }
  const MotionModelOptions options;
  const auto near = [](double found, double used) { return found <= used && found > 0.5 * used; };
  EXPECT_PRED2(near, largest.translation, options.acceleration_density) << "m^2/s^3";
  EXPECT_PRED2(near, largest.rotation, options.angular_density) << "rad^2/s^3";
}

}  // namespace
}  // namespace hmcdyn::slam
