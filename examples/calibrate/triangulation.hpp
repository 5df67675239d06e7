// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "calibrate/feature_tracks.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::calibrate {

/// An image of a recording and what its camera measured.
struct CalibrationImage {
  double timestamp = 0.0;  ///< Of the colour image (s).
  cv::Mat gray;            ///< CV_8UC1, rectified.
  cv::Mat depth;           ///< CV_32FC1 (m), rectified, 0 = none.
};

/// Camera in the world, or nothing where it is not known; one an image.
using ImagePoses = std::vector<std::optional<Eigen::Isometry3d>>;

/// The trajectory's poses at the images' times, interpolated between two poses that are at most
/// `largest_gap` (s) apart, else the nearest one within half of that.
ImagePoses posesFromTrajectory(const std::vector<CalibrationImage>& images,
                               const evaluate::Trajectory& trajectory, double largest_gap = 0.1);

/// Poses from the images alone: each from the points that images before it saw, with their depth,
/// by RANSAC and PnP. It drifts; triangulate() mends that. Images with fewer than 12 known points
/// have no pose.
ImagePoses posesFromTracks(const std::vector<CalibrationImage>& images,
                           const std::vector<Track>& tracks, const PinholeCamera& camera);

/// A point of the scene where its images put it, without a look at its measured depth.
struct TriangulatedTrack {
  int track = 0;                                    ///< Index of the track.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< World (m).
  Eigen::Matrix3d covariance;                       ///< Of it (m^2), the poses taken for true.
  std::vector<TrackPoint> seen;                     ///< The points of the track that agree with it.
};

struct Triangulation {
  ImagePoses poses;  ///< Refined, camera in the world; none where the image took no part.
  std::vector<TriangulatedTrack> tracks;
  double pixel_error = 0.0;     ///< Median distance of `seen` from its projection (px).
  double position_error = 0.0;  ///< RMS distance of the refined positions from the given ones (m).
};

struct TriangulationOptions {
  double pixel_sigma = 0.7;  ///< Of a key point (px), > 0, to start with; SIFT on real images.
  double least_pixel_sigma = 0.05;  ///< No key point is taken to be better (px), > 0.
  int least_images = 3;             ///< That see a point, >= 2.
  /// What a given position is worth (m), > 0. Pixels alone let the scale drift along a path whose
  /// ends see nothing in common; RGB-D SLAM and motion capture are good to some millimetres.
  double position_sigma = 0.005;
};

/// Poses and points from where the images see the points and, within position_sigma each, from the
/// given positions, by bundle adjustment; the result is moved, turned and scaled as a whole to fit
/// the given positions, so its scale is theirs on average.
/// @param images depth is looked at to start from, and not kept to.
/// @throws std::runtime_error where fewer than three images or 50 points can be used, or the
/// positions do not tell a scale.
Triangulation triangulate(const std::vector<CalibrationImage>& images,
                          const std::vector<Track>& tracks, const ImagePoses& poses,
                          const PinholeCamera& camera, const TriangulationOptions& options = {});

/// Depth at the pixel nearest to a place; 0 where there is none.
float depthAt(const cv::Mat& depth, double u, double v);

}  // namespace hmcdyn::calibrate
