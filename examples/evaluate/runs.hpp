// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/command_line.hpp"
#include "evaluate/relative_pose_error.hpp"

namespace hmcdyn::evaluate {

/// How many of the frames given to a system got a pose.
struct Tracking {
  std::size_t frames = 0;
  std::size_t tracked = 0;
};

/// An estimate with what the command asks to know about it.
struct Run {
  SystemFile source;
  bool is_baseline = false;
  std::optional<AteResult> ate;
  std::optional<RpeResult> rpe;
  std::optional<Tracking> tracking;
};

struct Evaluation {
  Trajectory groundtruth;
  std::vector<Run> runs;  ///< The baseline's first, else as given.
};

/// Reads and evaluates all that the arguments name. Time stamps in other units than seconds are
/// found out, the ground truth's by reviewStamps(), the others by where both overlap.
/// @param note takes what was assumed or left out, a sentence each; before anything is thrown.
/// @throws std::runtime_error naming the file at fault.
Evaluation evaluateRuns(const Arguments& arguments,
                        const std::function<void(const std::string&)>& note);

}  // namespace hmcdyn::evaluate
