// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/correction_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "evaluate/statistics.hpp"

namespace hmcdyn::calibrate {
namespace {

constexpr std::size_t kLeastSamples = 100;
/// Points that make a square between nodes known, about three to a corner, and the share of squares
/// that must be known: else most of the field is a guess from the side, which does more harm to a
/// run than the error that it is for.
constexpr std::size_t kPointsOfSquare = 10;
constexpr double kLeastKnown = 0.5;
constexpr double kMadToDeviation = 1.4826;  // of a normal distribution
constexpr double kBiweight = 4.685;         // 95 % efficient with normal noise

/// A sample as an equation in the unknowns scale - 1 and the nodes: row . x = right side, in units
/// of the depth.
struct Equation {
  const DepthSample* sample = nullptr;
  slam::GridWeights grid;
  double share = 1.0;  // of a track's samples, so that a point counts once
};

std::vector<Equation> equationsOf(const std::vector<DepthSample>& samples, cv::Size image,
                                  const CorrectionFitOptions& options) {
  std::map<int, int> samples_of;
  for (const DepthSample& sample : samples) {
    samples_of[sample.track] += sample.at_edge ? 0 : 1;
  }
  std::vector<Equation> equations;
  for (const DepthSample& sample : samples) {
    if (!sample.at_edge) {
      equations.push_back(
          {&sample, slam::gridWeights(options.rows, options.columns, sample.u, sample.v, image),
           1.0 / samples_of[sample.track]});
    }
  }
  return equations;
}

/// Which squares between nodes hold enough points, row by row.
std::vector<std::uint8_t> knownSquares(const std::vector<Equation>& equations, cv::Size image,
                                       const CorrectionFitOptions& options) {
  const auto part = [](double at, int size, int parts) {
    return std::clamp(static_cast<int>(at / size * parts), 0, parts - 1);
  };
  const int across = options.columns - 1;
  std::vector<std::set<int>> tracks(static_cast<std::size_t>((options.rows - 1) * across));
  for (const Equation& equation : equations) {
    const DepthSample& sample = *equation.sample;
    const int square = part(sample.v, image.height, options.rows - 1) * across +
                       part(sample.u, image.width, across);
    tracks[static_cast<std::size_t>(square)].insert(sample.track);
  }
  std::vector<std::uint8_t> known;
  known.reserve(tracks.size());
  for (const std::set<int>& of_square : tracks) {
    known.push_back(of_square.size() >= kPointsOfSquare ? 1 : 0);
  }
  return known;
}

/// Nearest and farthest depth (m) of all but the outermost hundredths.
std::array<double, 2> rangeOf(const std::vector<Equation>& equations) {
  std::vector<double> depths;
  depths.reserve(equations.size());
  for (const Equation& equation : equations) {
    depths.push_back(equation.sample->measured);
  }
  std::sort(depths.begin(), depths.end());
  const std::size_t margin = depths.size() / 100;
  return {depths[margin], depths[depths.size() - 1 - margin]};
}

/// Adds the priors: no scale error, no growth, and nodes that continue their neighbours.
void addPriors(Eigen::MatrixXd& normal, const CorrectionFitOptions& options, double smoothness) {
  normal(0, 0) += 1.0 / (options.scale_prior * options.scale_prior);
  const auto node = [&](int row, int column) { return 1 + row * options.columns + column; };
  const double bend = 1.0 / (smoothness * smoothness);
  const auto addDifference = [&](const std::vector<std::pair<int, double>>& terms) {
    for (const auto& a : terms) {
      for (const auto& b : terms) {
        normal(a.first, b.first) += bend * a.second * b.second;
      }
    }
  };
  for (int row = 0; row < options.rows; ++row) {
    for (int column = 0; column < options.columns; ++column) {
      normal(node(row, column), node(row, column)) +=
          1.0 / (options.growth_prior * options.growth_prior * options.rows * options.columns);
      if (row > 0 && row + 1 < options.rows) {
        addDifference({{node(row - 1, column), 1.0},
                       {node(row, column), -2.0},
                       {node(row + 1, column), 1.0}});
      }
      if (column > 0 && column + 1 < options.columns) {
        addDifference({{node(row, column - 1), 1.0},
                       {node(row, column), -2.0},
                       {node(row, column + 1), 1.0}});
      }
      if (row + 1 < options.rows && column + 1 < options.columns) {
        addDifference({{node(row, column), 1.0},
                       {node(row + 1, column), -1.0},
                       {node(row, column + 1), -1.0},
                       {node(row + 1, column + 1), 1.0}});
      }
    }
  }
}

/// What is left of an equation: relative, so that near and far points speak alike.
double residualOf(const Equation& equation, const Eigen::VectorXd& x, double truth_scale) {
  const double depth = equation.sample->measured;
  double growth = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    growth += equation.grid.weight[i] * x[1 + equation.grid.node[i]];
  }
  return 1.0 + x[0] + growth * depth - truth_scale * equation.sample->truth / depth;
}

double robustDeviation(const std::vector<Equation>& equations, const Eigen::VectorXd& x,
                       double truth_scale) {
  std::vector<double> sizes;
  sizes.reserve(equations.size());
  for (const Equation& equation : equations) {
    sizes.push_back(std::abs(residualOf(equation, x, truth_scale)));
  }
  return std::max(1e-6, kMadToDeviation * evaluate::median(sizes));
}

Eigen::VectorXd solve(const std::vector<Equation>& equations, const CorrectionFitOptions& options,
                      double smoothness, double truth_scale) {
  constexpr int kIterations = 12;
  const Eigen::Index unknowns = 1 + options.rows * options.columns;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double deviation = robustDeviation(equations, x, truth_scale);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    addPriors(normal, options, smoothness);
    for (const Equation& equation : equations) {
      const double depth = equation.sample->measured;
      const double share = residualOf(equation, x, truth_scale) / (kBiweight * deviation);
      if (std::abs(share) >= 1.0) {
        continue;
      }
      const double biweight = (1.0 - share * share) * (1.0 - share * share);
      const double weight = equation.share * biweight / (deviation * deviation);
      std::array<Eigen::Index, 5> index{};
      std::array<double, 5> value{1.0};
      for (std::size_t i = 0; i < 4; ++i) {
        index[i + 1] = 1 + equation.grid.node[i];
        value[i + 1] = equation.grid.weight[i] * depth;
      }
      const double target = truth_scale * equation.sample->truth / depth - 1.0;
      for (std::size_t a = 0; a < 5; ++a) {
        right[index[a]] += weight * value[a] * target;
        for (std::size_t b = 0; b < 5; ++b) {
          normal(index[a], index[b]) += weight * value[a] * value[b];
        }
      }
    }
    x = normal.ldlt().solve(right);
  }
  return x;
}

slam::DepthCorrection correctionOf(const Eigen::VectorXd& x, const CorrectionFitOptions& options) {
  slam::DepthCorrection correction;
  correction.scale = 1.0 + x[0];
  correction.rows = options.rows;
  correction.columns = options.columns;
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    correction.growth.push_back(x[i]);
  }
  return correction;
}

/// The equations of every second track, or of the others.
std::vector<Equation> half(const std::vector<Equation>& equations, int parity) {
  std::vector<Equation> part;
  for (const Equation& equation : equations) {
    if (equation.sample->track % 2 == parity) {
      part.push_back(equation);
    }
  }
  return part;
}

/// Median of the relative errors of each half after the fit to the other.
double heldOutError(const std::vector<Equation>& equations, const CorrectionFitOptions& options,
                    double smoothness, double truth_scale) {
  std::vector<double> errors;
  for (const int parity : {0, 1}) {
    const Eigen::VectorXd x = solve(half(equations, 1 - parity), options, smoothness, truth_scale);
    for (const Equation& equation : half(equations, parity)) {
      errors.push_back(std::abs(residualOf(equation, x, truth_scale)));
    }
  }
  return evaluate::median(errors);
}

double medianRatio(const std::vector<Equation>& equations, const slam::DepthCorrection& correction,
                   cv::Size image) {
  std::vector<double> ratios;
  for (const Equation& equation : equations) {
    const DepthSample& s = *equation.sample;
    ratios.push_back(corrected(correction, s.measured, s.u, s.v, image) / s.measured);
  }
  return evaluate::median(ratios);
}

void divide(slam::DepthCorrection& correction, double by) {
  correction.scale /= by;
  for (double& node : correction.growth) {
    node /= by;
  }
}

}  // namespace

double corrected(const slam::DepthCorrection& correction, double depth, double u, double v,
                 cv::Size image) {
  return depth * (correction.scale + slam::growthAt(correction, u, v, image) * depth);
}

CorrectionFit fitCorrection(const std::vector<DepthSample>& samples, cv::Size image,
                            const CorrectionFitOptions& options) {
  const std::vector<Equation> equations = equationsOf(samples, image, options);
  if (equations.size() < kLeastSamples || half(equations, 0).empty() ||
      half(equations, 1).empty()) {
    throw std::runtime_error(fmt::format(
        "{} depths away from edges could be triangulated; expected at least {}: the camera must "
        "move sideways, and see texture with depth",
        equations.size(), kLeastSamples));
  }
  CorrectionFit fit;
  fit.known_squares = knownSquares(equations, image, options);
  fit.known_range = rangeOf(equations);
  const auto squares = fit.known_squares.size();
  const auto known = std::count(fit.known_squares.begin(), fit.known_squares.end(), 1);
  if (static_cast<double>(known) < kLeastKnown * static_cast<double>(squares)) {
    throw std::runtime_error(fmt::format(
        "depths of at least {} points could be compared in {} of {} parts of the image; expected "
        "half of them: move the camera so that texture with depth passes through all of it",
        kPointsOfSquare, known, squares));
  }
  if (!options.scale_known) {
    std::vector<double> ratios;
    ratios.reserve(equations.size());
    for (const Equation& equation : equations) {
      ratios.push_back(equation.sample->measured / equation.sample->truth);
    }
    fit.truth_scale = evaluate::median(ratios);
  }
  fit.held_out_after = std::numeric_limits<double>::infinity();
  for (const double smoothness : options.smoothness) {
    const double error = heldOutError(equations, options, smoothness, fit.truth_scale);
    if (error < fit.held_out_after) {
      fit.held_out_after = error;
      fit.smoothness = smoothness;
    }
  }
  const auto fitTo = [&](const std::vector<Equation>& part) {
    return correctionOf(solve(part, options, fit.smoothness, fit.truth_scale), options);
  };
  fit.correction = fitTo(equations);
  std::array<slam::DepthCorrection, 2> of_others{fitTo(half(equations, 1)),
                                                 fitTo(half(equations, 0))};
  if (!options.scale_known) {
    const double mean = medianRatio(equations, fit.correction, image);
    divide(fit.correction, mean);
    divide(of_others[0], mean);
    divide(of_others[1], mean);
    fit.truth_scale /= mean;
  }
  std::vector<double> before;
  for (const DepthSample& s : samples) {
    const auto& correction = of_others[static_cast<std::size_t>(s.track % 2)];
    fit.held_out.push_back(corrected(correction, s.measured, s.u, s.v, image));
    if (!s.at_edge) {
      before.push_back(std::abs(s.measured / (fit.truth_scale * s.truth) - 1.0));
    }
  }
  fit.held_out_before = evaluate::median(before);
  return fit;
}

}  // namespace hmcdyn::calibrate
