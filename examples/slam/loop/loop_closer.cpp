// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_closer.hpp"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

#include <Eigen/Eigenvalues>

#include "slam/optimization/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

[[noreturn]] void refuse(const std::string& what, const std::string& id,
                         const std::string& expected) {
  throw std::invalid_argument(what + " is " + id + ", expected " + expected);
}

/// Places of ids in an array.
template <class Id>
class Numbering {
 public:
  Numbering(std::string name, std::size_t size) : name_(std::move(name)) { places_.reserve(size); }

  void append(Id id) {
    if (!places_.emplace(id, static_cast<int>(places_.size())).second) {
      refuse(name_, std::to_string(id), "each id once");
    }
  }
  bool has(Id id) const { return places_.count(id) != 0; }
  int of(Id id, const char* where) const {
    const auto found = places_.find(id);
    if (found == places_.end()) {
      refuse(where, std::to_string(id), "the id of one of the snapshot's " + name_);
    }
    return found->second;
  }

 private:
  std::string name_;
  std::unordered_map<Id, int> places_;
};

/// The ids of a snapshot, resolved.
struct Places {
  Numbering<std::size_t> key_frames;
  Numbering<int> points;

  explicit Places(const LoopSnapshot& snapshot)
      : key_frames("key frames", snapshot.key_frames.size()),
        points("points", snapshot.points.size()) {
    for (const auto& key_frame : snapshot.key_frames) {
      key_frames.append(key_frame.id);
    }
    for (const auto& point : snapshot.points) {
      points.append(point.id);
    }
  }
};

void checkOptions(const LoopCloserOptions& options) {
  requirePositive("options.covisibility_sigma_rotation", options.covisibility_sigma_rotation);
  requirePositive("options.covisibility_sigma_translation", options.covisibility_sigma_translation);
  requirePositive("options.loop_sigma_rotation", options.loop_sigma_rotation);
  requirePositive("options.loop_sigma_translation", options.loop_sigma_translation);
  requireAtLeast("options.reference_covisibility", options.reference_covisibility, 1);
}

Matrix6d informationOf(double sigma_rotation, double sigma_translation) {
  Eigen::Matrix<double, 6, 1> diagonal;
  diagonal.head<3>().setConstant(1.0 / (sigma_rotation * sigma_rotation));
  diagonal.tail<3>().setConstant(1.0 / (sigma_translation * sigma_translation));
  return diagonal.asDiagonal();
}

/// The information of a measurement that has an independent error of covariance floor^-1 on top:
/// (I^-1 + F^-1)^-1 = I (I + F)^-1 F, which also holds where I is singular.
Matrix6d withFloor(const Matrix6d& information, const Matrix6d& floor) {
  const Matrix6d sum = information + floor;
  const Matrix6d combined = information * sum.ldlt().solve(floor);
  return 0.5 * (combined + combined.transpose());
}

PoseGraphEdge covisibilityEdge(const LoopSnapshot& snapshot, int from, int to, int weight,
                               const LoopCloserOptions& options) {
  PoseGraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.to_from = snapshot.key_frames[static_cast<std::size_t>(to)].camera_from_world *
                 snapshot.key_frames[static_cast<std::size_t>(from)].camera_from_world.inverse();
  edge.information =
      static_cast<double>(std::max(weight, 1)) / options.reference_covisibility *
      informationOf(options.covisibility_sigma_rotation, options.covisibility_sigma_translation);
  return edge;
}

/// Loops first, then what ties key frames that share points or follow each other.
PoseGraphProblem graphOf(const LoopSnapshot& snapshot, const Places& places,
                         const LoopCloserOptions& options) {
  PoseGraphProblem graph;
  for (const auto& key_frame : snapshot.key_frames) {
    graph.nodes.push_back(key_frame.camera_from_world);
  }
  const Matrix6d floor = informationOf(options.loop_sigma_rotation, options.loop_sigma_translation);
  for (const LoopConstraint& loop : snapshot.loops) {
    graph.edges.push_back({places.key_frames.of(loop.from, "loops.from"),
                           places.key_frames.of(loop.to, "loops.to"), loop.to_from,
                           withFloor(loop.information, floor), true});
  }
  std::vector<int> weight_to_next(snapshot.key_frames.size(), 0);
  for (const auto& pair : snapshot.covisibility) {
    const int a = places.key_frames.of(pair.a, "covisibility.a");
    const int b = places.key_frames.of(pair.b, "covisibility.b");
    if (std::abs(a - b) == 1) {
      int& weight = weight_to_next[static_cast<std::size_t>(std::min(a, b))];
      weight = std::max(weight, pair.weight);
    } else if (a != b && pair.weight >= options.min_covisibility) {
      graph.edges.push_back(covisibilityEdge(snapshot, a, b, pair.weight, options));
    }
  }
  for (int i = 0; i + 1 < static_cast<int>(snapshot.key_frames.size()); ++i) {
    graph.edges.push_back(
        covisibilityEdge(snapshot, i, i + 1, weight_to_next[static_cast<std::size_t>(i)], options));
  }
  return graph;
}

/// For each point the one that it is one with: of those that loops tie together, the first.
std::vector<int> fusedPoints(const LoopSnapshot& snapshot, const Places& places) {
  std::vector<int> into(snapshot.points.size());
  for (std::size_t i = 0; i < into.size(); ++i) {
    into[i] = static_cast<int>(i);
  }
  const auto root = [&into](int point) {
    while (into[static_cast<std::size_t>(point)] != point) {
      point = into[static_cast<std::size_t>(point)];
    }
    return point;
  };
  for (const LoopConstraint& loop : snapshot.loops) {
    for (const auto& [a, b] : loop.map_points) {
      if (places.points.has(a) && places.points.has(b)) {  // others were culled since
        const int first = root(places.points.of(a, "map point"));
        const int second = root(places.points.of(b, "map point"));
        into[static_cast<std::size_t>(std::max(first, second))] = std::min(first, second);
      }
    }
  }
  for (std::size_t i = 0; i < into.size(); ++i) {
    into[i] = root(static_cast<int>(i));
  }
  return into;
}

/// Points moved with their anchors.
std::vector<Eigen::Vector3d> carriedPoints(const LoopSnapshot& snapshot, const Places& places,
                                           const std::vector<Eigen::Isometry3d>& corrected) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(snapshot.points.size());
  for (const auto& point : snapshot.points) {
    const auto anchor =
        static_cast<std::size_t>(places.key_frames.of(point.anchor, "points.anchor"));
    points.push_back(corrected[anchor].inverse() *
                     (snapshot.key_frames[anchor].camera_from_world * point.position));
  }
  return points;
}

BundleProblem bundleOf(const LoopSnapshot& snapshot, const Places& places,
                       const std::vector<Eigen::Isometry3d>& poses,
                       const std::vector<Eigen::Vector3d>& points, const std::vector<int>& into) {
  BundleProblem problem;
  problem.camera = snapshot.camera;
  for (const Eigen::Isometry3d& pose : poses) {
    problem.poses.push_back({pose, problem.poses.empty()});
  }
  problem.points = points;
  problem.observations.reserve(snapshot.sightings.size());
  for (const auto& sighting : snapshot.sightings) {
    const int point = places.points.of(sighting.point, "sightings.point");
    problem.observations.push_back({places.key_frames.of(sighting.key_frame, "sightings.key_frame"),
                                    into[static_cast<std::size_t>(point)], sighting.u, sighting.v,
                                    sighting.sigma, sighting.depth, sighting.weight});
  }
  return problem;
}

}  // namespace

LoopClosure closeLoops(const LoopSnapshot& snapshot, const LoopCloserOptions& options) {
  checkOptions(options);
  const Places places(snapshot);
  LoopClosure closure;
  closure.pose_graph = optimizePoseGraph(graphOf(snapshot, places, options), options.pose_graph);
  std::vector<Eigen::Isometry3d> poses = closure.pose_graph.nodes;
  std::vector<Eigen::Vector3d> points = carriedPoints(snapshot, places, poses);
  const std::vector<int> into = fusedPoints(snapshot, places);
  if (options.bundle_adjustment) {
    closure.bundle = adjustBundle(bundleOf(snapshot, places, poses, points, into), options.bundle);
    closure.inlier = closure.bundle.inlier;
    poses = closure.bundle.poses;
    points = closure.bundle.points;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Isometry3d before = snapshot.key_frames[i].camera_from_world.inverse();
    closure.key_frames.push_back({snapshot.key_frames[i].id, poses[i]});
    closure.largest_correction =
        std::max(closure.largest_correction,
                 (poses[i].inverse().translation() - before.translation()).norm());
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto target = static_cast<std::size_t>(into[i]);
    closure.points.push_back({snapshot.points[i].id, points[target], snapshot.points[target].id});
    closure.fused += target != i ? 1 : 0;
  }
  return closure;
}

}  // namespace hmcdyn::slam
