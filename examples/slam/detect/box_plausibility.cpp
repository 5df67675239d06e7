// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/box_plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "slam/detect/box_notes.hpp"
#include "slam/detect/box_order.hpp"
#include "slam/detect/box_selection.hpp"
#include "slam/detect/coco_classes.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::slam {
namespace {

bool isInverted(const DetectionBox& box) {
  return box.x_max <= box.x_min || box.y_max <= box.y_min;
}

bool isShare(const DetectionBox& box) {
  constexpr float kAtMost = 1.05f;  // detectors' boxes reach a little beyond the image
  const auto within = [](float value) { return value >= 1.0f - kAtMost && value <= kAtMost; };
  return within(box.x_min) && within(box.y_min) && within(box.x_max) && within(box.y_max);
}

bool isOutside(const DetectionBox& box, cv::Size image) {
  return image.area() > 0 &&
         (box.x_max < 0.0f || box.y_max < 0.0f || box.x_min > static_cast<float>(image.width - 1) ||
          box.y_min > static_cast<float>(image.height - 1));
}

/// Reaches farther beyond the right or the lower border than detectors' boxes do.
bool isBeyond(const DetectionBox& box, cv::Size image) {
  constexpr float kAtMost = 1.05f;  // image sides
  return image.area() > 0 && (box.x_max > kAtMost * static_cast<float>(image.width) ||
                              box.y_max > kAtMost * static_cast<float>(image.height));
}

std::string guessOfContent(const std::vector<TimedBox>& boxes, const BoxCounts& counts,
                           cv::Size image) {
  if (2 * counts.shares > counts.in_file) {
    return fmt::format(
        "they look like shares of the image (0..1){}; multiply them by its sides{}",
        counts.inverted > 0 ? ", perhaps centre and size as YOLO writes them" : "",
        image.area() > 0 ? fmt::format(", {} and {}", image.width, image.height) : "");
  }
  const bool are_points = std::all_of(boxes.begin(), boxes.end(), [](const TimedBox& timed) {
    return timed.box.x_min == timed.box.x_max || timed.box.y_min == timed.box.y_max;
  });
  if (are_points) {
    return "they have no area; is one corner written twice?";
  }
  std::string order = guessOfOrder(boxes, image);
  if (!order.empty()) {
    return order;
  }
  if (counts.outside == 0 && counts.shares == 0) {  // another size does not turn a box inside out
    return guessOfCorners(boxes, image);
  }
  return image.area() > 0 ? fmt::format("are they of images of another size than {} x {}?",
                                        image.width, image.height)
                          : "are they x y width height?";
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), what));
}

/// Counts and sorts out what is no box in the image.
std::vector<TimedBox> withoutImpossible(const std::vector<TimedBox>& boxes, cv::Size image,
                                        const std::filesystem::path& file, BoxCounts& counts) {
  std::vector<TimedBox> possible;
  std::size_t inverted_shares = 0;
  for (const TimedBox& timed : boxes) {
    const bool inverted = isInverted(timed.box);
    if (isShare(timed.box)) {
      ++counts.shares;
      inverted_shares += inverted ? 1 : 0;
    } else if (inverted) {
      ++counts.inverted;
    } else if (isOutside(timed.box, image)) {
      ++counts.outside;
    } else {
      counts.beyond += isBeyond(timed.box, image) ? 1 : 0;
      possible.push_back(timed);
    }
  }
  constexpr std::size_t kOften = 5;  // of a fifth of the lines a slip is no explanation
  const bool in_other_order = kOften * counts.inverted >= boxes.size() && counts.inverted > 1 &&
                              !guessOfOrder(boxes, image).empty();
  if (!boxes.empty() && (possible.empty() || in_other_order)) {
    BoxCounts guessed = counts;
    guessed.inverted += inverted_shares;
    refuse(file,
           fmt::format("{} of {} lines are no boxes \"x_min y_min x_max y_max\" in pixels ({} with "
                       "a maximum not above its minimum, {} outside the image, {} within its "
                       "first pixel); {}",
                       boxes.size() - possible.size(), boxes.size(), counts.inverted,
                       counts.outside, counts.shares, guessOfContent(boxes, guessed, image)));
  }
  return possible;
}

double distanceTo(const std::vector<double>& times, double time) {
  double least = std::numeric_limits<double>::infinity();
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after != times.end()) {
    least = *after - time;
  }
  if (after != times.begin()) {
    least = std::min(least, time - *std::prev(after));
  }
  return least;
}

std::vector<double> stampsOf(const std::vector<TimedBox>& boxes) {
  std::vector<double> stamps;
  stamps.reserve(boxes.size());
  for (const TimedBox& timed : boxes) {
    stamps.push_back(timed.timestamp);
  }
  return stamps;
}

/// "; their time stamps step by 1: they look like frame numbers", or nothing.
std::string guessOfStamps(const std::vector<TimedBox>& boxes) {
  const std::vector<double> stamps = stampsOf(boxes);
  constexpr std::size_t kFew = 4;  // boxes that one image may well have
  if (stamps.size() > kFew && std::count(stamps.begin(), stamps.end(), stamps.front()) ==
                                  static_cast<std::ptrdiff_t>(stamps.size())) {
    return "; all their time stamps are the same: were they rounded, as a float of 32 bits is?";
  }
  const std::string doubt = support::reviewStamps(stamps).doubt;
  return doubt.empty() ? "" : fmt::format("; their time stamps {}", doubt);
}

/// Makes seconds of the stamps, by the unit in which they fit the frames.
void useClockOf(const FramesOfBoxes& frames, const std::filesystem::path& file,
                std::vector<TimedBox>& boxes, BoxReview& review) {
  if (frames.times.empty() || boxes.empty()) {
    return;
  }
  const std::vector<double> stamps = stampsOf(boxes);
  constexpr double kSlack = 1.0;  // s; a detector may have seen what comes before the list
  const std::optional<double> seconds = support::secondsByOverlap(
      stamps, frames.times.front(), frames.times.back(), frames.unit_seconds, kSlack);
  if (!seconds) {
    const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
    refuse(file,
           fmt::format(
               "no box is at a frame's time: the boxes cover {:.6f} to {:.6f}, the frames "
               "{:.6f} to {:.6f} s; are these another recording's, or another clock's (if both "
               "began together, they differ by {}: {} are ahead)?{}",
               *first, *last, frames.times.front(), frames.times.back(),
               support::differenceOf(frames.times.front(), *first),
               frames.times.front() > *first ? "the frames" : "the boxes", guessOfStamps(boxes)));
  }
  if (*seconds != 1.0) {
    review.notes.push_back(
        fmt::format("{}: the time stamps are read as {}, since that fits the frames", file.string(),
                    support::nameOfUnit(*seconds)));
  }
  for (TimedBox& timed : boxes) {
    timed.timestamp *= *seconds;
  }
}

bool isWanted(const DetectionBox& box, const DetectorOptions& options) {
  return options.classes.empty() || std::find(options.classes.begin(), options.classes.end(),
                                              box.class_id) != options.classes.end();
}

std::string classesIn(const std::vector<TimedBox>& boxes) {
  std::set<int> ids;
  for (const TimedBox& timed : boxes) {
    ids.insert(timed.box.class_id);
  }
  std::vector<std::string> names;
  for (const int id : ids) {
    names.push_back(fmt::format("{} ({})", id, cocoClassName(id)));
    constexpr std::size_t kNamed = 5;
    if (names.size() == kNamed) {
      names.emplace_back("...");
      break;
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void noteWhatIsLeftOut(const std::vector<TimedBox>& boxes, const DetectorOptions& options,
                       const std::filesystem::path& file, BoxReview& review) {
  const BoxCounts& counts = review.counts;
  std::vector<std::string> rules;
  const auto rule = [&](std::size_t count, const std::string& why) {
    if (count > 0) {
      rules.push_back(fmt::format("{} {}", count, why));
    }
  };
  rule(counts.shares, "within the image's first pixel (shares of the image?)");
  rule(counts.inverted, "with a maximum not above its minimum");
  rule(counts.outside, "outside the image");
  rule(counts.other_class, "of classes that --classes does not ask for");
  rule(counts.low_score,
       fmt::format("with a score below --score-threshold {:g}", options.score_threshold));
  rule(counts.other_time,
       fmt::format("without a frame within {:g} s of their time stamp{}", options.time_tolerance,
                   2 * counts.other_time > counts.in_file ? guessOfStamps(boxes) : ""));
  rule(counts.weaker, fmt::format("beyond the {} strongest of their time stamp (boxes before "
                                  "suppression, NMS?)",
                                  kMostBoxes));
  const std::size_t odd =
      counts.shares + counts.inverted + counts.outside + counts.other_time + counts.weaker;
  const bool notable = odd > 0 || (counts.kept == 0 && counts.in_file > 0);
  if (notable) {
    review.notes.push_back(
        fmt::format("{}: {} of {} boxes are left out: {}{}", file.string(),
                    counts.in_file - counts.kept, counts.in_file, fmt::join(rules, ", "),
                    counts.kept == 0 && counts.other_class > 0
                        ? fmt::format("; the file has the classes {}", classesIn(boxes))
                        : ""));
  }
}

/// The kMostBoxes strongest of each time stamp, in the order that they had.
std::vector<TimedBox> strongestOfEachTime(std::vector<TimedBox> boxes, BoxCounts& counts) {
  std::map<double, std::vector<std::size_t>> of_time;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    of_time[boxes[i].timestamp].push_back(i);
  }
  std::vector<std::uint8_t> stays(boxes.size(), 1);
  for (auto& [time, indices] : of_time) {
    if (indices.size() <= kMostBoxes) {
      continue;
    }
    std::stable_sort(indices.begin(), indices.end(), [&](std::size_t a, std::size_t b) {
      return boxes[a].box.score > boxes[b].box.score;
    });
    for (std::size_t k = kMostBoxes; k < indices.size(); ++k) {
      stays[indices[k]] = 0;
      ++counts.weaker;
    }
  }
  std::vector<TimedBox> kept;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (stays[i] != 0) {
      kept.push_back(boxes[i]);
    }
  }
  return kept;
}

}  // namespace

BoxReview reviewBoxes(const std::vector<TimedBox>& boxes, const DetectorOptions& options,
                      const std::filesystem::path& file) {
  BoxReview review;
  BoxCounts& counts = review.counts;
  counts.in_file = boxes.size();
  const FramesOfBoxes& frames = options.frames;
  std::vector<TimedBox> possible = withoutImpossible(boxes, frames.image, file, counts);
  useClockOf(frames, file, possible, review);
  double nearest = std::numeric_limits<double>::infinity();
  for (const TimedBox& timed : possible) {
    const double distance = frames.times.empty() ? 0.0 : distanceTo(frames.times, timed.timestamp);
    nearest = std::min(nearest, distance);
    if (!isWanted(timed.box, options)) {
      ++counts.other_class;
    } else if (timed.box.score < options.score_threshold) {
      ++counts.low_score;
    } else if (!(distance <= options.time_tolerance)) {
      ++counts.other_time;
    } else {
      review.kept.push_back(timed);
    }
  }
  review.kept = strongestOfEachTime(std::move(review.kept), counts);
  counts.kept = review.kept.size();
  if (!possible.empty() && nearest > options.time_tolerance) {
    refuse(file, fmt::format("no box is within {:g} s of a frame, the nearest is {:.6f} s away; "
                             "are the time stamps those of the colour images?",
                             options.time_tolerance, nearest));
  }
  noteDoubtful(possible, frames.image, file, review);
  noteWhatIsLeftOut(boxes, options, file, review);
  return review;
}

}  // namespace hmcdyn::slam
