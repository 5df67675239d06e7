// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include <hmcdyn/steps/box_carrier.hpp>

namespace hmcdyn {
namespace {

/// Boxes are followed on images of half the size: their flow needs no more.
constexpr float kFlowScale = 0.5f;

constexpr double kMaxCarry = 2.0;     ///< (s) Without a newer detection a box ends.
constexpr float kMinFollowed = 0.4f;  ///< Fewer of the thing's points followed, and it ends.
/// Median deviation of the points from the box's motion, as a share of its diagonal: limbs swing by
/// as much as their owner is large in the image. At least so many pixels.
constexpr float kMaxScatter = 0.02f;
constexpr float kLeastScatter = 5.0f;
constexpr float kDepthBand = 0.5f;       ///< The thing's points lie within its depth +- this (m).
constexpr float kDepthGap = 0.25f;       ///< Depths farther apart are of different layers (m).
constexpr float kMinLayerShare = 0.2f;   ///< A layer with fewer of a box's points is not the thing.
constexpr float kAssociationIou = 0.3f;  ///< Least overlap of a carried box with the detected one.
constexpr float kDuplicateSize = 0.5f;   ///< Ratio of areas above which two boxes may be doubles.
/// A missed box of which more lies in a detected one of its class is not bridged.
constexpr float kMaxCovered = 0.5f;
constexpr float kMinVisible = 0.3f;  ///< A box of which less is in the image has left it.

void requireOption(bool good, const char* option, double value, const char* expected) {
  if (!good) {
    throw std::invalid_argument(std::string(option) + " is " + std::to_string(value) +
                                "; expected " + expected);
  }
}

void checkCarrier(const BoxCarrierOptions& o) {
  requireOption(o.max_bridge >= 0.0 && std::isfinite(o.max_bridge), "BoxCarrierOptions::max_bridge",
                o.max_bridge, "0 s or more");
  requireOption(o.history >= 0.0, "BoxCarrierOptions::history", o.history, "0 s or more");
  requireOption(o.min_detections >= 1, "BoxCarrierOptions::min_detections", o.min_detections,
                "1 or more");
  requireOption(o.grid >= 3 && o.grid <= 100, "BoxCarrierOptions::grid", o.grid, "3..100");
  requireOption(o.min_points >= 2, "BoxCarrierOptions::min_points",
                static_cast<double>(o.min_points), "2 or more");
}

float areaOf(const DetectionBox& box) {
  return std::max(0.0f, box.x_max - box.x_min) * std::max(0.0f, box.y_max - box.y_min);
}

float intersectionOf(const DetectionBox& a, const DetectionBox& b) {
  const float width = std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min);
  const float height = std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min);
  return width > 0.0f && height > 0.0f ? width * height : 0.0f;
}

bool areDoubles(const DetectionBox& a, const DetectionBox& b, const BoxCarrierOptions& options) {
  const float smaller = std::min(areaOf(a), areaOf(b));
  const float larger = std::max(areaOf(a), areaOf(b));
  return a.class_id == b.class_id && smaller > 0.0f &&
         intersectionOf(a, b) > options.duplicate_overlap * smaller &&
         smaller > kDuplicateSize * larger;
}

/// Whether a missed box is one that was detected after all, drawn differently: most of it lies in
/// the detected one. (So does somebody who is hidden behind it, of whom there is little to see.)
bool isPartOf(const DetectionBox& missed, const DetectionBox& detected,
              const BoxCarrierOptions& options) {
  return missed.class_id == detected.class_id &&
         (areDoubles(missed, detected, options) ||
          intersectionOf(missed, detected) > kMaxCovered * areaOf(missed));
}

/// The values are taken by copy: they are reordered. Not for an empty one.
float medianOf(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Depth (m) of the nearest layer that holds enough of the values; NaN without one. A person
/// stands before the background that the box holds as well.
float nearestLayer(std::vector<float> depth) {
  std::sort(depth.begin(), depth.end());
  const float least = kMinLayerShare * static_cast<float>(depth.size());
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= depth.size(); ++i) {
    if (i < depth.size() && depth[i] - depth[i - 1] <= kDepthGap) {
      continue;
    }
    if (static_cast<float>(i - begin) >= least) {
      return depth[begin + (i - begin) / 2];
    }
    begin = i;
  }
  return kNaN;
}

/// A regular grid of pixels in the part of the box that is in the image, with their depths.
KeyPoints gridIn(const DetectionBox& box, cv::Size image, const cv::Mat& depth, int side) {
  KeyPoints points;
  points.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto share = [side](int i) {
        return (static_cast<float>(i) + 0.5f) / static_cast<float>(side);
      };
      const float u = box.x_min + share(column) * (box.x_max - box.x_min);
      const float v = box.y_min + share(row) * (box.y_max - box.y_min);
      if (!(u >= 0.0f && v >= 0.0f && u <= static_cast<float>(image.width - 1) &&
            v <= static_cast<float>(image.height - 1))) {
        continue;
      }
      const float z =
          depth.empty() ? 0.0f : depth.at<float>(static_cast<int>(v), static_cast<int>(u));
      points.push_back(u, v, z);
    }
  }
  return points;
}

/// The grid's points that lie on the thing: in its depth layer; without depth, in the middle third
/// of the box's width, where a standing person covers most.
KeyPoints pointsOnThing(const KeyPoints& grid, const DetectionBox& box, float thing_depth) {
  KeyPoints points;
  const float middle = 0.5f * (box.x_min + box.x_max);
  const float reach = (box.x_max - box.x_min) / 6.0f;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool on_thing = std::isfinite(thing_depth)
                              ? std::abs(grid.depth[i] - thing_depth) <= kDepthBand
                              : std::abs(grid.u[i] - middle) <= reach;
    if (on_thing) {
      points.push_back(grid.u[i] * kFlowScale, grid.v[i] * kFlowScale, grid.depth[i]);
    }
  }
  return points;
}

/// How a box moves: scaled about its middle, then shifted.
struct BoxMotion {
  float du = 0.0f;
  float dv = 0.0f;
  float scale = 1.0f;
};

/// Medians of the points' shifts and of the ratios of their distances; nothing where the points do
/// not move as one. @param box that they are in.
std::optional<BoxMotion> medianMotion(const DetectionBox& box, const KeyPoints& from,
                                      const FlowMatches& to, const BoxCarrierOptions& options) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (std::isfinite(to.u[i])) {
      found.push_back(i);
    }
  }
  const float least = kMinFollowed * static_cast<float>(from.size());
  if (found.size() < options.min_points || static_cast<float>(found.size()) < least) {
    return std::nullopt;
  }
  std::vector<float> du;
  std::vector<float> dv;
  std::vector<float> ratio;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::size_t i = found[k];
    du.push_back((to.u[i] - from.u[i]) / kFlowScale);
    dv.push_back((to.v[i] - from.v[i]) / kFlowScale);
    for (std::size_t m = 0; m < k; ++m) {
      const std::size_t j = found[m];
      const float before = std::hypot(from.u[i] - from.u[j], from.v[i] - from.v[j]);
      ratio.push_back(std::hypot(to.u[i] - to.u[j], to.v[i] - to.v[j]) / before);
    }
  }
  BoxMotion motion{medianOf(du), medianOf(dv), medianOf(ratio)};
  std::vector<float> deviation;
  for (std::size_t k = 0; k < du.size(); ++k) {
    deviation.push_back(std::hypot(du[k] - motion.du, dv[k] - motion.dv));
  }
  const float diagonal = std::hypot(box.x_max - box.x_min, box.y_max - box.y_min);
  if (medianOf(deviation) > std::max(kLeastScatter, kMaxScatter * diagonal)) {
    return std::nullopt;
  }
  motion.scale = std::clamp(motion.scale, 0.9f, 1.1f);  // a person's size changes slowly
  return motion;
}

DetectionBox moved(const DetectionBox& box, const BoxMotion& motion) {
  DetectionBox result = box;
  const float u = 0.5f * (box.x_min + box.x_max) + motion.du;
  const float v = 0.5f * (box.y_min + box.y_max) + motion.dv;
  const float half_width = 0.5f * motion.scale * (box.x_max - box.x_min);
  const float half_height = 0.5f * motion.scale * (box.y_max - box.y_min);
  result.x_min = u - half_width;
  result.x_max = u + half_width;
  result.y_min = v - half_height;
  result.y_max = v + half_height;
  return result;
}

float visibleShare(const DetectionBox& box, cv::Size size) {
  DetectionBox image;
  image.x_max = static_cast<float>(size.width - 1);
  image.y_max = static_cast<float>(size.height - 1);
  const float area = areaOf(box);
  return area > 0.0f ? intersectionOf(box, image) / area : 0.0f;
}

}  // namespace

float intersectionOverUnion(const DetectionBox& a, const DetectionBox& b) {
  const float intersection = intersectionOf(a, b);
  return intersection > 0.0f ? intersection / (areaOf(a) + areaOf(b) - intersection) : 0.0f;
}

std::vector<DetectionBox> mergeDoubles(const std::vector<DetectionBox>& boxes,
                                       const BoxCarrierOptions& options) {
  const auto isStronger = [](const DetectionBox& a, const DetectionBox& b) {
    return a.score != b.score ? a.score > b.score : areaOf(a) > areaOf(b);
  };
  std::vector<DetectionBox> kept;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    bool stays = true;
    for (std::size_t j = 0; j < boxes.size() && stays; ++j) {
      const bool equal = !isStronger(boxes[i], boxes[j]) && !isStronger(boxes[j], boxes[i]);
      const bool yields = isStronger(boxes[j], boxes[i]) || (equal && j < i);
      stays = i == j || !yields || !areDoubles(boxes[i], boxes[j], options);
    }
    if (stays) {
      kept.push_back(boxes[i]);
    }
  }
  return kept;
}

std::vector<DetectionBox> clipToImage(const std::vector<DetectionBox>& boxes, cv::Size image) {
  const auto right = static_cast<float>(image.width - 1);
  const auto bottom = static_cast<float>(image.height - 1);
  std::vector<DetectionBox> clipped;
  for (DetectionBox box : boxes) {
    const bool inverted = box.x_max < box.x_min || box.y_max < box.y_min;
    const bool outside =
        box.x_max < 0.0f || box.y_max < 0.0f || box.x_min > right || box.y_min > bottom;
    if (!inverted && outside) {
      continue;
    }
    if (!inverted) {
      box.x_min = std::max(box.x_min, 0.0f);
      box.y_min = std::max(box.y_min, 0.0f);
      box.x_max = std::min(box.x_max, right);
      box.y_max = std::min(box.y_max, bottom);
    }
    clipped.push_back(box);
  }
  return clipped;
}

void BoxCarrier::reset() noexcept {
  history_.clear();
  tracks_.clear();
  bridged_ = 0;
}

BoxCarrier::BoxCarrier(const BoxCarrierOptions& options) : options_(options) {
  checkCarrier(options_);
}

void BoxCarrier::remember(const CarriedFrame& frame) {
  if (!history_.empty() &&
      (history_.back().size != frame.gray.size() || frame.timestamp <= history_.back().timestamp)) {
    history_.clear();
    tracks_.clear();
  }
  cv::Mat half;
  cv::resize(frame.gray, half, cv::Size(), kFlowScale, kFlowScale, cv::INTER_AREA);
  history_.push_back({frame.index, frame.timestamp, frame.gray.size(),
                      buildFlowPyramid(half, options_.flow), frame.depth});
  while (history_.size() > 2 && frame.timestamp - history_.front().timestamp > options_.history) {
    history_.pop_front();
  }
}

bool BoxCarrier::carry(Track& track, const Moment& from, const Moment& to) const {
  const KeyPoints grid = gridIn(track.box, from.size, from.depth, options_.grid);
  std::vector<float> depth;
  std::copy_if(grid.depth.begin(), grid.depth.end(), std::back_inserter(depth), hasDepth);
  if (!std::isfinite(track.depth) && depth.size() >= options_.min_points) {
    track.depth = nearestLayer(depth);
  }
  const bool use_depth = std::isfinite(track.depth) && depth.size() >= options_.min_points;
  const KeyPoints points = pointsOnThing(grid, track.box, use_depth ? track.depth : kNaN);
  if (points.size() < options_.min_points) {
    return false;
  }
  const FlowMatches matches =
      trackIntoEarlierFrame(from.pyramid, to.pyramid, points.view(), options_.flow);
  const std::optional<BoxMotion> motion = medianMotion(track.box, points, matches, options_);
  if (!motion) {
    return false;
  }
  if (use_depth) {
    track.depth = medianOf(points.depth);
  }
  track.box = moved(track.box, *motion);
  track.fresh = false;
  return visibleShare(track.box, to.size) >= kMinVisible;
}

void BoxCarrier::carryAll(std::vector<Track>& tracks, const Moment& from, const Moment& to) const {
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [&](Track& track) { return !carry(track, from, to); }),
               tracks.end());
}

std::vector<BoxCarrier::Track> BoxCarrier::tracksAt(std::size_t moment,
                                                    const std::vector<DetectionBox>& boxes) const {
  std::vector<Track> tracks;
  for (const DetectionBox& box : mergeDoubles(boxes, options_)) {
    Track track;
    track.box = box;
    track.detected_at = history_[moment].timestamp;
    tracks.push_back(track);
  }
  for (std::size_t k = moment; k + 1 < history_.size(); ++k) {
    carryAll(tracks, history_[k], history_[k + 1]);
  }
  return tracks;
}

void BoxCarrier::associate(std::vector<Track> detected) {
  struct Pair {
    float overlap;
    std::size_t detected;
    std::size_t known;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < detected.size(); ++i) {
    for (std::size_t j = 0; j < tracks_.size(); ++j) {
      const float overlap = intersectionOverUnion(detected[i].box, tracks_[j].box);
      if (overlap >= kAssociationIou && detected[i].box.class_id == tracks_[j].box.class_id) {
        pairs.push_back({overlap, i, j});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap > b.overlap; });
  std::vector<bool> taken(detected.size(), false);
  std::vector<bool> found(tracks_.size(), false);
  for (const Pair& pair : pairs) {
    if (!taken[pair.detected] && !found[pair.known]) {
      taken[pair.detected] = true;
      found[pair.known] = true;
      detected[pair.detected].detections = tracks_[pair.known].detections + 1;
    }
  }
  const std::size_t newly = detected.size();
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    const bool is_double = std::any_of(
        detected.begin(), detected.begin() + static_cast<std::ptrdiff_t>(newly),
        [&](const Track& other) { return isPartOf(tracks_[j].box, other.box, options_); });
    if (!found[j] && !is_double) {
      tracks_[j].missed = true;
      detected.push_back(tracks_[j]);
    }
  }
  tracks_ = std::move(detected);
}

bool BoxCarrier::hasEnded(const Track& track, const Moment& now) const {
  const double age = now.timestamp - track.detected_at;
  // Half a millisecond: time stamps are rounded to microseconds.
  return age > (track.missed ? options_.max_bridge : kMaxCarry) + 0.0005 ||
         (track.missed && options_.max_bridge == 0.0);
}

std::vector<DetectionBox> BoxCarrier::update(const CarriedFrame& frame,
                                             const std::optional<FrameDetection>& detection) {
  remember(frame);
  const Moment& now = history_.back();
  if (history_.size() > 1) {
    carryAll(tracks_, history_[history_.size() - 2], now);
  }
  if (detection) {
    const auto moment = std::find_if(history_.begin(), history_.end(), [&](const Moment& past) {
      return past.index == detection->frame;
    });
    if (moment != history_.end()) {
      associate(tracksAt(static_cast<std::size_t>(moment - history_.begin()), detection->boxes));
    }
  }
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(),
                               [&](const Track& track) { return hasEnded(track, now); }),
                tracks_.end());
  bridged_ = 0;
  std::vector<DetectionBox> boxes;
  for (const Track& track : tracks_) {
    // One that was seen too seldom is followed in silence: a detector that answers for every third
    // frame only sees it again in time, a false alarm is over.
    if (track.missed && track.detections < options_.min_detections) {
      continue;
    }
    bridged_ += track.missed ? 1 : 0;
    if (track.fresh) {
      boxes.push_back(track.box);
    } else {
      const std::vector<DetectionBox> clipped = clipToImage({track.box}, now.size);
      boxes.insert(boxes.end(), clipped.begin(), clipped.end());
    }
  }
  return boxes;
}

}  // namespace hmcdyn
