// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "slam/features/orb_descriptor.hpp"
#include "slam/features/spread_corners.hpp"

namespace hmcdyn::slam {
namespace {

/// 1-2-1 in each direction, into a buffer. The image may be part of a larger one, which does not
/// count.
void smoothInto(cv::Mat& buffer, const cv::Mat& image) {
  cv::GaussianBlur(image, buffer, cv::Size(3, 3), 0.0, 0.0,
                   cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
}

/// Bits of a descriptor compare single pixels. Smoothed like this (the paper of BRIEF, Calonder et
/// al. 2010, finds sigma 2 best), true matches half a second apart differ by 36 bits, by 45 with
/// 1-2-1.
void smoothForDescriptors(cv::Mat& buffer, const cv::Mat& image) {
  constexpr double kSigma = 2.0;  // px
  cv::GaussianBlur(image, buffer, cv::Size(7, 7), kSigma, kSigma,
                   cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
}

template <class T>
void require(bool valid, const char* field, T value, const char* expected) {
  if (!valid) {
    throw std::invalid_argument(std::string("ORB options: ") + field + " is " +
                                std::to_string(value) + "; expected " + expected);
  }
}

void checkImages(const cv::Mat& gray, const cv::Mat& mask) {
  if (gray.empty()) {
    throw std::invalid_argument("ORB: the image is empty");
  }
  if (gray.type() != CV_8UC1) {
    throw std::invalid_argument("ORB: the image is of type " + cv::typeToString(gray.type()) +
                                "; expected CV_8UC1");
  }
  if (!mask.empty() && (mask.type() != CV_8UC1 || mask.size() != gray.size())) {
    throw std::invalid_argument(
        "ORB: the mask is " + std::to_string(mask.cols) + "x" + std::to_string(mask.rows) +
        " of type " + cv::typeToString(mask.type()) + "; expected " + std::to_string(gray.cols) +
        "x" + std::to_string(gray.rows) + " of CV_8UC1");
  }
}

/// Maps a level's pixel coordinates to the image's: the pixel areas coincide, not the centres.
class LevelToImage {
 public:
  LevelToImage(cv::Size image, cv::Size level)
      : x_scale_(static_cast<float>(image.width) / static_cast<float>(level.width)),
        y_scale_(static_cast<float>(image.height) / static_cast<float>(level.height)) {}

  cv::Point2f operator()(float x, float y) const {
    return {(x + 0.5f) * x_scale_ - 0.5f, (y + 0.5f) * y_scale_ - 0.5f};
  }

 private:
  float x_scale_;
  float y_scale_;
};

float degrees(cv::Point2f direction) {
  const double angle = std::atan2(direction.y, direction.x) * 180.0 / CV_PI;
  const auto positive = static_cast<float>(angle < 0.0 ? angle + 360.0 : angle);
  return positive < 360.0f ? positive : 0.0f;
}

}  // namespace

void checkOrbOptions(const OrbOptions& options) {
  require(options.features > 0, "features", options.features, "> 0");
  require(options.scale_factor > 1.0f && std::isfinite(options.scale_factor), "scale_factor",
          options.scale_factor, "> 1");
  require(options.levels >= 1 && options.levels <= 32, "levels", options.levels, "1..32");
  require(options.fast_threshold >= 1 && options.fast_threshold <= 254, "fast_threshold",
          options.fast_threshold, "1..254");
  require(options.min_fast_threshold >= 1 && options.min_fast_threshold <= options.fast_threshold,
          "min_fast_threshold", options.min_fast_threshold, "1..fast_threshold");
  require(options.cell > 0, "cell", options.cell, "> 0");
  require(options.spread_share >= 0.0f && options.spread_share <= 1.0f, "spread_share",
          options.spread_share, "0..1");
}

OrbExtractor::OrbExtractor(const OrbOptions& options) : options_(options) {
  checkOrbOptions(options_);
  pattern_ = makeOrbPattern();
  levels_.resize(static_cast<std::size_t>(options_.levels));
}

Features OrbExtractor::extract(const cv::Mat& gray, const cv::Mat& mask, int wanted) {
  checkImages(gray, mask);
  if (wanted < 0) {
    throw std::invalid_argument("OrbExtractor::extract: wanted is " + std::to_string(wanted) +
                                "; expected a count >= 0");
  }
  std::vector<int> available;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    makeLevel(i, gray);
    findCorners(levels_[i], mask);
    available.push_back(static_cast<int>(levels_[i].corners.size()));
  }
  const std::vector<int> shares =
      shareOverLevels(wanted > 0 ? wanted : options_.features, available, options_.scale_factor);
  const int total = std::accumulate(shares.begin(), shares.end(), 0);
  Features features;
  if (total > 0) {
    features.key_points.reserve(static_cast<std::size_t>(total));
    features.descriptors.create(total, kDescriptorBytes, CV_8U);
  }
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (shares[i] > 0) {
      describeLevel(i, shares[i], features);
    }
  }
  return features;
}

void OrbExtractor::makeLevel(std::size_t index, const cv::Mat& gray) {
  if (index == 0) {
    // Less noise: more corners are found again, and more precisely. The levels above are smoothed
    // by their making.
    smoothInto(levels_.front().image, gray);
    return;
  }
  const double scale = std::pow(options_.scale_factor, static_cast<double>(index));
  const cv::Size size(std::max(1, cvRound(gray.cols / scale)),
                      std::max(1, cvRound(gray.rows / scale)));
  cv::resize(levels_[index - 1].image, levels_[index].image, size, 0.0, 0.0, cv::INTER_LINEAR);
}

void OrbExtractor::findCorners(Level& level, const cv::Mat& mask) const {
  level.corners.clear();
  const cv::Size size = level.image.size();
  if (size.width <= 2 * kOrbMargin || size.height <= 2 * kOrbMargin) {
    return;
  }
  const cv::Rect inner(kOrbMargin, kOrbMargin, size.width - 2 * kOrbMargin,
                       size.height - 2 * kOrbMargin);
  const cv::Rect with_border(inner.x - 1, inner.y - 1, inner.width + 2, inner.height + 2);
  level.scores = fastScores(level.image, with_border, options_.min_fast_threshold, level.scores);
  level.corners = localMaxima(level.scores, inner);
  if (!mask.empty()) {
    const LevelToImage to_image(mask.size(), size);
    const auto masked = [&](const Corner& corner) {
      const cv::Point2f p = to_image(static_cast<float>(corner.x), static_cast<float>(corner.y));
      return mask.at<uchar>(cvRound(p.y), cvRound(p.x)) == 0;
    };
    level.corners.erase(std::remove_if(level.corners.begin(), level.corners.end(), masked),
                        level.corners.end());
  }
  level.corners = keepStrongPerCell(level.corners, options_.fast_threshold, options_.cell, size);
}

void OrbExtractor::describeLevel(std::size_t index, int count, Features& features) {
  Level& level = levels_[index];
  smoothForDescriptors(level.smooth, level.image);
  const cv::Size size = level.image.size();
  const LevelToImage to_image(levels_.front().image.size(), size);
  const auto scale = static_cast<float>(std::pow(options_.scale_factor, index));
  for (const Corner& corner : selectSpread(level.corners, count, size, options_.spread_share)) {
    const cv::Point2f offset = subPixelOffset(level.scores, corner.x, corner.y);
    const cv::Point2f direction = centroidDirection(level.image, corner.x, corner.y);
    const OrbDescriptor descriptor =
        describe(level.smooth, corner.x, corner.y, direction, pattern_);
    const auto row = static_cast<int>(features.key_points.size());
    std::copy(descriptor.begin(), descriptor.end(), features.descriptors.ptr<uchar>(row));
    features.key_points.emplace_back(
        to_image(static_cast<float>(corner.x) + offset.x, static_cast<float>(corner.y) + offset.y),
        static_cast<float>(2 * kPatternRadius + 1) * scale, degrees(direction),
        static_cast<float>(corner.strength) / 16.0f, static_cast<int>(index));
  }
}

}  // namespace hmcdyn::slam
