// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace hmcdyn::test {

/// What the std::invalid_argument says that `call` throws; "nothing thrown" without one. Other
/// exceptions pass.
template <class Call>
std::string invalidArgumentOf(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace hmcdyn::test
