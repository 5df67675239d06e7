// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <fmt/format.h>
#include <opencv2/calib3d.hpp>

#include "calibrate/pixel_accuracy.hpp"
#include "evaluate/alignment.hpp"
#include "evaluate/statistics.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::calibrate {
namespace {

constexpr std::size_t kLeastPoints = 50;
constexpr int kWeighings = 2;            // a third changes nothing that matters
constexpr double kFarOut = 4.0;          // deviations: of normal errors one of 3000 observations is
constexpr double kRotationSigma = 0.05;  // rad: pixels know better

Eigen::Vector3d inCamera(const TrackPoint& seen, double depth, const PinholeCamera& camera) {
  return {(static_cast<double>(seen.pixel.x) - camera.cx) / camera.fx * depth,
          (static_cast<double>(seen.pixel.y) - camera.cy) / camera.fy * depth, depth};
}

/// The world point of a track by the first of its images that has a pose and a depth.
std::optional<Eigen::Vector3d> firstGuess(const Track& track,
                                          const std::vector<CalibrationImage>& images,
                                          const ImagePoses& poses, const PinholeCamera& camera) {
  for (const TrackPoint& seen : track) {
    const auto& pose = poses[static_cast<std::size_t>(seen.image)];
    const auto depth = static_cast<double>(
        depthAt(images[static_cast<std::size_t>(seen.image)].depth,
                static_cast<double>(seen.pixel.x), static_cast<double>(seen.pixel.y)));
    if (pose && depth > 0.0) {
      return *pose * inCamera(seen, depth, camera);
    }
  }
  return std::nullopt;
}

/// Camera in the world from points and their pixels, or nothing.
std::optional<Eigen::Isometry3d> poseFromPoints(const std::vector<cv::Point3d>& points,
                                                const std::vector<cv::Point2d>& pixels,
                                                const PinholeCamera& camera) {
  if (points.size() < 12) {
    return std::nullopt;
  }
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation;
  cv::Vec3d translation;
  std::vector<int> inliers;
  if (!cv::solvePnPRansac(points, pixels, matrix, cv::noArray(), rotation, translation, false, 200,
                          4.0f, 0.999, inliers) ||
      inliers.size() < 12) {
    return std::nullopt;
  }
  std::vector<cv::Point3d> good_points;
  std::vector<cv::Point2d> good_pixels;
  for (const int i : inliers) {
    good_points.push_back(points[static_cast<std::size_t>(i)]);
    good_pixels.push_back(pixels[static_cast<std::size_t>(i)]);
  }
  cv::solvePnPRefineLM(good_points, good_pixels, matrix, cv::noArray(), rotation, translation);
  cv::Matx33d turned;
  cv::Rodrigues(rotation, turned);
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      camera_from_world.matrix()(row, column) = turned(row, column);
    }
    camera_from_world.translation()[row] = translation[row];
  }
  return camera_from_world.inverse();
}

/// A bundle problem, and which image and track its poses and points are.
struct Problem {
  slam::BundleProblem bundle;
  std::vector<int> image_of;
  std::vector<int> track_of;
  std::vector<TrackPoint> seen;  // by observation
};

/// The given way from the first image to each other one, as a weak expectation.
std::vector<slam::BundleMotion> givenMotions(const std::vector<slam::BundlePose>& poses,
                                             double position_sigma) {
  Eigen::Matrix<double, 6, 1> weights;
  weights << Eigen::Vector3d::Constant(1.0 / (kRotationSigma * kRotationSigma)),
      Eigen::Vector3d::Constant(1.0 / (position_sigma * position_sigma));
  std::vector<slam::BundleMotion> motions;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    motions.push_back({0, static_cast<int>(i),
                       poses[i].camera_from_world * poses[0].camera_from_world.inverse(),
                       weights.asDiagonal().toDenseMatrix()});
  }
  return motions;
}

Problem makeProblem(const std::vector<CalibrationImage>& images, const std::vector<Track>& tracks,
                    const ImagePoses& poses, const PinholeCamera& camera,
                    const TriangulationOptions& options) {
  Problem problem;
  problem.bundle.camera = camera;
  std::vector<int> pose_of(images.size(), -1);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (poses[i]) {
      pose_of[i] = static_cast<int>(problem.bundle.poses.size());
      problem.bundle.poses.push_back({poses[i]->inverse(), false});
      problem.image_of.push_back(static_cast<int>(i));
    }
  }
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const auto usable = std::count_if(tracks[t].begin(), tracks[t].end(), [&](const auto& seen) {
      return pose_of[static_cast<std::size_t>(seen.image)] >= 0;
    });
    const std::optional<Eigen::Vector3d> guess = firstGuess(tracks[t], images, poses, camera);
    if (usable < options.least_images || !guess) {
      continue;
    }
    for (const TrackPoint& seen : tracks[t]) {
      const int pose = pose_of[static_cast<std::size_t>(seen.image)];
      if (pose >= 0) {
        problem.bundle.observations.push_back(
            {pose, static_cast<int>(problem.bundle.points.size()), seen.pixel.x, seen.pixel.y,
             static_cast<float>(options.pixel_sigma), 0.0f, 1.0f});
        problem.seen.push_back(seen);
      }
    }
    problem.bundle.points.push_back(*guess);
    problem.track_of.push_back(static_cast<int>(t));
  }
  if (problem.bundle.poses.size() < 3 || problem.bundle.points.size() < kLeastPoints) {
    throw std::runtime_error(fmt::format(
        "{} images with a pose see {} points often enough; expected at least 3 and {}: is the "
        "scene static and textured, and does the trajectory belong to the recording?",
        problem.bundle.poses.size(), problem.bundle.points.size(), kLeastPoints));
  }
  problem.bundle.motions = givenMotions(problem.bundle.poses, options.position_sigma);
  return problem;
}

/// What an observation tells of the point: J^T J / sigma^2, in world axes, and its pixel error.
struct Contribution {
  Eigen::Matrix3d information;
  double pixel_error = 0.0;
};

Contribution contributionOf(const Eigen::Vector3d& point, const TrackPoint& seen,
                            const Eigen::Isometry3d& camera_from_world, const PinholeCamera& camera,
                            double sigma) {
  const Eigen::Vector3d p = camera_from_world * point;
  Eigen::Matrix<double, 2, 3> projection;
  projection << camera.fx / p.z(), 0.0, -camera.fx * p.x() / (p.z() * p.z()),  //
      0.0, camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
  const Eigen::Matrix<double, 2, 3> jacobian = projection * camera_from_world.linear();
  const Eigen::Vector2d pixel(camera.fx * p.x() / p.z() + camera.cx,
                              camera.fy * p.y() / p.z() + camera.cy);
  return {jacobian.transpose() * jacobian / (sigma * sigma),
          (pixel -
           Eigen::Vector2d(static_cast<double>(seen.pixel.x), static_cast<double>(seen.pixel.y)))
              .norm()};
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<Eigen::Isometry3d>& cameras_from_world) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(cameras_from_world.size());
  for (const Eigen::Isometry3d& pose : cameras_from_world) {
    positions.emplace_back(pose.inverse().translation());
  }
  return positions;
}

/// Distance of an observation from its projection (px); nothing behind the camera.
std::optional<double> distanceOf(const slam::BundleObservation& observation,
                                 const slam::BundleSolution& solution,
                                 const PinholeCamera& camera) {
  const Eigen::Vector3d p = solution.poses[static_cast<std::size_t>(observation.pose)] *
                            solution.points[static_cast<std::size_t>(observation.point)];
  if (!(p.z() > 0.0)) {
    return std::nullopt;
  }
  return std::hypot(camera.fx * p.x() / p.z() + camera.cx - static_cast<double>(observation.u),
                    camera.fy * p.y() / p.z() + camera.cy - static_cast<double>(observation.v));
}

/// Starts the problem anew from its solution, each observation with the deviation that the
/// solution's residuals give to key points of its size. What lies far out by that measure takes no
/// part any more: wrong matches are many, and start far away, where a robust loss lets all of them
/// pull alike.
void weighBySize(Problem& problem, const slam::BundleSolution& solution,
                 const TriangulationOptions& options) {
  slam::BundleProblem& bundle = problem.bundle;
  std::vector<std::size_t> index;
  std::vector<PixelResidual> residuals;
  for (std::size_t i = 0; i < bundle.observations.size(); ++i) {
    bundle.observations[i].weight = 0.0f;
    if (const auto distance = distanceOf(bundle.observations[i], solution, bundle.camera)) {
      index.push_back(i);
      residuals.push_back({problem.seen[i].size, *distance});
    }
  }
  const auto equations = static_cast<double>(2 * residuals.size());
  const auto unknowns = static_cast<double>(3 * bundle.points.size() + 6 * bundle.poses.size());
  const std::vector<double> deviations = pixelDeviations(
      residuals, std::max(0.1, 1.0 - unknowns / equations), options.least_pixel_sigma);
  for (std::size_t i = 0; i < index.size(); ++i) {
    slam::BundleObservation& observation = bundle.observations[index[i]];
    observation.sigma = static_cast<float>(deviations[i]);
    observation.weight = residuals[i].distance > kFarOut * deviations[i] ? 0.0f : 1.0f;
  }
  for (std::size_t i = 0; i < bundle.poses.size(); ++i) {
    bundle.poses[i].camera_from_world = solution.poses[i];
  }
  bundle.points = solution.points;
}

/// A solution as the given positions' similarity moves it.
Triangulation moved(const Problem& problem, const slam::BundleSolution& solution,
                    const evaluate::Alignment& similarity, std::size_t images,
                    const TriangulationOptions& options) {
  Triangulation result;
  result.poses.resize(images);
  std::vector<Eigen::Isometry3d> camera_from_world;
  for (std::size_t i = 0; i < solution.poses.size(); ++i) {
    const Eigen::Isometry3d pose = solution.poses[i].inverse();
    Eigen::Isometry3d placed = Eigen::Isometry3d::Identity();
    placed.linear() = similarity.rotation * pose.linear();
    placed.translation() = similarity * pose.translation();
    result.poses[static_cast<std::size_t>(problem.image_of[i])] = placed;
    camera_from_world.push_back(placed.inverse());
  }
  std::vector<TriangulatedTrack> tracks(solution.points.size());
  std::vector<Eigen::Matrix3d> information(tracks.size(), Eigen::Matrix3d::Zero());
  std::vector<double> errors;
  for (std::size_t i = 0; i < problem.seen.size(); ++i) {
    const slam::BundleObservation& observation = problem.bundle.observations[i];
    const auto point = static_cast<std::size_t>(observation.point);
    if (solution.inlier[i] == 0) {
      continue;
    }
    tracks[point].point = similarity * solution.points[point];
    const Contribution contribution =
        contributionOf(tracks[point].point, problem.seen[i],
                       camera_from_world[static_cast<std::size_t>(observation.pose)],
                       problem.bundle.camera, static_cast<double>(observation.sigma));
    information[point] += contribution.information;
    errors.push_back(contribution.pixel_error);
    tracks[point].seen.push_back(problem.seen[i]);
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (static_cast<int>(tracks[i].seen.size()) >= options.least_images) {
      tracks[i].track = problem.track_of[i];
      tracks[i].covariance = information[i].inverse();
      result.tracks.push_back(std::move(tracks[i]));
    }
  }
  result.pixel_error = errors.empty() ? 0.0 : evaluate::median(errors);
  return result;
}

}  // namespace

float depthAt(const cv::Mat& depth, double u, double v) {
  const int x = cvRound(u);
  const int y = cvRound(v);
  return x >= 0 && y >= 0 && x < depth.cols && y < depth.rows ? depth.at<float>(y, x) : 0.0f;
}

ImagePoses posesFromTrajectory(const std::vector<CalibrationImage>& images,
                               const evaluate::Trajectory& trajectory, double largest_gap) {
  ImagePoses poses;
  for (const CalibrationImage& image : images) {
    const auto after = std::lower_bound(
        trajectory.begin(), trajectory.end(), image.timestamp,
        [](const evaluate::StampedPose& pose, double time) { return pose.timestamp < time; });
    const auto before = after == trajectory.begin() ? after : after - 1;
    std::optional<Eigen::Isometry3d> pose;
    if (after != trajectory.end() && after != before &&
        after->timestamp - before->timestamp <= largest_gap) {
      const double part =
          (image.timestamp - before->timestamp) / (after->timestamp - before->timestamp);
      pose = Eigen::Isometry3d::Identity();
      pose->translation() =
          (1.0 - part) * before->pose.translation() + part * after->pose.translation();
      pose->linear() = Eigen::Quaterniond(before->pose.linear())
                           .slerp(part, Eigen::Quaterniond(after->pose.linear()))
                           .toRotationMatrix();
    } else {
      for (const auto& near : {before, after}) {
        if (near != trajectory.end() &&
            std::abs(near->timestamp - image.timestamp) <= 0.5 * largest_gap) {
          pose = near->pose;
        }
      }
    }
    poses.push_back(pose);
  }
  return poses;
}

ImagePoses posesFromTracks(const std::vector<CalibrationImage>& images,
                           const std::vector<Track>& tracks, const PinholeCamera& camera) {
  ImagePoses poses(images.size());
  if (poses.empty()) {
    return poses;
  }
  poses.front() = Eigen::Isometry3d::Identity();
  for (std::size_t i = 1; i < images.size(); ++i) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (const Track& track : tracks) {
      const auto seen = std::find_if(track.begin(), track.end(), [i](const TrackPoint& point) {
        return point.image == static_cast<int>(i);
      });
      if (seen == track.end()) {
        continue;
      }
      // The image itself has no pose yet: only those before it speak.
      if (const auto point = firstGuess(track, images, poses, camera)) {
        points.emplace_back(point->x(), point->y(), point->z());
        pixels.emplace_back(seen->pixel.x, seen->pixel.y);
      }
    }
    poses[i] = poseFromPoints(points, pixels, camera);
  }
  return poses;
}

Triangulation triangulate(const std::vector<CalibrationImage>& images,
                          const std::vector<Track>& tracks, const ImagePoses& poses,
                          const PinholeCamera& camera, const TriangulationOptions& options) {
  Problem problem = makeProblem(images, tracks, poses, camera, options);
  std::vector<Eigen::Vector3d> given;
  for (const slam::BundlePose& pose : problem.bundle.poses) {
    given.emplace_back(pose.camera_from_world.inverse().translation());
  }
  slam::BundleOptions bundle_options;
  bundle_options.rounds = 3;
  bundle_options.max_iterations = 40;
  bundle_options.function_tolerance = 1e-7;
  bundle_options.max_dense_poses = 200;
  slam::BundleSolution solution = slam::adjustBundle(problem.bundle, bundle_options);
  for (int pass = 0; pass < kWeighings; ++pass) {
    weighBySize(problem, solution, options);
    solution = slam::adjustBundle(problem.bundle, bundle_options);
  }
  const std::vector<Eigen::Vector3d> refined = positionsOf(solution.poses);
  const evaluate::Alignment similarity =
      evaluate::align(refined, given, evaluate::AlignmentModel::kSimilarity);
  Triangulation result = moved(problem, solution, similarity, images.size(), options);
  double sum = 0.0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    sum += (similarity * refined[i] - given[i]).squaredNorm();
  }
  result.position_error = std::sqrt(sum / static_cast<double>(given.size()));
  return result;
}

}  // namespace hmcdyn::calibrate
