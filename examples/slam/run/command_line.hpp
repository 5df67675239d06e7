// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "slam/run/options.hpp"

namespace hmcdyn::slam {

/// Declares every option of hmcdyn_slam, with unit and default, so that parsing fills `options`.
/// `app` and `options` must live until the parsing.
void declareOptions(CLI::App& app, SlamOptions& options);

}  // namespace hmcdyn::slam
