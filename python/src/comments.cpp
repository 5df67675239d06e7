// SPDX-License-Identifier: BSD-3-Clause
#include "comments.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hmcdyn::python {
namespace {

struct Comment {
  std::string_view name;
  const char* text;
};

constexpr Comment kComments[] = {
#include "comments.inc"  // made by the build
};

}  // namespace

const char* commentOf(const char* name) {
  const auto* const found =
      std::find_if(std::begin(kComments), std::end(kComments),
                   [name](const Comment& comment) { return comment.name == name; });
  if (found == std::end(kComments)) {
    throw std::logic_error(std::string("no header has a comment on ") + name);
  }
  return found->text;
}

}  // namespace hmcdyn::python
