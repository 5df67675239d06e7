// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_verification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "slam/loop/coverage.hpp"
#include "slam/loop/pixel_grid.hpp"
#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

bool isSighted(const KeyPoints& points, std::size_t i) {
  return std::isfinite(points.u[i]) && std::isfinite(points.v[i]) && hasDepth(points.depth[i]);
}

SightedPoint sighted(const LoopKeyFrame& key_frame, std::size_t i) {
  return {key_frame.points.u[i], key_frame.points.v[i], key_frame.points.depth[i],
          key_frame.sigma[i]};
}

/// What the points of one key frame make of the other, given the motion between them.
struct GuidedSearch {
  std::vector<std::pair<int, int>> pairs;  ///< One-to-one, by `from`.
  double support = 0.0;
  double coverage = 0.0;
  double depth_agreement = 0.0;
};

/// Nearest key point with a depth around a pixel.
std::optional<std::size_t> neighbourOf(const LoopKeyFrame& to, const PixelGrid& grid,
                                       const Eigen::Vector2d& pixel, double radius) {
  std::optional<std::size_t> nearest;
  double best = std::numeric_limits<double>::max();
  grid.around(pixel.x(), pixel.y(), radius, [&](std::size_t j) {
    const double distance = std::hypot(to.points.u[j] - pixel.x(), to.points.v[j] - pixel.y());
    if (hasDepth(to.points.depth[j]) && distance < best) {
      best = distance;
      nearest = j;
    }
  });
  return nearest;
}

struct Claim {
  int from = -1;
  int distance = std::numeric_limits<int>::max();
};

double shareOf(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

GuidedSearch searchAround(const LoopKeyFrame& from, const LoopKeyFrame& to,
                          const Eigen::Isometry3d& to_from, const PinholeCamera& camera,
                          const LoopVerificationOptions& options) {
  const PixelGrid grid(to.points, std::max(options.radius, options.neighbour_radius));
  std::vector<Claim> claims(to.points.size());
  std::vector<Cell> cells(from.points.size());
  Coverage coverage(options.cell_points, options.min_square_support);
  std::size_t visible = 0;
  std::size_t compared = 0;
  std::size_t agreeing = 0;
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    if (!isSighted(from.points, i)) {
      continue;
    }
    const double depth = from.points.depth[i];
    const Eigen::Vector3d p = to_from * camera.unproject(from.points.u[i], from.points.v[i], depth);
    const Eigen::Vector2d pixel = camera.project(p);
    if (!(p.z() > 0.0) || !grid.covers(pixel.x(), pixel.y())) {
      continue;
    }
    ++visible;
    cells[i] = cellOf(pixel.x(), pixel.y(), options.cell);
    coverage.expect(cells[i]);
    if (const auto j = neighbourOf(to, grid, pixel, options.neighbour_radius)) {
      const double seen = to.points.depth[*j];
      const double tolerance =
          3.0 * std::hypot(relativeDepthError(depth, options.ransac.depth_error),
                           relativeDepthError(seen, options.ransac.depth_error)) +
          options.depth_tolerance * p.z();
      ++compared;
      agreeing += std::abs(p.z() - seen) <= tolerance ? 1 : 0;
    }
    const auto alike = alikeAround(from, i, to, grid, pixel, options.radius, options.max_distance);
    if (alike && alike->second < claims[alike->first].distance) {
      claims[alike->first] = {static_cast<int>(i), alike->second};
    }
  }
  GuidedSearch search;
  for (std::size_t j = 0; j < claims.size(); ++j) {
    if (claims[j].from >= 0) {
      search.pairs.emplace_back(claims[j].from, static_cast<int>(j));
      coverage.find(cells[static_cast<std::size_t>(claims[j].from)]);
    }
  }
  std::sort(search.pairs.begin(), search.pairs.end());
  search.support = shareOf(search.pairs.size(), visible);
  search.coverage = coverage.share();
  search.depth_agreement = shareOf(agreeing, compared);
  return search;
}

/// The motion that fits the pairs best. The points of `from` are taken as exact there, so that
/// their noise is put on the side of `to`: both times sqrt(2).
PoseRefinementResult refine(const LoopKeyFrame& from, const LoopKeyFrame& to,
                            const std::vector<std::pair<int, int>>& pairs,
                            const Eigen::Isometry3d& to_from, const PinholeCamera& camera,
                            const LoopVerificationOptions& options) {
  const auto root2 = std::sqrt(2.0f);
  std::vector<float> x, y, z, u, v, sigma, depth, depth_sigma;
  for (const auto& [i, j] : pairs) {
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(j);
    const Eigen::Vector3f p =
        camera.unproject(from.points.u[a], from.points.v[a], from.points.depth[a]).cast<float>();
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
    u.push_back(to.points.u[b]);
    v.push_back(to.points.v[b]);
    sigma.push_back(root2 * std::max(from.sigma[a], to.sigma[b]));
    depth.push_back(to.points.depth[b]);
    depth_sigma.push_back(sigmaOfDifference(depth.back(), options.ransac.depth_error));
  }
  PoseRefinementOptions refinement;
  refinement.depth_row = DepthRow::kDepth;
  return refinePose({x, y, z, u, v, sigma, depth, {}, depth_sigma}, camera, to_from, refinement);
}

/// Squares of the image with a point in them.
std::size_t cellsOf(const KeyPoints& points, const std::vector<int>& chosen, double cell) {
  std::set<Cell> cells;
  for (const int i : chosen) {
    const auto k = static_cast<std::size_t>(i);
    cells.insert(cellOf(points.u[k], points.v[k], cell));
  }
  return cells.size();
}

LoopVerdict judge(const LoopVerification& found, const LoopVerificationOptions& options) {
  if (found.inliers < options.min_inliers) {
    return LoopVerdict::kTooFewInliers;
  }
  if (found.cells < options.min_cells) {
    return LoopVerdict::kClustered;
  }
  if (found.support < options.min_support) {
    return LoopVerdict::kLittleSupport;
  }
  if (found.coverage < options.min_coverage) {
    return LoopVerdict::kLocalSupport;
  }
  return found.depth_agreement < options.min_depth_agreement ? LoopVerdict::kDepthDisagrees
                                                             : LoopVerdict::kAccepted;
}

void checkOptions(const LoopVerificationOptions& options) {
  requirePositive("options.radius", options.radius);
  requirePositive("options.neighbour_radius", options.neighbour_radius);
  requirePositive("options.cell", options.cell);
  requireNotNegative("options.depth_tolerance", options.depth_tolerance);
  require(options.cell_points >= 1, "options.cell_points", std::to_string(options.cell_points),
          "at least 1");
}

}  // namespace

const char* toString(LoopVerdict verdict) noexcept {
  switch (verdict) {
    case LoopVerdict::kAccepted:
      return "accepted";
    case LoopVerdict::kLowScore:
      return "low score";
    case LoopVerdict::kInconsistent:
      return "inconsistent";
    case LoopVerdict::kTooFewMatches:
      return "too few matches";
    case LoopVerdict::kTooFewInliers:
      return "too few inliers";
    case LoopVerdict::kClustered:
      return "clustered";
    case LoopVerdict::kLittleSupport:
      return "little support";
    case LoopVerdict::kLocalSupport:
      return "local support";
    case LoopVerdict::kDepthDisagrees:
      return "depth disagrees";
    case LoopVerdict::kOutvoted:
      return "outvoted";
  }
  return "invalid";
}

LoopVerification verifyLoop(const LoopKeyFrame& from, const LoopKeyFrame& to,
                            const PinholeCamera& camera, const LoopVerificationOptions& options) {
  checkOptions(options);
  checkLoopKeyFrame(from, "from");
  checkLoopKeyFrame(to, "to");
  LoopVerification result;
  std::vector<SightedPair> pairs;
  for (const DescriptorMatch& match :
       matchDescriptors(from.descriptors, to.descriptors, options.matcher)) {
    const auto i = static_cast<std::size_t>(match.from);
    const auto j = static_cast<std::size_t>(match.to);
    if (isSighted(from.points, i) && isSighted(to.points, j)) {
      pairs.push_back({sighted(from, i), sighted(to, j)});
    }
  }
  result.matches = pairs.size();
  if (result.matches < options.min_matches) {
    return result;
  }
  result.verdict = LoopVerdict::kTooFewInliers;
  const RigidRansacResult ransac = rigidRansac(pairs, camera, options.ransac);
  result.inliers = ransac.inliers;
  constexpr std::size_t kFewestToSearch = 6;  // twice a sample
  if (ransac.inliers < kFewestToSearch) {
    return result;
  }

  const GuidedSearch search = searchAround(from, to, ransac.to_from, camera, options);
  const PoseRefinementResult refined =
      refine(from, to, search.pairs, ransac.to_from, camera, options);
  result.inliers = refined.inliers;
  if (!refined.succeeded() || !refined.covariance) {
    return result;
  }
  result.to_from = refined.camera_from_world;
  const Eigen::Matrix<double, 6, 6> covariance = *refined.covariance;
  result.information = covariance.inverse();
  std::vector<int> of_from;
  std::vector<int> of_to;
  for (std::size_t k = 0; k < search.pairs.size(); ++k) {
    if (refined.inlier[k] != 0) {
      result.key_points.push_back(search.pairs[k]);
      of_from.push_back(search.pairs[k].first);
      of_to.push_back(search.pairs[k].second);
    }
  }
  // Once more, from where the motion has moved to.
  const GuidedSearch seen = searchAround(from, to, result.to_from, camera, options);
  result.support = seen.support;
  result.coverage = seen.coverage;
  result.depth_agreement = seen.depth_agreement;
  result.cells = std::min(cellsOf(from.points, of_from, options.cell),
                          cellsOf(to.points, of_to, options.cell));
  result.verdict = judge(result, options);
  return result;
}

}  // namespace hmcdyn::slam
