// SPDX-License-Identifier: BSD-3-Clause
#include "slam/dataset/tum_dataset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "slam/dataset/association.hpp"
#include "slam/dataset/file_io.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;

// A line of a list: a time stamp and the one or two files that belong to it.
struct ListLine {
  double timestamp = 0.0;
  std::vector<std::string> files;
  std::size_t line = 0;
};

// In the order of time, each time stamp once.
std::vector<ListLine> sortedOnce(std::vector<ListLine> lines, const fs::path& file) {
  std::stable_sort(lines.begin(), lines.end(), [](const ListLine& left, const ListLine& right) {
    return left.timestamp < right.timestamp;
  });
  std::vector<ListLine> once;
  for (ListLine& line : lines) {
    if (once.empty() || line.timestamp != once.back().timestamp) {
      once.push_back(std::move(line));
    } else if (line.files != once.back().files) {
      throw errorAt(file, line.line,
                    fmt::format("time stamp {} has other files than in line {}",
                                formatTimestamp(line.timestamp), once.back().line));
    }
  }
  return once;
}

// Lines "time file" of rgb.txt and depth.txt, or "time rgb_file time depth_file".
std::vector<ListLine> readList(const fs::path& file, std::size_t files_per_line) {
  std::vector<ListLine> lines;
  for (const TextRow& row : readTextRows(file)) {
    if (row.fields.size() != 2 * files_per_line) {
      throw errorAt(file, row.line,
                    fmt::format("{} fields; expected \"{}\"", row.fields.size(),
                                files_per_line == 1 ? "time file" : "time rgb time depth"));
    }
    ListLine line;
    line.line = row.line;
    line.timestamp = parseFinite(row.fields.front(), "time stamp", file, row.line);
    for (std::size_t i = 0; i < files_per_line; ++i) {
      parseFinite(row.fields[2 * i], "time stamp", file, row.line);
      line.files.push_back(row.fields[2 * i + 1]);
    }
    lines.push_back(std::move(line));
  }
  if (lines.empty()) {
    throw std::runtime_error(fmt::format("{}: lists no image", file.string()));
  }
  return sortedOnce(std::move(lines), file);
}

double smallestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const double time : a) {
    const auto after = std::lower_bound(b.begin(), b.end(), time);
    if (after != b.end()) {
      smallest = std::min(smallest, *after - time);
    }
    if (after != b.begin()) {
      smallest = std::min(smallest, time - *std::prev(after));
    }
  }
  return smallest;
}

std::vector<double> timestampsOf(const std::vector<ListLine>& lines) {
  std::vector<double> timestamps;
  timestamps.reserve(lines.size());
  for (const ListLine& line : lines) {
    timestamps.push_back(line.timestamp);
  }
  return timestamps;
}

std::vector<FrameEntry> pairByTime(const fs::path& folder, double tolerance) {
  const std::vector<ListLine> rgb = readList(folder / "rgb.txt", 1);
  const std::vector<ListLine> depth = readList(folder / "depth.txt", 1);
  const std::vector<double> rgb_times = timestampsOf(rgb);
  const std::vector<double> depth_times = timestampsOf(depth);
  const auto pairs = associate(rgb_times, depth_times, tolerance);
  if (pairs.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: no colour image has a depth image within {} s; the smallest difference of the time "
        "stamps in rgb.txt and depth.txt is {:.6f} s",
        folder.string(), tolerance, smallestDifference(rgb_times, depth_times)));
  }
  std::vector<FrameEntry> frames;
  frames.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    frames.push_back({frames.size(), rgb[i].timestamp, folder / rgb[i].files.front(),
                      folder / depth[j].files.front()});
  }
  return frames;
}

std::vector<FrameEntry> readAssociations(const fs::path& folder, const fs::path& file) {
  std::vector<FrameEntry> frames;
  for (const ListLine& line : readList(file, 2)) {
    frames.push_back(
        {frames.size(), line.timestamp, folder / line.files.front(), folder / line.files.back()});
  }
  return frames;
}

}  // namespace

std::vector<FrameEntry> listFrames(const fs::path& folder, const DatasetOptions& options) {
  if (!(options.time_tolerance >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "DatasetOptions::time_tolerance is {} s; expected 0 or more", options.time_tolerance));
  }
  if (!fs::is_directory(folder)) {
    throw std::runtime_error(
        fmt::format("data set {}: {}", folder.string(),
                    fs::exists(folder) ? "is not a folder" : "no such folder"));
  }
  const fs::path listed = folder / "associations.txt";
  std::vector<FrameEntry> frames;
  if (!options.associations.empty()) {
    frames = readAssociations(folder, options.associations);
  } else if (fs::exists(listed)) {
    frames = readAssociations(folder, listed);
  } else {
    frames = pairByTime(folder, options.time_tolerance);
  }
  const bool any = std::any_of(frames.begin(), frames.end(), [](const FrameEntry& frame) {
    return fs::exists(frame.rgb) && fs::exists(frame.depth);
  });
  if (!any) {
    throw std::runtime_error(fmt::format(
        "data set {}: none of the {} listed frames has both its files; the first is {} with {}",
        folder.string(), frames.size(), frames.front().rgb.string(),
        frames.front().depth.string()));
  }
  return frames;
}

std::string formatTimestamp(double timestamp) { return fmt::format("{:.6f}", timestamp); }

}  // namespace hmcdyn::slam
