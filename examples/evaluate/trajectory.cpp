// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <istream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "support/text_table.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr std::array<const char*, 8> kNames{"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};

[[noreturn]] void failAt(const std::string& name, std::size_t line, const std::string& what) {
  throw support::errorAt(name, line, what);
}

std::array<double, kNames.size()> parseValues(const support::TextRow& row,
                                              const std::string& name) {
  if (row.fields.size() != kNames.size()) {
    failAt(name, row.line,
           fmt::format("{} fields; expected 8: timestamp tx ty tz qx qy qz qw{}", row.fields.size(),
                       support::guessOfPose(row)));
  }
  std::array<double, kNames.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!support::parseNumber(row.fields[i], values.at(i))) {
      failAt(name, row.line,
             fmt::format("{} is '{}'; expected a number{}", kNames.at(i),
                         support::printable(row.fields[i]),
                         i == 0 ? support::guessOfStamp(row.fields[i]) : ""));
    }
  }
  return values;
}

/// What a file's lines came to, besides poses.
struct Counts {
  std::size_t lines = 0;
  std::size_t without_pose = 0;
  std::size_t first_without_pose = 0;  ///< Its line.
  std::size_t far_from_unit = 0;
  std::size_t first_far_from_unit = 0;  ///< Its line.
  std::size_t repeated = 0;
};

std::vector<std::string> notesOf(const Counts& counts, const std::vector<double>& stamps,
                                 const std::string& name) {
  std::vector<std::string> notes;
  if (counts.without_pose > 0) {
    notes.push_back(fmt::format(
        "{}: {} of {} lines are left out, the first is line {}: NaN, infinity or a zero quaternion",
        name, counts.without_pose, counts.lines, counts.first_without_pose));
  }
  if (counts.far_from_unit > 0) {
    notes.push_back(fmt::format(
        "{}: {} of {} quaternions are far from norm 1, the first in line {}; they were normalised, "
        "but are these quaternions qx qy qz qw?",
        name, counts.far_from_unit, counts.lines, counts.first_far_from_unit));
  }
  if (10 * counts.repeated > counts.lines) {
    notes.push_back(
        fmt::format("{}: {} of {} lines repeat the time stamp of the line before, and the last of "
                    "each counts{}",
                    name, counts.repeated, counts.lines, support::guessOfRepeated(stamps)));
  }
  return notes;
}

/// The pose of a line, nothing where it says that there is none.
std::optional<StampedPose> poseOf(const support::TextRow& row, const std::string& name,
                                  Counts& counts) {
  const std::array<double, kNames.size()> values = parseValues(row, name);
  ++counts.lines;
  const auto [time, tx, ty, tz, qx, qy, qz, qw] = values;
  Eigen::Quaterniond rotation(qw, qx, qy, qz);
  const double norm = rotation.norm();
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  if (!finite || norm < 1e-6 || !std::isfinite(norm)) {
    if (counts.without_pose++ == 0) {
      counts.first_without_pose = row.line;
    }
    return std::nullopt;
  }
  constexpr double kTolerance = 0.1;  // far more than rounding to two decimals
  if (std::abs(norm - 1.0) > kTolerance && counts.far_from_unit++ == 0) {
    counts.first_far_from_unit = row.line;
  }
  rotation.normalize();
  StampedPose stamped;
  stamped.timestamp = time;
  stamped.pose.linear() = rotation.toRotationMatrix();
  stamped.pose.translation() = Eigen::Vector3d(tx, ty, tz);
  return stamped;
}

void requireFile(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw std::runtime_error(fmt::format("{}: is a folder; expected a file", file.string()));
  }
  if (!std::ifstream(file)) {
    throw std::runtime_error(
        fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  }
}

}  // namespace

NotedTrajectory parseTrajectory(const std::string& text, const std::string& name) {
  support::TextTable table = support::parseTable(support::toText(text, name), name,
                                                 [](std::size_t n) { return n == kNames.size(); });
  NotedTrajectory result;
  result.notes = std::move(table.notes);
  Trajectory& trajectory = result.poses;
  Counts counts;
  std::vector<double> stamps;
  for (const support::TextRow& row : table.rows) {
    const std::optional<StampedPose> stamped = poseOf(row, name, counts);
    if (!stamped) {
      continue;
    }
    stamps.push_back(stamped->timestamp);
    if (!trajectory.empty() && stamped->timestamp < trajectory.back().timestamp) {
      failAt(name, row.line,
             fmt::format("timestamp {:.6f} is before the previous one, {:.6f}; expected time to "
                         "increase",
                         stamped->timestamp, trajectory.back().timestamp));
    }
    if (!trajectory.empty() && stamped->timestamp == trajectory.back().timestamp) {
      trajectory.back() = *stamped;
      ++counts.repeated;
    } else {
      trajectory.push_back(*stamped);
    }
  }
  if (trajectory.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: holds no pose; expected lines `timestamp tx ty tz qx qy qz qw`{}", name,
        counts.without_pose > 0
            ? fmt::format(", found {} with NaN, infinity or a zero quaternion", counts.without_pose)
            : ""));
  }
  const std::vector<std::string> more = notesOf(counts, stamps, name);
  result.notes.insert(result.notes.end(), more.begin(), more.end());
  return result;
}

NotedTrajectory readNotedTrajectory(const std::filesystem::path& file) {
  requireFile(file);
  return parseTrajectory(support::readBytes(file), file.string());
}

NotedTrajectory readTrajectoryFor(const std::filesystem::path& file, double first, double last) {
  NotedTrajectory truth = readNotedTrajectory(file);
  constexpr double kSlack = 0.02;  // s; the tolerance of association
  const std::optional<double> seconds =
      support::secondsByOverlap(timestampsOf(truth.poses), first, last, 1.0, kSlack);
  if (!seconds) {
    throw std::runtime_error(fmt::format(
        "{}: has no pose at the frames' time: it covers {:.6f} to {:.6f}, the frames {:.6f} to "
        "{:.6f} s; is it another recording's, or another clock's?",
        file.string(), truth.poses.front().timestamp, truth.poses.back().timestamp, first, last));
  }
  if (*seconds != 1.0) {
    truth.notes.push_back(
        fmt::format("{}: the time stamps are read as {}, since that fits the frames", file.string(),
                    support::nameOfUnit(*seconds)));
  }
  truth.poses = withStampsTimes(std::move(truth.poses), *seconds);
  return truth;
}

Trajectory readTrajectory(std::istream& stream, const std::string& name) {
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return parseTrajectory(text, name).poses;
}

Trajectory readTrajectory(const std::filesystem::path& file) {
  return readNotedTrajectory(file).poses;
}

Trajectory withStampsTimes(Trajectory trajectory, double factor) {
  for (StampedPose& stamped : trajectory) {
    stamped.timestamp *= factor;
  }
  return trajectory;
}

std::vector<double> readTimestamps(const std::filesystem::path& file) {
  requireFile(file);
  const support::TextTable table = support::readTable(file, [](std::size_t) { return true; });
  std::vector<double> timestamps;
  for (const support::TextRow& row : table.rows) {
    double timestamp = 0.0;
    if (!support::parseNumber(row.fields.front(), timestamp) || !std::isfinite(timestamp)) {
      failAt(file.string(), row.line,
             fmt::format("timestamp is '{}'; expected a number",
                         support::printable(row.fields.front())));
    }
    timestamps.push_back(timestamp);
  }
  if (timestamps.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: holds no line; expected lines that start with a timestamp", file.string()));
  }
  return timestamps;
}

std::string toTumLine(const StampedPose& stamped) {
  const Eigen::Vector3d t = stamped.pose.translation();
  const Eigen::Quaterniond q(stamped.pose.linear());
  return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", stamped.timestamp,
                     t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

void writeTrajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::ofstream stream(file);
  stream << "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& stamped : trajectory) {
    stream << toTumLine(stamped) << '\n';
  }
  stream.close();
  if (!stream) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  }
}

std::vector<double> timestampsOf(const Trajectory& trajectory) {
  std::vector<double> timestamps;
  timestamps.reserve(trajectory.size());
  for (const StampedPose& stamped : trajectory) {
    timestamps.push_back(stamped.timestamp);
  }
  return timestamps;
}

void checkTrajectory(const Trajectory& trajectory, const std::string& argument) {
  if (trajectory.empty()) {
    throw std::invalid_argument(argument + ": has 0 poses; expected at least 1");
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const StampedPose& stamped = trajectory[i];
    if (!std::isfinite(stamped.timestamp) || !stamped.pose.matrix().allFinite()) {
      throw std::invalid_argument(
          fmt::format("{}: pose {} holds NaN or infinity; expected finite values", argument, i));
    }
    if (i > 0 && stamped.timestamp <= trajectory[i - 1].timestamp) {
      throw std::invalid_argument(
          fmt::format("{}: timestamp {:.6f} of pose {} follows {:.6f}; expected time to increase",
                      argument, stamped.timestamp, i, trajectory[i - 1].timestamp));
    }
  }
}

}  // namespace hmcdyn::evaluate
