// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/triangulation.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::calibrate {
namespace {

const PinholeCamera kCamera{500.0, 500.0, 320.0, 240.0};

/// A cloud of points, a camera on an arc in front of it, and a depth that is 5 % too long.
struct World {
  std::vector<CalibrationImage> images;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector3d> points;
  ImagePoses poses;
};

World makeWorld() {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  World world;
  for (int i = 0; i < 200; ++i) {
    world.points.emplace_back(1.2 * unit(random), 0.9 * unit(random), 2.5 + unit(random));
  }
  world.tracks.resize(world.points.size());
  for (int i = 0; i < 8; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() =
        Eigen::Vector3d(0.1 * i - 0.35, 0.1 * std::sin(i), 0.05 * std::cos(2.0 * i));
    pose.linear() = Eigen::AngleAxisd(-0.03 * (i - 4), Eigen::Vector3d::UnitY()).toRotationMatrix();
    world.poses.emplace_back(pose);
    CalibrationImage image;
    image.timestamp = i / 10.0;
    image.depth = cv::Mat::zeros(480, 640, CV_32FC1);
    for (std::size_t k = 0; k < world.points.size(); ++k) {
      const Eigen::Vector3d p = pose.inverse() * world.points[k];
      const double u = kCamera.fx * p.x() / p.z() + kCamera.cx;
      const double v = kCamera.fy * p.y() / p.z() + kCamera.cy;
      if (u > 2.0 && v > 2.0 && u < 637.0 && v < 477.0) {
        world.tracks[k].push_back({i, cv::Point2f(static_cast<float>(u), static_cast<float>(v))});
        cv::circle(image.depth, {cvRound(u), cvRound(v)}, 1, cv::Scalar(1.05 * p.z()), -1);
      }
    }
    world.images.push_back(image);
  }
  return world;
}

TEST(Triangulation, PointsAreWhereTheImagesPutThemWhateverTheDepthSays) {
  const World world = makeWorld();
  const Triangulation found = triangulate(world.images, world.tracks, world.poses, kCamera);
  ASSERT_GT(found.tracks.size(), 150U);
  for (const TriangulatedTrack& track : found.tracks) {
    const auto& truth = world.points[static_cast<std::size_t>(track.track)];
    EXPECT_LT((track.point - truth).norm(), 0.003) << track.track;
  }
  EXPECT_LT(found.pixel_error, 0.05);
  EXPECT_LT(found.position_error, 0.001);
}

TEST(Triangulation, PosesFromTheImagesAloneHaveTheDepthsScale) {
  // Depth is 5 % too long, so positions without a trajectory are; after refinement points are 5 %
  // too far from the first camera.
  const World world = makeWorld();
  const ImagePoses poses = posesFromTracks(world.images, world.tracks, kCamera);
  const Triangulation found = triangulate(world.images, world.tracks, poses, kCamera);
  ASSERT_GT(found.tracks.size(), 150U);
  double sum = 0.0;
  for (const TriangulatedTrack& track : found.tracks) {
    const Eigen::Vector3d truth =
        world.poses[0]->inverse() * world.points[static_cast<std::size_t>(track.track)];
    sum += track.point.z() / truth.z();
  }
  EXPECT_NEAR(sum / static_cast<double>(found.tracks.size()), 1.05, 0.01);
}

TEST(Triangulation, CovarianceIsThatOfTheRays) {
  // A point seen from both ends of a baseline b at distance z with a deviation of s px: its depth
  // has z^2 / (f b) sqrt(2) s, with all eight images less, and never less than half of it.
  // The pixels are exact here, so that the least deviation is the one that counts.
  const World world = makeWorld();
  TriangulationOptions options;
  options.least_pixel_sigma = 0.7;
  const Triangulation found =
      triangulate(world.images, world.tracks, world.poses, kCamera, options);
  for (const TriangulatedTrack& track : found.tracks) {
    if (track.seen.size() == 8) {
      const double z = track.point.z();
      const double two_views = z * z / (500.0 * 0.7) * std::sqrt(2.0) * 0.7;
      const double sigma = std::sqrt(track.covariance(2, 2));
      EXPECT_LT(sigma, 1.2 * two_views);
      EXPECT_GT(sigma, 0.4 * two_views);
    }
  }
}

TEST(Triangulation, LargeKeyPointsThatAreFoundBadlyDoNotMoveThePoints) {
  // Half of the points are large key points whose places follow the camera by some pixels, as those
  // over two surfaces do: enough to turn the cameras, too little to be wrong matches.
  World world = makeWorld();
  for (std::size_t k = 0; k < world.tracks.size(); ++k) {
    for (TrackPoint& seen : world.tracks[k]) {
      const bool large = k % 2 == 1;
      seen.size = large ? 30.0f : 3.0f;
      seen.pixel.x += large ? static_cast<float>((seen.image * 7 + static_cast<int>(k)) % 5) : 0.0f;
    }
  }
  TriangulationOptions options;
  options.pixel_sigma = 3.0;
  const Triangulation found =
      triangulate(world.images, world.tracks, world.poses, kCamera, options);
  for (const TriangulatedTrack& track : found.tracks) {
    if (track.track % 2 == 0) {
      const auto& truth = world.points[static_cast<std::size_t>(track.track)];
      EXPECT_LT((track.point - truth).norm(), 0.003) << track.track;
    }
  }
}

TEST(Triangulation, TooFewPointsAreAnErrorThatSaysSo) {
  World world = makeWorld();
  world.tracks.resize(20);
  EXPECT_THROW(triangulate(world.images, world.tracks, world.poses, kCamera), std::runtime_error);
}

TEST(Triangulation, PosesAreInterpolatedAndMissingOnesAreMissing) {
  evaluate::Trajectory trajectory(3);
  trajectory[1].timestamp = 0.1;
  trajectory[1].pose.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  trajectory[2].timestamp = 2.0;
  std::vector<CalibrationImage> images(4);
  images[0].timestamp = 0.025;  // between the first two
  images[1].timestamp = 0.14;   // near the second
  images[2].timestamp = 1.0;    // near none
  images[3].timestamp = 2.04;   // near the last
  const ImagePoses poses = posesFromTrajectory(images, trajectory);
  ASSERT_TRUE(poses[0] && poses[1] && poses[3]);
  EXPECT_FALSE(poses[2]);
  EXPECT_NEAR(poses[0]->translation().x(), 0.25, 1e-9);
  EXPECT_NEAR(poses[1]->translation().x(), 1.0, 1e-9);
  EXPECT_NEAR(poses[3]->translation().x(), 0.0, 1e-9);
}

}  // namespace
}  // namespace hmcdyn::calibrate
