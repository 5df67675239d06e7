// SPDX-License-Identifier: BSD-3-Clause
// Step 6, extended: what the neighbours on the same surface, and the frames before, say about a
// point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/votes/surface_depth.hpp>

namespace hmcdyn {

/// How points vote on each other. The vote of a point counts with
/// (1 - q / 8)^4, q = (distance in the image / sigma)^2 + (depth difference / depth_sigma)^2,
/// which is close to a Gaussian and exactly 0 beyond 2.83 sigma.
struct MotionBeliefOptions {
  float sigma = 80.0f;         ///< Reach of a vote within the frame (px).
  float memory_sigma = 24.0f;  ///< Reach of what the frame before believed (px).
  /// Depth reach: depth_sigma(z) = depth_sigma_floor + depth_sigma_quadratic z^2 (m).
  float depth_sigma_floor = 0.03f;
  float depth_sigma_quadratic = 0.02f;  ///< (1/m)

  float still_distance = 0.3f;    ///< A point up to this distance (px) votes 0 ("at rest"), ...
  float moving_distance = 1.0f;   ///< ... from this on 1 ("moving"), in between linearly.
  float dynamic_evidence = 0.5f;  ///< The least that a point of a dynamic cluster votes, 0..1.

  float quiet_weight = 0.3f;     ///< Weight of "at rest" in a box: people pause.
  float inferred_weight = 0.3f;  ///< Weight of a point whose depth is inferred, not measured.
  float dragged_weight = 0.05f;  ///< Weight of a point whose flow a nearer surface may drag along.
  /// Depth at which points beyond the sensor's range vote among themselves (m). A surface that is
  /// measured that deep votes with them.
  float unmeasured_depth = 9.0f;
  float min_weight = 0.2f;  ///< Votes of less weight than this leave a point unjudged.

  float memory_gain = 2.0f;     ///< Weight of the memory against the votes of the frame.
  float memory_decay = 0.9f;    ///< What a frame leaves of the memory's weight, 0..1.
  float weight_cap = 20.0f;     ///< So many full votes make a belief certain.
  float dynamic_belief = 0.6f;  ///< A point believed to move by more than this is dynamic, 0..1.
  /// A belief of less weight than this does not make a point one that is known to be at rest, 0..1.
  float certain_weight = 0.5f;
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const MotionBeliefOptions& options) {
  const auto require = [](bool good, const char* name, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("MotionBeliefOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  const auto positive = [&](const char* name, float value) {
    require(value > 0.0f && std::isfinite(value), name, value, "a finite value > 0");
  };
  const auto share = [&](const char* name, float value) {
    require(value >= 0.0f && value <= 1.0f, name, value, "a value in [0, 1]");
  };
  positive("sigma", options.sigma);
  positive("memory_sigma", options.memory_sigma);
  positive("depth_sigma_floor", options.depth_sigma_floor);
  positive("unmeasured_depth", options.unmeasured_depth);
  positive("min_weight", options.min_weight);
  positive("weight_cap", options.weight_cap);
  require(options.depth_sigma_quadratic >= 0.0f && std::isfinite(options.depth_sigma_quadratic),
          "depth_sigma_quadratic", options.depth_sigma_quadratic, "a finite value >= 0 (1/m)");
  require(options.still_distance >= 0.0f, "still_distance", options.still_distance,
          "a value >= 0 (px)");
  require(
      options.moving_distance > options.still_distance && std::isfinite(options.moving_distance),
      "moving_distance", options.moving_distance, "a finite value above still_distance (px)");
  require(options.memory_gain >= 0.0f && std::isfinite(options.memory_gain), "memory_gain",
          options.memory_gain, "a finite value >= 0");
  share("dynamic_evidence", options.dynamic_evidence);
  share("quiet_weight", options.quiet_weight);
  share("inferred_weight", options.inferred_weight);
  share("dragged_weight", options.dragged_weight);
  share("memory_decay", options.memory_decay);
  share("dynamic_belief", options.dynamic_belief);
  share("certain_weight", options.certain_weight);
}

/// What is believed about N key points; of the frame before, it is the memory for this one. The two
/// frames need not have as many points.
struct MotionBelief {
  std::vector<float> u;       ///< N columns (px); one that is not finite takes no part.
  std::vector<float> v;       ///< N rows (px); the same.
  std::vector<float> depth;   ///< N depths of their surfaces (m); 0 = unknown, takes no part.
  std::vector<float> belief;  ///< N beliefs, 0 = at rest .. 1 = moving; NaN = nothing is known.
  std::vector<float> weight;  ///< N weights, 0 = a guess .. 1 = certain.

  /// N.
  std::size_t size() const noexcept { return u.size(); }
};

/// @throws std::invalid_argument unless the five arrays have one size and beliefs and weights lie
/// in [0, 1] (a belief may be NaN).
inline void checkBelief(const MotionBelief& belief, const char* name) {
  const std::size_t n = belief.size();
  if (belief.v.size() != n || belief.depth.size() != n || belief.belief.size() != n ||
      belief.weight.size() != n) {
    throw std::invalid_argument(std::string(name) + ": u has " + std::to_string(n) +
                                " elements, v " + std::to_string(belief.v.size()) + ", depth " +
                                std::to_string(belief.depth.size()) + ", belief " +
                                std::to_string(belief.belief.size()) + ", weight " +
                                std::to_string(belief.weight.size()) + "; expected equal sizes");
  }
  const auto outside = [](float value) { return value < 0.0f || value > 1.0f; };  // not NaN
  for (std::size_t i = 0; i < n; ++i) {
    if (outside(belief.belief[i]) || !(belief.weight[i] >= 0.0f && belief.weight[i] <= 1.0f)) {
      throw std::invalid_argument(std::string(name) + ": point " + std::to_string(i) +
                                  " has belief " + std::to_string(belief.belief[i]) + ", weight " +
                                  std::to_string(belief.weight[i]) +
                                  "; expected both in [0, 1], or a belief of NaN");
    }
  }
}

/// What a frame's points are judged by. All of one size N, borrowed.
struct MotionBeliefInput {
  KeyPointsView points;             ///< N key points of the frame.
  Span<const float> distance;       ///< Distances (px), NaN = none.
  Span<const PointLabel> label;     ///< Verdicts of the steps before.
  Span<const std::uint8_t> in_box;  ///< 1 in a detection box, whether or not it is dynamic.
  Span<const float> earlier_u;      ///< Columns in the frame of the memory (px); empty = none.
  Span<const float> earlier_v;      ///< Rows there; not finite stands for "where it is now".
  /// 1 for points that are to be judged, 0 for those that somebody else has judged and that vote
  /// only; empty = all are.
  Span<const std::uint8_t> is_open = {};
};

namespace detail {

/// Votes as arrays: a vote of `value` counts with `weight`. Vectors, not arrays of Eigen's: these
/// are freed by another function than they came from where library and user differ in their flags.
struct Votes {
  std::vector<float> u, v, depth, value, weight;  // of at least `count` elements
  std::size_t count = 0;

  void reserve(std::size_t n) {
    if (u.size() < n) {
      u.resize(n);
      v.resize(n);
      depth.resize(n);
      value.resize(n);
      weight.resize(n);
    }
    count = 0;
  }
  void add(float column, float row, float metres, float vote, float vote_weight) {
    u[count] = column;
    v[count] = row;
    depth[count] = metres;
    value[count] = vote * vote_weight;
    weight[count] = vote_weight;
    ++count;
  }
};

struct VoteSum {
  float value = 0.0f;   ///< Sum of weight times vote.
  float weight = 0.0f;  ///< Sum of weights.
};

inline VoteSum countVotes(const Votes& votes, float u, float v, float depth, float sigma,
                          const MotionBeliefOptions& options, std::vector<float>& scratch) {
  if (votes.count == 0) {
    return {};
  }
  const auto n = static_cast<Eigen::Index>(votes.count);
  const auto first = [n](const std::vector<float>& values) {
    return Eigen::Map<const Eigen::ArrayXf>(values.data(), n);
  };
  const float per_pixel = 1.0f / sigma;
  const float per_metre =
      1.0f / (options.depth_sigma_floor + options.depth_sigma_quadratic * depth * depth);
  Eigen::Map<Eigen::ArrayXf> kernel(scratch.data(), n);
  kernel = (1.0f - 0.125f * (((first(votes.u) - u) * per_pixel).square() +
                             ((first(votes.v) - v) * per_pixel).square() +
                             ((first(votes.depth) - depth) * per_metre).square()))
               .max(0.0f);
  kernel = kernel.square().square();
  return {(kernel * first(votes.value)).sum(), (kernel * first(votes.weight)).sum()};
}

/// What a point's own distance says: 0 at rest .. 1 moving.
inline float ownEvidence(float distance, PointLabel label, const MotionBeliefOptions& options) {
  const float ramp =
      (distance - options.still_distance) / (options.moving_distance - options.still_distance);
  const float evidence = std::clamp(ramp, 0.0f, 1.0f);
  return label == PointLabel::kDynamic ? std::max(evidence, options.dynamic_evidence) : evidence;
}

inline float ownWeight(float evidence, SurfaceSupport support, bool is_dragged, bool in_box,
                       const MotionBeliefOptions& options) {
  float weight = in_box ? options.quiet_weight + (1.0f - options.quiet_weight) * evidence : 1.0f;
  if (support == SurfaceSupport::kEnclosed || support == SurfaceSupport::kBehind) {
    weight *= options.inferred_weight;
  }
  return is_dragged ? weight * options.dragged_weight : weight;
}

}  // namespace detail

/// Memory that updateMotionBelief reuses from frame to frame.
struct MotionBeliefWorkspace {
  SurfaceDepths surface;         ///< Of this frame's points; filled by the caller.
  detail::Votes votes;           ///< Of this frame's measured points.
  detail::Votes memory;          ///< All that the frame before believed.
  detail::Votes dynamic_memory;  ///< What it believed to move.
  detail::Votes certain_memory;  ///< What it was certain of.
  std::vector<float> scratch;    ///< Of one count of votes.
};

namespace detail {

/// A vote from no pixel or no depth would reach every point as a NaN.
inline bool isPlaced(float u, float v, float depth) {
  return std::isfinite(u) && std::isfinite(v) && hasDepth(depth);
}

inline void collectVotes(const MotionBeliefInput& input, const MotionBelief& current,
                         const MotionBeliefOptions& options, MotionBeliefWorkspace& workspace) {
  workspace.votes.reserve(input.points.size());
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    if (isPlaced(current.u[i], current.v[i], current.depth[i]) && !std::isnan(input.distance[i])) {
      const float evidence = ownEvidence(input.distance[i], input.label[i], options);
      workspace.votes.add(
          input.points.u[i], input.points.v[i], current.depth[i], evidence,
          ownWeight(evidence, workspace.surface.support[i], workspace.surface.is_dragged[i] != 0,
                    input.in_box[i] != 0, options));
    }
  }
}

inline void collectMemory(const MotionBelief& memory, const MotionBeliefOptions& options,
                          MotionBeliefWorkspace& workspace) {
  workspace.memory.reserve(memory.size());
  workspace.dynamic_memory.reserve(memory.size());
  workspace.certain_memory.reserve(memory.size());
  for (std::size_t k = 0; k < memory.size(); ++k) {
    if (isPlaced(memory.u[k], memory.v[k], memory.depth[k]) && memory.weight[k] > 0.0f &&
        !std::isnan(memory.belief[k])) {
      workspace.memory.add(memory.u[k], memory.v[k], memory.depth[k], memory.belief[k],
                           memory.weight[k]);
      if (memory.belief[k] > options.dynamic_belief) {
        workspace.dynamic_memory.add(memory.u[k], memory.v[k], memory.depth[k], memory.belief[k],
                                     memory.weight[k]);
      }
      if (memory.weight[k] >= options.certain_weight) {
        workspace.certain_memory.add(memory.u[k], memory.v[k], memory.depth[k], memory.belief[k],
                                     memory.weight[k]);
      }
    }
  }
}

inline void makeRoom(std::size_t votes, MotionBeliefWorkspace& workspace) {
  if (workspace.scratch.size() < votes) {
    workspace.scratch.resize(votes);
  }
}

/// Belief and weight of one point: the votes around it now, and around where it was before.
inline std::pair<float, float> judge(const MotionBeliefInput& input, std::size_t i, float depth,
                                     const MotionBeliefOptions& options,
                                     MotionBeliefWorkspace& workspace) {
  const float u = input.points.u[i];
  const float v = input.points.v[i];
  const bool has_earlier = !input.earlier_u.empty() && std::isfinite(input.earlier_u[i]) &&
                           std::isfinite(input.earlier_v[i]);
  const float earlier_u = has_earlier ? input.earlier_u[i] : u;
  const float earlier_v = has_earlier ? input.earlier_v[i] : v;
  const auto count = [&](const Votes& votes, float column, float row, float sigma) {
    return countVotes(votes, column, row, depth, sigma, options, workspace.scratch);
  };
  const bool concerned =
      input.in_box[i] != 0 ||
      count(workspace.dynamic_memory, earlier_u, earlier_v, options.memory_sigma).weight > 0.0f;
  if (!concerned) {  // outside every box, and nothing moved here: static, as the paper has it
    return {0.0f, options.memory_decay};
  }
  VoteSum sum = count(workspace.votes, u, v, options.sigma);
  const VoteSum memory = count(workspace.memory, earlier_u, earlier_v, options.memory_sigma);
  if (memory.weight > 0.0f) {
    const float gain = options.memory_gain * std::min(1.0f, options.weight_cap / memory.weight);
    sum.value += gain * memory.value;
    sum.weight += gain * memory.weight;
  }
  if (sum.weight < options.min_weight) {
    return {kNaN, 0.0f};
  }
  return {sum.value / sum.weight,
          options.memory_decay * std::min(1.0f, sum.weight / options.weight_cap)};
}

inline void checkInput(const MotionBeliefInput& input) {
  checkKeyPoints(input.points);
  const std::size_t n = input.points.size();
  const bool earlier_fits = (input.earlier_u.empty() && input.earlier_v.empty()) ||
                            (input.earlier_u.size() == n && input.earlier_v.size() == n);
  if (input.distance.size() != n || input.label.size() != n || input.in_box.size() != n ||
      !earlier_fits) {
    throw std::invalid_argument("updateMotionBelief: " + std::to_string(n) + " key points, but " +
                                std::to_string(input.distance.size()) + " distances, " +
                                std::to_string(input.label.size()) + " labels, " +
                                std::to_string(input.in_box.size()) + " flags, " +
                                std::to_string(input.earlier_u.size()) + " earlier columns, " +
                                std::to_string(input.earlier_v.size()) +
                                " rows; expected equal sizes (no earlier pixels: 0)");
  }
  if (!input.is_open.empty() && input.is_open.size() != n) {
    throw std::invalid_argument(
        "updateMotionBelief: is_open has " + std::to_string(input.is_open.size()) +
        " elements; expected one for each of the " + std::to_string(n) + " key points, or none");
  }
}

}  // namespace detail

/// Lets the points of a frame vote on each other. A single distance errs where it matters most: at
/// a silhouette, optical flow drags the background along; an arm at rest on a moving body looks
/// static; whoever pauses looks static altogether. So each point in a box listens to its
/// neighbours in the image *and* in depth (a bilateral vote, after Tomasi and Manduchi 1998), and
/// to what the frame before believed where it was then (as Detect-SLAM propagates the moving
/// probability of key points; Zhong et al. 2018).
///
/// Points outside every box and far from all that was believed to move are at rest. What was
/// believed to move stays so outside the boxes, too: detectors miss people.
///
/// A point whose pixel is not finite neither votes nor is judged. One that is not open
/// (MotionBeliefInput::is_open) is not judged either: its belief is NaN, its weight 0.
///
/// @param memory of the frame before, of any number of points; empty at the start.
/// @param workspace its `surface` must be surfaceDepths() of these points.
/// @return N beliefs: this frame's result, and the next one's memory.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline MotionBelief updateMotionBelief(const MotionBeliefInput& input, const MotionBelief& memory,
                                       const MotionBeliefOptions& options,
                                       MotionBeliefWorkspace& workspace) {
  checkOptions(options);
  detail::checkInput(input);
  checkBelief(memory, "updateMotionBelief: memory");
  const std::size_t n = input.points.size();
  const SurfaceDepths& surface = workspace.surface;
  if (surface.depth.size() != n || surface.support.size() != n || surface.is_dragged.size() != n) {
    throw std::invalid_argument("updateMotionBelief: workspace.surface has " +
                                std::to_string(surface.depth.size()) +
                                " points; expected surfaceDepths() of these " + std::to_string(n));
  }
  MotionBelief current;
  current.u.assign(input.points.u.begin(), input.points.u.end());
  current.v.assign(input.points.v.begin(), input.points.v.end());
  current.depth = workspace.surface.depth;
  for (std::size_t i = 0; i < n; ++i) {
    if (workspace.surface.support[i] == SurfaceSupport::kNone) {
      current.depth[i] = options.unmeasured_depth;
    }
  }
  detail::collectVotes(input, current, options, workspace);
  detail::collectMemory(memory, options, workspace);
  detail::makeRoom(std::max(n, memory.size()), workspace);
  current.belief.assign(n, kNaN);
  current.weight.assign(n, 0.0f);
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_open = input.is_open.empty() || input.is_open[i] != 0;
    if (is_open && detail::isPlaced(current.u[i], current.v[i], current.depth[i])) {
      std::tie(current.belief[i], current.weight[i]) =
          detail::judge(input, i, current.depth[i], options, workspace);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {  // at an edge a memory would be passed to the wrong side
    current.weight[i] = workspace.surface.is_dragged[i] != 0 ? 0.0f : current.weight[i];
  }
  return current;
}

/// What the frame before knows of N points by where they were then, for the choice of matches that
/// speak for the camera's motion. What appears has no past: a person who steps out from behind
/// another one is unknown until a frame has judged it with some certainty.
///
/// @param depth N depths of their surfaces (m). @param earlier_u, earlier_v N pixels in the frame
/// of the memory; not finite = no match, and nothing is known.
/// @return N verdicts: moving where the neighbours' mean belief is above dynamic_belief; else at
/// rest where one of them has at least certain_weight.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline std::vector<KnownMotion> knownMotion(Span<const float> depth, Span<const float> earlier_u,
                                            Span<const float> earlier_v, const MotionBelief& memory,
                                            const MotionBeliefOptions& options,
                                            MotionBeliefWorkspace& workspace) {
  checkOptions(options);
  checkBelief(memory, "knownMotion: memory");
  const std::size_t n = depth.size();
  if (earlier_u.size() != n || earlier_v.size() != n) {
    throw std::invalid_argument("knownMotion: " + std::to_string(n) + " depths, but " +
                                std::to_string(earlier_u.size()) + " columns and " +
                                std::to_string(earlier_v.size()) + " rows; expected equal sizes");
  }
  detail::collectMemory(memory, options, workspace);
  detail::makeRoom(memory.size(), workspace);
  std::vector<KnownMotion> known(n, KnownMotion::kUnknown);
  for (std::size_t i = 0; i < n; ++i) {
    if (!detail::isPlaced(earlier_u[i], earlier_v[i], depth[i])) {
      continue;
    }
    const auto count = [&](const detail::Votes& votes) {
      return detail::countVotes(votes, earlier_u[i], earlier_v[i], depth[i], options.memory_sigma,
                                options, workspace.scratch);
    };
    const detail::VoteSum sum = count(workspace.memory);
    if (sum.weight > 0.0f && sum.value > options.dynamic_belief * sum.weight) {
      known[i] = KnownMotion::kMoving;
    } else if (count(workspace.certain_memory).weight > 0.0f) {
      known[i] = KnownMotion::kAtRest;
    }
  }
  return known;
}

}  // namespace hmcdyn
