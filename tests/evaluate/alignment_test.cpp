// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/alignment.hpp"

#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "expect_throw.hpp"
#include "trajectories.hpp"

namespace hmcdyn::evaluate {
namespace {

using Points = std::vector<Eigen::Vector3d>;

const Points kTetrahedron{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 3.0}};

Points transformed(const Points& points, const Eigen::Isometry3d& pose, double scale) {
  Points result;
  for (const Eigen::Vector3d& point : points) {
    result.emplace_back(pose * (scale * point));
  }
  return result;
}

void expectAligned(const Alignment& alignment, const Points& source, const Points& target) {
  for (std::size_t i = 0; i < source.size(); ++i) {
    EXPECT_TRUE((alignment * source[i]).isApprox(target[i], 1e-9)) << "point " << i;
  }
}

TEST(Alignment, FindsARigidTransform) {
  std::mt19937 random(1);
  const Eigen::Isometry3d pose = test::randomPose(random, 5.0);
  const Points target = transformed(kTetrahedron, pose, 1.0);
  const Alignment alignment = align(kTetrahedron, target);
  EXPECT_TRUE(alignment.rotation.isApprox(pose.linear(), 1e-12));
  EXPECT_TRUE(alignment.translation.isApprox(pose.translation(), 1e-12));
  EXPECT_EQ(alignment.scale, 1.0);
  EXPECT_TRUE(alignment.unique);
}

TEST(Alignment, FindsASimilarityTransform) {
  std::mt19937 random(2);
  const Eigen::Isometry3d pose = test::randomPose(random, 5.0);
  const Points target = transformed(kTetrahedron, pose, 0.25);
  const Alignment alignment = align(kTetrahedron, target, AlignmentModel::kSimilarity);
  EXPECT_TRUE(alignment.rotation.isApprox(pose.linear(), 1e-12));
  EXPECT_NEAR(alignment.scale, 0.25, 1e-12);
  expectAligned(alignment, kTetrahedron, target);
}

TEST(Alignment, NeverMirrors) {
  Points mirrored = kTetrahedron;
  for (Eigen::Vector3d& point : mirrored) {
    point.z() = -point.z();
  }
  EXPECT_NEAR(align(kTetrahedron, mirrored).rotation.determinant(), 1.0, 1e-12);
}

TEST(Alignment, OfPointsInAPlaneIsUnique) {
  const Points square{{1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0}, {-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}};
  std::mt19937 random(3);
  const Eigen::Isometry3d pose = test::randomPose(random, 5.0);
  const Alignment alignment = align(square, transformed(square, pose, 1.0));
  EXPECT_TRUE(alignment.unique);
  EXPECT_TRUE(alignment.rotation.isApprox(pose.linear(), 1e-9));
}

TEST(Alignment, OfPointsOnALineFitsButIsNotUnique) {
  const Points line{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {3.0, 0.0, 0.0}};
  std::mt19937 random(4);
  const Points target = transformed(line, test::randomPose(random, 5.0), 1.0);
  const Alignment alignment = align(line, target);
  EXPECT_FALSE(alignment.unique);
  EXPECT_NEAR(alignment.rotation.determinant(), 1.0, 1e-12);
  expectAligned(alignment, line, target);
}

TEST(Alignment, OfCoincidingPointsMovesTheirCentres) {
  const Points still(4, Eigen::Vector3d(1.0, 2.0, 3.0));
  const Alignment alignment = align(still, kTetrahedron);
  EXPECT_FALSE(alignment.unique);
  const Eigen::Vector3d centre(0.25, 0.5, 0.75);
  EXPECT_TRUE((alignment * still.front()).isApprox(centre, 1e-12));
  EXPECT_TRUE(alignment.rotation.allFinite());
}

TEST(Alignment, NeedsThreePairs) {
  const Points two{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { align(two, two); }),
            "alignment needs at least 3 pairs of positions; there are 2");
}

TEST(Alignment, FindsNoScaleOfPointsThatCoincide) {
  const Points still(4, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(test::messageOf<std::runtime_error>(
                [&] { align(still, kTetrahedron, AlignmentModel::kSimilarity); }),
            "no scale can be estimated: all positions of the estimate coincide");
  EXPECT_EQ(test::messageOf<std::runtime_error>(
                [&] { align(kTetrahedron, still, AlignmentModel::kSimilarity); }),
            "no scale can be estimated: all positions of the ground truth coincide");
}

TEST(Alignment, FindsNoScaleOfUnrelatedPoints) {
  // One moves only where the other stands still.
  const Points first{{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const Points second{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}};
  EXPECT_THROW(align(first, second, AlignmentModel::kSimilarity), std::runtime_error);
}

TEST(Alignment, RefusesUnequalSizesAndNaN) {
  Points broken = kTetrahedron;
  broken[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::messageOf<std::invalid_argument>([&] { align(kTetrahedron, broken); }),
            "align: target holds NaN or infinity at 1; expected finite points");
  broken.pop_back();
  EXPECT_EQ(test::messageOf<std::invalid_argument>([&] { align(kTetrahedron, broken); }),
            "align: source has 4 points, target 3; expected equal sizes");
}

}  // namespace
}  // namespace hmcdyn::evaluate
