// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/feature_tracks.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

namespace hmcdyn::calibrate {
namespace {

// cv::SIFT doubles the image, whose pixels then lie at x / 2 - 0.25, and divides by two alone.
constexpr float kSiftOffset = 0.25f;

struct ImageFeatures {
  std::vector<cv::Point2f> pixels;
  std::vector<float> sizes;
  cv::Mat descriptors;  // CV_32FC1, a row each
};

struct Match {
  int first = 0;  // of all key points of all images
  int second = 0;
  float distance = 0.0f;
};

void checkOptions(const TrackOptions& o) {
  const auto require = [](bool good, const char* field, double value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("TrackOptions: ") + field + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(o.features > 0, "features", o.features, "at least 1");
  require(o.ratio > 0.0 && o.ratio <= 1.0, "ratio", o.ratio, "0..1");
  require(o.epipolar_distance > 0.0, "epipolar_distance", o.epipolar_distance, "pixels above 0");
  require(o.least_matches >= 8, "least_matches", o.least_matches, "at least 8");
  for (const int gap : o.gaps) {
    require(gap > 0, "gaps", gap, "numbers above 0");
  }
}

ImageFeatures featuresOf(const cv::Mat& image, cv::SIFT& sift) {
  std::vector<cv::KeyPoint> found;
  sift.detect(image, found);
  // A corner with two directions is one place.
  std::vector<cv::KeyPoint> key_points;
  for (const cv::KeyPoint& point : found) {
    const bool known =
        std::any_of(key_points.begin(), key_points.end(),
                    [&point](const cv::KeyPoint& other) { return other.pt == point.pt; });
    if (!known) {
      key_points.push_back(point);
    }
  }
  ImageFeatures features;
  sift.compute(image, key_points, features.descriptors);
  for (const cv::KeyPoint& point : key_points) {
    features.pixels.push_back(point.pt - cv::Point2f(kSiftOffset, kSiftOffset));
    features.sizes.push_back(point.size);
  }
  return features;
}

/// Pairs of key points that are each other's nearest, by far enough.
std::vector<cv::DMatch> mutualMatches(const ImageFeatures& a, const ImageFeatures& b,
                                      double ratio) {
  if (a.descriptors.rows < 2 || b.descriptors.rows < 2) {
    return {};
  }
  const cv::BFMatcher matcher(cv::NORM_L2);
  std::vector<std::vector<cv::DMatch>> forward;
  std::vector<cv::DMatch> backward;
  matcher.knnMatch(a.descriptors, b.descriptors, forward, 2);
  matcher.match(b.descriptors, a.descriptors, backward);
  std::vector<cv::DMatch> matches;
  for (const auto& best : forward) {
    const bool clear = best.size() < 2 || best[0].distance < ratio * best[1].distance;
    const auto partner = static_cast<std::size_t>(best[0].trainIdx);
    if (clear && backward[partner].trainIdx == best[0].queryIdx) {
      matches.push_back(best[0]);
    }
  }
  return matches;
}

std::vector<cv::DMatch> verifiedMatches(const ImageFeatures& a, const ImageFeatures& b,
                                        const TrackOptions& options) {
  const std::vector<cv::DMatch> matches = mutualMatches(a, b, options.ratio);
  if (static_cast<int>(matches.size()) < options.least_matches) {
    return {};
  }
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const cv::DMatch& match : matches) {
    from.push_back(a.pixels[static_cast<std::size_t>(match.queryIdx)]);
    to.push_back(b.pixels[static_cast<std::size_t>(match.trainIdx)]);
  }
  std::vector<std::uint8_t> inlier;
  cv::findFundamentalMat(from, to, cv::USAC_MAGSAC, options.epipolar_distance, 0.999, 2000, inlier);
  std::vector<cv::DMatch> verified;
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    if (inlier[i] != 0) {
      verified.push_back(matches[i]);
    }
  }
  return static_cast<int>(verified.size()) < options.least_matches ? std::vector<cv::DMatch>()
                                                                   : verified;
}

/// Sets of key points that are one point of the scene.
class TrackSets {
 public:
  explicit TrackSets(const std::vector<int>& image_of) : parent_(image_of.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const int image : image_of) {
      images_.push_back({image});
    }
  }

  int find(int point) {
    while (parent_[static_cast<std::size_t>(point)] != point) {
      auto& parent = parent_[static_cast<std::size_t>(point)];
      parent = parent_[static_cast<std::size_t>(parent)];
      point = parent;
    }
    return point;
  }

  /// Joins two sets unless an image has a key point in both.
  void join(int first, int second) {
    const int a = find(first);
    const int b = find(second);
    if (a == b) {
      return;
    }
    auto& of_a = images_[static_cast<std::size_t>(a)];
    auto& of_b = images_[static_cast<std::size_t>(b)];
    std::vector<int> both;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          std::back_inserter(both));
    if (!both.empty()) {
      return;
    }
    std::vector<int> united;
    std::merge(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(united));
    of_a = std::move(united);
    of_b.clear();
    parent_[static_cast<std::size_t>(b)] = a;
  }

 private:
  std::vector<int> parent_;
  std::vector<std::vector<int>> images_;  // of a root's set, sorted
};

}  // namespace

std::vector<Track> featureTracks(const std::vector<cv::Mat>& images, const TrackOptions& options) {
  checkOptions(options);
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(options.features);
  std::vector<ImageFeatures> features;
  std::vector<int> image_of;
  std::vector<int> first_of;  // an image's first key point among all
  for (const cv::Mat& image : images) {
    first_of.push_back(static_cast<int>(image_of.size()));
    features.push_back(featuresOf(image, *sift));
    image_of.insert(image_of.end(), features.back().pixels.size(),
                    static_cast<int>(features.size()) - 1);
  }
  std::vector<Match> matches;
  for (std::size_t a = 0; a < images.size(); ++a) {
    for (const int gap : options.gaps) {
      const std::size_t b = a + static_cast<std::size_t>(gap);
      if (b < images.size()) {
        for (const cv::DMatch& match : verifiedMatches(features[a], features[b], options)) {
          matches.push_back(
              {first_of[a] + match.queryIdx, first_of[b] + match.trainIdx, match.distance});
        }
      }
    }
  }
  // The surest first: a wrong match must not stand in the way of a right one.
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& x, const Match& y) { return x.distance < y.distance; });
  TrackSets sets(image_of);
  for (const Match& match : matches) {
    sets.join(match.first, match.second);
  }
  std::map<int, Track> tracks;  // in the order of their roots
  for (std::size_t i = 0; i < image_of.size(); ++i) {
    const int image = image_of[i];
    const auto within = i - static_cast<std::size_t>(first_of[static_cast<std::size_t>(image)]);
    const ImageFeatures& of_image = features[static_cast<std::size_t>(image)];
    tracks[sets.find(static_cast<int>(i))].push_back(
        {image, of_image.pixels[within], of_image.sizes[within]});
  }
  std::vector<Track> result;
  for (auto& track : tracks) {
    if (track.second.size() >= 2) {
      result.push_back(std::move(track.second));
    }
  }
  return result;
}

}  // namespace hmcdyn::calibrate
