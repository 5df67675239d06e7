// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include <hmcdyn/span.hpp>

namespace hmcdyn::evaluate {

/// What the TUM tools print about a list of errors, in the unit of the errors.
struct Statistics {
  double rmse = 0.0;      ///< Square root of the mean square.
  double mean = 0.0;      ///< Arithmetic mean.
  double median = 0.0;    ///< Middle value; of an even count the mean of the two middle values.
  double std = 0.0;       ///< Standard deviation of the population (divided by the count).
  double min = 0.0;       ///< Smallest value.
  double max = 0.0;       ///< Largest value.
  std::size_t count = 0;  ///< How many values.
};

/// Statistics of at least one value.
/// @throws std::invalid_argument when there is no value or one is not finite.
Statistics computeStatistics(Span<const double> values);

/// Median of at least one value; of an even count the mean of the two middle values.
/// @throws std::invalid_argument when there is no value.
double median(Span<const double> values);

}  // namespace hmcdyn::evaluate
