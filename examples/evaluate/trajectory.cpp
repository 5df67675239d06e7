// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <istream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

namespace hmcdyn::evaluate {
namespace {

constexpr std::string_view kSeparators = " \t,\r";

/// A line's fields. The views point into the line.
std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = line.find_first_not_of(kSeparators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

[[noreturn]] void failAt(const std::string& name, std::size_t line, const std::string& what) {
  throw std::runtime_error(fmt::format("{}:{}: {}", name, line, what));
}

double parseFinite(std::string_view field, const char* what, const std::string& name,
                   std::size_t line) {
  double value = 0.0;
  const char* end = field.data() + field.size();
  const auto parsed = std::from_chars(field.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    failAt(name, line, fmt::format("{} is '{}'; expected a number", what, field));
  }
  if (!std::isfinite(value)) {
    failAt(name, line, fmt::format("{} is {}; expected a finite number", what, field));
  }
  return value;
}

StampedPose parsePose(const std::vector<std::string_view>& fields, const std::string& name,
                      std::size_t line) {
  constexpr std::array<const char*, 8> kNames{"timestamp", "tx", "ty", "tz",
                                              "qx",        "qy", "qz", "qw"};
  if (fields.size() != kNames.size()) {
    failAt(name, line,
           fmt::format("{} fields; expected 8: timestamp tx ty tz qx qy qz qw", fields.size()));
  }
  std::array<double, kNames.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values.at(i) = parseFinite(fields[i], kNames.at(i), name, line);
  }
  const auto [time, tx, ty, tz, qx, qy, qz, qw] = values;
  Eigen::Quaterniond rotation(qw, qx, qy, qz);
  if (rotation.norm() < 1e-6) {
    failAt(name, line, "the quaternion is zero; expected a rotation");
  }
  rotation.normalize();
  StampedPose stamped;
  stamped.timestamp = time;
  stamped.pose.linear() = rotation.toRotationMatrix();
  stamped.pose.translation() = Eigen::Vector3d(tx, ty, tz);
  return stamped;
}

/// Calls `visit(fields, line_number)` for each line that is neither blank nor a comment.
template <class Visit>
void forEachDataLine(std::istream& stream, const std::string& name, const Visit& visit) {
  std::string text;
  std::size_t line = 0;
  while (std::getline(stream, text)) {
    ++line;
    const std::vector<std::string_view> fields = split(text);
    if (!fields.empty() && fields.front().front() != '#') {
      visit(fields, line);
    }
  }
  if (stream.bad()) {
    failAt(name, line + 1, "reading failed");
  }
}

std::ifstream open(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw std::runtime_error(fmt::format("{}: is a folder; expected a file", file.string()));
  }
  std::ifstream stream(file);
  if (!stream) {
    throw std::runtime_error(
        fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  }
  return stream;
}

}  // namespace

Trajectory readTrajectory(std::istream& stream, const std::string& name) {
  Trajectory trajectory;
  forEachDataLine(stream, name, [&](const auto& fields, std::size_t line) {
    const StampedPose stamped = parsePose(fields, name, line);
    if (!trajectory.empty() && stamped.timestamp < trajectory.back().timestamp) {
      failAt(name, line,
             fmt::format("timestamp {:.6f} is before the previous one, {:.6f}; expected time to "
                         "increase",
                         stamped.timestamp, trajectory.back().timestamp));
    }
    if (!trajectory.empty() && stamped.timestamp == trajectory.back().timestamp) {
      trajectory.back() = stamped;
    } else {
      trajectory.push_back(stamped);
    }
  });
  if (trajectory.empty()) {
    throw std::runtime_error(
        fmt::format("{}: holds no pose; expected lines `timestamp tx ty tz qx qy qz qw`", name));
  }
  return trajectory;
}

Trajectory readTrajectory(const std::filesystem::path& file) {
  std::ifstream stream = open(file);
  return readTrajectory(stream, file.string());
}

std::vector<double> readTimestamps(const std::filesystem::path& file) {
  std::ifstream stream = open(file);
  std::vector<double> timestamps;
  forEachDataLine(stream, file.string(), [&](const auto& fields, std::size_t line) {
    timestamps.push_back(parseFinite(fields.front(), "timestamp", file.string(), line));
  });
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
