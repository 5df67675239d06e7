// SPDX-License-Identifier: BSD-3-Clause
#include "support/file_kind.hpp"

#include <algorithm>
#include <array>

namespace hmcdyn::support {
namespace {

using namespace std::string_view_literals;

struct Magic {
  std::string_view bytes;
  const char* kind;
};

constexpr std::array<Magic, 15> kMagics{{
    {"\x1F\x8B"sv, "a gzip archive: unpack it"},
    {"BZh"sv, "a bzip2 archive: unpack it"},
    {"\xFD"
     "7zXZ"sv,
     "an xz archive: unpack it"},
    {"PK\x03\x04"sv, "a zip archive, as PyTorch's .pt, NumPy's .npz and Excel's .xlsx are"},
    {"\x80\x02}"sv, "a pickle of Python's, as PyTorch's older .pt and .pth are"},
    {"\x80\x02\x8A"sv, "a pickle of Python's, as PyTorch's older .pt and .pth are"},
    {"\x80\x04\x95"sv, "a pickle of Python's"},
    {"\x93NUMPY"sv, "a NumPy array (.npy)"},
    {"\x89PNG"sv, "a PNG image"},
    {"\xFF\xD8\xFF"sv, "a JPEG image"},
    {"\x89HDF"sv, "an HDF5 file, as Keras's .h5 and MATLAB's .mat are"},
    {"SQLite format 3"sv, "an SQLite database, as ROS 2's .db3 is"},
    {"#ROSBAG"sv, "a bag of ROS: write its topics into files"},
    {"%PDF"sv, "a PDF document"},
    {"version https://git-lfs"sv, "a pointer of Git LFS: fetch the file with \"git lfs pull\""},
}};

}  // namespace

std::string kindOfBytes(std::string_view bytes) {
  const auto* const found = std::find_if(kMagics.begin(), kMagics.end(), [&](const Magic& magic) {
    return bytes.substr(0, magic.bytes.size()) == magic.bytes;
  });
  return found == kMagics.end() ? std::string() : found->kind;
}

std::string guessOfMarkup(std::string_view field) {
  const bool is_list = !field.empty() && field.front() == '[' &&
                       (field.size() == 1 || field.find_first_of("[{\"]", 1) == 1);
  if (is_list || (!field.empty() && field.front() == '{')) {
    return "; is this JSON? Write a line of text a row";
  }
  if (!field.empty() && field.front() == '<') {
    return "; is this XML, or a page of the web? Write a line of text a row";
  }
  return {};
}

}  // namespace hmcdyn::support
