// SPDX-License-Identifier: BSD-3-Clause
#include "mask/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mask/departure.hpp"
#include "mask/named.hpp"
#include "mask/surface_tolerance.hpp"

namespace hmcdyn::internal {
namespace {

constexpr float kFarWeight = 0.5f;           // of "static" beyond max_depth
constexpr std::size_t kFewestToDoubt = 200;  // surfaces, before their agreement means anything
constexpr float kMismatchOfMoving = 0.3f;    // share of a moving surface, where it has texture
// Ages (s) between which a thing moves by more than its edges flicker, and is still near its place.
constexpr double kYoungestDeparture = 0.06;
constexpr double kOldestDeparture = 0.5;

struct Tally {
  std::size_t same = 0;
  std::size_t compared = 0;
  std::size_t mismatch = 0;  ///< Same surfaces with another gray level.
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

/// The rays of the columns, and room for a row.
RowPlaces prepared(RowPlaces reuse, int width, const SmallCamera& camera) {
  RowPlaces places = std::move(reuse);
  const auto columns = static_cast<std::size_t>(width);
  places.ray.resize(columns);
  places.depth.resize(columns);
  places.pixel.resize(columns);
  for (std::size_t x = 0; x < columns; ++x) {
    places.ray[x] = (static_cast<float>(x) - camera.cx) / camera.fx;
  }
  return places;
}

class Comparer {
 public:
  Comparer(const SmallFrame& frame, const SmallCamera& camera,
           const std::vector<std::uint8_t>& named, const MaskModel& model)
      : frame_(frame), camera_(camera), named_(named), model_(model) {}

  Tally run(const Comparison& with, EvidenceImage& image) const {
    Tally tally;
    for (int y = 0; y < frame_.height; ++y) {
      place(y, with.motion, image.places);
      const Tally of_row = row(y, with, image);
      tally.same += of_row.same;
      tally.compared += of_row.compared;
      tally.mismatch += of_row.mismatch;
    }
    return tally;
  }

 private:
  /// Pixels nearer than max_depth that the earlier frame saw: placeOnRay() with one division.
  void place(int y, const RelativePose& motion, RowPlaces& places) const {
    const auto r = motion.rotation;
    const auto t = motion.translation;
    const SmallCamera camera = camera_;
    const float ray_y = (static_cast<float>(y) - camera.cy) / camera.fy;
    const int width = frame_.width;
    const int height = frame_.height;
    const float max_depth = model_.options.max_depth;
    const float* depth = frame_.depth.data() + frame_.index(y, 0);
    const float* rays = places.ray.data();
    float* to_depth = places.depth.data();
    std::int32_t* to_pixel = places.pixel.data();
    for (int x = 0; x < width; ++x) {
      const float z = depth[x];
      const float ray_x = rays[x];
      const float there = (r[6] * ray_x + r[7] * ray_y + r[8]) * z + t[2];
      const float inverse = 1.0f / there;
      const float u = camera.fx * ((r[0] * ray_x + r[1] * ray_y + r[2]) * z + t[0]) * inverse +
                      camera.cx + 0.5f;
      const float v = camera.fy * ((r[3] * ray_x + r[4] * ray_y + r[5]) * z + t[1]) * inverse +
                      camera.cy + 0.5f;
      const bool has_place = allOf(z > 0.0f, z <= max_depth, there >= kNearestPlace);
      to_depth[x] = there;
      to_pixel[x] = pixelAround(u, v, has_place, width, height);
    }
  }

  Tally row(int y, const Comparison& with, EvidenceImage& image) const {
    const float max_depth = model_.options.max_depth;
    const std::size_t start = frame_.index(y, 0);
    Tally tally;
    for (std::size_t x = 0; x < image.places.pixel.size(); ++x) {
      const std::size_t i = start + x;
      const std::int32_t pixel = image.places.pixel[x];
      if (pixel >= 0) {
        judge(i, image.places.depth[x], with.earlier->cells[static_cast<std::size_t>(pixel)], with,
              image, tally);
      } else if (frame_.depth[i] > max_depth) {
        // not judged; but what is that far does not belong to the thing before it
        image.evidence[i] = {-kFarWeight, kFarWeight};
      }
    }
    return tally;
  }

  void judge(std::size_t i, float there, const MaskCell& cell, const Comparison& with,
             EvidenceImage& image, Tally& tally) const {
    if (!(cell.farthest > 0.0f)) {
      return;
    }
    const EvidenceModel& o = model_.evidence;
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
      ++tally.mismatch;
      return;  // what it says is known once all are counted: addMismatches()
    }
    comparisons.same = static_cast<std::uint8_t>(comparisons.same | with.bit);
    const bool is_named = !named_.empty() && named_[i] == kNamed;
    const float weight =
        with.same_weight * (named_.empty() ? weightByEdges(cell, tolerance) : 1.0f);
    evidence.value += weight * std::max(-1.0f, cell.belief - (is_named ? o.named_drift : o.drift));
    evidence.weight += weight;
  }

  /// A surface without an edge looks the same when it has moved along itself. Where boxes or masks
  /// name what may move, it is of the room all the same.
  float weightByEdges(const MaskCell& cell, float tolerance) const {
    const float plain = model_.evidence.plain_weight;
    const float depth_edge = (cell.farthest - cell.nearest) / tolerance;
    const float gray_edge =
        frame_.gray.empty()
            ? 0.0f
            : static_cast<float>(cell.brightest - cell.darkest) / model_.evidence.edge_gray;
    const float edge = std::clamp(std::max(depth_edge, gray_edge), 0.0f, 1.0f);
    return plain + (1.0f - plain) * edge;
  }

  bool differsInGray(std::size_t i, const MaskCell& cell) const {
    const float tolerance = model_.options.gray_tolerance;
    const float gray = frame_.gray[i];
    return gray > static_cast<float>(cell.brightest) + tolerance ||
           gray < static_cast<float>(cell.darkest) - tolerance;
  }

  const SmallFrame& frame_;
  const SmallCamera& camera_;
  const std::vector<std::uint8_t>& named_;
  const MaskModel& model_;
};

/// Gray levels say nothing where the whole image has become brighter or darker: a lamp, the
/// exposure or a black frame.
bool areComparable(const SmallFrame& frame, const SmallFrame& earlier, float tolerance) {
  return !frame.gray.empty() && !earlier.gray.empty() &&
         std::abs(frame.brightness - earlier.brightness) <= tolerance;
}

/// A surface with another gray level moves, or the images differ there for reasons of their own:
/// light, exposure, blur, a pose that is not exact. How often they do is seen on all surfaces,
/// since those believed to be the room would be the ones without a mismatch; the weight is the
/// logarithm of the likelihood ratio. Where boxes or masks say what may move, gray levels say
/// little.
float mismatchWeight(const Tally& tally, bool is_named, const EvidenceModel& model) {
  if (is_named) {
    return model.named_mismatch_weight;
  }
  if (tally.same < kFewestToDoubt) {
    return 0.0f;
  }
  const float share = static_cast<float>(tally.mismatch + 1) / static_cast<float>(tally.same);
  return std::clamp(model.mismatch_weight * std::log(kMismatchOfMoving / share), 0.0f, 1.0f);
}

void addMismatches(float weight, std::uint8_t bit, EvidenceImage& image) {
  for (std::size_t i = 0; i < image.evidence.size(); ++i) {
    const float added = (image.comparisons[i].mismatch & bit) != 0 ? weight : 0.0f;
    image.evidence[i].value += added;
    image.evidence[i].weight += added;
  }
}

}  // namespace

EvidenceImage compareWithEarlier(const SmallFrame& frame, const SmallCamera& camera,
                                 const std::vector<const SmallFrame*>& earlier,
                                 const std::vector<std::uint8_t>& named, const MaskModel& model,
                                 EvidenceImage reuse) {
  EvidenceImage image = std::move(reuse);
  image.evidence.assign(frame.size(), {});
  image.comparisons.assign(frame.size(), {});
  image.agreement = 1.0f;
  image.fresh = 0;
  image.proof = 0;
  const EvidenceModel& o = model.evidence;
  image.places = prepared(std::move(image.places), frame.width, camera);
  const Comparer comparer(frame, camera, named, model);
  // Departures go by it: in the older frames of a crowd so many surfaces are others that the noise
  // measured there is too large to see who left.
  SurfaceTolerance youngest;
  std::uint8_t bit = 1;
  for (const SmallFrame* other : earlier) {
    const double age = frame.timestamp - other->timestamp;
    const float grown = std::min(1.0f, static_cast<float>(age) / o.same_age);
    const RelativePose motion = relativePose(other->camera_from_world, frame.camera_from_world);
    const SurfaceTolerance tolerance =
        surfaceTolerance(model, measuredNoise(frame, *other, camera, motion, model, image.errors));
    youngest = bit == 1 ? tolerance : youngest;
    const Tally tally = comparer.run(
        {other, motion, bit, o.same_weight_young + (1.0f - o.same_weight_young) * grown, tolerance,
         areComparable(frame, *other, model.options.gray_tolerance)},
        image);
    addMismatches(mismatchWeight(tally, !named.empty(), o), bit, image);
    if (o.departure_weight > 0.0f && age >= kYoungestDeparture && age <= kOldestDeparture) {
      addDepartures(frame, camera, *other, bit, youngest, model, image);
    }
    if (bit == 1 && tally.compared >= kFewestToDoubt) {
      image.agreement = static_cast<float>(tally.same) / static_cast<float>(tally.compared);
    }
    if (age <= model.segment.fresh_age + 0.01 || bit == 1) {
      image.fresh = static_cast<std::uint8_t>(image.fresh | bit);
    }
    if (age >= model.segment.proof_age) {
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
