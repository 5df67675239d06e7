// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "evaluate/relative_pose_error.hpp"
#include "evaluate/truth_frame.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::evaluate {

enum class Command { kAte, kRpe, kSummary };

/// A trajectory and the system it is from. Files of one system are runs of it.
struct SystemFile {
  std::string system;
  std::filesystem::path file;
};

/// What the user asked for. Empty paths were not given.
struct Arguments {
  Command command = Command::kSummary;
  std::filesystem::path groundtruth;
  TruthFrame truth_frame = TruthFrame::kCamera;  ///< What its poses are of.
  std::vector<SystemFile> estimates;
  std::vector<SystemFile> baselines;           ///< Runs of one system.
  std::optional<double> tolerance;             ///< Association (s); not set: each metric's default.
  double offset = 0.0;                         ///< Added to the estimate's time stamps (s).
  std::optional<support::TimeUnit> time_unit;  ///< Of all files; none = found out.
  bool scale = false;                          ///< Fit a scale, too.
  double delta = 1.0;                          ///< RPE: distance of the poses of a pair.
  DeltaUnit delta_unit = DeltaUnit::kSeconds;
  std::optional<std::size_t> frames;   ///< Frames given to the system.
  std::filesystem::path associations;  ///< List of the frames given to the system.
  bool json = false;
  std::filesystem::path output;
  std::filesystem::path plot;
};

/// System of trajectories that were given without a name.
inline constexpr const char* kUnnamedSystem = "estimate";

/// Reads the command line. Help, version and usage errors are printed at once.
/// @return the arguments, or the exit code of a program that has nothing more to do: 0 after help,
/// 2 after a usage error.
std::variant<Arguments, int> parseCommandLine(int argc, const char* const* argv);

}  // namespace hmcdyn::evaluate
