// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/error_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

namespace hmcdyn::calibrate {
namespace {

constexpr double kOneSigma = 0.6827;

struct Bin {
  std::vector<double> depths;
  std::vector<double> errors;
  std::vector<double> variances;    // of the triangulation
  std::vector<double> differences;  // of neighbouring images' errors
};

std::vector<double> sizesOf(const std::vector<double>& values) {
  std::vector<double> sizes;
  sizes.reserve(values.size());
  for (const double value : values) {
    sizes.push_back(std::abs(value));
  }
  return sizes;
}

double medianOf(const std::vector<double>& values) { return percentile(values, 0.5); }

/// Least squares of a x + b y = target over equations (x, y, target), neither a nor b below 0.
std::array<double, 2> nonNegative(const std::vector<std::array<double, 3>>& equations) {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double x = 0.0;
  double y = 0.0;
  for (const auto& e : equations) {
    xx += e[0] * e[0];
    xy += e[0] * e[1];
    yy += e[1] * e[1];
    x += e[0] * e[2];
    y += e[1] * e[2];
  }
  const double determinant = xx * yy - xy * xy;
  if (determinant > 1e-9 * xx * yy) {
    const double a = (x * yy - y * xy) / determinant;
    const double b = (y * xx - x * xy) / determinant;
    if (a >= 0.0 && b >= 0.0) {
      return {a, b};
    }
  }
  // One of them is 0; the sum of squares falls by x^2 / xx or y^2 / yy with the other alone.
  return x * x * yy > y * y * xx ? std::array<double, 2>{x / xx, 0.0}
                                 : std::array<double, 2>{0.0, y / yy};
}

RangeStatistics statisticsOf(const Bin& bin, double nearest, double step) {
  RangeStatistics range;
  range.nearest = nearest;
  range.farthest = nearest + step;
  range.count = bin.errors.size();
  range.middle = medianOf(bin.depths);
  range.bias = medianOf(bin.errors);
  range.total = percentile(sizesOf(bin.errors), kOneSigma);
  range.noise = percentile(sizesOf(bin.differences), kOneSigma) / std::sqrt(2.0);
  range.systematic = std::sqrt(std::max(
      0.0, range.total * range.total - range.noise * range.noise - medianOf(bin.variances)));
  return range;
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto place = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place),
                   values.end());
  return values[place];
}

ErrorStatistics errorStatistics(const std::vector<DepthSample>& samples,
                                const std::vector<double>& depths, double truth_scale,
                                cv::Size image, const StatisticsOptions& options) {
  if (depths.size() != samples.size() || !(options.range_step > 0.0)) {
    throw std::invalid_argument(
        "errorStatistics: depths and samples differ in number, or "
        "range_step is not above 0");
  }
  std::map<int, Bin> bins;
  std::array<std::vector<double>, 9> regions;
  std::array<std::vector<double>, 2> by_edge;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const DepthSample& s = samples[i];
    const double truth = truth_scale * s.truth;
    const double error = depths[i] - truth;
    Bin& bin = bins[static_cast<int>(truth / options.range_step)];
    bin.depths.push_back(truth);
    bin.errors.push_back(error);
    bin.variances.push_back(truth_scale * truth_scale * s.sigma * s.sigma);
    if (i > 0 && samples[i - 1].track == s.track && samples[i - 1].image + 1 == s.image) {
      bin.differences.push_back(error - (depths[i - 1] - truth_scale * samples[i - 1].truth));
    }
    const int row = std::clamp(static_cast<int>(3.0 * s.v / image.height), 0, 2);
    const int column = std::clamp(static_cast<int>(3.0 * s.u / image.width), 0, 2);
    if (!s.at_edge) {  // there it would say on which side of things the points lie
      regions[static_cast<std::size_t>(3 * row + column)].push_back(error / truth);
    }
    by_edge[s.at_edge ? 1 : 0].push_back(std::abs(error) / (truth * truth));
  }
  ErrorStatistics statistics;
  for (const auto& bin : bins) {
    if (bin.second.errors.size() >= options.least_count &&
        bin.second.differences.size() >= options.least_count / 2) {
      statistics.ranges.push_back(
          statisticsOf(bin.second, bin.first * options.range_step, options.range_step));
    }
  }
  for (int i = 0; i < 9; ++i) {
    const auto& errors = regions[static_cast<std::size_t>(i)];
    if (errors.size() >= options.least_count) {
      statistics.regions.push_back(
          {i / 3, i % 3, errors.size(), medianOf(errors), percentile(sizesOf(errors), kOneSigma)});
    }
  }
  statistics.elsewhere = percentile(by_edge[0], kOneSigma);
  statistics.at_edges = percentile(by_edge[1], kOneSigma);
  statistics.edges = by_edge[1].size();
  return statistics;
}

DepthErrorModel fitModel(const std::vector<RangeStatistics>& ranges) {
  if (ranges.empty()) {
    throw std::runtime_error(
        "no range of depth has enough points to tell its error; is the recording long enough?");
  }
  std::vector<std::array<double, 3>> noise;
  std::vector<std::array<double, 3>> systematic;
  for (const RangeStatistics& range : ranges) {
    const double z = range.middle;
    // Both are differences of squares or of images: known to a share of the whole, even where they
    // are 0.
    const double unit = std::max(1e-5, range.total);
    noise.push_back({1.0 / unit, z * z / unit, range.noise / unit});
    systematic.push_back({z / unit, z * z / unit, range.systematic / unit});
  }
  const std::array<double, 2> of_noise = nonNegative(noise);
  const std::array<double, 2> of_systematic = nonNegative(systematic);
  DepthErrorModel model;
  model.noise_floor = static_cast<float>(of_noise[0]);
  model.noise_quadratic = static_cast<float>(of_noise[1]);
  model.systematic_linear = static_cast<float>(of_systematic[0]);
  model.systematic_quadratic = static_cast<float>(of_systematic[1]);
  return model;
}

}  // namespace hmcdyn::calibrate
