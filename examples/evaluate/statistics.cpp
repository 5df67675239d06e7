// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace hmcdyn::evaluate {

double median(Span<const double> values) {
  if (values.empty()) {
    throw std::invalid_argument("median: values has 0 elements; expected at least 1");
  }
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (sorted.size() % 2 == 1) {
    return *middle;
  }
  return 0.5 * (*std::max_element(sorted.begin(), middle) + *middle);
}

Statistics computeStatistics(Span<const double> values) {
  if (values.empty()) {
    throw std::invalid_argument("statistics: values has 0 elements; expected at least 1");
  }
  const Eigen::Map<const Eigen::ArrayXd> x(values.data(), static_cast<Eigen::Index>(values.size()));
  if (!x.isFinite().all()) {
    throw std::invalid_argument("statistics: values holds NaN or infinity; expected finite values");
  }
  Statistics result;
  result.rmse = std::sqrt(x.square().mean());
  result.mean = x.mean();
  result.median = median(values);
  result.std = std::sqrt((x - x.mean()).square().mean());
  result.min = x.minCoeff();
  result.max = x.maxCoeff();
  result.count = values.size();
  return result;
}

}  // namespace hmcdyn::evaluate
