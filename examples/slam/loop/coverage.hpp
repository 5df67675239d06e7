// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/loop/loop_key_frame.hpp"
#include "slam/loop/pixel_grid.hpp"

namespace hmcdyn::slam {

/// A square of the image, by column and row of squares.
using Cell = std::pair<int, int>;

/// @param side of a square (px, > 0).
Cell cellOf(double u, double v, double side);

/// Where points should be seen again, and whether they are, by squares of the image: a thing that
/// is in two places brings its own squares only, however many points it has.
class Coverage {
 public:
  /// @param cell_points squares with fewer expected points are not asked; >= 1.
  /// @param min_square_support share of its expected points that a square must have found.
  Coverage(std::size_t cell_points, double min_square_support)
      : cell_points_(cell_points), min_square_support_(min_square_support) {}

  void expect(const Cell& cell) { ++squares_[cell].expected; }
  void find(const Cell& cell) { ++squares_[cell].found; }

  /// The share of the asked squares that found enough, 0..1; 0 where none is asked.
  double share() const;

 private:
  struct Square {
    std::size_t expected = 0;
    std::size_t found = 0;
  };

  std::size_t cell_points_;
  double min_square_support_;
  std::map<Cell, Square> squares_;
};

/// The key point of `to` around a pixel that looks most like one of `from`, and in how many bits it
/// differs.
/// @param radius px. @param max_distance bits of 256.
std::optional<std::pair<std::size_t, int>> alikeAround(const LoopKeyFrame& from, std::size_t i,
                                                       const LoopKeyFrame& to,
                                                       const PixelGrid& grid,
                                                       const Eigen::Vector2d& pixel, float radius,
                                                       int max_distance);

struct CoverageOptions {
  float radius = 8.0f;          ///< Around where a point should be (px, > 0).
  int max_distance = 80;        ///< Of the descriptors (bits of 256).
  float cell = 80.0f;           ///< Side of the squares (px, > 0).
  std::size_t cell_points = 3;  ///< See Coverage; also of the frame's key points. >= 1
  double min_square_support = 0.1;
};

/// Whether a frame agrees with where a key frame's points should be in it: Coverage over those
/// squares in which the frame has key points. Where it has none, somebody may stand in the way:
/// that is no contradiction.
/// @param frame_from_key_frame motion between the cameras.
double coverageIn(const LoopKeyFrame& frame, const LoopKeyFrame& key_frame,
                  const Eigen::Isometry3d& frame_from_key_frame, const PinholeCamera& camera,
                  const CoverageOptions& options);

}  // namespace hmcdyn::slam
