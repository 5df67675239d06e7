// SPDX-License-Identifier: BSD-3-Clause
// Measures the extractor against cv::ORB on a folder of real frames: time, matches between frames,
// their spread, and how precisely points are found again in warped frames.
// Usage: measure_features FOLDER (of PNG files, in order of time)

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/features/hamming_distance.hpp"
#include "slam/features/orb_extractor.hpp"

namespace hmcdyn::slam {
namespace {

using Extract = std::function<Features(const cv::Mat&)>;
constexpr int kLargestDistance = 64;  // of a match (bits)

double threadMs() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Positions in both images of the pairs that are each other's nearest.
struct Matches {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
};

Matches match(const Features& a, const Features& b) {
  const auto nearest = [](const Features& from, int i, const Features& to) {
    std::pair<int, int> best(kDescriptorBytes * 8 + 1, -1);
    for (int j = 0; j < to.descriptors.rows; ++j) {
      const int distance =
          hammingDistance(from.descriptors.ptr<uchar>(i), to.descriptors.ptr<uchar>(j));
      best = std::min(best, {distance, j});
    }
    return best;
  };
  Matches matches;
  for (int i = 0; i < a.descriptors.rows; ++i) {
    const auto [distance, j] = nearest(a, i, b);
    if (distance <= kLargestDistance && nearest(b, j, a).second == i) {
      matches.from.push_back(a.key_points[static_cast<std::size_t>(i)].pt);
      matches.to.push_back(b.key_points[static_cast<std::size_t>(j)].pt);
    }
  }
  return matches;
}

void measureTime(const std::vector<cv::Mat>& frames, const Extract& ours, const Extract& theirs) {
  std::vector<double> our_ms;
  std::vector<double> their_ms;
  std::vector<double> ratios;
  for (int round = 0; round < 5; ++round) {
    for (const cv::Mat& frame : frames) {  // interleaved, so that other load hits both
      const double start = threadMs();
      ours(frame);
      const double between = threadMs();
      theirs(frame);
      const double end = threadMs();
      our_ms.push_back(between - start);
      their_ms.push_back(end - between);
      ratios.push_back(our_ms.back() / their_ms.back());
    }
  }
  std::printf("CPU time, median: hmcdyn %.2f ms, cv::ORB %.2f ms, ratio %.3f (least: %.2f, %.2f)\n",
              median(our_ms), median(their_ms), median(ratios),
              *std::min_element(our_ms.begin(), our_ms.end()),
              *std::min_element(their_ms.begin(), their_ms.end()));
}

void measurePairs(const char* name, const std::vector<cv::Mat>& frames, const Extract& extract) {
  std::vector<Features> features;
  std::transform(frames.begin(), frames.end(), std::back_inserter(features), extract);
  for (const std::size_t gap : {1U, 3U, 8U}) {
    double inliers = 0.0;
    double cells = 0.0;
    int pairs = 0;
    for (std::size_t i = 0; i + gap < features.size(); i += 3, ++pairs) {
      const Matches matches = match(features[i], features[i + gap]);
      if (matches.from.size() < 8) {
        continue;
      }
      cv::Mat good;
      cv::findFundamentalMat(matches.from, matches.to, cv::USAC_MAGSAC, 1.0, 0.999, 5000, good);
      std::set<std::pair<int, int>> occupied;
      for (int k = 0; k < good.rows; ++k) {
        if (good.at<uchar>(k) != 0) {
          const cv::Point2f p = matches.from[static_cast<std::size_t>(k)];
          occupied.insert({static_cast<int>(p.x) / 32, static_cast<int>(p.y) / 32});
        }
      }
      inliers += cv::countNonZero(good);
      cells += static_cast<double>(occupied.size());
    }
    std::printf("%-8s %zu frames apart: %.0f inliers of F in %.0f cells of 32x32 px\n", name, gap,
                inliers / pairs, cells / pairs);
  }
}

void measureWarps(const char* name, const std::vector<cv::Mat>& frames, const Extract& extract) {
  cv::RNG random(7);
  std::vector<double> errors;
  double correct = 0.0;
  int warps = 0;
  for (std::size_t i = 0; i < frames.size(); i += 5, ++warps) {
    const cv::Mat& frame = frames[i];
    const cv::Point2f centre(0.5f * static_cast<float>(frame.cols - 1),
                             0.5f * static_cast<float>(frame.rows - 1));
    const cv::Matx23d map = cv::Mat(
        cv::getRotationMatrix2D(centre, random.uniform(-30.0, 30.0), random.uniform(0.8, 1.25)));
    cv::Mat warped;
    cv::warpAffine(frame, warped, map, frame.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
    cv::Mat noise(frame.size(), CV_16S);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(warped, noise, warped, cv::noArray(), CV_8U);
    const Matches matches = match(extract(frame), extract(warped));
    for (std::size_t k = 0; k < matches.from.size(); ++k) {
      const cv::Point2f p = matches.from[k];
      const cv::Vec2d expected = map * cv::Vec3d(p.x, p.y, 1.0);
      const double error = std::hypot(matches.to[k].x - expected[0], matches.to[k].y - expected[1]);
      if (error < 4.0) {
        correct += 1.0;
        errors.push_back(error);
      }
    }
  }
  std::printf("%-8s warped: %.0f matches within 4 px, median error %.3f px\n", name,
              correct / warps, median(errors));
}

int run(const std::string& folder) {
  std::vector<cv::String> files;
  cv::glob(folder + "/*.png", files);
  std::vector<cv::Mat> frames;
  for (const cv::String& file : files) {
    frames.push_back(cv::imread(file, cv::IMREAD_GRAYSCALE));
    if (frames.back().empty()) {
      throw std::runtime_error(file + ": cannot be read as an image");
    }
  }
  if (frames.size() < 9) {
    throw std::runtime_error(folder + ": fewer than 9 PNG files");
  }
  cv::setNumThreads(1);
  OrbExtractor extractor;
  const auto orb = cv::ORB::create(extractor.options().features);
  const Extract ours = [&](const cv::Mat& image) { return extractor.extract(image); };
  const Extract theirs = [&](const cv::Mat& image) {
    Features features;
    orb->detectAndCompute(image, {}, features.key_points, features.descriptors);
    return features;
  };
  measureTime(frames, ours, theirs);
  for (const auto& [name, extract] : {std::pair("hmcdyn", ours), std::pair("cv::ORB", theirs)}) {
    measurePairs(name, frames, extract);
    measureWarps(name, frames, extract);
  }
  return 0;
}

}  // namespace
}  // namespace hmcdyn::slam

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: measure_features FOLDER\n");
    return 2;
  }
  try {
    return hmcdyn::slam::run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measure_features: %s\n", error.what());
    return 1;
  }
}
