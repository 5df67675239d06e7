// SPDX-License-Identifier: BSD-3-Clause
// Files of boxes.
#include <stdexcept>
#include <string>

#include "fuzz_input.hpp"
#include "slam/detection/file_detector.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  try {
    hmcdyn::slam::readBoxFile(folder.write("fuzzed.txt", std::string(bytes, bytes + size)));
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
                          "the message names the file");
  }
  return 0;
}
