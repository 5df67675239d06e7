// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/map_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "slam/output/tum_line.hpp"

namespace hmcdyn::slam {
namespace {

constexpr Colour kLightGrey{200, 200, 200};
constexpr std::size_t kChunk = std::size_t{1} << 20U;  // bytes between two writes

std::filesystem::path temporaryBeside(std::filesystem::path file) {
  file += ".tmp";
  return file;
}

/// A field of a CSV row, quoted where it holds a comma, a quote or a line break.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') {
      quoted += c;
    }
  }
  return quoted + "\"";
}

void appendLittleEndian(std::string& bytes, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(bits >> shift));
  }
}

std::string plyHeader(std::size_t points) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment hmcdyn, metres\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points);
}

void appendVertices(AppendFile& file, const PointCloud& cloud) {
  std::string bytes;
  for (std::size_t i = 0; i < cloud.position.size(); ++i) {
    const Eigen::Vector3f& position = cloud.position[i];
    if (!position.allFinite()) {
      continue;
    }
    for (const float coordinate : {position.x(), position.y(), position.z()}) {
      appendLittleEndian(bytes, coordinate);
    }
    for (const std::uint8_t channel : cloud.colour.empty() ? kLightGrey : cloud.colour[i]) {
      bytes += static_cast<char>(channel);
    }
    if (bytes.size() >= kChunk) {
      file.append(bytes);
      bytes.clear();
    }
  }
  file.append(bytes);
}

/// Lets `fill` write a temporary file and puts it in the place of `file`. @return it, still open.
template <class Fill>
AppendFile replaceBy(const std::filesystem::path& file, const Fill& fill) {
  const std::filesystem::path temporary = temporaryBeside(file);
  try {
    AppendFile written(temporary);
    fill(written);
    written.moveTo(file);
    return written;
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(file.string() + ": cannot be replaced: " + error.what());
  }
}

}  // namespace

KeyFramesWriter::KeyFramesWriter(const std::filesystem::path& file) : file_(file) {}

void KeyFramesWriter::write(const StampedPose& key_frame) {
  file_.append(tumLine(key_frame.timestamp, key_frame.camera_from_world));
}

void KeyFramesWriter::rewrite(const std::vector<StampedPose>& key_frames) {
  std::string lines;
  for (const StampedPose& key_frame : key_frames) {
    lines += tumLine(key_frame.timestamp, key_frame.camera_from_world);
  }
  file_ = replaceBy(file_.path(), [&](AppendFile& file) { file.append(lines); });
}

LoopsWriter::LoopsWriter(const std::filesystem::path& file) : file_(file) {
  file_.append("timestamp,matched_timestamp,score,inliers,verdict\n");
}

void LoopsWriter::write(const LoopRow& candidate) {
  file_.append(fmt::format(
      "{:.6f},{:.6f},{},{},{}\n", candidate.timestamp, candidate.matched_timestamp,
      std::isnan(candidate.score) ? "nan" : fmt::format("{:.6g}", candidate.score),
      candidate.inliers, candidate.refusal.empty() ? "accepted" : csvField(candidate.refusal)));
}

std::size_t writePly(const std::filesystem::path& file, const PointCloud& cloud) {
  if (!cloud.colour.empty() && cloud.colour.size() != cloud.position.size()) {
    throw std::invalid_argument(
        fmt::format("point cloud: {} points, {} colours; expected none or one a point",
                    cloud.position.size(), cloud.colour.size()));
  }
  const auto points = static_cast<std::size_t>(
      std::count_if(cloud.position.begin(), cloud.position.end(),
                    [](const Eigen::Vector3f& position) { return position.allFinite(); }));
  replaceBy(file, [&](AppendFile& written) {
    written.append(plyHeader(points));
    appendVertices(written, cloud);
  });
  return points;
}

}  // namespace hmcdyn::slam
