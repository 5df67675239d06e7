// SPDX-License-Identifier: BSD-3-Clause
// Kind 11: what took quadratic time for inputs that are many of the same. Were it quadratic still,
// these would run for minutes.
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/regions.hpp>
#include <hmcdyn/steps/clustering.hpp>

namespace hmcdyn::faults {
namespace {

TEST(Bounds, EqualPointsInSpaceOrUnderAnotherDistanceAreOneClusterAtOnce) {
  constexpr int kPoints = 200000;
  for (const float order : {1.0f, 2.0f, 3.0f}) {
    for (const Eigen::Index dimensions : {2, 3}) {
      if (dimensions == 2 && order == 2.0f) {
        continue;  // the plane has its own backend
      }
      Eigen::MatrixXf points = Eigen::MatrixXf::Constant(dimensions, kPoints, 1.5f);
      points.col(7).setConstant(9.0f);  // alone
      ClusteringOptions options;
      options.order = order;
      options.min_points = kPoints - 1;  // every one of the others counts
      const Clustering clusters = densityClusters(points, options);
      EXPECT_EQ(clusters.clusters, 1);
      EXPECT_EQ(clusters.label[0], 0);
      EXPECT_EQ(clusters.is_core[kPoints - 1], 1);
      EXPECT_EQ(clusters.label[7], kNoise);
      options.min_points = kPoints;
      EXPECT_EQ(densityClusters(points, options).clusters, 0);
    }
  }
}

TEST(Bounds, PointsWithinOneNeighbourhoodAreOneClusterAtOnce) {
  constexpr int kPoints = 20000;
  for (const float order : {1.0f, 2.0f, 3.0f}) {
    for (const Eigen::Index dimensions : {1, 3}) {
      Eigen::MatrixXf points(dimensions, kPoints);
      for (int i = 0; i < kPoints; ++i) {
        points.col(i).setConstant(1.5f + 1e-6f * static_cast<float>(i));  // 2 cm, epsilon 10 cm
      }
      points.col(7).setConstant(9.0f);
      ClusteringOptions options;
      options.order = order;
      const Clustering clusters = densityClusters(points, options);
      EXPECT_EQ(clusters.clusters, 1);
      EXPECT_EQ(clusters.label[kPoints - 1], 0);
      EXPECT_EQ(clusters.label[7], kNoise);
    }
  }
}

TEST(Bounds, AnImageWithALabelAPixelHasItsRegionsAtOnce) {
  constexpr int kWidth = 640;
  constexpr int kHeight = 480;
  std::vector<std::int32_t> labels(kWidth * kHeight);
  std::vector<LabelRegion> regions;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    labels[i] = static_cast<std::int32_t>(i) + 1;
    regions.push_back({static_cast<int>(labels.size() - i), 0, 1.0f});  // from the last on
  }
  regions.push_back({1, 5, 0.5f});  // a label's second region, which does not count
  const LabelImageView<std::int32_t> view{labels.data(), kWidth, kHeight, kWidth};
  const std::vector<DetectionBox> boxes = boundingBoxes(view, regions);
  ASSERT_EQ(boxes.size(), regions.size());
  EXPECT_EQ(boxes.front().x_min, 639.0f);  // of the last pixel
  EXPECT_EQ(boxes.front().y_max, 479.0f);
  EXPECT_EQ(boxes[labels.size() - 1].x_max, 0.0f);  // of the first
  EXPECT_EQ(boxes.back().x_max, -1.0f);
  KeyPoints points;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      points.push_back(static_cast<float>(column), static_cast<float>(row), 1.0f);
    }
  }
  const std::vector<int> region = regionsOfPoints(points.view(), view, regions);
  EXPECT_EQ(region.front(), kWidth * kHeight - 1);
  EXPECT_EQ(region.back(), 0);
}

}  // namespace
}  // namespace hmcdyn::faults
