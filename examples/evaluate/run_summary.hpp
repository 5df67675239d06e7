// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hmcdyn::evaluate {

/// Root mean square and standard deviation of an error over a trajectory.
struct ErrorSummary {
  double rmse = 0.0;
  double sd = 0.0;
};

/// What summary.json of one run of hmcdyn_slam says.
struct RunSummary {
  std::string sequence;                     ///< Name of the sequence's folder.
  std::string variant;                      ///< Which system, or which ablation.
  std::string name;                         ///< Which of its runs.
  std::size_t frames = 0;                   ///< Given to the system, F_I of eq. 11.
  std::size_t tracked = 0;                  ///< F_O of eq. 11.
  double tracking_ms = 0.0;                 ///< CPU time of the tracking thread a frame (ms).
  std::optional<ErrorSummary> ate;          ///< (m); none without a ground truth.
  std::optional<ErrorSummary> translation;  ///< RPE (m/s); none for a short clip.
  std::optional<ErrorSummary> rotation;     ///< RPE (deg/s).
};

/// Reads summary.json of a run that came to its end.
/// @throws std::runtime_error naming the file when it is missing, cut off, malformed or of a run
/// that was stopped.
RunSummary readRunSummary(const std::filesystem::path& file);

/// All runs of a folder.
struct RunCollection {
  std::vector<RunSummary> runs;
  std::vector<std::string> unfinished;  ///< Run folders without a usable summary, and why.
};

/// Reads FOLDER/sequence/variant/run/summary.json, ordered by these names.
/// @throws std::runtime_error when `folder` is no folder.
RunCollection collectRuns(const std::filesystem::path& folder);

}  // namespace hmcdyn::evaluate
