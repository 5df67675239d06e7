// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// What one sighting says about whether a map point stands still.
struct LandmarkSighting {
  PointLabel label = PointLabel::kStatic;  ///< The filter's verdict on the key point.
  float weight = 1.0f;                     ///< Its weight, eq. 7.
  bool agrees = true;                      ///< It was matched, and agreed with the pose.
};

struct LandmarkTrustOptions {
  double prior = 0.5;      ///< Log-odds of a new point: it passed the filter once.
  double agreement = 0.4;  ///< Log-odds that a matched static sighting adds; a suspect's by weight.
  double contradiction = 0.8;  ///< Log-odds that a dynamic sighting takes.
  double limit = 4.0;     ///< Largest log-odds, so that a thing that starts to move is found out.
  double removal = -0.7;  ///< Points below are removed (log-odds).
  /// Points from here on may shape the map (log-odds): seen static twice.
  double threshold = 1.2;
};

/// The log-odds that a point stands still: the binary Bayes filter of occupancy grids (Moravec and
/// Elfes 1985), with the filter's verdicts as measurements. One wrong verdict on a wall is made up
/// for, and a person who pauses is not trusted at once.
struct LandmarkTrust {
  double log_odds = 0.0;

  void update(const LandmarkSighting& evidence, const LandmarkTrustOptions& options) {
    if (evidence.label == PointLabel::kDynamic) {
      log_odds -= options.contradiction;
    } else if (evidence.agrees && evidence.label == PointLabel::kStatic) {
      log_odds += options.agreement;
    } else if (evidence.agrees && evidence.label == PointLabel::kSuspect) {
      log_odds += options.agreement * static_cast<double>(evidence.weight);
    }
    log_odds = std::clamp(log_odds, -options.limit, options.limit);
  }

  /// 0 = moves .. 1 = stands still.
  double probability() const { return 1.0 / (1.0 + std::exp(-log_odds)); }
};

}  // namespace hmcdyn::slam
