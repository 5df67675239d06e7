// SPDX-License-Identifier: BSD-3-Clause
// Lines of JSON by which a program answers --detector command.
#include <cmath>
#include <stdexcept>
#include <string>

#include "fuzz_input.hpp"
#include "slam/detect/command_detector.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const hmcdyn::slam::CommandAnswer answer =
        hmcdyn::slam::parseCommandAnswer(std::string(bytes, bytes + size), 1);
    for (const hmcdyn::DetectionBox& box : answer.boxes) {
      hmcdyn::fuzz::require(
          std::isfinite(box.x_min) && std::isfinite(box.y_max) && std::isfinite(box.score),
          "a box is finite");
    }
  } catch (const std::runtime_error&) {  // as documented
  }
  return 0;
}
