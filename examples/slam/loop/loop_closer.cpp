// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_closer.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include <Eigen/Eigenvalues>

#include "se3.hpp"
#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

using se3::Matrix6d;

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
  requirePositive("options.max_loop_error", options.max_loop_error);
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

/// Two key frames that share points or follow each other: a comes before b.
struct Tie {
  int a = 0;
  int b = 0;
  int weight = 0;  // points that they share

  int span() const { return b - a; }
};

std::vector<Tie> tiesOf(const LoopSnapshot& snapshot, const Places& places,
                        const LoopCloserOptions& options) {
  std::vector<Tie> ties;
  std::vector<int> weight_to_next(snapshot.key_frames.size(), 0);
  for (const auto& pair : snapshot.covisibility) {
    const int first = places.key_frames.of(pair.a, "covisibility.a");
    const int second = places.key_frames.of(pair.b, "covisibility.b");
    const Tie tie{std::min(first, second), std::max(first, second), pair.weight};
    if (tie.span() == 1) {
      int& weight = weight_to_next[static_cast<std::size_t>(tie.a)];
      weight = std::max(weight, tie.weight);
    } else if (tie.span() > 1 && tie.weight >= options.min_covisibility) {
      ties.push_back(tie);
    }
  }
  for (int i = 0; i + 1 < static_cast<int>(snapshot.key_frames.size()); ++i) {
    ties.push_back({i, i + 1, weight_to_next[static_cast<std::size_t>(i)]});
  }
  return ties;
}

/// How much less a tie says than if it stood alone. Along the path, where each key frame is tied to
/// all before it up to some, many ties span the same step and have its one error in them: a tie
/// over d steps has d steps' variance, and of n over a step each repeats the others. So divided,
/// they hold a step as one tie would; else a chain of many key frames is too stiff to be closed. A
/// tie to a place that the path had left stands alone.
std::vector<double> redundancyOf(const std::vector<Tie>& ties, std::size_t key_frames) {
  std::vector<std::vector<int>> before(key_frames);
  for (const Tie& tie : ties) {
    before[static_cast<std::size_t>(tie.b)].push_back(tie.a);
  }
  std::vector<int> earliest(key_frames, 0);  // without a gap before the key frame
  for (std::size_t b = 0; b < key_frames; ++b) {
    std::sort(before[b].begin(), before[b].end(), std::greater<>());
    earliest[b] = static_cast<int>(b);
    for (const int a : before[b]) {
      earliest[b] = a == earliest[b] - 1 ? a : earliest[b];
    }
  }
  const auto isAlongPath = [&](const Tie& tie) {
    return tie.a >= earliest[static_cast<std::size_t>(tie.b)];
  };
  std::vector<double> over_step(key_frames + 1, 0.0);  // ties over the step from i to i + 1
  for (const Tie& tie : ties) {
    if (isAlongPath(tie)) {
      over_step[static_cast<std::size_t>(tie.a)] += 1.0;
      over_step[static_cast<std::size_t>(tie.b)] -= 1.0;
    }
  }
  std::partial_sum(over_step.begin(), over_step.end(), over_step.begin());
  std::vector<double> up_to(key_frames + 2, 0.0);  // sums of it
  std::partial_sum(over_step.begin(), over_step.end(), up_to.begin() + 1);
  std::vector<double> redundancy;
  redundancy.reserve(ties.size());
  for (const Tie& tie : ties) {
    // span times the mean number of ties over its steps
    redundancy.push_back(isAlongPath(tie) ? up_to[static_cast<std::size_t>(tie.b)] -
                                                up_to[static_cast<std::size_t>(tie.a)]
                                          : 1.0);
  }
  return redundancy;
}

PoseGraphEdge covisibilityEdge(const LoopSnapshot& snapshot, const Tie& tie, double redundancy,
                               const LoopCloserOptions& options) {
  PoseGraphEdge edge;
  edge.from = tie.a;
  edge.to = tie.b;
  edge.to_from = snapshot.key_frames[static_cast<std::size_t>(tie.b)].camera_from_world *
                 snapshot.key_frames[static_cast<std::size_t>(tie.a)].camera_from_world.inverse();
  edge.information =
      static_cast<double>(std::max(tie.weight, 1)) / options.reference_covisibility / redundancy *
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
  const std::vector<Tie> ties = tiesOf(snapshot, places, options);
  const std::vector<double> redundancy = redundancyOf(ties, snapshot.key_frames.size());
  for (std::size_t i = 0; i < ties.size(); ++i) {
    graph.edges.push_back(covisibilityEdge(snapshot, ties[i], redundancy[i], options));
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
  for (const LoopSnapshot::Point& point : snapshot.points) {
    problem.depth_offsets.push_back(point.depth_offset);
  }
  problem.observations.reserve(snapshot.sightings.size());
  for (const auto& sighting : snapshot.sightings) {
    const int point = places.points.of(sighting.point, "sightings.point");
    problem.observations.push_back({places.key_frames.of(sighting.key_frame, "sightings.key_frame"),
                                    into[static_cast<std::size_t>(point)], sighting.u, sighting.v,
                                    sighting.sigma, sighting.depth, sighting.weight,
                                    sighting.depth_sigma});
  }
  return problem;
}

/// By how much poses contradict each loop: squared errors (sigma^2), as in the pose graph.
std::vector<double> loopErrors(const LoopSnapshot& snapshot, const Places& places,
                               const std::vector<Eigen::Isometry3d>& poses,
                               const LoopCloserOptions& options) {
  const Matrix6d floor = informationOf(options.loop_sigma_rotation, options.loop_sigma_translation);
  std::vector<double> errors;
  errors.reserve(snapshot.loops.size());
  for (const LoopConstraint& loop : snapshot.loops) {
    const auto from = static_cast<std::size_t>(places.key_frames.of(loop.from, "loops.from"));
    const auto to = static_cast<std::size_t>(places.key_frames.of(loop.to, "loops.to"));
    const Eigen::Isometry3d error = poses[to] * poses[from].inverse() * loop.to_from.inverse();
    const Eigen::AngleAxisd turn(error.linear());
    Eigen::Matrix<double, 6, 1> delta;
    delta << turn.angle() * turn.axis(), error.translation();
    errors.push_back(delta.dot(withFloor(loop.information, floor) * delta));
  }
  return errors;
}

/// The worst of the loops that are contradicted by too much.
std::optional<std::size_t> refusedOf(const std::vector<double>& errors, double largest) {
  const auto worst = std::max_element(errors.begin(), errors.end());
  if (worst == errors.end() || *worst <= largest) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(worst - errors.begin());
}

}  // namespace

LoopClosure closeLoops(const LoopSnapshot& snapshot, const LoopCloserOptions& options) {
  checkOptions(options);
  const Places places(snapshot);
  LoopClosure closure;
  closure.pose_graph = optimizePoseGraph(graphOf(snapshot, places, options), options.pose_graph);
  std::vector<Eigen::Isometry3d> poses = closure.pose_graph.nodes;
  std::vector<Eigen::Vector3d> points = carriedPoints(snapshot, places, poses);
  std::vector<int> into = fusedPoints(snapshot, places);
  if (options.bundle_adjustment) {
    closure.bundle = adjustBundle(bundleOf(snapshot, places, poses, points, into), options.bundle);
    closure.inlier = closure.bundle.inlier;
    poses = closure.bundle.poses;
    points = closure.bundle.points;
  }
  closure.loop_error = loopErrors(snapshot, places, poses, options);
  const bool stopped = closure.bundle.termination == BundleTermination::kStopped;
  if (!stopped) {
    closure.refused = refusedOf(closure.loop_error, options.max_loop_error);
  }
  closure.closed = !stopped && !closure.refused;
  if (!closure.closed) {
    closure.inlier.clear();
    std::iota(into.begin(), into.end(), 0);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = snapshot.key_frames[i].camera_from_world;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = snapshot.points[i].position;
    }
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
    const double offset = closure.closed && !closure.bundle.depth_offsets.empty()
                              ? closure.bundle.depth_offsets[target]
                              : snapshot.points[target].depth_offset;
    closure.points.push_back(
        {snapshot.points[i].id, points[target], snapshot.points[target].id, offset});
    closure.fused += target != i ? 1 : 0;
  }
  return closure;
}

}  // namespace hmcdyn::slam
