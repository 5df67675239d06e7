// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/relocalizer.hpp"

#include <cmath>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <hmcdyn/pose_refinement.hpp>

#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

/// Matches whose point in the key frame has a place.
struct Matched {
  std::vector<DescriptorMatch> matches;  // from: key frame, to: frame
  std::vector<Eigen::Vector3d> points;   // in the key frame's camera (m)
};

bool isFinite(const KeyPoints& points, std::size_t i) {
  return std::isfinite(points.u[i]) && std::isfinite(points.v[i]);
}

Matched matchWith(const LoopKeyFrame& key_frame, const LoopKeyFrame& frame,
                  const PinholeCamera& camera, const RelocalizerOptions& options) {
  Matched matched;
  for (const DescriptorMatch& match :
       matchDescriptors(key_frame.descriptors, frame.descriptors, options.matcher)) {
    const auto i = static_cast<std::size_t>(match.from);
    if (isFinite(key_frame.points, i) && hasDepth(key_frame.points.depth[i]) &&
        isFinite(frame.points, static_cast<std::size_t>(match.to))) {
      matched.matches.push_back(match);
      matched.points.push_back(camera.unproject(key_frame.points.u[i], key_frame.points.v[i],
                                                key_frame.points.depth[i]));
    }
  }
  return matched;
}

/// frame_from_key_frame by the depths of both.
std::optional<Eigen::Isometry3d> rigidPose(const Matched& matched, const LoopKeyFrame& key_frame,
                                           const LoopKeyFrame& frame, const PinholeCamera& camera,
                                           const RelocalizerOptions& options) {
  const auto sighted = [](const LoopKeyFrame& seen, int point) {
    const auto i = static_cast<std::size_t>(point);
    return SightedPoint{seen.points.u[i], seen.points.v[i], seen.points.depth[i], seen.sigma[i]};
  };
  std::vector<SightedPair> pairs;
  for (const DescriptorMatch& match : matched.matches) {
    pairs.push_back({sighted(key_frame, match.from), sighted(frame, match.to)});
  }
  const RigidRansacResult ransac = rigidRansac(pairs, camera, options.ransac);
  if (ransac.usable < options.min_depth_pairs || !ransac.found) {
    return std::nullopt;
  }
  return ransac.to_from;
}

/// The same by the pixels of the frame alone.
std::optional<Eigen::Isometry3d> perspectivePose(const Matched& matched, const LoopKeyFrame& frame,
                                                 const PinholeCamera& camera,
                                                 const RelocalizerOptions& options) {
  constexpr std::size_t kFewest = 6;  // OpenCV's sample and one to agree
  if (matched.matches.size() < kFewest) {
    return std::nullopt;
  }
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (std::size_t k = 0; k < matched.matches.size(); ++k) {
    const auto j = static_cast<std::size_t>(matched.matches[k].to);
    points.emplace_back(matched.points[k].x(), matched.points[k].y(), matched.points[k].z());
    pixels.emplace_back(frame.points.u[j], frame.points.v[j]);
  }
  const cv::Matx33d intrinsics(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  constexpr double kConfidence = 0.999;
  cv::Vec3d rotation;
  cv::Vec3d translation;
  try {
    if (!cv::solvePnPRansac(points, pixels, intrinsics, cv::noArray(), rotation, translation, false,
                            options.pnp_iterations, options.pnp_reprojection, kConfidence,
                            cv::noArray(), cv::SOLVEPNP_AP3P)) {
      return std::nullopt;
    }
  } catch (const cv::Exception&) {
    return std::nullopt;  // what it throws on degenerate points
  }
  const Eigen::Vector3d axis(rotation[0], rotation[1], rotation[2]);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (!axis.allFinite()) {
    return std::nullopt;
  }
  if (axis.norm() > 0.0) {
    pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
  }
  pose.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
  return pose.matrix().allFinite() ? std::optional(pose) : std::nullopt;
}

PoseRefinementResult refine(const Matched& matched, const LoopKeyFrame& frame,
                            const Eigen::Isometry3d& initial, const PinholeCamera& camera,
                            const RelocalizerOptions& options) {
  std::vector<float> x, y, z, u, v, sigma, depth, depth_sigma;
  for (std::size_t k = 0; k < matched.matches.size(); ++k) {
    const auto j = static_cast<std::size_t>(matched.matches[k].to);
    const Eigen::Vector3f point = matched.points[k].cast<float>();
    x.push_back(point.x());
    y.push_back(point.y());
    z.push_back(point.z());
    u.push_back(frame.points.u[j]);
    v.push_back(frame.points.v[j]);
    sigma.push_back(frame.sigma[j]);
    depth.push_back(frame.points.depth[j]);
    depth_sigma.push_back(sigmaOfDifference(depth.back(), options.ransac.depth_error));
  }
  PoseRefinementOptions refinement;
  refinement.depth_row = DepthRow::kDepth;
  return refinePose({x, y, z, u, v, sigma, depth, {}, depth_sigma}, camera, initial, refinement);
}

/// Tries one key frame, and takes it over where it is the best so far.
void tryKeyFrame(const LoopKeyFrame& key_frame, const LoopKeyFrame& frame,
                 const PinholeCamera& camera, const RelocalizerOptions& options,
                 RelocalizationResult& result) {
  const Matched matched = matchWith(key_frame, frame, camera, options);
  ++result.tried;
  result.most_matches = std::max(result.most_matches, matched.matches.size());
  if (matched.matches.size() < options.min_inliers) {
    return;
  }
  auto method = RelocalizationMethod::kRigid;
  std::optional<Eigen::Isometry3d> pose = rigidPose(matched, key_frame, frame, camera, options);
  if (!pose) {
    method = RelocalizationMethod::kPerspective;
    pose = perspectivePose(matched, frame, camera, options);
  }
  if (!pose) {
    return;
  }
  const PoseRefinementResult refined = refine(matched, frame, *pose, camera, options);
  if (!refined.succeeded() || refined.inliers <= result.most_inliers) {
    return;
  }
  if (refined.inliers >= options.min_inliers &&
      coverageIn(frame, key_frame, refined.camera_from_world, camera, options.coverage) <
          options.min_coverage) {
    ++result.contradicted;
    return;
  }
  result.most_inliers = refined.inliers;
  if (refined.inliers < options.min_inliers) {
    return;
  }
  result.camera_from_world = refined.camera_from_world * key_frame.camera_from_world;
  result.key_frame = key_frame.id;
  result.method = method;
  result.matches.clear();
  for (std::size_t k = 0; k < matched.matches.size(); ++k) {
    if (refined.inlier[k] != 0) {
      const int i = matched.matches[k].from;
      result.matches.push_back(
          {matched.matches[k].to, i, key_frame.map_point[static_cast<std::size_t>(i)]});
    }
  }
}

}  // namespace

RelocalizationResult relocalize(const LoopKeyFrame& frame, const PlaceIndex& index,
                                const std::map<std::size_t, LoopKeyFrame>& key_frames,
                                const PinholeCamera& camera, const RelocalizerOptions& options) {
  requireAtLeast("options.pnp_iterations", options.pnp_iterations, 1);
  requirePositive("options.pnp_reprojection", options.pnp_reprojection);
  LoopKeyFrame query = frame;
  query.map_point.assign(frame.points.size(), -1);
  checkLoopKeyFrame(query, "frame");
  RelocalizationResult result;
  for (const PlaceCandidate& place : index.query(frame.descriptors, options.max_candidates)) {
    const auto found = key_frames.find(place.id);
    if (found != key_frames.end()) {
      checkLoopKeyFrame(found->second, "key_frames");
      requireRigid("key_frames.camera_from_world", found->second.camera_from_world);
      tryKeyFrame(found->second, query, camera, options, result);
      if (result.camera_from_world && result.most_inliers >= options.enough_inliers) {
        break;  // the others see less of the same
      }
    }
  }
  return result;
}

}  // namespace hmcdyn::slam
