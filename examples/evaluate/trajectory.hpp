// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace hmcdyn::evaluate {

/// A pose and when it held.
struct StampedPose {
  double timestamp = 0.0;                                  ///< Time (s), Unix time in TUM files.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< Camera in the world; metres.
};

/// Poses in strictly increasing order of time.
using Trajectory = std::vector<StampedPose>;

/// A trajectory, and how its file was read.
struct NotedTrajectory {
  Trajectory poses;
  std::vector<std::string> notes;  ///< What was assumed or left out, "FILE: ...", one a sentence.
};

/// Reads a TUM trajectory: a line a pose, `timestamp tx ty tz qx qy qz qw` (s, m, quaternion),
/// separated by blanks, tabs, commas or semicolons, as parseTable() reads them. Blank lines,
/// comments and a line of column names are skipped. Quaternions are normalised. Of lines with one
/// time stamp the last counts, as in the TUM tools (the published ground truth of
/// fr3/walking_static doubles a stamp). A line whose pose is NaN, infinite or has a zero quaternion
/// says that there was no pose: it is left out and counted, as in the TUM tools.
/// @throws std::runtime_error naming file and line when the file cannot be read, a line does not
/// hold eight numbers, time goes back, or there is no pose at all.
NotedTrajectory readNotedTrajectory(const std::filesystem::path& file);

/// The same of a text; `name` stands for the file in messages.
NotedTrajectory parseTrajectory(const std::string& text, const std::string& name);

/// readNotedTrajectory() of a file that goes with frames: its time stamps in seconds, where they
/// are in another unit and that makes them fit. @param first, last time of the frames (s).
/// @throws std::runtime_error as well where it has no pose at the frames' time.
NotedTrajectory readTrajectoryFor(const std::filesystem::path& file, double first, double last);

/// readNotedTrajectory() without its notes.
Trajectory readTrajectory(const std::filesystem::path& file);

/// The same from a stream; `name` stands for the file in messages.
Trajectory readTrajectory(std::istream& stream, const std::string& name);

/// The trajectory with its time stamps times a factor, which makes seconds of other units.
/// @param factor above 0.
Trajectory withStampsTimes(Trajectory trajectory, double factor);

/// Reads the first column of a list as TUM's `rgb.txt` or an associations file: time stamps (s) in
/// the order of the lines. Blank lines and lines that start with '#' are skipped.
/// @throws std::runtime_error naming file and line when the file cannot be read, a line does not
/// start with a finite number, or there is no line at all.
std::vector<double> readTimestamps(const std::filesystem::path& file);

/// A pose as a line of a TUM trajectory, without the line's end: microseconds, nanometres.
std::string toTumLine(const StampedPose& stamped);

/// Writes a TUM trajectory that readTrajectory() accepts, over what the file held.
/// @throws std::runtime_error naming the file when not all of it could be written.
void writeTrajectory(const std::filesystem::path& file, const Trajectory& trajectory);

/// Time stamps (s) of the poses.
std::vector<double> timestampsOf(const Trajectory& trajectory);

/// @throws std::invalid_argument naming `argument` when there is no pose, a pose is not finite, or
/// time does not increase.
void checkTrajectory(const Trajectory& trajectory, const std::string& argument);

}  // namespace hmcdyn::evaluate
