// SPDX-License-Identifier: BSD-3-Clause
// What runs leave behind and other programs read: key points, summaries, the paper's results.
#include <cmath>
#include <stdexcept>
#include <string>

#include "evaluate/label_score.hpp"
#include "evaluate/paper_results.hpp"
#include "evaluate/run_summary.hpp"
#include "fuzz_input.hpp"

namespace {

template <class Read>
void expectNamed(const Read& read) {
  try {
    read();
  } catch (const std::runtime_error& error) {  // as documented
    hmcdyn::fuzz::require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
                          "the message names the file");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  const std::filesystem::path file = folder.write("fuzzed.txt", std::string(bytes, bytes + size));
  expectNamed([&] {
    for (const auto& point : hmcdyn::evaluate::readLabelledPoints(file)) {
      hmcdyn::fuzz::require(std::isfinite(point.u) && std::isfinite(point.v), "a point is finite");
    }
  });
  expectNamed([&] { hmcdyn::evaluate::readRunSummary(file); });
  expectNamed([&] {
    for (const auto& value : hmcdyn::evaluate::readPaperResults(file)) {
      hmcdyn::fuzz::require(!value.metric.empty(), "a value has a metric");
    }
  });
  return 0;
}
