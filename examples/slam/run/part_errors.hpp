// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "slam/input/source/frame_source.hpp"

namespace hmcdyn::slam {

/// What a part of the system threw in a run.
struct PartError {
  std::string part;       ///< "local mapping", for example.
  std::string error;      ///< What it threw first.
  std::size_t times = 1;  ///< How often it threw.
};

/// Runs work that may throw, and remembers what it threw: an error in one part is no end of the
/// others. One thread's.
class PartErrors {
 public:
  /// @param report is told the first error of each part; may be empty.
  explicit PartErrors(Report report = {}) : report_(std::move(report)) {}

  /// @param consequence what the run does without the result, for the report.
  /// @return false where the work threw.
  template <class Work>
  bool attempt(const std::string& part, const std::string& consequence, const Work& work) {
    try {
      work();
      return true;
    } catch (const std::exception& error) {
      add(part, consequence, error.what());
    } catch (...) {
      add(part, consequence, "it threw what is no std::exception");
    }
    return false;
  }

  /// One entry a part, in the order in which they failed first.
  const std::vector<PartError>& all() const noexcept { return errors_; }

 private:
  void add(const std::string& part, const std::string& consequence, const std::string& error) {
    for (PartError& known : errors_) {
      if (known.part == part) {
        ++known.times;
        return;
      }
    }
    errors_.push_back({part, error});
    if (report_) {
      report_(part + " failed: " + error + "; " + consequence +
              "; further failures of this part are only counted");
    }
  }

  Report report_;
  std::vector<PartError> errors_;
};

}  // namespace hmcdyn::slam
