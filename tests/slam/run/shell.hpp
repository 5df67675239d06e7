// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace hmcdyn::slam::test {

/// What came of a command.
struct Outcome {
  int exit_code = -1;
  std::string text;  ///< Standard output and error.
};

inline Outcome runShell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  if (pipe == nullptr) {
    return outcome;
  }
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) {
    outcome.text += buffer.data();
  }
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

}  // namespace hmcdyn::slam::test
