// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/steps/epipolar.hpp>

#include "invalid_argument.hpp"
#include "random.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

using test::Random;

/// Single precision against double, in an image of 640x480 pixels.
constexpr double kSinglePrecision = 2e-3;

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& t) {
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  return cross;
}

/// Pairs that own their pixels.
struct Pairs {
  std::vector<float> u1, v1, u2, v2;

  PointPairsView view() const { return {u1, v1, u2, v2}; }
  Pairs swapped() const { return {u2, v2, u1, v1}; }
};

Pairs onePair(float u1, float v1, float u2, float v2) { return {{u1}, {v1}, {u2}, {v2}}; }

Pairs randomPairs(std::size_t n, std::uint32_t seed) {
  Random random(seed);
  Pairs pairs;
  for (std::size_t i = 0; i < n; ++i) {
    pairs.u1.push_back(random.uniformFloat(0.0, 640.0));
    pairs.v1.push_back(random.uniformFloat(0.0, 480.0));
    pairs.u2.push_back(random.uniformFloat(0.0, 640.0));
    pairs.v2.push_back(random.uniformFloat(0.0, 480.0));
  }
  return pairs;
}

Eigen::Isometry3d randomMotion(Random& random) {
  const auto vector = [&](double size) {
    return Eigen::Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                           random.uniform(-size, size));
  };
  return test::motionOf(vector(4.0), vector(0.2));
}

TEST(Epipolar, SidewaysTranslationMeasuresTheRowDifference) {
  // Given a camera that moves along its x axis: lines are rows.
  const Eigen::Matrix3d fundamental = crossMatrix({1.0, 0.0, 0.0});
  const Pairs pairs{
      {10.0f, 600.0f, 5.0f}, {20.0f, 7.25f, 400.0f}, {300.0f, 20.0f, 4.0f}, {23.5f, 7.25f, 150.0f}};

  // When
  const std::vector<float> distance = epipolarDistances(fundamental, pairs.view());

  // Then the distance is |dv|, whatever du is.
  EXPECT_NEAR(distance[0], 3.5, kSinglePrecision);
  EXPECT_NEAR(distance[1], 0.0, kSinglePrecision);
  EXPECT_NEAR(distance[2], 250.0, kSinglePrecision);
}

TEST(Epipolar, ForwardTranslationMeasuresFromTheLineThroughTheEpipole) {
  // Given a camera that moves along its optical axis: every line passes the principal point.
  const Eigen::Matrix3d fundamental = crossMatrix({320.0, 240.0, 1.0});
  // (30, 40) from the epipole, later (60, 80), and 2.5 px aside of the line along (3, 4) / 5.
  const Pairs pairs = onePair(350.0f, 280.0f, 380.0f - 2.0f, 320.0f + 1.5f);

  EXPECT_NEAR(epipolarDistances(fundamental, pairs.view())[0], 2.5, kSinglePrecision);
  EXPECT_NEAR(epipolarDistance(fundamental, {350.0, 280.0}, {378.0, 321.5}), 2.5, 1e-9);
}

TEST(Epipolar, LineHoldsEveryPointOfTheRay) {
  const Eigen::Isometry3d motion = test::motionOf({1.0, -2.0, 0.5}, {0.1, 0.05, -0.02});
  const Eigen::Matrix3d fundamental = test::fundamentalOf(test::kSceneCamera, motion);
  const Eigen::Vector3d line = epipolarLine(fundamental, {100.0, 200.0});
  for (const double depth : {0.5, 1.0, 3.0, 10.0}) {
    const Eigen::Vector2d seen =
        test::kSceneCamera.project(motion * test::kSceneCamera.unproject(100.0, 200.0, depth));
    EXPECT_NEAR(line.dot(seen.homogeneous()) / line.head<2>().norm(), 0.0, 1e-9);
  }
}

TEST(Epipolar, PointsMovedAcrossTheirLineAreThatFarAway) {
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    // Given two poses, and static points moved across their epipolar lines by known amounts
    const Eigen::Isometry3d motion = randomMotion(random);
    test::SceneSettings settings;
    settings.points = 40;
    settings.seed = static_cast<std::uint32_t>(100 + trial);
    test::TwoViewScene scene = test::makeScene(motion, settings);
    std::vector<double> moved;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      const Eigen::Vector2d along =
          test::epipolarDirection(test::kSceneCamera, motion, scene.earlier(i));
      moved.push_back(random.uniform(0.0, 20.0));
      scene.moveCurrent(i, moved.back() * Eigen::Vector2d(-along.y(), along.x()) +
                               random.uniform(-5.0, 5.0) * along);
    }

    // When
    const std::vector<float> distance =
        epipolarDistances(test::fundamentalOf(test::kSceneCamera, motion), scene.pairs());

    // Then
    for (std::size_t i = 0; i < scene.size(); ++i) {
      EXPECT_NEAR(distance[i], moved[i], kSinglePrecision) << "trial " << trial << " point " << i;
    }
  }
}

TEST(Epipolar, VectorisedAgreesWithTheScalarLoop) {
  Random random(7);
  for (const std::size_t n : {0U, 1U, 3U, 7U, 8U, 9U, 64U, 1000U}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Matrix3d fundamental =
          test::fundamentalOf(test::kSceneCamera, randomMotion(random));
      const Pairs pairs = randomPairs(n, static_cast<std::uint32_t>(1000 + trial));
      const std::vector<float> distance = epipolarDistances(fundamental, pairs.view());
      ASSERT_EQ(distance.size(), n);
      for (std::size_t i = 0; i < n; ++i) {
        const double expected =
            epipolarDistance(fundamental, {pairs.u1[i], pairs.v1[i]}, {pairs.u2[i], pairs.v2[i]});
        EXPECT_NEAR(distance[i], expected, kSinglePrecision) << n << " points, trial " << trial;
      }
    }
  }
}

TEST(Epipolar, SinglePrecisionDegradesGentlyNearTheEpipole) {
  // Given forward motion, an epipole in the image, and static points close to it
  Random random(21);
  for (const double radius : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d epipole(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0), 1.0);
      const double angle = random.uniform(0.0, 6.283);
      const Eigen::Vector2d ray(std::cos(angle), std::sin(angle));
      const Eigen::Vector2f earlier = (epipole.head<2>() + radius * ray).cast<float>();
      const Eigen::Vector2f current = (epipole.head<2>() + 1.5 * radius * ray).cast<float>();
      const Pairs pairs = onePair(earlier.x(), earlier.y(), current.x(), current.y());

      // Then they do not look as if they moved.
      EXPECT_NEAR(epipolarDistances(crossMatrix(epipole), pairs.view())[0], 0.0,
                  kSinglePrecision + 0.05 / radius)
          << radius << " px from the epipole";
    }
  }
}

TEST(Epipolar, NaNInAnyCoordinateTouchesThatPointOnly) {
  const Eigen::Matrix3d fundamental = crossMatrix({1.0, 0.0, 0.0});
  for (int broken = 0; broken < 4; ++broken) {
    Pairs pairs{std::vector<float>(9, 1.0f), std::vector<float>(9, 2.0f),
                std::vector<float>(9, 3.0f), std::vector<float>(9, 4.0f)};
    std::vector<float>* arrays[] = {&pairs.u1, &pairs.v1, &pairs.u2, &pairs.v2};
    (*arrays[broken])[4] = kNaN;
    const std::vector<float> distance = epipolarDistances(fundamental, pairs.view());
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_EQ(std::isnan(distance[i]), i == 4) << "array " << broken << " point " << i;
    }
    EXPECT_TRUE(std::isnan(transferDistances(Eigen::Matrix3d::Identity(), pairs.view())[4]));
  }
}

TEST(Epipolar, InfinitePixelsHaveNoDistance) {
  const float infinity = std::numeric_limits<float>::infinity();
  const Pairs pairs = onePair(1.0f, 2.0f, 3.0f, infinity);
  EXPECT_TRUE(std::isnan(epipolarDistances(crossMatrix({1.0, 0.0, 0.0}), pairs.view())[0]));
  EXPECT_TRUE(std::isnan(transferDistances(Eigen::Matrix3d::Identity(), pairs.view())[0]));
}

TEST(Epipolar, NoLineAtTheEpipole) {
  // Given forward motion, and a point at the epipole: F p = 0.
  const Eigen::Matrix3d forward = crossMatrix({320.0, 240.0, 1.0});
  const Pairs pairs = onePair(320.0f, 240.0f, 325.0f, 240.0f);
  EXPECT_TRUE(std::isnan(epipolarDistances(forward, pairs.view())[0]));
  EXPECT_TRUE(std::isnan(epipolarDistance(forward, {320.0, 240.0}, {325.0, 240.0})));

  // Given a line at infinity: F p = (0, 0, 1), a distance without bound.
  const Eigen::Matrix3d at_infinity = Eigen::Vector3d(0.0, 0.0, 1.0).asDiagonal();
  EXPECT_TRUE(std::isnan(epipolarDistances(at_infinity, pairs.view())[0]));
  EXPECT_TRUE(std::isnan(epipolarDistance(at_infinity, {320.0, 240.0}, {325.0, 240.0})));

  // Given no model at all.
  EXPECT_TRUE(std::isnan(epipolarDistances(Eigen::Matrix3d::Zero(), pairs.view())[0]));
}

TEST(Epipolar, ScaleAndSignOfFDoNotMatter) {
  Random random(3);
  const Eigen::Matrix3d fundamental = test::fundamentalOf(test::kSceneCamera, randomMotion(random));
  const Pairs pairs = randomPairs(200, 5);
  const std::vector<float> expected = epipolarDistances(fundamental, pairs.view());
  for (const double scale : {-1.0, 1e-9, 1e9, -3e20}) {
    const std::vector<float> scaled = epipolarDistances(scale * fundamental, pairs.view());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(scaled[i], expected[i], kSinglePrecision) << "scale " << scale;
    }
  }
}

TEST(Epipolar, SwappedRolesMeasureInTheEarlierFrame) {
  // Given sideways motion, where both frames share their rows: the distance is the same.
  const Pairs rows = onePair(10.0f, 20.0f, 300.0f, 23.5f);
  const Eigen::Matrix3d sideways = crossMatrix({1.0, 0.0, 0.0});
  EXPECT_NEAR(epipolarDistances(sideways.transpose(), rows.swapped().view())[0], 3.5,
              kSinglePrecision);

  // Given a general motion, and the earlier pixels moved across their lines of the inverse motion.
  const Eigen::Isometry3d motion = test::motionOf({1.0, 2.0, -3.0}, {0.1, -0.05, 0.08});
  const test::TwoViewScene scene = test::makeScene(motion, {});
  const Eigen::Isometry3d inverse = motion.inverse();
  test::TwoViewScene reversed{scene.current_u, scene.current_v, scene.current_depth,
                              scene.earlier_u, scene.earlier_v, scene.earlier_depth};
  for (std::size_t i = 0; i < reversed.size(); ++i) {
    const Eigen::Vector2d along =
        test::epipolarDirection(test::kSceneCamera, inverse, reversed.earlier(i));
    reversed.moveCurrent(i, 6.0 * Eigen::Vector2d(-along.y(), along.x()));
  }
  const Eigen::Matrix3d fundamental = test::fundamentalOf(test::kSceneCamera, motion);
  for (const float distance : epipolarDistances(fundamental.transpose(), reversed.pairs())) {
    EXPECT_NEAR(distance, 6.0, kSinglePrecision);
  }
}

TEST(Epipolar, ReusedMemoryLeavesNothingBehind) {
  const Eigen::Matrix3d sideways = crossMatrix({1.0, 0.0, 0.0});
  const Pairs pairs = onePair(0.0f, 1.0f, 0.0f, 3.0f);
  const std::vector<float> distance =
      epipolarDistances(sideways, pairs.view(), std::vector<float>(10, 77.0f));
  ASSERT_EQ(distance.size(), 1U);
  EXPECT_NEAR(distance[0], 2.0, kSinglePrecision);
}

TEST(Epipolar, UnequalSizesAreRefused) {
  Pairs pairs = randomPairs(4, 1);
  pairs.v1.pop_back();
  const std::string expected =
      "point pairs: earlier u, v and current u, v have 4, 3, 4 and 4 elements; expected equal "
      "sizes";
  const Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  EXPECT_EQ(test::invalidArgumentOf([&] { epipolarDistances(matrix, pairs.view()); }), expected);
  EXPECT_EQ(test::invalidArgumentOf([&] { transferDistances(matrix, pairs.view()); }), expected);
  for (const TwoViewModelKind kind : {TwoViewModelKind::kNone, TwoViewModelKind::kFundamental,
                                      TwoViewModelKind::kHomography, TwoViewModelKind::kIdentity}) {
    EXPECT_EQ(test::invalidArgumentOf([&] {
                modelDistances({kind, matrix}, pairs.view());
              }),
              expected)
        << toString(kind);
  }
}

TEST(Transfer, MeasuresTheDisplacementFromTheTransferredPoint) {
  // Given a homography that shifts by (3, 4): a point that stays is 5 px from where it should be.
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift.topRightCorner<2, 1>() << 3.0, 4.0;
  const Pairs pairs{{100.0f, 100.0f}, {50.0f, 50.0f}, {100.0f, 103.0f}, {50.0f, 54.0f}};
  const std::vector<float> distance = transferDistances(shift, pairs.view());
  EXPECT_NEAR(distance[0], 5.0, kSinglePrecision);
  EXPECT_NEAR(distance[1], 0.0, kSinglePrecision);
}

TEST(Transfer, DividesByTheThirdCoordinate) {
  // Given w = 1 + u / 1024: (512, 300) goes to (512, 300) / 1.5.
  Eigen::Matrix3d perspective = Eigen::Matrix3d::Identity();
  perspective(2, 0) = 1.0 / 1024.0;
  const auto u = static_cast<float>(512.0 / 1.5);
  EXPECT_NEAR(transferDistances(perspective, onePair(512.0f, 300.0f, u, 203.0f).view())[0], 3.0,
              kSinglePrecision);
  for (const double scale : {-2.0, 1e-6, 1e6}) {
    EXPECT_NEAR(
        transferDistances(scale * perspective, onePair(512.0f, 300.0f, u, 203.0f).view())[0], 3.0,
        kSinglePrecision);
  }
  // w = 0: the point is taken to infinity.
  EXPECT_TRUE(
      std::isnan(transferDistances(perspective, onePair(-1024.0f, 5.0f, 0.0f, 0.0f).view())[0]));
}

TEST(Transfer, RotationTakesStaticPointsToThemselves) {
  const Eigen::Isometry3d rotation = test::motionOf({2.0, -1.0, 3.0}, {0.0, 0.0, 0.0});
  const Eigen::Matrix3d k = test::calibrationMatrix(test::kSceneCamera);
  const Eigen::Matrix3d homography = k * rotation.linear() * k.inverse();
  test::TwoViewScene scene = test::makeScene(rotation, {});
  scene.moveCurrent(0, {0.0, 7.0});
  const std::vector<float> distance = transferDistances(homography, scene.pairs());
  EXPECT_NEAR(distance[0], 7.0, kSinglePrecision);
  for (std::size_t i = 1; i < scene.size(); ++i) {
    EXPECT_NEAR(distance[i], 0.0, kSinglePrecision);
  }
}

TEST(ModelDistances, FollowTheKind) {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = 10.0;
  const Pairs pairs = onePair(0.0f, 0.0f, 3.0f, 4.0f);
  const Eigen::Matrix3d sideways = crossMatrix({1.0, 0.0, 0.0});
  const auto distance = [&](TwoViewModelKind kind, const Eigen::Matrix3d& matrix) {
    return modelDistances({kind, matrix}, pairs.view())[0];
  };
  EXPECT_NEAR(distance(TwoViewModelKind::kFundamental, sideways), 4.0, kSinglePrecision);
  EXPECT_NEAR(distance(TwoViewModelKind::kHomography, shift), std::hypot(7.0, 4.0),
              kSinglePrecision);
  // A camera that stands still: plain displacement, whatever the matrix says.
  EXPECT_NEAR(distance(TwoViewModelKind::kIdentity, shift), 5.0, kSinglePrecision);
  EXPECT_TRUE(std::isnan(distance(TwoViewModelKind::kNone, shift)));
}

TEST(ModelDistances, KindsHaveNames) {
  EXPECT_STREQ(toString(TwoViewModelKind::kNone), "none");
  EXPECT_STREQ(toString(TwoViewModelKind::kFundamental), "fundamental");
  EXPECT_STREQ(toString(TwoViewModelKind::kHomography), "homography");
  EXPECT_STREQ(toString(TwoViewModelKind::kIdentity), "identity");
}

// K = diag(f, f, 1), t = (1, 0, 0): K^-T [t]x K^-1 has -1/f at (1, 2) and 1/f at (2, 1), and
// nothing else. Lines are rows of the image.
TEST(FundamentalOfMotion, OfASidewaysMoveHasRowsAsEpipolarLines) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translation().x() = 1.0;
  const Eigen::Matrix3d f = fundamentalOfMotion({100.0, 100.0, 0.0, 0.0}, motion);
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  expected(1, 2) = -0.01;
  expected(2, 1) = 0.01;
  EXPECT_LT((f - expected).norm(), 1e-15);
  EXPECT_NEAR(epipolarDistance(f, {7.0, 3.0}, {90.0, 5.5}), 2.5, 1e-12);
}

TEST(FundamentalOfMotion, PutsEveryPointAtRestOnItsLineAndAMovedOneOffIt) {
  const PinholeCamera camera{535.4, 539.2, 320.1, 247.6};
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() =
      Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, -0.9, 0.2).normalized()).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.04, -0.02, 0.03);
  const TwoViewModel model = modelOfMotion(camera, motion);
  ASSERT_EQ(model.kind, TwoViewModelKind::kFundamental);
  for (const double depth : {0.6, 1.5, 4.0}) {
    for (const double u : {20.0, 300.0, 600.0}) {
      const Eigen::Vector2d earlier(u, 400.0 - 0.5 * u);
      const Eigen::Vector2d current =
          camera.project(motion * camera.unproject(earlier.x(), earlier.y(), depth));
      EXPECT_NEAR(epipolarDistance(model.matrix, earlier, current), 0.0, 1e-9);
      const Eigen::Vector3d line = epipolarLine(model.matrix, earlier);
      const Eigen::Vector2d across = line.head<2>().normalized();
      EXPECT_NEAR(epipolarDistance(model.matrix, earlier, current + 3.0 * across), 3.0, 1e-9);
    }
  }
}

TEST(ModelOfMotion, OfATurnIsTheHomographyThatMovesPixelsByIt) {
  const PinholeCamera camera{500.0, 500.0, 320.0, 240.0};
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()).toRotationMatrix();
  motion.translation().x() = 0.0001;  // 0.05 px at 1 m
  const TwoViewModel model = modelOfMotion(camera, motion);
  ASSERT_EQ(model.kind, TwoViewModelKind::kHomography);
  // The centre's ray turns by 0.02 rad: f tan(0.02).
  const Eigen::Vector2d moved =
      (Eigen::Matrix3d(model.matrix) * Eigen::Vector3d(320.0, 240.0, 1.0)).hnormalized();
  EXPECT_NEAR(moved.x(), 320.0 + 500.0 * std::tan(0.02), 1e-9);
  EXPECT_NEAR(moved.y(), 240.0, 1e-9);
}

}  // namespace
}  // namespace hmcdyn
