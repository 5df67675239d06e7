// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace hmcdyn::test {

/// Path below the folder of real data and models, whether it exists or not.
inline std::filesystem::path sharedPath(const std::string& relative) {
  return std::filesystem::path(HMCDYN_SHARED_DATA) / relative;
}

}  // namespace hmcdyn::test

/// Skips the running test where a file or folder of the real data is missing.
#define HMCDYN_SKIP_WITHOUT_SHARED(relative)                                            \
  if (!std::filesystem::exists(hmcdyn::test::sharedPath(relative))) {                   \
    GTEST_SKIP() << "needs " << hmcdyn::test::sharedPath(relative)                      \
                 << ", which is not part of the project; set -DHMCDYN_SHARED_DATA=DIR"; \
  }                                                                                     \
  static_assert(true, "")
