// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/tum_dataset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "slam/input/dataset/association.hpp"
#include "slam/input/dataset/file_io.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;

// A line of a list: a time stamp and the one or two files that belong to it.
struct ListLine {
  double timestamp = 0.0;
  std::vector<std::string> files;
  std::size_t line = 0;
};

struct List {
  fs::path file;
  std::vector<ListLine> lines;  // in the order of time, each time stamp once
  double unit_seconds = 1.0;
  std::vector<std::string> notes;
};

std::vector<double> timestampsOf(const std::vector<ListLine>& lines) {
  std::vector<double> timestamps;
  timestamps.reserve(lines.size());
  for (const ListLine& line : lines) {
    timestamps.push_back(line.timestamp);
  }
  return timestamps;
}

// In the order of time, each time stamp once.
std::vector<ListLine> sortedOnce(std::vector<ListLine> lines, const fs::path& file) {
  const std::vector<double> as_written = timestampsOf(lines);
  std::stable_sort(lines.begin(), lines.end(), [](const ListLine& left, const ListLine& right) {
    return left.timestamp < right.timestamp;
  });
  std::vector<ListLine> once;
  for (ListLine& line : lines) {
    if (once.empty() || line.timestamp != once.back().timestamp) {
      once.push_back(std::move(line));
    } else if (line.files != once.back().files) {
      throw errorAt(file, line.line,
                    fmt::format("time stamp {} has other files than in line {}{}",
                                formatTimestamp(line.timestamp), once.back().line,
                                support::guessOfRepeated(as_written)));
    }
  }
  return once;
}

// Makes seconds of a list's time stamps.
void applyUnit(List& list, const DatasetOptions& options) {
  support::StampReview review;
  if (options.time_unit) {
    review.unit = *options.time_unit;
  } else {
    review = support::reviewStamps(timestampsOf(list.lines));
  }
  if (!review.doubt.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: the time stamps {}; say what they are by --time-unit (s, ms, us, ns, or frame, at the "
        "camera's {:g} frames a second)",
        list.file.string(), review.doubt, options.frame_rate));
  }
  for (const std::string& note : review.notes) {
    list.notes.push_back(fmt::format("{}: {}", list.file.string(), note));
  }
  list.unit_seconds = support::secondsOf(review.unit, options.frame_rate);
  for (ListLine& line : list.lines) {
    line.timestamp *= list.unit_seconds;
  }
}

// Frames are taken in the order of time, which a list in another order says wrongly, perhaps.
void noteOrder(const support::TextTable& table, List& list) {
  std::vector<std::string> fields;
  for (const support::TextRow& row : table.rows) {
    fields.push_back(row.fields.front());
  }
  const support::BackwardReview order = support::reviewOrder(fields);
  if (order.is_unpadded) {
    throw std::runtime_error(fmt::format("{}: the time stamps {}", list.file.string(), order.what));
  }
  if (!order.what.empty()) {
    list.notes.push_back(fmt::format(
        "{}: the time stamps {}; the frames are taken in the order of their time stamps",
        list.file.string(), order.what));
  }
}

// A file of a list, which may be quoted, or have backslashes where other systems have them.
fs::path fileIn(const fs::path& folder, std::string name) {
  const bool quoted = name.size() > 2 && (name.front() == '"' || name.front() == '\'') &&
                      name.front() == name.back();
  if (quoted && !fs::exists(folder / name)) {
    name = name.substr(1, name.size() - 2);
  }
  if (name.find('\\') != std::string::npos && !fs::exists(folder / name)) {
    std::replace(name.begin(), name.end(), '\\', '/');
  }
  return folder / name;
}

// Files of one kind, which a list may name without the folder that they are in.
class FilesOf {
 public:
  FilesOf(fs::path folder, const char* kind) : folder_(std::move(folder)), kind_(kind) {}

  fs::path operator()(const std::string& name) {
    fs::path file = fileIn(folder_, name);
    fs::path below = folder_ / kind_ / file.filename();
    if (file.parent_path() == folder_ && !fs::exists(file) && fs::exists(below)) {
      ++found_below_;
      return below;
    }
    return file;
  }

  // Says how many were.
  void note(std::vector<std::string>& notes) const {
    if (found_below_ > 0) {
      notes.push_back(
          fmt::format("{} files are listed without their folder, and read from {}/ (\"{}/NAME\" is "
                      "expected in the list)",
                      found_below_, (folder_ / kind_).string(), kind_));
    }
  }

 private:
  fs::path folder_;
  const char* kind_;
  std::size_t found_below_ = 0;
};

// Lines "time file" of rgb.txt and depth.txt, or "time rgb_file time depth_file".
List readList(const fs::path& file, std::size_t files_per_line, const DatasetOptions& options) {
  List list;
  list.file = file;
  support::TextTable table =
      support::readTable(file, [&](std::size_t fields) { return fields == 2 * files_per_line; });
  list.notes = std::move(table.notes);
  for (const support::TextRow& row : table.rows) {
    if (row.fields.size() != 2 * files_per_line) {
      throw errorAt(file, row.line,
                    fmt::format("{} fields; expected \"{}\"{}", row.fields.size(),
                                files_per_line == 1 ? "time file" : "time rgb time depth",
                                support::guessOfStamp(row.fields.front())));
    }
    ListLine line;
    line.line = row.line;
    line.timestamp = support::parseStamp(row.fields.front(), "time stamp", file.string(), row.line);
    for (std::size_t i = 0; i < files_per_line; ++i) {
      support::parseStamp(row.fields[2 * i], "time stamp", file.string(), row.line);
      line.files.push_back(row.fields[2 * i + 1]);
    }
    list.lines.push_back(std::move(line));
  }
  if (list.lines.empty()) {
    throw std::runtime_error(fmt::format("{}: lists no image", file.string()));
  }
  noteOrder(table, list);
  // Before they are sorted: what stands still or goes back says what it is.
  if (!options.time_unit && list.lines.size() > 2) {
    const support::StampReview as_written = support::reviewStamps(timestampsOf(list.lines));
    if (!as_written.doubt.empty()) {
      sortedOnce(list.lines, file);  // a time stamp with two files is the graver finding
      applyUnit(list, options);      // says what the doubt is
    }
  }
  list.lines = sortedOnce(std::move(list.lines), file);
  applyUnit(list, options);
  return list;
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

// Why no image has a partner: lists that do not overlap are of two clocks.
std::string guessOfClocks(const std::vector<double>& rgb, const std::vector<double>& depth) {
  if (rgb.front() <= depth.back() && depth.front() <= rgb.back()) {
    return "; a larger --time-tolerance may be what is wanted";
  }
  return fmt::format(
      "; rgb.txt covers {} to {} s and depth.txt {} to {} s: two clocks (if both began together, "
      "they differ by {}: {} is ahead)? Write both by one clock, or associations.txt",
      formatTimestamp(rgb.front()), formatTimestamp(rgb.back()), formatTimestamp(depth.front()),
      formatTimestamp(depth.back()), support::differenceOf(rgb.front(), depth.front()),
      rgb.front() > depth.front() ? "colour" : "depth");
}

double medianStep(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    steps.push_back(times[i] - times[i - 1]);
  }
  if (steps.empty()) {
    return 0.0;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// "depth.txt has an image every 0.100 s, rgb.txt every 0.033 s" where the rates differ by half.
std::string noteOfRates(const std::vector<double>& rgb, const std::vector<double>& depth) {
  const double of_rgb = medianStep(rgb);
  const double of_depth = medianStep(depth);
  if (of_depth < 1.5 * of_rgb && of_rgb < 1.5 * of_depth) {
    return {};
  }
  return fmt::format("; depth.txt has an image every {:.4f} s, rgb.txt every {:.4f} s", of_depth,
                     of_rgb);
}

void requireLists(const fs::path& folder) {
  for (const char* name : {"rgb.txt", "depth.txt"}) {
    if (!fs::exists(folder / name)) {
      throw std::runtime_error(
          fmt::format("{}: no such file; expected a folder in TUM format: associations.txt, or "
                      "rgb.txt and depth.txt with lines \"time file\"",
                      (folder / name).string()));
    }
  }
}

FrameList pairByTime(const fs::path& folder, const DatasetOptions& options) {
  requireLists(folder);
  const List rgb = readList(folder / "rgb.txt", 1, options);
  const List depth = readList(folder / "depth.txt", 1, options);
  const std::vector<double> rgb_times = timestampsOf(rgb.lines);
  const std::vector<double> depth_times = timestampsOf(depth.lines);
  const auto pairs = associate(rgb_times, depth_times, options.time_tolerance);
  if (pairs.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: no colour image has a depth image within {} s; the smallest difference of the time "
        "stamps in rgb.txt and depth.txt is {:.6f} s{}",
        folder.string(), options.time_tolerance, smallestDifference(rgb_times, depth_times),
        guessOfClocks(rgb_times, depth_times)));
  }
  FrameList list;
  list.unit_seconds = rgb.unit_seconds;
  list.notes = rgb.notes;
  list.notes.insert(list.notes.end(), depth.notes.begin(), depth.notes.end());
  list.frames.reserve(pairs.size());
  std::vector<bool> paired(rgb.lines.size(), false);
  FilesOf color_files(folder, "rgb");
  FilesOf depth_files(folder, "depth");
  for (const auto& [i, j] : pairs) {
    paired[i] = true;
    list.frames.push_back({list.frames.size(), rgb.lines[i].timestamp,
                           color_files(rgb.lines[i].files.front()),
                           depth_files(depth.lines[j].files.front())});
  }
  color_files.note(list.notes);
  depth_files.note(list.notes);
  list.color_without_depth = rgb.lines.size() - pairs.size();
  list.depth_without_color = depth.lines.size() - pairs.size();
  if (list.color_without_depth > 0) {
    const auto first = std::find(paired.begin(), paired.end(), false) - paired.begin();
    list.notes.push_back(fmt::format(
        "{} of the {} colour images {} no depth image within {} s and {} left out, the first is "
        "{}{}",
        list.color_without_depth, rgb.lines.size(), list.color_without_depth == 1 ? "has" : "have",
        options.time_tolerance, list.color_without_depth == 1 ? "is" : "are",
        rgb.lines[static_cast<std::size_t>(first)].files.front(),
        noteOfRates(rgb_times, depth_times)));
  }
  if (list.depth_without_color > 0) {
    list.notes.push_back(fmt::format(
        "{} of the {} depth images {} no colour image within {} s{}", list.depth_without_color,
        depth.lines.size(), list.depth_without_color == 1 ? "has" : "have", options.time_tolerance,
        list.color_without_depth > 0 ? "" : noteOfRates(rgb_times, depth_times)));
  }
  return list;
}

FrameList readAssociations(const fs::path& folder, const fs::path& file,
                           const DatasetOptions& options) {
  const List lines = readList(file, 2, options);
  FrameList list;
  list.unit_seconds = lines.unit_seconds;
  list.notes = lines.notes;
  FilesOf color_files(folder, "rgb");
  FilesOf depth_files(folder, "depth");
  for (const ListLine& line : lines.lines) {
    list.frames.push_back({list.frames.size(), line.timestamp, color_files(line.files.front()),
                           depth_files(line.files.back())});
  }
  color_files.note(list.notes);
  depth_files.note(list.notes);
  return list;
}

}  // namespace

FrameList readFrameList(const fs::path& folder, const DatasetOptions& options) {
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
  FrameList list;
  if (!options.associations.empty()) {
    list = readAssociations(folder, options.associations, options);
  } else if (fs::exists(listed)) {
    list = readAssociations(folder, listed, options);
  } else {
    list = pairByTime(folder, options);
  }
  const bool any = std::any_of(list.frames.begin(), list.frames.end(), [](const FrameEntry& frame) {
    return fs::exists(frame.rgb) && fs::exists(frame.depth);
  });
  if (!any) {
    throw std::runtime_error(fmt::format(
        "data set {}: none of the {} listed frames has both its files; the first is {} with {}",
        folder.string(), list.frames.size(), list.frames.front().rgb.string(),
        list.frames.front().depth.string()));
  }
  return list;
}

std::vector<FrameEntry> listFrames(const fs::path& folder, const DatasetOptions& options) {
  return readFrameList(folder, options).frames;
}

std::string formatTimestamp(double timestamp) { return fmt::format("{:.6f}", timestamp); }

}  // namespace hmcdyn::slam
