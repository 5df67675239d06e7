// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "evaluate/runs.hpp"

namespace hmcdyn::evaluate {

/// A picture of 1600 x 800 pixels: on the left the ground truth and the aligned estimates in the
/// plane of the truth's two axes of largest extent, one scale for both; on the right the absolute
/// trajectory error over time. `offset` is what was added to the estimates' stamps (s). Runs of one
/// system share a colour. Lines break where time stamps are missing.
/// @throws std::invalid_argument when there is no run or one lacks its ATE.
cv::Mat drawRuns(const Evaluation& evaluation, double offset = 0.0);

}  // namespace hmcdyn::evaluate
