// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <vector>

namespace hmcdyn::slam {
namespace {

constexpr double kPi = 3.14159265358979323846;

// All of this was chosen by measuring matches on warped and on consecutive real frames; none of it
// is critical.
constexpr std::uint32_t kSeed = 1;
constexpr std::size_t kCandidates = 32768;
constexpr double kSigma = (2 * kPatternRadius + 1) / 5.0;  // px; BRIEF's G(0, S^2 / 25)
constexpr double kCorrelationLength = 4.0;                 // px
constexpr double kLargestCorrelation = 0.3;                // of two bits
constexpr double kDeviationWeight = 0.5;                   // against the bias, in the ranking

struct Point {
  int x = 0;
  int y = 0;
};

struct Test {
  Point a;
  Point b;
  double deviation = 0.0;  // standard deviation of I(a) - I(b)
  std::int64_t rank = 0;   // the smaller the better
};

/// The field's covariance, by squared distance (px^2): exp(-r / length), smooth at 0.
class Covariance {
 public:
  double operator()(Point p, Point q) const {
    const int dx = p.x - q.x;
    const int dy = p.y - q.y;
    return values_[static_cast<std::size_t>(dx * dx + dy * dy)];
  }

 private:
  static constexpr int kLargestDistance = 2 * kPatternRadius;
  std::vector<double> values_ = [] {
    std::vector<double> values;
    for (int squared = 0; squared <= kLargestDistance * kLargestDistance; ++squared) {
      values.push_back(std::exp(-std::sqrt(squared + 1.0) / kCorrelationLength));
    }
    return values;
  }();
};

/// How a bit leans once the patch is turned: with m10 and m01 the first moments of the patch,
/// turning makes m01 = 0 and m10 > 0, which is Rayleigh distributed before.
class CentroidModel {
 public:
  explicit CentroidModel(const Covariance& covariance) {
    std::vector<Point> disc;
    for (int y = -kCentroidRadius; y <= kCentroidRadius; ++y) {
      for (int x = -kCentroidRadius; x <= kCentroidRadius; ++x) {
        if (x * x + y * y <= kCentroidRadius * kCentroidRadius) {
          disc.push_back({x, y});
        }
      }
    }
    for (int y = -kPatternRadius; y <= kPatternRadius; ++y) {
      for (int x = -kPatternRadius; x <= kPatternRadius; ++x) {
        double sum = 0.0;
        if (x * x + y * y <= kPatternRadius * kPatternRadius) {
          for (const Point& p : disc) {
            sum += p.x * covariance(p, {x, y});
          }
        }
        with_moment_.push_back(sum);
      }
    }
    for (const Point& p : disc) {
      moment_variance_ += p.x * withMoment(p.x, p.y);
    }
  }

  /// |mean| of I(a) - I(b) in units of its remaining standard deviation.
  double bias(const Test& test) const {
    const double m10 = withMoment(test.a.x, test.a.y) - withMoment(test.b.x, test.b.y);
    const double m01 = withMoment(test.a.y, test.a.x) - withMoment(test.b.y, test.b.x);
    const double mean = m10 * std::sqrt(kPi / 2.0 / moment_variance_);
    const double variance =
        test.deviation * test.deviation - (m10 * m10 + m01 * m01) / moment_variance_;
    return std::abs(mean) / std::sqrt(std::max(variance, 1e-9));
  }

 private:
  /// Covariance of I(x, y) with m10; by symmetry that of I(y, x) with m01.
  double withMoment(int x, int y) const {
    constexpr int kSide = 2 * kPatternRadius + 1;
    return with_moment_[static_cast<std::size_t>((y + kPatternRadius) * kSide + x +
                                                 kPatternRadius)];
  }

  std::vector<double> with_moment_;
  double moment_variance_ = 0.0;
};

/// Normally distributed points inside the pattern's radius. Box and Muller's transform, since
/// std::normal_distribution differs between standard libraries.
class PointSource {
 public:
  Point draw() {
    for (;;) {
      const double radius = kSigma * std::sqrt(-2.0 * std::log(uniform()));
      const double angle = 2.0 * kPi * uniform();
      const Point point{static_cast<int>(std::lround(radius * std::cos(angle))),
                        static_cast<int>(std::lround(radius * std::sin(angle)))};
      if (point.x * point.x + point.y * point.y <= kPatternRadius * kPatternRadius) {
        return point;
      }
    }
  }

 private:
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }

  // NOLINTNEXTLINE(cert-msc32-c,cert-msc51-cpp): the same pattern every time
  std::mt19937 random_{kSeed};
};

std::vector<Test> rankedCandidates(const Covariance& covariance) {
  const CentroidModel model(covariance);
  PointSource source;
  std::vector<Test> candidates;
  while (candidates.size() < kCandidates) {
    Test test{source.draw(), source.draw()};
    const double variance = 2.0 * (covariance(test.a, test.a) - covariance(test.a, test.b));
    if (variance <= 0.0) {
      continue;  // both points are one
    }
    test.deviation = std::sqrt(variance);
    // Whole numbers, so that mirror images tie on every machine, and the order drawn decides.
    test.rank = std::llround(1e6 * (model.bias(test) - kDeviationWeight * test.deviation));
    candidates.push_back(test);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Test& a, const Test& b) { return a.rank < b.rank; });
  return candidates;
}

}  // namespace

OrbPattern makeOrbPattern() {
  const Covariance covariance;
  // Two signs of jointly normal differences with correlation r correlate by 2/pi asin(r).
  const double largest = std::sin(kPi / 2.0 * kLargestCorrelation) + 1e-9;
  const auto independent = [&](const Test& s, const Test& t) {
    const double common =
        covariance(s.a, t.a) - covariance(s.a, t.b) - covariance(s.b, t.a) + covariance(s.b, t.b);
    return std::abs(common) <= largest * s.deviation * t.deviation;
  };
  std::vector<Test> chosen;
  for (const Test& test : rankedCandidates(covariance)) {
    if (std::all_of(chosen.begin(), chosen.end(),
                    [&](const Test& other) { return independent(test, other); })) {
      chosen.push_back(test);
      if (chosen.size() == kDescriptorBits) {
        break;
      }
    }
  }
  if (chosen.size() < kDescriptorBits) {
    throw std::logic_error("ORB pattern: too few uncorrelated tests for these constants");
  }
  OrbPattern pattern;
  for (std::size_t i = 0; i < kDescriptorBits; ++i) {
    pattern.x[i] = static_cast<float>(chosen[i].a.x);
    pattern.y[i] = static_cast<float>(chosen[i].a.y);
    pattern.x[i + kDescriptorBits] = static_cast<float>(chosen[i].b.x);
    pattern.y[i + kDescriptorBits] = static_cast<float>(chosen[i].b.y);
  }
  return pattern;
}

}  // namespace hmcdyn::slam
