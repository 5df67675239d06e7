// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/local_bundle.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace hmcdyn::slam {
namespace {

/// The latest key frame and the ones that share most points with it.
std::vector<int> freeKeyFrames(const Map& map, std::size_t most) {
  const int latest = static_cast<int>(map.keyFrames().size()) - 1;
  std::vector<int> chosen{latest};
  for (const auto& [key_frame, shared] : map.covisible(latest)) {
    if (chosen.size() >= most) {
      break;
    }
    chosen.push_back(key_frame);
  }
  return chosen;
}

bool takesPart(const MapPoint& point, const Map& map, const LocalBundleOptions& options) {
  return !point.removed && point.observations.size() >= options.min_observations &&
         point.trust.log_odds >= map.options().trust.threshold;
}

/// Key frames, other than the free ones, that see most of the points.
std::vector<int> fixedKeyFrames(const Map& map, const std::vector<int>& points,
                                const std::vector<int>& free, std::size_t most) {
  std::map<int, int> seen;
  for (const int point : points) {
    for (const Observation& observation :
         map.points()[static_cast<std::size_t>(point)].observations) {
      ++seen[observation.key_frame];
    }
  }
  for (const int key_frame : free) {
    seen.erase(key_frame);
  }
  std::vector<std::pair<int, int>> most_first(seen.begin(), seen.end());
  std::stable_sort(most_first.begin(), most_first.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<int> chosen;
  for (std::size_t k = 0; k < std::min(most, most_first.size()); ++k) {
    chosen.push_back(most_first[k].first);
  }
  return chosen;
}

/// What the depths of the bundle's points say, key frame by key frame.
class DepthSigmas {
 public:
  /// @param key_frames numbers of key frames are its keys. @param points sorted.
  DepthSigmas(const Map& map, const std::map<int, int>& key_frames,
              const std::vector<int>& points) {
    for (const auto& [key_frame, pose] : key_frames) {
      const Frame& frame = map.keyFrames()[static_cast<std::size_t>(key_frame)].frame;
      std::vector<std::size_t>& used = used_[key_frame];
      for (std::size_t i = 0; i < frame.map_point.size(); ++i) {
        if (std::binary_search(points.begin(), points.end(), frame.map_point[i])) {
          used.push_back(i);
        }
      }
      sigmas_[key_frame] = depthSigmas(frame, used, map.options().depth_error);
    }
  }

  /// @param key_point sees one of the points.
  float of(int key_frame, std::size_t key_point) const {
    const std::vector<std::size_t>& used = used_.at(key_frame);
    const auto place = std::lower_bound(used.begin(), used.end(), key_point) - used.begin();
    return sigmas_.at(key_frame)[static_cast<std::size_t>(place)];
  }

 private:
  std::map<int, std::vector<std::size_t>> used_;  ///< Key points, ascending.
  std::map<int, std::vector<float>> sigmas_;      ///< Of their depths (m).
};

BundleObservation observe(const Frame& frame, std::size_t key_point, int pose, int point) {
  BundleObservation observation;
  observation.pose = pose;
  observation.point = point;
  observation.u = frame.points.u[key_point];
  observation.v = frame.points.v[key_point];
  observation.sigma = frame.sigma[key_point];
  observation.depth = frame.points.depth[key_point];
  observation.weight = frame.weight[key_point];
  return observation;
}

}  // namespace

bool judgesObservations(const BundleSolution& solution) {
  return solution.rounds > 0 && solution.termination != BundleTermination::kNumericalFailure &&
         solution.termination != BundleTermination::kNothingToDo;
}

LocalBundle makeLocalBundle(const Map& map, const LocalBundleOptions& options) {
  LocalBundle bundle;
  bundle.problem.camera = map.camera();
  if (map.keyFrames().size() < 2) {
    return bundle;
  }
  const std::vector<int> free =
      freeKeyFrames(map, std::max<std::size_t>(options.free_key_frames, 1));
  for (const int point : map.pointsOf(free)) {
    if (takesPart(map.points()[static_cast<std::size_t>(point)], map, options)) {
      bundle.points.push_back(point);
    }
  }
  const std::vector<int> fixed = fixedKeyFrames(map, bundle.points, free, options.fixed_key_frames);
  std::map<int, int> pose_of;
  const auto add = [&](int key_frame, bool is_fixed) {
    pose_of[key_frame] = static_cast<int>(bundle.key_frames.size());
    bundle.key_frames.push_back(key_frame);
    bundle.problem.poses.push_back({map.poseOf(key_frame), is_fixed});
  };
  for (const int key_frame : free) {
    add(key_frame, key_frame == 0);  // the first one holds the world in its place
  }
  for (const int key_frame : fixed) {
    add(key_frame, true);
  }
  for (const auto& [key_frame, pose] : pose_of) {
    const std::optional<KeyFrameMotion>& motion =
        map.keyFrames()[static_cast<std::size_t>(key_frame)].motion;
    const auto from = motion ? pose_of.find(motion->from) : pose_of.end();
    if (from != pose_of.end()) {
      bundle.problem.motions.push_back({from->second, pose, motion->to_from, motion->information});
    }
  }
  const DepthSigmas depth_sigmas(map, pose_of, bundle.points);
  for (std::size_t k = 0; k < bundle.points.size(); ++k) {
    const MapPoint& point = map.points()[static_cast<std::size_t>(bundle.points[k])];
    bundle.problem.points.push_back(point.position);
    bundle.problem.depth_offsets.push_back(point.depth_offset);
    for (const Observation& seen : point.observations) {
      const auto pose = pose_of.find(seen.key_frame);
      if (pose != pose_of.end()) {
        bundle.problem.observations.push_back(
            observe(map.keyFrames()[static_cast<std::size_t>(seen.key_frame)].frame, seen.key_point,
                    pose->second, static_cast<int>(k)));
        bundle.problem.observations.back().depth_sigma =
            depth_sigmas.of(seen.key_frame, seen.key_point);
      }
    }
  }
  return bundle;
}

MapCorrection toCorrection(const LocalBundle& bundle, const BundleSolution& solution) {
  MapCorrection correction;
  for (std::size_t k = 0; k < bundle.key_frames.size(); ++k) {
    if (!bundle.problem.poses[k].fixed) {
      correction.key_frames.emplace_back(bundle.key_frames[k], solution.poses[k]);
    }
  }
  for (std::size_t k = 0; k < bundle.points.size(); ++k) {
    correction.points.emplace_back(bundle.points[k], solution.points[k]);
    correction.depth_offsets.emplace_back(bundle.points[k], solution.depth_offsets[k]);
  }
  if (!judgesObservations(solution)) {
    return correction;
  }
  for (std::size_t k = 0; k < bundle.problem.observations.size(); ++k) {
    const BundleObservation& observation = bundle.problem.observations[k];
    if (solution.inlier[k] == 0 && observation.weight > 0.0f) {
      correction.outliers.emplace_back(
          bundle.points[static_cast<std::size_t>(observation.point)],
          bundle.key_frames[static_cast<std::size_t>(observation.pose)]);
    }
  }
  return correction;
}

}  // namespace hmcdyn::slam
