// SPDX-License-Identifier: BSD-3-Clause
#include "evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "departure.hpp"
#include "named.hpp"

namespace hmcdyn::internal {
namespace {

constexpr float kNearestOfAll = 0.1f;        // (m): no depth camera measures nearer
constexpr float kFarWeight = 0.5f;           // of "static" beyond max_depth
constexpr std::size_t kFewestToDoubt = 200;  // surfaces, before their agreement means anything
// Ages (s) between which a thing moves by more than its edges flicker, and is still near its place.
constexpr double kYoungestDeparture = 0.06;
constexpr double kOldestDeparture = 0.5;

struct Tally {
  std::size_t same = 0;
  std::size_t compared = 0;
};

/// What stays the same between the pixels of one comparison.
struct Comparison {
  const SmallFrame* earlier = nullptr;
  RelativePose motion{};
  std::uint8_t bit = 0;
  float same_weight = 0.0f;
  SurfaceTolerance tolerance;
  bool by_gray = false;
};

class Comparer {
 public:
  Comparer(const SmallFrame& frame, const SmallCamera& camera,
           const std::vector<std::uint8_t>& named, const MotionMaskOptions& options)
      : frame_(frame), camera_(camera), named_(named), options_(options) {}

  Tally run(const Comparison& with, EvidenceImage& image) const {
    Tally tally;
    for (int y = 0; y < frame_.height; ++y) {
      row(y, with, image, tally);
    }
    return tally;
  }

 private:
  void row(int y, const Comparison& with, EvidenceImage& image, Tally& tally) const {
    const auto& r = with.motion.rotation;
    const auto& t = with.motion.translation;
    const float ray_y = (static_cast<float>(y) - camera_.cy) / camera_.fy;
    const float columns = static_cast<float>(frame_.width);
    const float rows = static_cast<float>(frame_.height);
    const float max_depth = options_.depth.max_depth;
    const auto start = static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.width);
    for (int x = 0; x < frame_.width; ++x) {
      const std::size_t i = start + static_cast<std::size_t>(x);
      const float z = frame_.depth[i];
      if (!(z > 0.0f)) {
        continue;
      }
      if (z > max_depth) {
        // not judged; but what is that far does not belong to the thing before it
        image.evidence[i] = {-kFarWeight, kFarWeight};
        continue;
      }
      const float ray_x = (static_cast<float>(x) - camera_.cx) / camera_.fx;
      const float there = (r[6] * ray_x + r[7] * ray_y + r[8]) * z + t[2];
      if (there < kNearestOfAll) {
        continue;
      }
      const float inverse = 1.0f / there;
      const float u = camera_.fx * ((r[0] * ray_x + r[1] * ray_y + r[2]) * z + t[0]) * inverse +
                      camera_.cx + 0.5f;
      const float v = camera_.fy * ((r[3] * ray_x + r[4] * ray_y + r[5]) * z + t[1]) * inverse +
                      camera_.cy + 0.5f;
      if (!(u >= 0.0f && v >= 0.0f && u < columns && v < rows)) {
        continue;
      }
      const MaskCell& cell =
          with.earlier->cells[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame_.width) +
                              static_cast<std::size_t>(u)];
      judge(i, there, cell, with, image, tally);
    }
  }

  void judge(std::size_t i, float there, const MaskCell& cell, const Comparison& with,
             EvidenceImage& image, Tally& tally) const {
    if (!(cell.farthest > 0.0f)) {
      return;
    }
    const MaskEvidenceOptions& o = options_.evidence;
    const float tolerance = with.tolerance.at(there);
    Evidence& evidence = image.evidence[i];
    Comparisons& comparisons = image.comparisons[i];
    if (cell.nearest > there + tolerance) {
      if (cell.nearest < kNoNearest) {
        comparisons.free = static_cast<std::uint8_t>(comparisons.free | with.bit);
        evidence.value += o.free_weight;
        evidence.weight += o.free_weight;
        ++tally.compared;
      }
      return;
    }
    if (cell.farthest < there - tolerance) {
      ++tally.compared;
      return;  // hidden then
    }
    ++tally.compared;
    ++tally.same;
    if (with.by_gray && differsInGray(i, cell)) {
      comparisons.mismatch = static_cast<std::uint8_t>(comparisons.mismatch | with.bit);
      evidence.value += o.mismatch_weight;
      evidence.weight += o.mismatch_weight;
      return;
    }
    comparisons.same = static_cast<std::uint8_t>(comparisons.same | with.bit);
    const float drift = !named_.empty() && named_[i] == kNamed ? o.named_drift : o.drift;
    evidence.value += with.same_weight * std::max(-1.0f, cell.belief - drift);
    evidence.weight += with.same_weight;
  }

  bool differsInGray(std::size_t i, const MaskCell& cell) const {
    const float tolerance = options_.depth.gray_tolerance;
    const float gray = frame_.gray[i];
    return gray > static_cast<float>(cell.brightest) + tolerance ||
           gray < static_cast<float>(cell.darkest) - tolerance;
  }

  const SmallFrame& frame_;
  const SmallCamera& camera_;
  const std::vector<std::uint8_t>& named_;
  const MotionMaskOptions& options_;
};

/// Gray levels say nothing where the whole image has become brighter or darker: a lamp, the
/// exposure or a black frame.
bool areComparable(const SmallFrame& frame, const SmallFrame& earlier, float tolerance) {
  return !frame.gray.empty() && !earlier.gray.empty() &&
         std::abs(frame.brightness - earlier.brightness) <= tolerance;
}

}  // namespace

SurfaceTolerance surfaceTolerance(const MaskDepthOptions& options) {
  const float sigmas = options.gate * std::sqrt(2.0f);  // both depths are noisy
  const DepthErrorModel& error = options.error;
  return {options.slack + sigmas * error.noise_floor, error.systematic_linear,
          sigmas * error.noise_quadratic + error.systematic_quadratic};
}

EvidenceImage compareWithEarlier(const SmallFrame& frame, const SmallCamera& camera,
                                 const std::vector<const SmallFrame*>& earlier,
                                 const std::vector<std::uint8_t>& named,
                                 const MotionMaskOptions& options, EvidenceImage reuse) {
  EvidenceImage image = std::move(reuse);
  image.evidence.assign(frame.size(), {});
  image.comparisons.assign(frame.size(), {});
  image.agreement = 1.0f;
  image.fresh = 0;
  image.proof = 0;
  const MaskEvidenceOptions& o = options.evidence;
  const Comparer comparer(frame, camera, named, options);
  const SurfaceTolerance tolerance = surfaceTolerance(options.depth);
  std::uint8_t bit = 1;
  for (const SmallFrame* other : earlier) {
    const double age = frame.timestamp - other->timestamp;
    const float grown = std::min(1.0f, static_cast<float>(age) / o.same_age);
    const Tally tally =
        comparer.run({other, relativePose(other->camera_from_world, frame.camera_from_world), bit,
                      o.same_weight_young + (1.0f - o.same_weight_young) * grown, tolerance,
                      areComparable(frame, *other, options.depth.gray_tolerance)},
                     image);
    if (o.departure_weight > 0.0f && age >= kYoungestDeparture && age <= kOldestDeparture) {
      addDepartures(frame, camera, *other, bit, options, image);
    }
    if (bit == 1 && tally.compared >= kFewestToDoubt) {
      image.agreement = static_cast<float>(tally.same) / static_cast<float>(tally.compared);
    }
    if (age <= options.segment.fresh_age + 0.01 || bit == 1) {
      image.fresh = static_cast<std::uint8_t>(image.fresh | bit);
    }
    if (age >= options.segment.proof_age) {
      image.proof = static_cast<std::uint8_t>(image.proof | bit);
    }
    bit = static_cast<std::uint8_t>(bit << 1);
  }
  return image;
}

void addPoints(const MotionMaskFrame& frame, int reduction, const SmallFrame& small, float weight,
               std::vector<Evidence>& evidence) {
  const float scale = 1.0f / static_cast<float>(reduction);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const float u = (frame.points.u[i] + 0.5f) * scale;
    const float v = (frame.points.v[i] + 0.5f) * scale;
    if (frame.verdicts[i] != PointLabel::kDynamic ||
        !(u >= 0.0f && v >= 0.0f && u < static_cast<float>(small.width) &&
          v < static_cast<float>(small.height))) {
      continue;
    }
    Evidence& at = evidence[static_cast<std::size_t>(v) * static_cast<std::size_t>(small.width) +
                            static_cast<std::size_t>(u)];
    at.value += weight;
    at.weight += weight;
  }
}

}  // namespace hmcdyn::internal
