// SPDX-License-Identifier: BSD-3-Clause
// Replaces the global operator new; every other form ends up here. In a file of its own, where the
// compiler cannot see through it and leave calls out.
#include "counting_allocator.hpp"

#include <cstdlib>
#include <new>

namespace {
std::size_t count = 0;
}  // namespace

std::size_t hmcdyn::test::allocations() noexcept { return count; }

void* operator new(std::size_t size) {
  ++count;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) {
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
