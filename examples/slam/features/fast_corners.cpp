// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <opencv2/core/hal/intrin.hpp>

namespace hmcdyn::slam {
namespace {

using Lanes = cv::v_uint8x16;
constexpr int kLanes = Lanes::nlanes;

constexpr std::size_t kRing = 16;
constexpr std::array<int, kRing> kRingX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
constexpr std::array<int, kRing> kRingY{3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};

/// The largest, over the 16 arcs of 9 ring pixels, of the smallest difference in the arc.
CV_ALWAYS_INLINE Lanes strongestArc(const std::array<Lanes, kRing>& d) {
  std::array<Lanes, kRing / 2> pairs;  // d[2i+1], d[2i+2]
  std::array<Lanes, kRing / 2> quads;  // d[2i+1] .. d[2i+4]
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = cv::v_min(d[2 * i + 1], d[(2 * i + 2) % kRing]);
  }
  for (std::size_t i = 0; i < quads.size(); ++i) {
    quads[i] = cv::v_min(pairs[i], pairs[(i + 1) % pairs.size()]);
  }
  Lanes strongest = cv::v_setzero_u8();
  for (std::size_t i = 0; i < quads.size(); ++i) {
    // Two arcs share d[2i+1] .. d[2i+8]; one adds the pixel before, the other the pixel after.
    const Lanes eight = cv::v_min(quads[i], quads[(i + 2) % quads.size()]);
    const Lanes ninth = cv::v_max(d[2 * i], d[(2 * i + 9) % kRing]);
    strongest = cv::v_max(strongest, cv::v_min(eight, ninth));
  }
  return strongest;
}

/// Scores of 16 pixels in a row from `p` on.
Lanes scoreLanes(const uchar* p, const std::array<int, kRing>& ring, const Lanes& threshold) {
  const auto at = [&](std::size_t i) { return cv::v_load(p + ring[i]); };
  const Lanes centre = cv::v_load(p);
  const Lanes bright = centre + threshold;  // saturating, as all 8-bit lane arithmetic here
  const Lanes dark = centre - threshold;
  // An arc of 9 holds at least one of any two opposite pixels.
  const Lanes high = cv::v_min(cv::v_max(at(0), at(8)), cv::v_max(at(4), at(12)));
  const Lanes low = cv::v_max(cv::v_min(at(0), at(8)), cv::v_min(at(4), at(12)));
  if (!cv::v_check_any((high > bright) | (low < dark))) {
    return cv::v_setzero_u8();
  }
  std::array<Lanes, kRing> brighter;
  std::array<Lanes, kRing> darker;
  for (std::size_t i = 0; i < kRing; ++i) {
    const Lanes pixel = at(i);
    brighter[i] = pixel - centre;
    darker[i] = centre - pixel;
  }
  const Lanes score = cv::v_max(strongestArc(brighter), strongestArc(darker));
  return score & (score > threshold);
}

/// Bit i is set where pixel i of a row is a local maximum above 0.
unsigned maximaMask(const uchar* above, const uchar* row, const uchar* below) {
  const auto three = [](const uchar* p) {
    return cv::v_max(cv::v_max(cv::v_load(p - 1), cv::v_load(p)), cv::v_load(p + 1));
  };
  const Lanes score = cv::v_load(row);
  const Lanes before = cv::v_max(three(above), cv::v_load(row - 1));
  const Lanes after = cv::v_max(three(below), cv::v_load(row + 1));
  return static_cast<unsigned>(cv::v_signmask((score > before) & (score >= after)));
}

/// Scores of three pixels in a row, weighted 1-2-1.
int smoothedRow(const uchar* centre) { return centre[-1] + 2 * centre[0] + centre[1]; }

float parabolaVertex(int before, int centre, int after) {
  const int curvature = before - 2 * centre + after;
  if (curvature >= 0) {
    return 0.0f;
  }
  const float vertex = 0.5f * static_cast<float>(before - after) / static_cast<float>(curvature);
  return std::clamp(vertex, -0.5f, 0.5f);
}

}  // namespace

cv::Mat fastScores(const cv::Mat& image, const cv::Rect& region, int threshold, cv::Mat buffer) {
  cv::Mat scores = std::move(buffer);
  scores.create(image.size(), CV_8U);
  std::array<int, kRing> ring{};
  for (std::size_t i = 0; i < kRing; ++i) {
    ring[i] = kRingY[i] * static_cast<int>(image.step) + kRingX[i];
  }
  const Lanes lanes_threshold = cv::v_setall_u8(static_cast<uchar>(threshold));
  const int end = region.x + region.width;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const uchar* pixels = image.ptr<uchar>(y);
    uchar* row = scores.ptr<uchar>(y);
    for (int first = region.x; first < end; first += kLanes) {
      const int x = std::min(first, end - kLanes);  // the last block overlaps its neighbour
      cv::v_store(row + x, scoreLanes(pixels + x, ring, lanes_threshold));
    }
  }
  return scores;
}

std::vector<Corner> localMaxima(const cv::Mat& scores, const cv::Rect& region) {
  std::vector<Corner> corners;
  const Lanes none = cv::v_setzero_u8();
  const int end = region.x + region.width;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const uchar* above = scores.ptr<uchar>(y - 1);
    const uchar* row = scores.ptr<uchar>(y);
    const uchar* below = scores.ptr<uchar>(y + 1);
    for (int first = region.x; first < end; first += kLanes) {
      const int x = std::min(first, end - kLanes);
      if (!cv::v_check_any(cv::v_load(row + x) != none)) {
        continue;
      }
      unsigned mask = maximaMask(above + x, row + x, below + x) >> (first - x);
      for (; mask != 0; mask &= mask - 1) {
        const int column = first + __builtin_ctz(mask);
        const int strength = smoothedRow(above + column) + 2 * smoothedRow(row + column) +
                             smoothedRow(below + column);
        corners.push_back({column, y, row[column], strength});
      }
    }
  }
  return corners;
}

cv::Point2f subPixelOffset(const cv::Mat& scores, int x, int y) {
  const uchar* above = scores.ptr<uchar>(y - 1) + x;
  const uchar* row = scores.ptr<uchar>(y) + x;
  const uchar* below = scores.ptr<uchar>(y + 1) + x;
  const auto column = [&](int dx) { return above[dx] + 2 * row[dx] + below[dx]; };
  return {parabolaVertex(column(-1), column(0), column(1)),
          parabolaVertex(smoothedRow(above), smoothedRow(row), smoothedRow(below))};
}

}  // namespace hmcdyn::slam
