// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/descriptor_matcher.hpp"

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kFar = 8 * kDescriptorBytes + 1;

void check(const char* argument, const cv::Mat& descriptors) {
  if (!descriptors.empty() &&
      (descriptors.type() != CV_8UC1 || descriptors.cols != kDescriptorBytes)) {
    throw std::invalid_argument(
        std::string(argument) + " has type " + std::to_string(descriptors.type()) + " and " +
        std::to_string(descriptors.cols) + " columns, expected CV_8U (0) and 32");
  }
}

struct Nearest {
  int index = -1;
  int best = kFar;
  int second = kFar;

  void offer(int candidate, int distance) {
    if (distance < best) {
      second = best;
      best = distance;
      index = candidate;
    } else if (distance < second) {
      second = distance;
    }
  }
};

bool isClear(const Nearest& nearest, const DescriptorMatcherOptions& options) {
  return nearest.best <= options.max_distance && nearest.best < nearest.second &&
         static_cast<float>(nearest.best) <= options.max_ratio * static_cast<float>(nearest.second);
}

}  // namespace

std::vector<DescriptorMatch> matchDescriptors(const cv::Mat& from, const cv::Mat& to,
                                              const DescriptorMatcherOptions& options) {
  check("from", from);
  check("to", to);
  std::vector<Nearest> of_from(static_cast<std::size_t>(from.rows));
  std::vector<Nearest> of_to(static_cast<std::size_t>(to.rows));
  for (int i = 0; i < from.rows; ++i) {
    const auto* descriptor = from.ptr<std::uint8_t>(i);
    for (int j = 0; j < to.rows; ++j) {
      const int distance = hammingDistance(descriptor, to.ptr<std::uint8_t>(j));
      of_from[static_cast<std::size_t>(i)].offer(j, distance);
      of_to[static_cast<std::size_t>(j)].offer(i, distance);
    }
  }
  std::vector<DescriptorMatch> matches;
  for (int i = 0; i < from.rows; ++i) {
    const Nearest& nearest = of_from[static_cast<std::size_t>(i)];
    if (nearest.index >= 0 && isClear(nearest, options) &&
        of_to[static_cast<std::size_t>(nearest.index)].index == i &&
        isClear(of_to[static_cast<std::size_t>(nearest.index)], options)) {
      matches.push_back({i, nearest.index, nearest.best});
    }
  }
  return matches;
}

}  // namespace hmcdyn::slam
