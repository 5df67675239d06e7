// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/tracker.hpp"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "slam/track/matched_points.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kMinPointsToStart = 30;  // half as many again as tracking needs

/// Median depth (m) of the key points that have one; 1 where none has.
double medianDepth(const Frame& frame) {
  std::vector<float> depths;
  std::copy_if(frame.points.depth.begin(), frame.points.depth.end(), std::back_inserter(depths),
               [](float depth) { return hasDepth(depth); });
  if (depths.empty()) {
    return 1.0;
  }
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

std::size_t staticPointsWithDepth(const Frame& frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    count += frame.in_person[i] == 0 && hasDepth(frame.points.depth[i]) ? 1 : 0;
  }
  return count;
}

}  // namespace

const char* toString(TrackingFailure failure) noexcept {
  switch (failure) {
    case TrackingFailure::kNone:
      return "none";
    case TrackingFailure::kTooFewKeyPoints:
      return "too few key points";
    case TrackingFailure::kTooFewMatches:
      return "too few matches";
    case TrackingFailure::kUnconfirmed:
      return "not confirmed";
  }
  return "invalid";
}

Tracker::Tracker(const PinholeCamera& camera, const TrackerOptions& options)
    : camera_(camera), options_(options), map_(camera, options_.map), motion_(options_.motion) {}

PoseRefinementResult Tracker::refine(const Frame& frame, const std::vector<PointMatch>& matches,
                                     const Eigen::Isometry3d& initial, MatchPolicy policy) const {
  MatchedPoints points(frame, matches, map_, policy);
  PoseRefinementResult refined =
      refinePose(points.view(), camera_, initial, options_.refinement, workspace_);
  if (refined.succeeded() && points.dropDisagreeingDepths(refined, camera_, options_.refinement)) {
    refined = refinePose(points.view(), camera_, refined.camera_from_world, options_.refinement,
                         workspace_);
  }
  return refined;
}

Tracker::Estimate Tracker::estimate(const Frame& frame, const KeyPointGrid& grid,
                                    const std::vector<int>& candidates,
                                    const Eigen::Isometry3d& around, float radius) const {
  const auto estimateBy = [&](MatchPolicy policy) {
    Estimate estimate;
    estimate.search = matchByProjection(frame, grid, map_, candidates, around, camera_, radius,
                                        options_.matcher, policy);
    estimate.refinement = refine(frame, estimate.search.matches, around, policy);
    return estimate;
  };
  Estimate kept = estimateBy(MatchPolicy::kKeptPoints);
  if (kept.refinement.inliers >= options_.few_inliers) {
    return kept;
  }
  Estimate trusted = estimateBy(MatchPolicy::kTrustedPoints);
  return trusted.refinement.inliers > kept.refinement.inliers ? trusted : kept;
}

std::optional<Eigen::Isometry3d> Tracker::relocalize(const Frame& frame) const {
  const std::vector<KeyFrame>& key_frames = map_.keyFrames();
  constexpr std::size_t kTries = 5;
  for (std::size_t k = 0; k < std::min(kTries, key_frames.size()); ++k) {
    const KeyFrame& key_frame = key_frames[key_frames.size() - 1 - k];
    const std::vector<PointMatch> matches = matchByDescriptor(frame, key_frame, options_.matcher);
    if (matches.size() < options_.min_inliers) {
      continue;
    }
    std::vector<cv::Point3d> world;
    std::vector<cv::Point2d> pixels;
    for (const PointMatch& match : matches) {
      const Eigen::Vector3d& p = map_.points()[static_cast<std::size_t>(match.map_point)].position;
      world.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(frame.points.u[match.key_point], frame.points.v[match.key_point]);
    }
    const cv::Matx33d intrinsics(camera_.fx, 0.0, camera_.cx, 0.0, camera_.fy, camera_.cy, 0.0, 0.0,
                                 1.0);
    cv::Vec3d rotation;
    cv::Vec3d translation;
    std::vector<int> inliers;
    constexpr int kIterations = 200;
    constexpr float kReprojection = 4.0f;  // px
    constexpr double kConfidence = 0.999;
    const bool found =  // draws that OpenCV seeds with a constant
        cv::solvePnPRansac(world, pixels, intrinsics, cv::noArray(), rotation, translation, false,
                           kIterations, kReprojection, kConfidence, inliers, cv::SOLVEPNP_EPNP);
    if (!found || inliers.size() < options_.min_inliers) {
      continue;
    }
    const Eigen::Vector3d axis(rotation[0], rotation[1], rotation[2]);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (axis.norm() > 0.0) {
      pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
    }
    pose.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
    return pose;
  }
  return std::nullopt;
}

bool Tracker::needsKeyFrame(const Frame& frame) const {
  const KeyFramePolicy& policy = options_.key_frames;
  const Frame& reference = map_.keyFrames().back().frame;
  const std::size_t known =
      reference.inliers > 0 ? reference.inliers : map_.keyFrames().back().map_points / 2;
  if (static_cast<double>(frame.inliers) <
      policy.min_reference_share * static_cast<double>(known)) {
    return true;
  }
  if (frame.inliers < policy.min_inliers && map_.newPointsIn(frame) >= policy.min_new_points) {
    return true;
  }
  const Eigen::Isometry3d way = frame.camera_from_world * reference.camera_from_world.inverse();
  return Eigen::AngleAxisd(way.linear()).angle() > policy.max_turn ||
         way.translation().norm() > policy.max_parallax * medianDepth(frame);
}

TrackingResult Tracker::initialize(Frame frame) {
  TrackingResult result;
  if (staticPointsWithDepth(frame) < kMinPointsToStart) {
    result.failure = TrackingFailure::kTooFewKeyPoints;
    return result;
  }
  frame.tracked = true;
  map_.insertKeyFrame(frame);
  result.new_key_frame = true;
  result.inliers = map_.keyFrames().back().map_points;
  constexpr double kExact = 1e-12;  // the first camera is the world's origin
  motion_.update(frame.timestamp, frame.camera_from_world,
                 kExact * MotionModel::Matrix6::Identity());
  last_match_ = frame.timestamp;
  last_ = std::move(frame);
  return result;
}

TrackingResult Tracker::lose(TrackingFailure failure) {
  lost_ = true;
  motion_.reset();
  if (failure != TrackingFailure::kUnconfirmed) {
    unconfirmed_.reset();
  }
  TrackingResult result;
  result.failure = failure;
  return result;
}

bool Tracker::isReachable(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                          double seconds) const {
  constexpr double kNoise = 0.05;  // m, rad: of two poses that were found on their own
  const Eigen::Isometry3d way = to * from.inverse();
  return way.translation().norm() <= options_.fastest * seconds + kNoise &&
         Eigen::AngleAxisd(way.linear()).angle() <= options_.fastest_turn * seconds + kNoise;
}

bool Tracker::isBelievable(double timestamp, const Eigen::Isometry3d& found) const {
  constexpr double kWithin = 1.0;  // s: later, nearly everything can be reached
  const double since = timestamp - last_->timestamp;
  if (since <= kWithin && isReachable(last_->camera_from_world, found, since)) {
    return true;
  }
  return unconfirmed_ && timestamp - unconfirmed_->first <= kWithin &&
         isReachable(unconfirmed_->second, found, timestamp - unconfirmed_->first);
}

void Tracker::apply(const MapCorrection& correction) {
  if (!last_ || correction.key_frames.empty()) {
    return;
  }
  const int reference = static_cast<int>(map_.keyFrames().size()) - 1;
  const Eigen::Isometry3d from_reference =
      last_->camera_from_world * map_.poseOf(reference).inverse();
  map_.apply(correction);
  last_->camera_from_world = from_reference * map_.poseOf(reference);
  unconfirmed_.reset();  // of the map as it was
  motion_.relocate(last_->camera_from_world);
}

void Tracker::countSightings(const Frame& frame, const ProjectionSearch& search) {
  std::unordered_map<int, std::size_t> key_point_of;  // what is seen, not the whole map
  for (std::size_t i = 0; i < frame.map_point.size(); ++i) {
    if (frame.map_point[i] != kNoMapPoint) {
      key_point_of.emplace(frame.map_point[i], i);
    }
  }
  const std::unordered_set<int> dynamic(search.seen_dynamic.begin(), search.seen_dynamic.end());
  for (const int point : search.visible) {
    const auto found = key_point_of.find(point);
    LandmarkSighting evidence;
    evidence.agrees = found != key_point_of.end();
    if (dynamic.count(point) != 0) {
      evidence.label = PointLabel::kDynamic;
    } else if (evidence.agrees) {
      evidence.label = frame.label[found->second];
      evidence.weight = frame.lambda[found->second];
    }
    map_.count(point, evidence.agrees, evidence);
  }
}

void Tracker::insertKeyFrame(Frame& frame, const KeyPointGrid& grid) {
  map_.cull();
  tieToForgottenPoints(frame, grid, map_, options_.duplicates);
  map_.insertKeyFrame(frame);
  for (const TriangulatedPoint& point : triangulateNewPoints(map_, options_.triangulation)) {
    map_.addPoint(point.position, point.first, point.second);
  }
  const KnownPoints known = knownPointsOf(map_, options_.duplicates);
  for (const KnownPoints::Sighting& seen : known.sightings) {
    map_.addObservation(seen.point, seen.key_frame, seen.key_point);
  }
  for (const auto& [point, into] : known.duplicates) {
    map_.fusePoints(point, into);
  }
  frame.map_point = map_.keyFrames().back().frame.map_point;
}

Tracker::Estimate Tracker::findAgain(const Frame& frame, const KeyPointGrid& grid,
                                     const std::vector<int>& candidates,
                                     const Relocalize& by_place) const {
  Estimate found;
  if (const std::optional<Eigen::Isometry3d> pose = relocalize(frame)) {
    found = estimate(frame, grid, candidates, *pose, options_.prediction_radius);
  }
  if (found.refinement.inliers < options_.min_inliers && by_place) {
    if (const std::optional<Eigen::Isometry3d> pose = by_place(frame)) {
      // Perhaps in another part of the map than the last frame.
      found = estimate(frame, grid, map_.pointsOf(map_.nearestKeyFrames(*pose)), *pose,
                       options_.wide_radius);
    }
  }
  return found;
}

std::optional<MotionPrediction> Tracker::predict(double timestamp) const {
  return lost_ ? std::nullopt : motion_.predict(timestamp);
}

void Tracker::takePose(Frame& frame, const Estimate& found,
                       const std::optional<MotionPrediction>& expected) {
  for (std::size_t k = 0; k < found.search.matches.size(); ++k) {
    if (found.refinement.inlier[k] != 0) {
      frame.map_point[found.search.matches[k].key_point] = found.search.matches[k].map_point;
    }
  }
  std::optional<MotionModel::Matrix6> covariance;
  if (found.refinement.covariance) {
    covariance = found.refinement.covariance->map();
  }
  const MotionModel::Update update =
      motion_.update(frame.timestamp, found.refinement.camera_from_world, covariance);
  frame.camera_from_world = found.refinement.camera_from_world;
  if (options_.fuse_motion && update.fused && expected && expected->covariance) {
    frame.camera_from_world = update.camera_from_world;
    frame.prior = PosePrior{expected->camera_from_world, *expected->covariance};
  }
}

Tracker::Estimate Tracker::findNear(const Frame& frame, const KeyPointGrid& grid,
                                    const std::vector<int>& candidates,
                                    const Eigen::Isometry3d& expected) const {
  Estimate found = estimate(frame, grid, candidates, expected, options_.prediction_radius);
  if (found.refinement.inliers < options_.min_inliers && frame.odometry) {
    found = estimate(frame, grid, candidates, *frame.odometry, options_.prediction_radius);
  }
  if (found.refinement.inliers < options_.min_inliers) {
    found = estimate(frame, grid, candidates, last_->camera_from_world, options_.wide_radius);
  }
  return found;
}

TrackingResult Tracker::carryOrLose(Frame& frame, const KeyPointGrid& grid,
                                    TrackingFailure failure) {
  if (lost_ || !frame.odometry || frame.timestamp - last_match_ > options_.longest_carry) {
    return lose(failure);
  }
  frame.camera_from_world = *frame.odometry;
  motion_.update(frame.timestamp, frame.camera_from_world, std::nullopt);
  TrackingResult result;
  result.carried = true;
  return goOn(frame, grid, result);
}

TrackingResult Tracker::goOn(Frame& frame, const KeyPointGrid& grid, TrackingResult result) {
  frame.tracked = true;
  frame.inliers = result.inliers;
  result.camera_from_world = frame.camera_from_world;
  result.relocalized = lost_;
  lost_ = false;
  if (needsKeyFrame(frame)) {
    insertKeyFrame(frame, grid);
    result.new_key_frame = true;
  }
  result.reference = static_cast<int>(map_.keyFrames().size()) - 1;
  last_ = std::move(frame);
  return result;
}

TrackingResult Tracker::track(Frame frame, const Relocalize& by_place) {
  if (!last_) {
    return initialize(std::move(frame));
  }
  const KeyPointGrid grid(frame);
  const std::vector<int> candidates = map_.pointsOf(map_.localKeyFrames(*last_));

  const std::optional<MotionPrediction> expected = motion_.predict(frame.timestamp);
  Estimate coarse;
  if (!lost_) {
    coarse = findNear(frame, grid, candidates,
                      expected ? expected->camera_from_world : last_->camera_from_world);
  }
  std::vector<int> around = candidates;
  const bool search = coarse.refinement.inliers < options_.min_inliers;
  if (search) {
    coarse = findAgain(frame, grid, candidates, by_place);
    if (coarse.refinement.inliers < options_.min_inliers) {
      return carryOrLose(frame, grid, TrackingFailure::kTooFewMatches);
    }
    around = map_.pointsOf(map_.nearestKeyFrames(coarse.refinement.camera_from_world));
  }

  const double noise =
      noiseFactor(frame, coarse.search.matches, coarse.refinement.camera_from_world, map_);
  for (float& sigma : frame.sigma) {
    sigma = static_cast<float>(sigma * noise);
  }
  const Estimate fine =
      estimate(frame, grid, around, coarse.refinement.camera_from_world, options_.refined_radius);
  if (!fine.refinement.succeeded() || fine.refinement.inliers < options_.min_inliers) {
    return carryOrLose(frame, grid, TrackingFailure::kTooFewMatches);
  }
  if (search && !isBelievable(frame.timestamp, fine.refinement.camera_from_world)) {
    unconfirmed_.emplace(frame.timestamp, fine.refinement.camera_from_world);
    return carryOrLose(frame, grid, TrackingFailure::kUnconfirmed);
  }
  unconfirmed_.reset();
  last_match_ = frame.timestamp;
  takePose(frame, fine, expected);
  countSightings(frame, fine.search);

  TrackingResult result;
  result.matches = fine.search.matches.size();
  result.inliers = fine.refinement.inliers;
  return goOn(frame, grid, result);
}

}  // namespace hmcdyn::slam
