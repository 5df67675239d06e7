// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/command_line.hpp"
#include "evaluate/runs.hpp"

namespace hmcdyn::evaluate {

/// A table for people: a row a run, median and spread of systems with several runs, improvement
/// over the baseline (eq. 12).
std::string toTable(const Arguments& arguments, const std::vector<Run>& runs);

/// JSON. A single run without a baseline: its statistics at the top. Otherwise `runs`, the same a
/// run, and `systems`, with statistics over the runs of each and its improvement in per cent.
std::string toJson(const Arguments& arguments, const std::vector<Run>& runs);

}  // namespace hmcdyn::evaluate
