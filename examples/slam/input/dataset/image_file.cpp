// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/image_file.hpp"

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/input/dataset/file_io.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

// PNG (RFC 2083, 3.2): a signature, then chunks of length (big endian), type, data and CRC, of
// which IEND is the last.
bool isTruncatedPng(std::string_view bytes) {
  if (bytes.substr(0, kPngSignature.size()) != kPngSignature) {
    return false;
  }
  constexpr std::size_t kFrame = 12;  // length, type and CRC
  std::string_view rest = bytes.substr(kPngSignature.size());
  while (rest.size() >= kFrame) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      length = length << 8U | static_cast<unsigned char>(rest[i]);
    }
    if (rest.size() - kFrame < length) {
      return true;
    }
    if (rest.substr(4, 4) == "IEND") {
      return false;
    }
    rest.remove_prefix(kFrame + length);
  }
  return true;
}

cv::Mat decode(std::string& bytes, const std::filesystem::path& file) {
  try {
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
    return cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("{}: cannot be decoded: {}", file.string(), error.what()));
  }
}

}  // namespace

cv::Mat readImage(const std::filesystem::path& file) {
  std::string bytes = readFile(file);
  if (bytes.empty()) {
    throw std::runtime_error(fmt::format("{}: is empty; expected an image", file.string()));
  }
  if (bytes.rfind("version https://git-lfs", 0) == 0) {
    throw std::runtime_error(fmt::format(
        "{}: is Git LFS's pointer to an image; fetch it with \"git lfs pull\"", file.string()));
  }
  if (isTruncatedPng(bytes)) {
    throw std::runtime_error(
        fmt::format("{}: truncated PNG, cut off after {} bytes", file.string(), bytes.size()));
  }
  cv::Mat image = decode(bytes, file);
  if (image.empty()) {
    throw std::runtime_error(fmt::format("{}: damaged, or no image", file.string()));
  }
  return image;
}

}  // namespace hmcdyn::slam
