// SPDX-License-Identifier: BSD-3-Clause
#include "mask/mask_score.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::masking {
namespace {

constexpr std::uint8_t kMoves = 255;
constexpr std::uint8_t kStands = 128;
constexpr std::uint8_t kRoom = 0;

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

/// The images of a folder by their stamps in milliseconds.
std::map<long long, std::filesystem::path> imagesIn(const std::filesystem::path& folder) {
  std::map<long long, std::filesystem::path> images;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path& path = entry.path();
    try {
      if (path.extension() == ".png" || path.extension() == ".jpg") {
        images[std::llround(1e3 * std::stod(path.stem().string()))] = path;
      }
    } catch (const std::exception&) {
      continue;  // not named by a stamp
    }
  }
  return images;
}

cv::Mat readMask(const std::filesystem::path& file) {
  cv::Mat mask = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (mask.empty() || mask.type() != CV_8UC1) {
    throw std::runtime_error(file.string() + ": no 8-bit image with one channel");
  }
  return mask;
}

/// Pixels of a region that have a neighbour outside it; the image's border is none.
cv::Mat borderOf(const cv::Mat& region) {
  cv::Mat eroded;
  cv::erode(region, eroded, cv::Mat::ones(3, 3, CV_8UC1), {-1, -1}, 1, cv::BORDER_REPLICATE);
  return region & ~eroded;
}

/// Pixels of one border within a distance of another.
double agreement(const cv::Mat& border, const cv::Mat& other, int distance) {
  cv::Mat grown;
  const int side = 2 * distance + 1;
  cv::dilate(other, grown, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  return cv::countNonZero(border & grown);
}

}  // namespace

double MaskScore::iou() const { return ratio(true_moving, true_moving + false_moving + missed); }
double MaskScore::precision() const { return ratio(true_moving, true_moving + false_moving); }
double MaskScore::recall() const { return ratio(true_moving, true_moving + missed); }
double MaskScore::falseShare() const {
  return ratio(false_moving, static_pixels + true_moving + missed);
}

double MaskScore::boundaryF() const {
  const double p = ratio(border_agreed, border_pixels);
  const double r = ratio(true_border_found, true_border_pixels);
  return 2 * p * r / (p + r);
}

void scoreFrame(const cv::Mat& truth, const cv::Mat& mask, const MaskScoreOptions& options,
                MaskScore& score) {
  const cv::Mat moves = truth == kMoves;
  const cv::Mat stands = truth == kStands;
  const cv::Mat room = truth == kRoom;
  const cv::Mat called = mask == kMoves;
  score.true_moving += cv::countNonZero(moves & called);
  score.missed += cv::countNonZero(moves & ~called);
  score.false_moving += cv::countNonZero(room & called);
  score.static_pixels += cv::countNonZero(room);
  score.standing += cv::countNonZero(stands);
  score.standing_as_moving += cv::countNonZero(stands & called);
  // A border between two parts of one person, the one moving, the other not, is not asked for.
  const cv::Mat ignored = (truth != kRoom) & (truth != kMoves);
  cv::Mat near_ignored;
  cv::dilate(
      ignored, near_ignored,
      cv::Mat::ones(2 * options.border_distance + 1, 2 * options.border_distance + 1, CV_8UC1));
  const cv::Mat border = borderOf(called) & ~near_ignored;
  const cv::Mat true_border = borderOf(moves) & ~near_ignored;
  score.border_agreed += agreement(border, borderOf(moves), options.border_distance);
  score.border_pixels += cv::countNonZero(border);
  score.true_border_found += agreement(true_border, borderOf(called), options.border_distance);
  score.true_border_pixels += cv::countNonZero(true_border);
}

MaskScore scoreMasks(const std::filesystem::path& sequence, const std::filesystem::path& folder,
                     const MaskScoreOptions& options) {
  auto truths = imagesIn(sequence / "mask");
  const bool nothing_moves = truths.empty();
  if (nothing_moves) {
    truths = imagesIn(sequence / "rgb");
  }
  const auto masks = imagesIn(folder);
  if (truths.empty() || masks.empty()) {
    throw std::runtime_error((truths.empty() ? sequence : folder).string() +
                             ": no images named by time stamps");
  }
  MaskScore score;
  ThingClock clock(options);
  std::size_t index = 0;
  for (const auto& [stamp, file] : truths) {
    const auto found = masks.find(stamp);
    cv::Mat mask = found == masks.end() ? cv::Mat() : readMask(found->second);
    cv::Mat truth;
    if (!nothing_moves) {
      truth = readMask(file);
    } else if (!mask.empty()) {
      truth = cv::Mat::zeros(mask.size(), CV_8UC1);
    }
    const bool scored = index++ >= options.skip_frames;
    if (!mask.empty() && mask.size() != truth.size()) {
      throw std::runtime_error(fmt::format("{}: is {} x {} pixels; expected {} x {} as {}",
                                           found->second.string(), mask.cols, mask.rows, truth.cols,
                                           truth.rows, file.string()));
    }
    if (mask.empty()) {
      score.without_mask += scored ? 1 : 0;
      if (truth.empty()) {
        continue;
      }
      mask = cv::Mat::zeros(truth.size(), CV_8UC1);
    }
    if (scored) {
      ++score.frames;
      scoreFrame(truth, mask, options, score);
    }
    clock.update(1e-3 * static_cast<double>(stamp), truth, mask, scored, score);
  }
  if (score.without_mask > 0 && score.without_mask >= score.frames) {
    throw std::runtime_error(fmt::format(
        "{}: none of its {} images has the time stamp of one of the {} in {}; are they another "
        "recording's?",
        folder.string(), masks.size(), truths.size(),
        (sequence / (nothing_moves ? "rgb" : "mask")).string()));
  }
  return score;
}

}  // namespace hmcdyn::masking
