// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/matched_points.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "slam/track/duplicates.hpp"
#include "track/room.hpp"

namespace hmcdyn::slam {
namespace {

TEST(WithoutOffset, SolvesForTheDepthThatWasMeasuredSo) {
  // 2 m with an offset of 0.01 / m are measured as 2.04 m.
  EXPECT_NEAR(withoutOffset(2.04f, 0.01), 2.0f, 1e-6f);
  EXPECT_NEAR(withoutOffset(1.96f, -0.01), 2.0f, 1e-6f);
  EXPECT_FLOAT_EQ(withoutOffset(3.0f, 0.0), 3.0f);
}

TEST(DepthSpread, IsHalfOfWhatDepthsDifferBesideThePoint) {
  cv::Mat depth(20, 20, CV_32F, cv::Scalar(2.0f));
  depth.colRange(10, 20).setTo(3.0f);
  depth.at<float>(5, 3) = 0.0f;  // a hole says nothing
  const std::vector<cv::KeyPoint> points = {
      {4.0f, 5.0f, 1.0f}, {8.4f, 5.0f, 1.0f}, {7.0f, 5.0f, 1.0f}, {0.0f, 0.0f, 1.0f}};
  const std::vector<float> spread = depthSpreadAtKeyPoints(depth, points);
  EXPECT_FLOAT_EQ(spread[0], 0.0f);
  EXPECT_FLOAT_EQ(spread[1], 0.5f);
  EXPECT_FLOAT_EQ(spread[2], 0.0f);
  EXPECT_FLOAT_EQ(spread[3], 0.0f);
}

TEST(DepthSigmas, ManyDepthsInOneSquareSayWhatOneSays) {
  Frame frame;
  for (const float u : {10.0f, 50.0f, 90.0f, 95.0f, 410.0f, 20.0f}) {
    frame.points.push_back(u, 30.0f, u == 20.0f ? 0.0f : 2.0f);
  }
  frame.depth_spread.assign(6, 0.0f);
  frame.depth_spread[4] = 0.5f;
  const DepthErrorModel model{0.001f, 0.0f, 0.0f, 0.01f, 0.5f};  // noise 1 mm, unshared 20 mm
  const std::vector<float> sigma = depthSigmas(frame, {0, 1, 2, 3, 4, 5}, model);
  EXPECT_NEAR(sigma[0], std::hypot(0.001f, 0.04f), 1e-6f);  // four together: twice one's
  EXPECT_NEAR(sigma[4], std::sqrt(0.001f * 0.001f + 0.02f * 0.02f + 0.25f), 1e-6f);
  EXPECT_FLOAT_EQ(sigma[5], 1.0f);
}

/// The first key frame's points as matches with themselves.
std::vector<PointMatch> matchesOf(const Frame& frame) {
  std::vector<PointMatch> matches;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.map_point[i] != kNoMapPoint) {
      matches.push_back({frame.map_point[i], i, 0});
    }
  }
  return matches;
}

TEST(MatchedPoints, ADepthThatDisagreesGoesAndThePointStays) {
  const Room room(31);
  Map map(kCamera, {});
  map.insertKeyFrame(room.see(0, movedBy(0.0, 0.0)));
  Frame frame = tied(room.see(1, movedBy(0.02, 0.0)), map);
  for (std::size_t i = 0; i < frame.points.size(); i += 4) {
    frame.points.depth[i] += 0.8f;
  }
  const std::vector<PointMatch> matches = matchesOf(frame);
  MatchedPoints points(frame, matches, map, MatchPolicy::kKeptPoints);
  PoseRefinementOptions options;
  options.depth_row = DepthRow::kDepth;
  const PoseRefinementResult before =
      refinePose(points.view(), kCamera, movedBy(0.0, 0.0), options);
  ASSERT_TRUE(before.succeeded());
  EXPECT_LT(before.inliers, matches.size());
  EXPECT_TRUE(points.dropDisagreeingDepths(before, kCamera, options));
  const PoseRefinementResult after =
      refinePose(points.view(), kCamera, before.camera_from_world, options);
  EXPECT_EQ(after.inliers, matches.size());
  EXPECT_LT(distanceBetween(after.camera_from_world, movedBy(0.02, 0.0)), 1e-3);
  EXPECT_FALSE(points.dropDisagreeingDepths(after, kCamera, options));
}

TEST(NoiseFactor, IsTheMedianResidualOverWhatSigmaExpects) {
  const Room room(32);
  Map map(kCamera, {});
  map.insertKeyFrame(room.see(0, movedBy(0.0, 0.0)));
  Frame frame = tied(room.see(1, movedBy(0.0, 0.0)), map);
  frame.sigma.assign(frame.points.size(), 1.0f);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    frame.points.u[i] += 1.5f;  // every residual is 1.5 sigma
  }
  const std::vector<PointMatch> matches = matchesOf(frame);
  EXPECT_NEAR(noiseFactor(frame, matches, movedBy(0.0, 0.0), map), 1.5 / std::sqrt(1.386), 1e-3);
  frame.sigma.assign(frame.points.size(), 100.0f);
  EXPECT_DOUBLE_EQ(noiseFactor(frame, matches, movedBy(0.0, 0.0), map), 0.6);
  EXPECT_DOUBLE_EQ(noiseFactor(frame, {}, movedBy(0.0, 0.0), map), 1.0);
}

TEST(KnownPoints, APlaceThatIsMappedTwiceIsOne) {
  const Room room(33);
  Map map(kCamera, {});
  Frame first = room.see(0, movedBy(0.0, 0.0));
  first.camera_from_world = movedBy(0.0, 0.0);
  map.insertKeyFrame(first);
  // The second key frame knows half of the first one's points and makes the others again.
  Frame second = tied(room.see(1, movedBy(0.05, 0.0)), map);
  second.camera_from_world = movedBy(0.05, 0.0);
  std::size_t again = 0;
  for (std::size_t i = 0; i < second.points.size(); i += 2) {
    again += second.map_point[i] != kNoMapPoint ? 1 : 0;
    second.map_point[i] = kNoMapPoint;
  }
  map.insertKeyFrame(std::move(second));
  const std::size_t before = map.points().held();
  const KnownPoints known = knownPointsOf(map, {});
  for (const auto& [point, into] : known.duplicates) {
    map.fusePoints(point, into);
  }
  ASSERT_GT(again, 50U);
  EXPECT_LE(map.points().held(), before - again + again / 20) << "nineteen of twenty are found";
  EXPECT_GE(map.points().held(), before - again) << "and no others";
}

TEST(MatchedPoints, CountFullyWhereTheMapHasTheWord) {
  const Room room(31);
  Map map(kCamera, {});
  map.insertKeyFrame(room.see(0, movedBy(0.0, 0.0)));
  Frame frame = tied(room.see(1, movedBy(0.02, 0.0)), map);
  frame.weight.assign(frame.points.size(), 0.0f);
  frame.weight.front() = 0.3f;
  const std::vector<PointMatch> matches = matchesOf(frame);
  ASSERT_EQ(matches.front().key_point, 0U);
  const MatchedPoints kept(frame, matches, map, MatchPolicy::kKeptPoints);
  EXPECT_EQ(kept.view().weight[0], 0.3f);
  EXPECT_EQ(kept.view().weight[1], 0.0f);
  const MatchedPoints trusted(frame, matches, map, MatchPolicy::kTrustedPoints);
  EXPECT_EQ(trusted.view().weight[0], 1.0f);
  EXPECT_EQ(trusted.view().weight[1], 1.0f);
}

}  // namespace
}  // namespace hmcdyn::slam
