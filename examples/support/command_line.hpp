// SPDX-License-Identifier: BSD-3-Clause
// What the command lines of all programs have in common.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace hmcdyn::support {

/// The exit code for a command line that is not understood.
inline constexpr int kBadUsage = 2;

/// What an option's number has to be, with a message that says so: CLI11's own validators name the
/// largest double.
CLI::Validator aboveZero();
CLI::Validator zeroOrMore();
CLI::Validator zeroToOne();

/// The candidate that differs from `word` by the fewest letters inserted, left out, replaced or
/// swapped with their neighbour, or that starts with it; the first at a tie. Nothing where more
/// than a third of the letters differ (a word of two to five may differ by one).
std::optional<std::string> nearest(const std::string& word,
                                   const std::vector<std::string>& candidates);

/// What is wrong with a command line that has unknown options or an unknown command: a line each,
/// "unknown option --filtr; did you mean --filter?". Empty where there is none.
/// @param app after app.parse(), whether or not it threw.
std::string describeUnknown(const CLI::App& app);

/// Parses a command line, with --version added. `check` runs afterwards and may throw
/// CLI::ParseError, too.
/// @return nothing where the program may go on, else its exit code: 0 after --help and --version,
/// kBadUsage after a message on standard error.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const std::function<void()>& check = {});

/// Does a program's work. @return its exit code: 0, or 1 after "PROGRAM: what was thrown" on
/// standard error.
int exitCodeOf(const char* program, const std::function<void()>& work);

}  // namespace hmcdyn::support
