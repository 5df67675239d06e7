// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detection/box_carrier.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/video/tracking.hpp>

namespace hmcdyn::slam {
namespace {

double area(const DetectionBox& box) {
  return std::max(0.0f, box.x_max - box.x_min) * std::max(0.0f, box.y_max - box.y_min);
}

double intersection(const DetectionBox& a, const DetectionBox& b) {
  const double width = std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min);
  const double height = std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A grid of points over the inner part of a box; where depths are known, only those of its nearest
/// layer: the rest of a box is background.
std::vector<cv::Point2f> pointsOn(const DetectionBox& box, const cv::Mat& depth,
                                  const cv::Size& image, const BoxCarrierOptions& options) {
  std::vector<cv::Point2f> points;
  std::vector<float> depths;
  constexpr float kInset = 0.12f;  // of the box's side: its border is background
  for (int row = 0; row < options.grid; ++row) {
    for (int column = 0; column < options.grid; ++column) {
      const auto place = [&](float low, float high, int k) {
        const float share = kInset + (1.0f - 2.0f * kInset) * static_cast<float>(k) /
                                         static_cast<float>(options.grid - 1);
        return low + share * (high - low);
      };
      const cv::Point2f p(place(box.x_min, box.x_max, column), place(box.y_min, box.y_max, row));
      if (p.x < 0.0f || p.y < 0.0f || p.x > static_cast<float>(image.width - 1) ||
          p.y > static_cast<float>(image.height - 1)) {
        continue;
      }
      points.push_back(p);
      depths.push_back(depth.empty() ? 0.0f : depth.at<float>(cvRound(p.y), cvRound(p.x)));
    }
  }
  std::vector<float> known;
  std::copy_if(depths.begin(), depths.end(), std::back_inserter(known),
               [](float z) { return hasDepth(z); });
  if (known.size() < options.min_points) {
    return points;
  }
  const auto near = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 5);
  std::nth_element(known.begin(), near, known.end());
  const float limit = *near + options.layer_depth;
  std::vector<cv::Point2f> on_thing;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (hasDepth(depths[k]) && depths[k] <= limit) {
      on_thing.push_back(points[k]);
    }
  }
  return on_thing;
}

struct Pairs {
  std::vector<cv::Point2f> from, to;
};

/// Shift by the median displacement, size by the median ratio of distances from the median point.
DetectionBox moved(const DetectionBox& box, const Pairs& pairs) {
  std::vector<float> u, v, du, dv;
  for (std::size_t k = 0; k < pairs.from.size(); ++k) {
    u.push_back(pairs.from[k].x);
    v.push_back(pairs.from[k].y);
    du.push_back(pairs.to[k].x - pairs.from[k].x);
    dv.push_back(pairs.to[k].y - pairs.from[k].y);
  }
  const cv::Point2f centre(median(u), median(v));
  const cv::Point2f shift(median(du), median(dv));
  std::vector<float> ratios;
  constexpr double kFarEnough = 8.0;  // px, for a ratio that means something
  for (std::size_t k = 0; k < pairs.from.size(); ++k) {
    const double before = cv::norm(pairs.from[k] - centre);
    if (before >= kFarEnough) {
      ratios.push_back(static_cast<float>(cv::norm(pairs.to[k] - centre - shift) / before));
    }
  }
  constexpr float kMostChange = 0.1f;  // of the size, from one frame to the next
  const float scale =
      ratios.size() < 4 ? 1.0f : std::clamp(median(ratios), 1.0f - kMostChange, 1.0f + kMostChange);
  DetectionBox result = box;
  result.x_min = centre.x + shift.x + scale * (box.x_min - centre.x);
  result.x_max = centre.x + shift.x + scale * (box.x_max - centre.x);
  result.y_min = centre.y + shift.y + scale * (box.y_min - centre.y);
  result.y_max = centre.y + shift.y + scale * (box.y_max - centre.y);
  return result;
}

}  // namespace

double overlap(const DetectionBox& a, const DetectionBox& b) {
  const double both = intersection(a, b);
  const double either = area(a) + area(b) - both;
  return either > 0.0 ? both / either : 0.0;
}

BoxCarrier::BoxCarrier(const BoxCarrierOptions& options) : options_(options) {
  const auto require = [](bool good, const char* name, double value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("BoxCarrierOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(options.max_age >= 0.0, "max_age", options.max_age, "a time >= 0 (s)");
  require(options.history >= 0.0, "history", options.history, "a time >= 0 (s)");
  require(options.min_overlap > 0.0 && options.min_overlap <= 1.0, "min_overlap",
          options.min_overlap, "a share in (0, 1]");
  require(options.double_overlap > 0.0, "double_overlap", options.double_overlap, "a share > 0");
  require(options.grid >= 3, "grid", options.grid, "at least 3 points a side");
}

std::vector<DetectionBox> BoxCarrier::withoutDoubles(const std::vector<DetectionBox>& boxes) {
  std::vector<DetectionBox> kept;
  for (const DetectionBox& box : boxes) {  // strongest first, as detectors give them
    const bool is_double = std::any_of(kept.begin(), kept.end(), [&](const DetectionBox& other) {
      const double smaller = std::min(area(box), area(other));
      const double larger = std::max(area(box), area(other));
      return box.class_id == other.class_id && smaller > 0.0 &&
             intersection(box, other) >= options_.double_overlap * smaller &&
             smaller >= options_.double_area * larger;
    });
    if (is_double) {
      ++merged_;
    } else {
      kept.push_back(box);
    }
  }
  return kept;
}

std::vector<BoxCarrier::Track> BoxCarrier::carry(const std::vector<Track>& tracks,
                                                 const Image& from, const Image& to) const {
  Pairs all;
  std::vector<std::size_t> ends;
  for (const Track& track : tracks) {
    const std::vector<cv::Point2f> points =
        pointsOn(track.box, from.depth, from.gray.size(), options_);
    all.from.insert(all.from.end(), points.begin(), points.end());
    ends.push_back(all.from.size());
  }
  if (all.from.empty()) {
    return {};
  }
  std::vector<std::uint8_t> found;
  std::vector<float> difference;
  constexpr int kWindow = 15;   // px
  constexpr int kMaxLevel = 3;  // people move fast
  cv::calcOpticalFlowPyrLK(
      from.gray, to.gray, all.from, all.to, found, difference, cv::Size(kWindow, kWindow),
      kMaxLevel, cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 10, 0.03));
  std::vector<Track> carried;
  std::size_t k = 0;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    Pairs pairs;
    for (; k < ends[t]; ++k) {
      if (found[k] != 0 && difference[k] <= options_.max_difference) {
        pairs.from.push_back(all.from[k]);
        pairs.to.push_back(all.to[k]);
      }
    }
    if (pairs.from.size() < options_.min_points) {
      continue;
    }
    Track track = tracks[t];
    track.box = moved(track.box, pairs);
    const bool inside = track.box.x_max > 0.0f && track.box.y_max > 0.0f &&
                        track.box.x_min < static_cast<float>(to.gray.cols) &&
                        track.box.y_min < static_cast<float>(to.gray.rows);
    if (inside && to.timestamp - track.seen <= options_.max_age) {
      carried.push_back(track);
    }
  }
  return carried;
}

std::vector<BoxCarrier::Track> BoxCarrier::associate(std::vector<Track> tracks,
                                                     const TimedDetection& detected,
                                                     const Image* before, const Image& at) {
  std::vector<Track> now;
  for (const DetectionBox& box : withoutDoubles(detected.boxes)) {
    now.push_back({box, detected.timestamp});
    const auto same = std::max_element(
        tracks.begin(), tracks.end(),
        [&](const Track& a, const Track& b) { return overlap(a.box, box) < overlap(b.box, box); });
    if (same != tracks.end() && same->box.class_id == box.class_id &&
        overlap(same->box, box) >= options_.min_overlap) {
      tracks.erase(same);
    }
  }
  if (options_.max_age <= 0.0 || before == nullptr || tracks.empty()) {
    return now;
  }
  // What was missed is carried on, unless it is part of what was found.
  for (const Track& track : carry(tracks, *before, at)) {
    const bool covered = std::any_of(now.begin(), now.end(), [&](const Track& other) {
      return intersection(track.box, other.box) >= options_.double_overlap * area(track.box);
    });
    if (!covered) {
      now.push_back(track);
    }
  }
  return now;
}

std::size_t BoxCarrier::imageAt(double timestamp) const {
  const auto found = std::find_if(images_.begin(), images_.end(),
                                  [&](const Image& image) { return image.timestamp == timestamp; });
  return static_cast<std::size_t>(found - images_.begin());
}

std::vector<DetectionBox> BoxCarrier::update(double timestamp, const cv::Mat& gray,
                                             const cv::Mat& depth,
                                             const std::optional<TimedDetection>& detected) {
  while (!images_.empty() && timestamp - images_.front().timestamp > options_.history) {
    images_.pop_front();
    tracks_.pop_front();
  }
  images_.push_back({timestamp, gray, depth});
  tracks_.emplace_back();
  std::size_t k = images_.size() - 1;
  if (detected && imageAt(detected->timestamp) < images_.size()) {
    k = imageAt(detected->timestamp);
    tracks_[k] = associate(k > 0 ? tracks_[k - 1] : std::vector<Track>{}, *detected,
                           k > 0 ? &images_[k - 1] : nullptr, images_[k]);
    ++k;
  }
  for (; k < images_.size(); ++k) {  // from the detection's frame to the present
    tracks_[k] = k == 0 || options_.max_age <= 0.0
                     ? std::vector<Track>{}
                     : carry(tracks_[k - 1], images_[k - 1], images_[k]);
  }
  std::vector<DetectionBox> boxes;
  for (const Track& track : tracks_.back()) {
    boxes.push_back(track.box);
    carried_ += track.seen < timestamp ? 1 : 0;
  }
  return boxes;
}

}  // namespace hmcdyn::slam
