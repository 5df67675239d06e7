// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/map_score.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nanoflann.hpp>

namespace hmcdyn::evaluate {
namespace {

constexpr std::uint8_t kOnSurface = 1;
constexpr std::uint8_t kFree = 2;
constexpr std::uint8_t kBehind = 4;
constexpr int kSampleStride = 16;  // px

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : static_cast<double>(part) / static_cast<double>(whole);
}

void check(const std::vector<Eigen::Vector3f>& points, const MapScoreOptions& options) {
  if (!(options.tolerance_base >= 0.0) || !(options.tolerance_slope >= 0.0) || options.every == 0 ||
      !(options.coverage_radius > 0.0) || !(options.max_depth > 0.0)) {
    throw std::invalid_argument(
        fmt::format("map score: tolerance {} m + {} / m, every {}, radius {} m, depth {} m; "
                    "expected tolerances "
                    "of at least 0, the others above 0",
                    options.tolerance_base, options.tolerance_slope, options.every,
                    options.coverage_radius, options.max_depth));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      throw std::invalid_argument(fmt::format("map score: point {} is not finite", i));
    }
  }
}

/// What a frame says of a depth at a pixel. The pixel's neighbours have a say, too, since at a
/// silhouette half a pixel decides between two surfaces.
std::uint8_t evidenceAt(const TrueFrame& frame, int row, int column, double z,
                        const MapScoreOptions& options) {
  const float centre = frame.depth.at<float>(row, column);
  bool all_beyond = centre > 0.0f;
  bool all_nearer = centre > 0.0f;
  for (int r = std::max(0, row - 1); r <= std::min(frame.depth.rows - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(frame.depth.cols - 1, column + 1); ++c) {
      const double seen = frame.depth.at<float>(r, c);
      if (seen <= 0.0) {
        continue;
      }
      const bool is_static = frame.mask.at<std::uint8_t>(r, c) == 0;
      const double tolerance = options.tolerance_base + options.tolerance_slope * seen * seen;
      if (is_static && std::abs(z - seen) <= tolerance) {
        return kOnSurface;
      }
      all_beyond = all_beyond && z < seen - tolerance;
      all_nearer = all_nearer && is_static && z > seen + tolerance;
    }
  }
  if (all_beyond) {
    return kFree;
  }
  return all_nearer ? kBehind : 0;
}

using Points = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace

double MapScore::ghostShare() const {
  return ratio(floating + buried, floating + buried + on_surface);
}

double MapScore::coverage() const { return ratio(covered, surface); }

MapScorer::MapScorer(std::vector<Eigen::Vector3f> points, const PinholeCamera& camera,
                     const MapScoreOptions& options)
    : points_(std::move(points)), camera_(camera), options_(options), evidence_(points_.size(), 0) {
  check(points_, options);
}

void MapScorer::add(const TrueFrame& frame) {
  if (frame.depth.type() != CV_32FC1 || frame.mask.type() != CV_8UC1 ||
      frame.depth.size() != frame.mask.size()) {
    throw std::invalid_argument(fmt::format(
        "map score: depth {}x{} type {}, mask {}x{} type {}; expected one size, CV_32FC1, CV_8UC1",
        frame.depth.cols, frame.depth.rows, frame.depth.type(), frame.mask.cols, frame.mask.rows,
        frame.mask.type()));
  }
  judge(frame);
  cover(frame);
}

void MapScorer::judge(const TrueFrame& frame) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d point = frame.camera_from_world * points_[i].cast<double>();
    if (point.z() <= 0.0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera_.project(point);
    if (pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < frame.depth.cols - 0.5 &&
        pixel.y() < frame.depth.rows - 0.5) {
      evidence_[i] |= evidenceAt(frame, static_cast<int>(std::lround(pixel.y())),
                                 static_cast<int>(std::lround(pixel.x())), point.z(), options_);
    }
  }
}

void MapScorer::cover(const TrueFrame& frame) {
  const Eigen::Isometry3d world_from_camera = frame.camera_from_world.inverse();
  for (int r = kSampleStride / 2; r < frame.depth.rows; r += kSampleStride) {
    for (int c = kSampleStride / 2; c < frame.depth.cols; c += kSampleStride) {
      const float z = frame.depth.at<float>(r, c);
      if (z > 0.0f && z <= options_.max_depth && frame.mask.at<std::uint8_t>(r, c) == 0) {
        samples_.emplace_back((world_from_camera * camera_.unproject(c, r, z)).cast<float>());
      }
    }
  }
}

MapScore MapScorer::score() const {
  MapScore score;
  for (const std::uint8_t evidence : evidence_) {
    if ((evidence & kOnSurface) != 0) {
      ++score.on_surface;
    } else if ((evidence & kFree) != 0) {
      ++score.floating;
    } else if ((evidence & kBehind) != 0) {
      ++score.buried;
    } else {
      ++score.unseen;
    }
  }
  score.surface = samples_.size();
  if (points_.empty() || samples_.empty()) {
    return score;
  }
  Points matrix(static_cast<Eigen::Index>(points_.size()), 3);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) = points_[i].transpose();
  }
  constexpr int kLeafSize = 16;
  const nanoflann::KDTreeEigenMatrixAdaptor<Points, 3> tree(3, std::cref(matrix), kLeafSize);
  const double radius = options_.coverage_radius;
  for (const Eigen::Vector3f& sample : samples_) {
    Eigen::Index nearest = 0;
    float squared = std::numeric_limits<float>::max();
    tree.query(sample.data(), 1, &nearest, &squared);
    score.covered += squared <= radius * radius ? 1 : 0;
  }
  return score;
}

}  // namespace hmcdyn::evaluate
