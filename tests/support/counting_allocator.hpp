// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace hmcdyn::test {

/// Calls of the global operator new so far, in an executable that counting_allocator.cpp is part
/// of.
std::size_t allocations() noexcept;

}  // namespace hmcdyn::test
