// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/rigid_ransac.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include <Eigen/Core>
#include <Eigen/LU>

#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

using Mask = std::vector<std::uint8_t>;
constexpr std::size_t kSample = 3;

/// A sighted point in its camera's frame.
struct Place {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     // px
  double depth_sigma = 0.0;                            // m
  double pixel_sigma = 1.0;                            // px
};

struct PlacePair {
  std::size_t index = 0;  // in the caller's pairs
  Place from;
  Place to;
};

void checkInput(const std::vector<SightedPair>& pairs, const PinholeCamera& camera,
                const RigidRansacOptions& options) {
  requirePositive("camera.fx", camera.fx);
  requirePositive("camera.fy", camera.fy);
  checkModel(options.depth_error);
  requirePositive("options.chi2_pixel", options.chi2_pixel);
  requirePositive("options.chi2_depth", options.chi2_depth);
  requireAtLeast("options.max_iterations", options.max_iterations, 1);
  require(options.confidence >= 0.0 && options.confidence <= 1.0, "options.confidence",
          std::to_string(options.confidence), "0..1");
  requireNotNegative("options.min_area", options.min_area);
  requireAtLeast("options.refits", options.refits, 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    requirePositive("pairs[" + std::to_string(i) + "].from.sigma", pairs[i].from.sigma);
    requirePositive("pairs[" + std::to_string(i) + "].to.sigma", pairs[i].to.sigma);
  }
}

std::optional<Place> placeOf(const SightedPoint& point, const PinholeCamera& camera,
                             const DepthErrorModel& depth_error) {
  if (!std::isfinite(point.u) || !std::isfinite(point.v) || !std::isfinite(point.depth) ||
      !(point.depth > 0.0)) {
    return std::nullopt;
  }
  return Place{camera.unproject(point.u, point.v, point.depth),
               {point.u, point.v},
               relativeDepthError(static_cast<double>(point.depth), depth_error),
               point.sigma};
}

std::vector<PlacePair> placesOf(const std::vector<SightedPair>& pairs, const PinholeCamera& camera,
                                const DepthErrorModel& depth_error) {
  std::vector<PlacePair> places;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::optional<Place> from = placeOf(pairs[i].from, camera, depth_error);
    const std::optional<Place> to = placeOf(pairs[i].to, camera, depth_error);
    if (from && to) {
      places.push_back({i, *from, *to});
    }
  }
  return places;
}

/// Whether `seen` is where `place`, moved by `motion`, should be seen.
bool agrees(const Place& place, const Place& seen, const Eigen::Isometry3d& motion,
            const PinholeCamera& camera, const RigidRansacOptions& options) {
  const Eigen::Vector3d p = motion * place.position;
  if (!(p.z() > 0.0)) {
    return false;
  }
  const double depth_error = p.z() - seen.position.z();
  const double depth_variance =
      place.depth_sigma * place.depth_sigma + seen.depth_sigma * seen.depth_sigma;
  if (depth_error * depth_error > options.chi2_depth * depth_variance) {
    return false;
  }
  const Eigen::Vector2d error = camera.project(p) - seen.pixel;
  const double scaled = place.pixel_sigma * place.position.z() / p.z();
  const double variance = seen.pixel_sigma * seen.pixel_sigma + scaled * scaled;
  // dh/dz of the moved point along its ray: where its depth is wrong, the pixel goes this way.
  const Eigen::Vector3d ray = motion.linear() * (place.position / place.position.z());
  const Eigen::Vector2d along = place.depth_sigma / p.z() *
                                Eigen::Vector2d(camera.fx * (ray.x() - p.x() / p.z() * ray.z()),
                                                camera.fy * (ray.y() - p.y() / p.z() * ray.z()));
  // e^T (variance I + along along^T)^-1 e, by Sherman and Morrison.
  const double projected = along.dot(error);
  const double distance =
      (error.squaredNorm() - projected * projected / (variance + along.squaredNorm())) / variance;
  return distance <= options.chi2_pixel;
}

Mask inliersOf(const std::vector<PlacePair>& pairs, const Eigen::Isometry3d& to_from,
               const PinholeCamera& camera, const RigidRansacOptions& options) {
  const Eigen::Isometry3d from_to = to_from.inverse();
  Mask mask;
  mask.reserve(pairs.size());
  for (const PlacePair& pair : pairs) {
    mask.push_back(agrees(pair.from, pair.to, to_from, camera, options) &&
                           agrees(pair.to, pair.from, from_to, camera, options)
                       ? 1
                       : 0);
  }
  return mask;
}

std::size_t countOf(const Mask& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
}

/// Least squares over the marked pairs; none where the points do not span a plane.
std::optional<Eigen::Isometry3d> fit(const std::vector<PlacePair>& pairs, const Mask& mask) {
  const auto n = static_cast<Eigen::Index>(countOf(mask));
  Eigen::Matrix3Xd from(3, n);
  Eigen::Matrix3Xd to(3, n);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (mask[i] != 0) {
      from.col(column) = pairs[i].from.position;
      to.col(column++) = pairs[i].to.position;
    }
  }
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.matrix() = Eigen::umeyama(from, to, false);
  if (!motion.matrix().allFinite()) {
    return std::nullopt;
  }
  return motion;
}

using Sample = std::array<std::size_t, kSample>;

Sample drawSample(std::mt19937& random, std::size_t n) {
  Sample sample{};
  for (std::size_t k = 0; k < kSample;) {
    sample.at(k) = random() % n;
    k += std::find(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(k), sample.at(k)) ==
                 sample.begin() + static_cast<std::ptrdiff_t>(k)
             ? 1
             : 0;
  }
  return sample;
}

/// The motion of three pairs, if they span a triangle whose sides are as long on both sides.
std::optional<Eigen::Isometry3d> motionOf(const std::vector<PlacePair>& pairs, const Sample& sample,
                                          const RigidRansacOptions& options) {
  constexpr double kSigmas = 3.0;
  Eigen::Matrix3d from;
  Eigen::Matrix3d to;
  for (std::size_t k = 0; k < kSample; ++k) {
    const PlacePair& a = pairs[sample.at(k)];
    const PlacePair& b = pairs[sample.at((k + 1) % kSample)];
    const double difference =
        (a.from.position - b.from.position).norm() - (a.to.position - b.to.position).norm();
    const double tolerance = kSigmas * (Eigen::Vector4d(a.from.depth_sigma, b.from.depth_sigma,
                                                        a.to.depth_sigma, b.to.depth_sigma)
                                            .norm() +
                                        // and a pixel sideways
                                        (a.from.position.z() + b.from.position.z()) * 2e-3);
    if (std::abs(difference) > tolerance) {
      return std::nullopt;
    }
    from.col(static_cast<Eigen::Index>(k)) = a.from.position;
    to.col(static_cast<Eigen::Index>(k)) = a.to.position;
  }
  const auto area = [](const Eigen::Matrix3d& corners) {
    const Eigen::Vector3d side = corners.col(1) - corners.col(0);
    return 0.5 * side.cross(corners.col(2) - corners.col(0)).norm();
  };
  if (!(std::min(area(from), area(to)) > options.min_area)) {
    return std::nullopt;
  }
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.matrix() = Eigen::umeyama(from, to, false);
  return motion.matrix().allFinite() ? std::optional(motion) : std::nullopt;
}

/// Samples until one of inliers only has been among them with the wanted confidence.
double samplesNeeded(std::size_t inliers, std::size_t pairs, double confidence) {
  const double share = static_cast<double>(inliers) / static_cast<double>(pairs);
  const double good = share * share * share;
  if (good >= 1.0) {
    return 1.0;
  }
  return good > 0.0 ? std::log(1.0 - confidence) / std::log1p(-good) : HUGE_VAL;
}

}  // namespace

RigidRansacResult rigidRansac(const std::vector<SightedPair>& pairs, const PinholeCamera& camera,
                              const RigidRansacOptions& options) {
  checkInput(pairs, camera, options);
  const std::vector<PlacePair> places = placesOf(pairs, camera, options.depth_error);
  RigidRansacResult result;
  result.inlier.assign(pairs.size(), 0);
  result.usable = places.size();
  if (places.size() < kSample) {
    return result;
  }
  std::mt19937 random(options.seed);
  Mask best(places.size(), 0);
  double needed = HUGE_VAL;
  while (result.iterations < options.max_iterations && result.iterations < needed) {
    ++result.iterations;
    const auto motion = motionOf(places, drawSample(random, places.size()), options);
    if (!motion) {
      continue;
    }
    Mask mask = inliersOf(places, *motion, camera, options);
    if (countOf(mask) > countOf(best)) {
      needed = samplesNeeded(countOf(mask), places.size(), options.confidence);
      best = std::move(mask);
      result.to_from = *motion;
    }
  }
  for (int k = 0; k < options.refits && countOf(best) >= kSample; ++k) {
    const auto motion = fit(places, best);
    Mask mask = motion ? inliersOf(places, *motion, camera, options) : Mask();
    if (!motion || countOf(mask) < countOf(best)) {
      break;
    }
    const bool settled = mask == best;
    result.to_from = *motion;
    best = std::move(mask);
    if (settled) {
      break;
    }
  }
  result.inliers = countOf(best);
  result.found = result.inliers >= kSample;
  for (std::size_t i = 0; i < places.size(); ++i) {
    result.inlier[places[i].index] = best[i];
  }
  return result;
}

}  // namespace hmcdyn::slam
