// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {
namespace {

/// A key frame's key points that may be triangulated.
struct View {
  const Frame* frame = nullptr;
  int key_frame = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::vector<std::size_t> key_points;
};

View viewOf(const Map& map, int key_frame) {
  View view;
  view.frame = &map.keyFrames()[static_cast<std::size_t>(key_frame)].frame;
  view.key_frame = key_frame;
  view.centre = view.frame->camera_from_world.inverse().translation();
  for (std::size_t i = 0; i < view.frame->points.size(); ++i) {
    const float depth = view.frame->points.depth[i];
    const bool measured = hasDepth(depth) && depth <= map.options().max_depth;
    if (!measured && view.frame->map_point[i] == kNoMapPoint && mayEnterMap(*view.frame, i)) {
      view.key_points.push_back(i);
    }
  }
  return view;
}

Eigen::Vector3d direction(const View& view, std::size_t key_point, const PinholeCamera& camera) {
  return (view.frame->camera_from_world.linear().transpose() *
          camera.unproject(view.frame->points.u[key_point], view.frame->points.v[key_point], 1.0))
      .normalized();
}

/// F with x_second^T F x_first = 0.
Eigen::Matrix3d fundamentalOf(const View& first, const View& second, const PinholeCamera& camera) {
  const Eigen::Isometry3d motion =
      second.frame->camera_from_world * first.frame->camera_from_world.inverse();
  const Eigen::Vector3d t = motion.translation();
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  Eigen::Matrix3d inverse_k = Eigen::Matrix3d::Identity();
  inverse_k(0, 0) = 1.0 / camera.fx;
  inverse_k(1, 1) = 1.0 / camera.fy;
  inverse_k(0, 2) = -camera.cx / camera.fx;
  inverse_k(1, 2) = -camera.cy / camera.fy;
  return inverse_k.transpose() * cross * motion.linear() * inverse_k;
}

const std::uint8_t* descriptorOf(const View& view, std::size_t key_point) {
  return view.frame->features.descriptors.ptr<std::uint8_t>(static_cast<int>(key_point));
}

/// The key point of `second` that looks most like one of `first`, near its epipolar line; the
/// number of key points where none does.
std::size_t matchAlongLine(const View& first, std::size_t i, const View& second,
                           const Eigen::Matrix3d& fundamental,
                           const TriangulationOptions& options) {
  const Eigen::Vector3d line =
      fundamental * Eigen::Vector3d(first.frame->points.u[i], first.frame->points.v[i], 1.0);
  const double norm = std::hypot(line.x(), line.y());
  int best = std::numeric_limits<int>::max();
  int runner_up = best;
  std::size_t found = second.frame->points.size();
  for (const std::size_t j : second.key_points) {
    const double distance = std::abs(line.x() * second.frame->points.u[j] +
                                     line.y() * second.frame->points.v[j] + line.z());
    if (distance > options.max_epipolar * second.frame->sigma[j] * norm ||
        std::abs(first.frame->features.key_points[i].octave -
                 second.frame->features.key_points[j].octave) > 1) {
      continue;
    }
    const int bits = hammingDistance(descriptorOf(first, i), descriptorOf(second, j));
    if (bits < best) {
      runner_up = best;
      best = bits;
      found = j;
    } else {
      runner_up = std::min(runner_up, bits);
    }
  }
  const bool clear = best <= options.max_distance &&
                     static_cast<float>(best) < options.max_ratio * static_cast<float>(runner_up);
  return clear ? found : second.frame->points.size();
}

bool projectsOnto(const View& view, std::size_t key_point, const Eigen::Vector3d& position,
                  const PinholeCamera& camera, double chi2) {
  const Eigen::Vector3d p = view.frame->camera_from_world * position;
  constexpr double kNearest = 0.1;  // m
  if (!(p.z() > kNearest)) {
    return false;
  }
  const Eigen::Vector2d seen(view.frame->points.u[key_point], view.frame->points.v[key_point]);
  const double sigma = view.frame->sigma[key_point];
  return (camera.project(p) - seen).squaredNorm() <= chi2 * sigma * sigma;
}

}  // namespace

Eigen::Vector3d midpoint(const Eigen::Vector3d& from, const Eigen::Vector3d& first,
                         const Eigen::Vector3d& to, const Eigen::Vector3d& second) {
  const Eigen::Vector3d way = to - from;
  const double cosine = first.dot(second);
  const double square_sine = 1.0 - cosine * cosine;  // 0 for parallel rays: NaN or infinity
  const double a = (way.dot(first) - cosine * way.dot(second)) / square_sine;
  const double b = (cosine * way.dot(first) - way.dot(second)) / square_sine;
  return 0.5 * (from + a * first + to + b * second);
}

std::vector<TriangulatedPoint> triangulateNewPoints(const Map& map,
                                                    const TriangulationOptions& options) {
  std::vector<TriangulatedPoint> points;
  const PinholeCamera& camera = map.camera();
  const int latest = static_cast<int>(map.keyFrames().size()) - 1;
  View first = viewOf(map, latest);
  std::size_t compared = 0;
  for (const auto& [neighbour, shared] : map.covisible(latest)) {
    if (compared++ >= options.neighbours) {
      break;
    }
    const View second = viewOf(map, neighbour);
    const Eigen::Matrix3d fundamental = fundamentalOf(first, second, camera);
    std::vector<std::size_t> left;
    for (const std::size_t i : first.key_points) {
      const std::size_t j = matchAlongLine(first, i, second, fundamental, options);
      bool good = j < second.frame->points.size();
      if (good) {
        const Eigen::Vector3d a = direction(first, i, camera);
        const Eigen::Vector3d b = direction(second, j, camera);
        const Eigen::Vector3d position = midpoint(first.centre, a, second.centre, b);
        good = std::acos(std::min(1.0, a.dot(b))) >= options.min_parallax && position.allFinite() &&
               projectsOnto(first, i, position, camera, options.chi2) &&
               projectsOnto(second, j, position, camera, options.chi2);
        if (good) {
          points.push_back({position, {latest, i}, {neighbour, j}});
        }
      }
      if (!good) {
        left.push_back(i);
      }
    }
    first.key_points = std::move(left);
  }
  return points;
}

}  // namespace hmcdyn::slam
