// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <gtest/gtest.h>

namespace hmcdyn::evaluate::test {

/// The message of the `Error` that `call` throws; empty, with a failed test, when it throws none.
template <class Error, class Call>
std::string messageOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace hmcdyn::evaluate::test
