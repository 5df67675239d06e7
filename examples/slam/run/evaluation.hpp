// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace hmcdyn::slam {

/// ATE and RPE (1 s) of a trajectory, or an object with "error" where they cannot be computed.
nlohmann::json evaluateTrajectory(const std::filesystem::path& groundtruth,
                                  const std::filesystem::path& estimate);

}  // namespace hmcdyn::slam
