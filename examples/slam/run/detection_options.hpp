// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "slam/run/options.hpp"

namespace hmcdyn::slam {

/// Declares the options of the group "Detection": which detector, its files and its bounds.
void declareDetection(CLI::App& app, SlamOptions& options);

}  // namespace hmcdyn::slam
