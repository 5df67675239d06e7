// SPDX-License-Identifier: BSD-3-Clause
// When things of the truth are found after they begin to move, and released after they stop.
#include <algorithm>
#include <map>

#include <opencv2/imgproc.hpp>

#include "mask/mask_score.hpp"

namespace hmcdyn::masking {
namespace {

constexpr std::uint8_t kMoving = 255;
constexpr std::uint8_t kStanding = 128;

/// Pixels of one connected part of the truth.
struct Part {
  int pixels = 0;
  int moving = 0;             ///< In the truth.
  int called = 0;             ///< Of the moving ones, called moving.
  int called_of_all = 0;      ///< Of all, called moving.
  std::map<int, int> before;  ///< Pixels by their number in the frame before.

  bool moves() const { return 2 * moving > pixels; }
  bool isFound() const { return 2 * called > moving; }
  bool isReleased() const { return 2 * called_of_all < pixels; }
};

std::vector<Part> partsOf(const cv::Mat& labels, int count, const cv::Mat& truth,
                          const cv::Mat& mask, const cv::Mat& ids) {
  std::vector<Part> parts(static_cast<std::size_t>(count));
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      const int label = labels.at<int>(row, column);
      if (label == 0) {
        continue;
      }
      Part& part = parts[static_cast<std::size_t>(label)];
      const bool moving = truth.at<std::uint8_t>(row, column) == kMoving;
      const bool called = mask.at<std::uint8_t>(row, column) == kMoving;
      ++part.pixels;
      part.moving += moving ? 1 : 0;
      part.called += moving && called ? 1 : 0;
      part.called_of_all += called ? 1 : 0;
      if (!ids.empty() && ids.at<int>(row, column) != 0) {
        ++part.before[ids.at<int>(row, column)];
      }
    }
  }
  return parts;
}

}  // namespace

void ThingClock::update(double timestamp, const cv::Mat& truth, const cv::Mat& mask, bool scored,
                        MaskScore& score) {
  const cv::Mat solid = (truth == kMoving) | (truth == kStanding);
  cv::Mat labels;
  const int count = cv::connectedComponents(solid, labels, 8, CV_32S);
  const std::vector<Part> parts = partsOf(labels, count, truth, mask, ids_);
  std::vector<int> id_of(parts.size(), 0);
  std::vector<Thing> now;
  const double least = options_.min_thing * static_cast<double>(truth.total());
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const Part& part = parts[k];
    if (part.pixels < least) {
      continue;
    }
    const auto most =
        std::max_element(part.before.begin(), part.before.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const int id = most == part.before.end() ? 0 : most->first;
    const auto known = std::find_if(things_.begin(), things_.end(),
                                    [id](const Thing& thing) { return thing.id == id; });
    Thing thing{next_id_, part.moves(), !first_ && part.moves(), timestamp};
    if (known != things_.end()) {
      thing = *known;
      things_.erase(known);  // of two parts of one thing, the second is new
      if (thing.moves != part.moves()) {
        (thing.moves ? score.never_found : score.never_released) += thing.waits && scored ? 1 : 0;
        thing = {thing.id, part.moves(), true, timestamp};
      }
    } else {
      ++next_id_;
    }
    if (thing.waits && (thing.moves ? part.isFound() : part.isReleased())) {
      thing.waits = false;
      if (scored) {
        (thing.moves ? score.seconds_to_find : score.seconds_to_release)
            .push_back(timestamp - thing.since);
      }
    }
    if (scored && part.moves()) {
      ++score.things;
      score.things_found += part.isFound() ? 1 : 0;
    }
    id_of[k] = thing.id;
    now.push_back(thing);
  }
  for (const Thing& gone : things_) {
    (gone.moves ? score.never_found : score.never_released) += gone.waits && scored ? 1 : 0;
  }
  things_ = now;
  ids_.create(truth.size(), CV_32SC1);
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      ids_.at<int>(row, column) = id_of[static_cast<std::size_t>(labels.at<int>(row, column))];
    }
  }
  first_ = false;
}

}  // namespace hmcdyn::masking
