// SPDX-License-Identifier: BSD-3-Clause
// Size and alignment of every public type as text in a section of the object file: sizes.sh reads
// it there, and writes rows.inc.
#include <array>
#include <cstddef>
#include <string_view>

#include <hmcdyn/hmcdyn.hpp>

namespace {

constexpr std::size_t kName = 44;
constexpr std::size_t kNumber = 7;

struct Row {
  std::array<char, kName> name{};
  std::array<char, kNumber> size{};
  std::array<char, kNumber> alignment{};
  char end = '\n';
};

constexpr std::array<char, kNumber> digits(std::size_t number) {
  std::array<char, kNumber> text{};
  for (std::size_t i = 0; i < kNumber; ++i) {
    text[kNumber - 1 - i] = i == 0 || number > 0 ? static_cast<char>('0' + number % 10) : ' ';
    number /= 10;
  }
  return text;
}

constexpr Row row(std::string_view name, std::size_t size, std::size_t alignment) {
  Row row;
  for (std::size_t i = 0; i < kName; ++i) {
    row.name[i] = i < name.size() ? name[i] : ' ';
  }
  row.size = digits(size);
  row.alignment = digits(alignment);
  return row;
}

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): a type's name as text
#define HMCDYN_ROW(...) row(#__VA_ARGS__, sizeof(__VA_ARGS__), alignof(__VA_ARGS__))

}  // namespace

__attribute__((used, section("hmcdyn_sizes"))) extern constexpr Row kSizes[] = {
#include "rows.inc"
};
