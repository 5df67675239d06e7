// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/tracker.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "random.hpp"
#include "track/room.hpp"

namespace hmcdyn::slam {
namespace {

TEST(Tracker, FollowsACameraThroughARoom) {
  const Room room(3);
  Tracker tracker(kCamera, {});
  for (std::size_t k = 0; k < 20; ++k) {
    const double t = static_cast<double>(k);
    const Eigen::Isometry3d truth = movedBy(0.01 * t, 0.004 * t);
    const TrackingResult result = tracker.track(room.see(k, truth));
    ASSERT_EQ(result.failure, TrackingFailure::kNone) << "frame " << k;
    EXPECT_LT(distanceBetween(result.camera_from_world, truth), 0.002) << "frame " << k;
  }
  EXPECT_GE(tracker.map().keyFrames().size(), 2U);
}

TEST(Tracker, AFrameWithoutKeyPointsIsLostAndTheNextIsFoundAgain) {
  const Room room(4);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  tracker.track(room.see(1, movedBy(0.01, 0.0)));
  const TrackingResult lost =
      tracker.track(makeFrame(2, 0.066, {}, cv::Mat::zeros(240, 320, CV_32F), 1.2f));
  EXPECT_EQ(lost.failure, TrackingFailure::kTooFewMatches);
  const Eigen::Isometry3d jumped = movedBy(0.15, 0.05);
  const TrackingResult found = tracker.track(room.see(3, jumped));
  ASSERT_EQ(found.failure, TrackingFailure::kNone);
  EXPECT_LT(distanceBetween(found.camera_from_world, jumped), 0.002);
}

Frame nothing(std::size_t index) {
  return makeFrame(index, 0.033 * static_cast<double>(index), {}, cv::Mat::zeros(240, 320, CV_32F),
                   1.2f);
}

// Half a metre in a thirtieth of a second is more than a camera moves. A wrong place would look so.
TEST(Tracker, AFrameThatIsFoundFarAwayIsBelievedWhenTheNextIsFoundBesideIt) {
  const Room room(14);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  tracker.track(nothing(1));
  const std::size_t points = tracker.map().points().size();
  const auto at = [&](std::size_t k, double x) {
    return tracker.track(room.see(k, movedBy(x, 0.0)));
  };
  EXPECT_EQ(at(2, 0.5).failure, TrackingFailure::kUnconfirmed);
  EXPECT_EQ(at(3, -0.5).failure, TrackingFailure::kUnconfirmed) << "not beside the one before";
  EXPECT_EQ(tracker.map().keyFrames().size(), 1U);
  EXPECT_EQ(tracker.map().points().size(), points);
  const TrackingResult found = at(4, -0.48);
  ASSERT_EQ(found.failure, TrackingFailure::kNone);
  EXPECT_TRUE(found.relocalized);
  EXPECT_LT(distanceBetween(found.camera_from_world, movedBy(-0.48, 0.0)), 0.002);
  EXPECT_STREQ(toString(TrackingFailure::kUnconfirmed), "not confirmed");
}

TEST(Tracker, AFrameThatIsLostBetweenTwoFindsMakesThemNoPair) {
  const Room room(15);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  EXPECT_EQ(tracker.track(room.see(1, movedBy(0.5, 0.0))).failure, TrackingFailure::kUnconfirmed);
  EXPECT_EQ(tracker.track(nothing(2)).failure, TrackingFailure::kTooFewMatches);
  EXPECT_EQ(tracker.track(room.see(3, movedBy(0.51, 0.0))).failure, TrackingFailure::kUnconfirmed);
  EXPECT_EQ(tracker.track(room.see(4, movedBy(0.52, 0.0))).failure, TrackingFailure::kNone);
}

TEST(Tracker, AfterLongNothingTheLastPlaceConfirmsNoMore) {
  const Room room(16);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  tracker.track(nothing(1));
  EXPECT_EQ(tracker.track(room.see(40, movedBy(0.0, 0.0))).failure, TrackingFailure::kUnconfirmed);
  EXPECT_EQ(tracker.track(room.see(41, movedBy(0.0, 0.0))).failure, TrackingFailure::kNone);
}

TEST(Tracker, WhereTheMapIsNotFoundTheFiltersOdometryCarriesTheCamera) {
  const Room room(17);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  tracker.track(room.see(1, movedBy(0.01, 0.0)));
  for (std::size_t k = 2; k < 5; ++k) {
    Frame blind = nothing(k);
    blind.odometry = movedBy(0.01 * static_cast<double>(k), 0.0);
    const TrackingResult carried = tracker.track(std::move(blind));
    ASSERT_EQ(carried.failure, TrackingFailure::kNone);
    EXPECT_TRUE(carried.carried);
    EXPECT_EQ(carried.inliers, 0U);
    EXPECT_EQ(
        distanceBetween(carried.camera_from_world, movedBy(0.01 * static_cast<double>(k), 0.0)),
        0.0);
  }
  const TrackingResult found = tracker.track(room.see(5, movedBy(0.05, 0.0)));
  ASSERT_EQ(found.failure, TrackingFailure::kNone);
  EXPECT_FALSE(found.carried);
  EXPECT_FALSE(found.relocalized) << "it was not lost";
  EXPECT_LT(distanceBetween(found.camera_from_world, movedBy(0.05, 0.0)), 0.002);
}

TEST(Tracker, ACarriedFrameMapsWhatItSees) {
  const Room room(19);
  const Room unknown(20);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  Frame frame = unknown.see(1, movedBy(0.01, 0.0));
  frame.odometry = movedBy(0.01, 0.0);
  const TrackingResult carried = tracker.track(std::move(frame));
  ASSERT_TRUE(carried.carried);
  EXPECT_TRUE(carried.new_key_frame);
  const TrackingResult next = tracker.track(unknown.see(2, movedBy(0.02, 0.0)));
  ASSERT_EQ(next.failure, TrackingFailure::kNone);
  EXPECT_FALSE(next.carried) << "the map has what the carried frame saw";
  EXPECT_LT(distanceBetween(next.camera_from_world, movedBy(0.02, 0.0)), 0.002);
}

TEST(Tracker, OdometryCarriesTheCameraForASecondAndNotFromWhereItIsLost) {
  const Room room(18);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  const auto blindAt = [&](std::size_t index) {
    Frame blind = nothing(index);
    blind.odometry = movedBy(0.0, 0.0);
    return tracker.track(std::move(blind)).failure;
  };
  for (std::size_t k = 1; k <= 30; ++k) {
    EXPECT_EQ(blindAt(k), TrackingFailure::kNone) << "frame " << k;
  }
  EXPECT_EQ(blindAt(31), TrackingFailure::kTooFewMatches);
  EXPECT_EQ(blindAt(32), TrackingFailure::kTooFewMatches) << "lost is lost";
}

TEST(Tracker, CannotStartWithoutDepth) {
  const Room room(5);
  Frame frame = room.see(0, movedBy(0.0, 0.0));
  std::fill(frame.points.depth.begin(), frame.points.depth.end(), 0.0f);
  Tracker tracker(kCamera, {});
  EXPECT_EQ(tracker.track(frame).failure, TrackingFailure::kTooFewKeyPoints);
}

TEST(Tracker, PointsOfWeightZeroDoNotMoveTheCamera) {
  const Room room(6);
  Tracker tracker(kCamera, {});
  tracker.track(room.see(0, movedBy(0.0, 0.0)));
  // A third of the key points slides by 8 px, and the filter says so.
  Frame frame = room.see(1, movedBy(0.01, 0.0));
  for (std::size_t i = 0; i < frame.points.size(); i += 3) {
    frame.points.u[i] += 8.0f;
    frame.weight[i] = 0.0f;
    frame.label[i] = PointLabel::kDynamic;
  }
  const TrackingResult result = tracker.track(frame);
  ASSERT_EQ(result.failure, TrackingFailure::kNone);
  EXPECT_LT(distanceBetween(result.camera_from_world, movedBy(0.01, 0.0)), 0.002);
}

// The filter drops all but ten points, which are too few. Those that the map has long trusted are
// matched all the same, and nine of ten stand still.
TEST(Tracker, WhereTheFilterLeavesTooFewTheMapHasTheWord) {
  const Room room(6);
  Tracker tracker(kCamera, {});
  for (std::size_t k = 0; k < 6; ++k) {
    ASSERT_EQ(tracker.track(room.see(k, movedBy(0.01 * static_cast<double>(k), 0.0))).failure,
              TrackingFailure::kNone);
  }
  Frame frame = room.see(6, movedBy(0.06, 0.0));
  for (std::size_t i = 10; i < frame.points.size(); ++i) {
    frame.points.u[i] += i % 10 == 0 ? 8.0f : 0.0f;
    frame.weight[i] = 0.0f;
    frame.label[i] = PointLabel::kDynamic;
  }
  const TrackingResult result = tracker.track(frame);
  ASSERT_EQ(result.failure, TrackingFailure::kNone);
  EXPECT_GT(result.inliers, frame.points.size() / 2);
  EXPECT_LT(distanceBetween(result.camera_from_world, movedBy(0.06, 0.0)), 0.002);
}

/// RMSE (m) of a camera that moves steadily and sees 80 points with 1 px of noise.
double errorWithNoise(bool fuse_motion) {
  const Room room(10, 80);
  TrackerOptions options;
  options.fuse_motion = fuse_motion;
  Tracker tracker(kCamera, options);
  hmcdyn::test::Random random(12);
  constexpr int kFrames = 60;
  double sum = 0.0;
  for (int k = 0; k < kFrames; ++k) {
    const Eigen::Isometry3d truth = movedBy(0.005 * k, 0.002 * k);
    Frame frame = room.see(static_cast<std::size_t>(k), truth);
    for (std::size_t i = 0; i < frame.points.size() && k > 0; ++i) {
      frame.points.u[i] += static_cast<float>(random.normal(1.0));
      frame.points.v[i] += static_cast<float>(random.normal(1.0));
    }
    const TrackingResult result = tracker.track(std::move(frame));
    EXPECT_EQ(result.failure, TrackingFailure::kNone) << "frame " << k;
    const double error = distanceBetween(result.camera_from_world, truth);
    sum += error * error;
  }
  return std::sqrt(sum / kFrames);
}

TEST(Tracker, MotionLessensTheNoiseOfFewPoints) {
  const double measured = errorWithNoise(false);
  EXPECT_GT(measured, 0.002) << "the test does not tell";
  EXPECT_LT(errorWithNoise(true), 0.8 * measured);
}

/// Points of the map after a camera has panned away and back, several times, over 300 points of a
/// room; every frame is a key frame, and the local map holds four of them.
std::size_t pointsAfterPanning(const DuplicateOptions& duplicates) {
  const Room room(9);
  TrackerOptions options;
  options.key_frames.max_turn = 0.0;  // every frame is a key frame
  options.map.local_key_frames = 4;
  options.duplicates = duplicates;
  Tracker tracker(kCamera, options);
  constexpr int kHalfPan = 30;  // frames
  for (int k = 0; k < 6 * kHalfPan; ++k) {
    const int step = k % (2 * kHalfPan);
    const double turn = 0.025 * (step < kHalfPan ? step : 2 * kHalfPan - step);
    const TrackingResult result =
        tracker.track(room.see(static_cast<std::size_t>(k), movedBy(0.0, turn)));
    EXPECT_EQ(result.failure, TrackingFailure::kNone) << "frame " << k;
    EXPECT_LT(distanceBetween(result.camera_from_world, movedBy(0.0, turn)), 0.01) << "frame " << k;
  }
  return tracker.map().points().held();
}

TEST(Tracker, APlaceThatIsSeenAgainIsNotMappedAgain) {
  DuplicateOptions forgotten;
  forgotten.neighbours = 0;
  forgotten.forgotten_after = 4;  // key frames, as many as the local map has
  EXPECT_LE(pointsAfterPanning(forgotten), 330U) << "a tenth more than there are";
  constexpr int kNever = 1000;
  DuplicateOptions shared;
  shared.forgotten_after = kNever;
  EXPECT_LE(pointsAfterPanning(shared), 330U) << "neighbours find them, too";
  DuplicateOptions none = shared;
  none.neighbours = 0;
  EXPECT_GT(pointsAfterPanning(none), 400U) << "the test does not tell";
}

TEST(Map, PeopleAndUncertainPointsStayOut) {
  const Room room(7);
  Frame frame = room.see(0, movedBy(0.0, 0.0));
  const std::size_t n = frame.points.size();
  ASSERT_GT(n, 50U);
  frame.in_person[0] = 1;                   // a person who stands still
  frame.label[1] = PointLabel::kDynamic;    // moves
  frame.label[2] = PointLabel::kUnmatched;  // nobody knows
  frame.label[3] = PointLabel::kSuspect;    // little deeper than the person
  frame.lambda[3] = 0.7f;
  frame.label[4] = PointLabel::kSuspect;  // background seen past the person
  frame.lambda[4] = 0.9f;
  Map map(kCamera, {});
  map.insertKeyFrame(frame);
  const std::vector<int>& entered = map.keyFrames().back().frame.map_point;
  EXPECT_EQ(entered[0], kNoMapPoint);
  EXPECT_EQ(entered[1], kNoMapPoint);
  EXPECT_EQ(entered[2], kNoMapPoint);
  EXPECT_EQ(entered[3], kNoMapPoint);
  EXPECT_NE(entered[4], kNoMapPoint);
  EXPECT_EQ(map.points().size(), n - 4);
}

TEST(Map, APointThatIsOftenCalledDynamicIsRemoved) {
  const Room room(8);
  Map map(kCamera, {});
  map.insertKeyFrame(room.see(0, movedBy(0.0, 0.0)));
  for (int k = 0; k < 6; ++k) {
    LandmarkSighting half;  // half of its sightings
    half.label = k % 2 == 0 ? PointLabel::kDynamic : PointLabel::kStatic;
    map.count(0, true, half);
    map.count(1, true, {});
    map.count(2, false, {PointLabel::kStatic, 1.0f, false});  // never found again
  }
  map.cull();
  EXPECT_TRUE(map.points()[0].removed);
  EXPECT_FALSE(map.points()[1].removed);
  EXPECT_TRUE(map.points()[2].removed);
}

TEST(DepthAtKeyPoints, FillsAHoleFromAgreeingNeighboursOnly) {
  cv::Mat depth = cv::Mat::zeros(20, 20, CV_32F);
  depth(cv::Rect(4, 4, 3, 3)).setTo(2.0f);
  depth.at<float>(5, 5) = 0.0f;
  depth(cv::Rect(12, 12, 3, 3)).setTo(2.0f);
  depth(cv::Rect(12, 12, 1, 3)).setTo(3.0f);  // an edge
  depth.at<float>(13, 13) = 0.0f;
  const std::vector<cv::KeyPoint> points = {
      {5.0f, 5.0f, 1.0f}, {13.0f, 13.0f, 1.0f}, {4.2f, 4.4f, 1.0f}, {19.9f, 0.0f, 1.0f}};
  const std::vector<float> found = depthAtKeyPoints(depth, points);
  EXPECT_FLOAT_EQ(found[0], 2.0f);
  EXPECT_FLOAT_EQ(found[1], 0.0f);
  EXPECT_FLOAT_EQ(found[2], 2.0f);
  EXPECT_FLOAT_EQ(found[3], 0.0f);
}

}  // namespace
}  // namespace hmcdyn::slam
