// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "slam/pipeline/options.hpp"

namespace hmcdyn::slam {

/// Runs the system over a folder and writes its results as they come, so that a run that is killed
/// keeps what it had. A frame that cannot be read is reported, counted and skipped.
/// @param stop is asked before each frame; true ends the run as if the frames had ended.
/// @return summary.json's content.
/// @throws std::invalid_argument for options that cannot be.
/// @throws std::runtime_error naming the file where data set, model, calibration or output folder
/// cannot be used.
nlohmann::json runSlam(SlamOptions options, const std::function<bool()>& stop = {});

}  // namespace hmcdyn::slam
