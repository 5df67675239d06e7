// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::evaluate {

struct MapScoreOptions {
  /// A point lies on a surface where its depth and the surface's differ by at most base + slope z^2
  /// (m, 1/m). The depth images of hmcdyn_synthesize --noise none are exact; others have steps.
  double tolerance_base = 0.04;
  double tolerance_slope = 0.008;
  std::size_t every = 5;          ///< Every so many frames of the sequence count. Above 0.
  double coverage_radius = 0.05;  ///< A surface is covered where a map point is so near (m).
  double max_depth = 4.0;         ///< Surfaces farther away need not be covered (m).
};

/// The truth about one frame.
struct TrueFrame {
  cv::Mat depth;  ///< CV_32FC1 (m), 0 = none.
  cv::Mat mask;   ///< CV_8UC1: 0 the room, else a person.
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();  ///< Translation in m.
};

/// Map points by where they lie, and how much of the room the map holds.
struct MapScore {
  std::size_t on_surface = 0;  ///< On a static surface in at least one frame.
  std::size_t floating = 0;    ///< Ghosts: on none, and frames look through their place.
  std::size_t buried = 0;      ///< Ghosts: on none, always behind what frames see there.
  std::size_t unseen = 0;      ///< Nothing is known: outside all frames, or behind people.
  std::size_t surface = 0;     ///< Sampled pixels of static surfaces.
  std::size_t covered = 0;     ///< Of them, those with a map point nearby.

  double ghostShare() const;  ///< Ghosts of all points but the unseen, NaN for none.
  double coverage() const;    ///< covered / surface, NaN for none.
};

/// Scores a map against frames, one at a time. A ghost is a point on no static surface: see
/// MapScore. A person who stands still is a ghost, too.
class MapScorer {
 public:
  /// @param points in the truth's world (m), finite.
  /// @throws std::invalid_argument on options out of range, or a point that is not finite.
  MapScorer(std::vector<Eigen::Vector3f> points, const PinholeCamera& camera,
            const MapScoreOptions& options = {});

  /// @throws std::invalid_argument where depth and mask differ in size or have another type.
  void add(const TrueFrame& frame);

  MapScore score() const;

 private:
  void judge(const TrueFrame& frame);
  void cover(const TrueFrame& frame);

  std::vector<Eigen::Vector3f> points_;
  PinholeCamera camera_;
  MapScoreOptions options_;
  std::vector<std::uint8_t> evidence_;    // bits, one element a point
  std::vector<Eigen::Vector3f> samples_;  // of static surfaces
};

/// Scores a map against a folder of hmcdyn_synthesize (calibration.yaml, groundtruth.txt,
/// associations.txt, depth/, mask/).
/// @throws std::invalid_argument as MapScorer. @throws std::runtime_error naming the file where one
/// is missing or malformed, or where no frame has a pose, a depth image and a mask.
MapScore scoreMap(std::vector<Eigen::Vector3f> points, const std::filesystem::path& sequence,
                  const MapScoreOptions& options = {});

}  // namespace hmcdyn::evaluate
