// SPDX-License-Identifier: BSD-3-Clause
// PLY files: what is read is finite.
#include <stdexcept>
#include <string>

#include "evaluate/point_cloud_file.hpp"
#include "fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  try {
    for (const Eigen::Vector3f& position : hmcdyn::evaluate::readPlyPositions(
             folder.write("fuzzed.ply", std::string(bytes, bytes + size)))) {
      hmcdyn::fuzz::require(position.allFinite(), "a position is finite");
    }
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.ply") != std::string::npos,
                          "the message names the file");
  }
  return 0;
}
