// SPDX-License-Identifier: BSD-3-Clause
// What clock time stamps are of: the one place that says what is plausible.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hmcdyn::support {

/// What a time stamp of 1 means.
enum class TimeUnit : std::uint8_t {
  kSeconds,
  kMilliseconds,
  kMicroseconds,
  kNanoseconds,
  kFrames,  ///< It is a frame's number.
};

/// "seconds", "frame numbers" and so on.
std::string toString(TimeUnit unit);

/// Seconds of a unit. @param frame_rate frames a second, for kFrames.
double secondsOf(TimeUnit unit, double frame_rate);

/// What can be said of the time stamps of a list of frames.
struct StampReview {
  TimeUnit unit = TimeUnit::kSeconds;
  /// What they look like where no unit is plausible: "step by 1: they look like frame numbers".
  /// Empty where `unit` is.
  std::string doubt;
  std::vector<std::string> notes;  ///< What was assumed, and what is unusual; a sentence each.
};

/// Finds the unit of time stamps: by their size where they count from 1970 (1989 to 2103 is
/// plausible), else by the median step between frames: a camera gives 1 to 250 frames a second, and
/// more than 2000 or fewer than one in four seconds are doubted. Whole numbers that step by less
/// than 4 may be anything, if they are more than 4. Ticks of 100 ns since 1601 or the year 1 are
/// doubted, too. Two stamps or fewer are seconds unless they
/// count from 1970 otherwise.
/// @param stamps finite, in the order of the file.
StampReview reviewStamps(const std::vector<double>& stamps);

/// What stamps look like that stand still or repeat where each should be a frame's own: durations
/// of frames, or rounded ones; to end a message with, or nothing.
std::string guessOfRepeated(const std::vector<double>& stamps);

/// What it means that the stamps of a list are not in the order of time: "go back 4 times, first
/// from 7.9 to 7.1", and, where they are seconds, a point and a count of smaller units without its
/// leading zeros, that they are. Nothing where they do not go back.
struct BackwardReview {
  std::string what;
  bool is_unpadded = false;  ///< Each number is right only with zeros behind its point.
};
/// @param fields the stamps as they are written.
BackwardReview reviewOrder(const std::vector<std::string>& fields);

/// The unit in which stamps of another file (boxes, ground truth) lie within the span of frames:
/// the first in which more than half of them do, else that in which most do, of the frames' own
/// file's, seconds, and the smaller ones, unless stamps near 0 would step by less than 4 ms, as no
/// camera does. Nothing where none does.
/// @param frame_times first and last of the frames (s). @param slack around them (s).
std::optional<double> secondsByOverlap(const std::vector<double>& stamps, double first, double last,
                                       double own_seconds, double slack);

/// "3600.000 s", without digits that a difference of large numbers does not have; never negative.
std::string differenceOf(double a, double b);

/// "nanoseconds" of 1e-9, "units of 0.0333 s" of others: what stamps are read as.
std::string nameOfUnit(double seconds);

/// The unit of a time since 1970, nothing where a stamp is none in any unit.
std::optional<TimeUnit> unitSince1970(double stamp);

/// What a field in the place of a time stamp is that is no number: a file's name, a date; to end a
/// message with, or nothing.
std::string guessOfStamp(const std::string& field);

/// The number in a field. @param what names it.
/// @throws std::runtime_error as parseFinite() does, with guessOfStamp().
double parseStamp(const std::string& field, const std::string& what, const std::string& file,
                  std::size_t line);

}  // namespace hmcdyn::support
