// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "slam/output/report/report.hpp"

namespace hmcdyn::slam {

/// Up to so many frames the charts show all; of a longer run at most as many, the last one, and two
/// a closed loop. A chart is some 1000 px wide.
inline constexpr std::size_t kMostFramesShown = 2100;

/// The frames that charts show, as places in input.frames in rising order. Of a long run, out of
/// each of 300 stretches of equally many frames: the first one, the first one that was lost, and
/// those with the largest error, time of all stages, dynamic points and boxes, and the fewest
/// static points, so that peaks stay; and the frames of the first 500 closed loops.
std::vector<std::size_t> framesToShow(const ReportInput& input);

}  // namespace hmcdyn::slam
