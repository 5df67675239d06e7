// SPDX-License-Identifier: BSD-3-Clause
// Tables of text in every encoding, and the clocks of the numbers in them.
#include "support/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz_input.hpp"
#include "support/time_stamps.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using hmcdyn::fuzz::require;
  std::vector<double> stamps;
  std::vector<std::string> written;
  try {
    const std::string text =
        hmcdyn::support::toText(std::string(bytes, bytes + size), "fuzzed.txt");
    const auto fits = [](std::size_t fields) { return fields == 2 || fields == 8; };
    std::size_t line = 0;
    for (const auto& row : hmcdyn::support::parseTable(text, "fuzzed.txt", fits).rows) {
      require(row.line > line, "lines are in order");
      line = row.line;
      require(!row.fields.empty(), "a row has a field");
      for (const std::string& field : row.fields) {
        require(!field.empty(), "a field has a character");
        double value = 0.0;
        if (hmcdyn::support::parseNumber(field, value) && std::isfinite(value)) {
          stamps.push_back(value);
          written.push_back(field);
        }
      }
      hmcdyn::support::guessOfPose(row);
      double value = 0.0;
      const std::string guess = hmcdyn::support::guessOfStamp(row.fields.front());
      require(guess.empty() || !hmcdyn::support::parseNumber(row.fields.front(), value),
              "a number is a time stamp");
    }
  } catch (const std::runtime_error& error) {  // as documented
    require(std::string(error.what()).find("fuzzed.txt") != std::string::npos,
            "the message names the file");
  }
  const hmcdyn::support::StampReview review = hmcdyn::support::reviewStamps(stamps);
  require(hmcdyn::support::secondsOf(review.unit, 30.0) > 0.0, "a unit lasts");
  hmcdyn::support::guessOfRepeated(stamps);
  require(hmcdyn::support::reviewOrder(written).what.empty() ==
              std::is_sorted(stamps.begin(), stamps.end()),
          "stamps go back where they are not sorted");
  hmcdyn::support::secondsByOverlap(stamps, 0.0, 1.0, 1.0, 0.02);
  return 0;
}
