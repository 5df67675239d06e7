// SPDX-License-Identifier: BSD-3-Clause
// Calibration files, ours and those of other systems: what is read is plausible.
#include <stdexcept>
#include <string>

#include "fuzz_input.hpp"
#include "slam/input/camera/calibration_file.hpp"
#include "slam/input/camera/plausibility.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  try {
    const hmcdyn::slam::CameraCalibration camera = hmcdyn::slam::readCalibrationFile(
        folder.write("fuzzed.txt", std::string(bytes, bytes + size)));
    hmcdyn::fuzz::require(hmcdyn::slam::whatIsImplausible(camera).empty(), "a camera is plausible");
    for (const std::string& unusual : hmcdyn::slam::whatIsUnusual(camera)) {
      hmcdyn::fuzz::require(!unusual.empty(), "what is unusual is said");
    }
    hmcdyn::fuzz::require((camera.width > 0) == (camera.height > 0), "a size has two sides");
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
                          "the message names the file");
  }
  return 0;
}
