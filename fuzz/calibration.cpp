// SPDX-License-Identifier: BSD-3-Clause
// Calibration files, ours and ORB-SLAM3's.
#include <stdexcept>
#include <string>

#include "fuzz_input.hpp"
#include "slam/camera/calibration_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  try {
    hmcdyn::slam::readCalibrationFile(folder.write("fuzzed.txt", std::string(bytes, bytes + size)));
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
                          "the message names the file");
  }
  return 0;
}
