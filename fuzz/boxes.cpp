// SPDX-License-Identifier: BSD-3-Clause
// Files of boxes, and what is left of them for frames from 1000 s on.
#include <stdexcept>
#include <string>

#include "fuzz_input.hpp"
#include "slam/detect/box_plausibility.hpp"
#include "slam/detect/file_detector.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  hmcdyn::slam::DetectorOptions options;
  options.frames.image = {640, 480};
  options.frames.times = {1000.0, 1000.1, 1000.2};
  try {
    const std::filesystem::path file = folder.write("fuzzed.txt", std::string(bytes, bytes + size));
    const hmcdyn::slam::BoxReview review = hmcdyn::slam::reviewBoxFile(file, options);
    const hmcdyn::slam::BoxCounts& counts = review.counts;
    hmcdyn::fuzz::require(counts.kept == review.kept.size(), "what is kept is counted");
    hmcdyn::fuzz::require(counts.in_file == counts.kept + counts.shares + counts.inverted +
                                                counts.outside + counts.other_class +
                                                counts.low_score + counts.other_time,
                          "every box is counted once");
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
                          "the message names the file");
  }
  return 0;
}
