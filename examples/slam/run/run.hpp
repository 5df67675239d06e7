// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>

#include <nlohmann/json_fwd.hpp>

#include "slam/detect/detector.hpp"
#include "slam/run/options.hpp"

namespace hmcdyn::slam {

/// Runs the system over a folder and writes its results as they come, so that a run that is killed
/// keeps what it had. A frame that cannot be read is reported, counted and skipped. Where a result
/// cannot be written, because the disk is full, say, the frames end there; the run finishes what it
/// has, writes what it can, and "write_failures" in the summary names file and reason. What the
/// threads of local mapping, loop closing and dense mapping throw costs their result and not the
/// run; what tracking throws after the first tracked frame ends the frames. The summary's "errors"
/// names both.
/// @param stop is asked before each frame; true ends the run as if the frames had ended.
/// @param detector in place of the one that the options name.
/// @return summary.json's content.
/// @throws std::invalid_argument for options that cannot be; whatever tracking throws before it has
/// tracked a frame.
/// @throws std::runtime_error naming the file where data set, model, calibration or output folder
/// cannot be used.
nlohmann::json runSlam(SlamOptions options, const std::function<bool()>& stop = {},
                       std::unique_ptr<ObjectDetector> detector = nullptr);

}  // namespace hmcdyn::slam
