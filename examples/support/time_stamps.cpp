// SPDX-License-Identifier: BSD-3-Clause
#include "support/time_stamps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "support/file_kind.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::support {
namespace {

struct Unit {
  TimeUnit unit;
  double seconds;
};

constexpr std::array<Unit, 4> kUnits{{{TimeUnit::kSeconds, 1.0},
                                      {TimeUnit::kMilliseconds, 1e-3},
                                      {TimeUnit::kMicroseconds, 1e-6},
                                      {TimeUnit::kNanoseconds, 1e-9}}};

// Of what cameras do, not of any data set. Between a unit's largest step and the next one's
// smallest lies a gap, in which nobody can tell.
constexpr double kShortestStep = 0.004;      // s; 250 Hz
constexpr double kLongestStep = 1.0;         // s
constexpr double kShortestInSeconds = 5e-4;  // s; nothing is smaller than seconds and not absurd
constexpr double kLongestInSeconds = 4.0;    // s; slow, not absurd

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> sorted(std::vector<double> stamps) {
  std::sort(stamps.begin(), stamps.end());
  return stamps;
}

/// Steps between stamps that differ, in the order of time.
std::vector<double> stepsOf(const std::vector<double>& in_order) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < in_order.size(); ++i) {
    if (in_order[i] > in_order[i - 1]) {
      steps.push_back(in_order[i] - in_order[i - 1]);
    }
  }
  return steps;
}

bool areWhole(const std::vector<double>& stamps) {
  return std::all_of(stamps.begin(), stamps.end(),
                     [](double stamp) { return stamp == std::floor(stamp); });
}

/// They do not grow, and each is as large as a camera's step.
bool areDurations(const std::vector<double>& stamps) {
  const bool grow = !stamps.empty() && std::is_sorted(stamps.begin(), stamps.end()) &&
                    stamps.front() != stamps.back();
  if (stamps.size() < 3 || grow) {
    return false;
  }
  std::size_t not_later = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    not_later += stamps[i] <= stamps[i - 1] ? 1 : 0;
  }
  const auto [smallest, largest] = std::minmax_element(stamps.begin(), stamps.end());
  const bool of_one_size = *smallest > 0.0 && *largest <= 3.0 * *smallest;
  const double middle = median(stamps);
  const bool is_step = std::any_of(kUnits.begin(), kUnits.end(), [&](const Unit& unit) {
    return middle * unit.seconds >= kShortestStep && middle * unit.seconds <= 0.5 * kLongestStep;
  });
  return is_step && of_one_size && 5 * not_later >= stamps.size() - 1;
}

std::optional<TimeUnit> unitByStep(double step) {
  if (step >= kShortestInSeconds && step <= kLongestInSeconds) {
    return TimeUnit::kSeconds;
  }
  for (const Unit& unit : kUnits) {
    if (step * unit.seconds >= kShortestStep && step * unit.seconds <= kLongestStep) {
      return unit.unit;
    }
  }
  return std::nullopt;
}

/// Windows' and .NET's: in nanoseconds they would be of 1973 and 1990, and the frames ten times as
/// fast.
bool areTicks(const std::vector<double>& stamps, double step) {
  constexpr double kTick = 1e-7;  // s
  const double ticks = median(stamps);
  const bool since_1601 = ticks > 1.2e17 && ticks < 1.5e17;  // 1981 to 2076
  const bool since_1 = ticks > 6.2e17 && ticks < 6.7e17;     // 1965 to 2124
  return (since_1601 || since_1) && step * kTick >= kShortestStep && step * kTick <= kLongestStep;
}

std::vector<double> numbersOf(const std::vector<std::string>& fields) {
  std::vector<double> numbers(fields.size(), 0.0);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    parseNumber(fields[i], numbers[i]);
  }
  return numbers;
}

/// "7.5" as "7.000005": what is behind the point counts in units of so many digits. Empty where a
/// field cannot be that.
std::vector<std::string> withZerosBehindThePoint(std::vector<std::string> fields,
                                                 std::size_t digits) {
  for (std::string& field : fields) {
    const std::size_t point = field.find('.');
    const std::size_t behind = point == std::string::npos ? 0 : field.size() - point - 1;
    const bool plain = field.find_first_not_of("0123456789.") == std::string::npos;
    if (behind == 0 || behind > digits || !plain) {
      return {};
    }
    field.insert(point + 1, digits - behind, '0');
  }
  return fields;
}

/// What large stamps went through that are all multiples of a power of two or ten; empty for
/// others.
std::string howRounded(const std::vector<double>& different) {
  const double largest = different.empty() ? 0.0 : std::abs(different.back());
  if (!(largest >= 0x1p24)) {  // a float holds smaller numbers to the second
    return {};
  }
  const auto areMultiplesOf = [&](double step) {
    return std::all_of(different.begin(), different.end(),
                       [step](double stamp) { return std::fmod(stamp, step) == 0.0; });
  };
  constexpr int kFloatDigits = 24;
  const double of_float = std::ldexp(1.0, std::ilogb(largest) + 1 - kFloatDigits);
  if (of_float >= 2.0 && areMultiplesOf(of_float)) {
    return fmt::format("multiples of {:g}: were they rounded by a float of 32 bits?", of_float);
  }
  for (const double step : {1000.0, 100.0, 10.0}) {
    if (areMultiplesOf(step)) {
      return fmt::format("multiples of {:g}: were they rounded by few digits, as %e writes?", step);
    }
  }
  return {};
}

void noteTheUnusual(const std::vector<double>& in_order, double seconds, StampReview& review) {
  const std::vector<double> steps = stepsOf(in_order);
  const double step = median(steps) * seconds;
  constexpr double kFastest = 250.0;  // Hz
  if (1.0 / step > kFastest) {
    review.notes.push_back(
        fmt::format("the time stamps say {:.0f} frames a second; are they in another unit, or "
                    "rounded? (--time-unit)",
                    1.0 / step));
  } else if (step > kLongestStep) {
    review.notes.push_back(
        fmt::format("the time stamps say one frame in {:.1f} s; are they in another unit? "
                    "(--time-unit)",
                    step));
  }
  constexpr double kGap = 10.0;  // s, and ten steps: a pause of the recording
  const double longest = *std::max_element(steps.begin(), steps.end()) * seconds;
  if (longest > std::max(kGap, 10.0 * step)) {
    const bool is_unset = in_order.front() == 0.0 && steps.front() * seconds == longest;
    review.notes.push_back(
        is_unset ? fmt::format("the first time stamp is 0, and the next {:.1f} s later: was the "
                               "clock not set yet? Leave its line out",
                               longest)
                 : fmt::format("the recording has a gap of {:.1f} s between two frames", longest));
  }
}

}  // namespace

std::string toString(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return "seconds";
    case TimeUnit::kMilliseconds:
      return "milliseconds";
    case TimeUnit::kMicroseconds:
      return "microseconds";
    case TimeUnit::kNanoseconds:
      return "nanoseconds";
    case TimeUnit::kFrames:
      return "frame numbers";
  }
  return {};
}

double secondsOf(TimeUnit unit, double frame_rate) {
  for (const Unit& known : kUnits) {
    if (known.unit == unit) {
      return known.seconds;
    }
  }
  return 1.0 / frame_rate;
}

std::optional<TimeUnit> unitSince1970(double stamp) {
  constexpr double kFirst = 6e8;   // s; 1989
  constexpr double kLast = 4.2e9;  // s; 2103
  for (const Unit& unit : kUnits) {
    if (stamp * unit.seconds >= kFirst && stamp * unit.seconds <= kLast) {
      return unit.unit;
    }
  }
  return std::nullopt;
}

StampReview reviewStamps(const std::vector<double>& stamps) {
  StampReview review;
  if (stamps.empty()) {
    return review;
  }
  if (areDurations(stamps)) {
    review.doubt = fmt::format(
        "do not grow, and lie around {:.6g}: they look like how long each frame lasted, not when "
        "it was taken; write their running sum",
        median(stamps));
    return review;
  }
  const std::vector<double> steps = stepsOf(sorted(stamps));
  if (!steps.empty() && areTicks(stamps, median(steps))) {
    review.doubt =
        "look like ticks of 100 ns since 1601 or the year 1, as Windows and .NET count; write them "
        "in seconds";
    return review;
  }
  // The microseconds of a machine that is up for an hour would be seconds of 1998, but for the
  // steps.
  constexpr double kSlowest = 60.0;  // s; a picture a minute
  const std::optional<TimeUnit> since_1970 = unitSince1970(median(stamps));
  if (since_1970 && (steps.empty() || median(steps) * secondsOf(*since_1970, 1.0) <= kSlowest)) {
    review.unit = *since_1970;
  } else if (steps.size() >= 2) {
    const double step = median(steps);
    constexpr std::size_t kFew = 4;  // stamps; that so many fall on whole seconds is no sign
    const bool is_count = stamps.size() > kFew && areWhole(stamps) && step < 1e3 * kShortestStep;
    const std::optional<TimeUnit> by_step = is_count ? std::nullopt : unitByStep(step);
    if (!by_step) {
      review.doubt =
          is_count
              ? fmt::format("are whole numbers that step by {:.6g}: they look like frame numbers",
                            step)
              : fmt::format("step by {:.6g}, which is no camera's time in any unit", step);
      return review;
    }
    review.unit = *by_step;
  }
  if (review.unit != TimeUnit::kSeconds) {
    review.notes.push_back(fmt::format(
        "the time stamps are read as {} (--time-unit says otherwise)", toString(review.unit)));
  }
  if (!steps.empty()) {
    noteTheUnusual(sorted(stamps), secondsOf(review.unit, 1.0), review);
  }
  return review;
}

std::string guessOfRepeated(const std::vector<double>& stamps) {
  if (areDurations(stamps)) {
    return fmt::format(
        "; the stamps lie around {:.6g} and do not grow: do they say how long each frame lasted? "
        "Write their running sum",
        median(stamps));
  }
  std::vector<double> different = sorted(stamps);
  different.erase(std::unique(different.begin(), different.end()), different.end());
  const double times = static_cast<double>(stamps.size()) /
                       static_cast<double>(std::max<std::size_t>(different.size(), 1));
  if (times < 1.5) {
    return {};
  }
  if (const std::string rounded = howRounded(different); !rounded.empty()) {
    return fmt::format("; {} lines have {} different stamps, all {}. Write them with six decimals",
                       stamps.size(), different.size(), rounded);
  }
  if (areWhole(stamps)) {
    return fmt::format(
        "; {} lines have {} different stamps, all whole numbers: were they rounded to seconds? "
        "Write them with six decimals",
        stamps.size(), different.size());
  }
  return fmt::format(
      "; {} lines have {} different stamps, each some {:.0f} times: was the time rounded, or "
      "the list written {:.0f} times?",
      stamps.size(), different.size(), times, times);
}

BackwardReview reviewOrder(const std::vector<std::string>& fields) {
  BackwardReview review;
  const std::vector<double> stamps = numbersOf(fields);
  std::size_t times = 0;
  std::size_t first = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] < stamps[i - 1] && times++ == 0) {
      first = i;
    }
  }
  if (times == 0) {
    return review;
  }
  review.what = fmt::format("go back {} times, first from {} to {}", times,
                            printable(fields[first - 1]), printable(fields[first]));
  constexpr std::size_t kMicroseconds = 6;  // digits
  constexpr std::size_t kNanoseconds = 9;
  for (const std::size_t digits : {kMicroseconds, kNanoseconds}) {
    const std::vector<std::string> padded = withZerosBehindThePoint(fields, digits);
    const std::vector<double> times_of = numbersOf(padded);
    if (!padded.empty() && std::is_sorted(times_of.begin(), times_of.end())) {
      review.is_unpadded = true;
      const auto [field, as] =
          std::mismatch(fields.begin(), fields.end(), padded.begin());  // the first with zeros
      review.what += fmt::format(
          ": they look like seconds, a point and {} without leading zeros ('{}' for '{}'); write "
          "all {} digits",
          digits == kMicroseconds ? "microseconds" : "nanoseconds", printable(*field),
          printable(*as), digits);
      break;
    }
  }
  return review;
}

std::optional<double> secondsByOverlap(const std::vector<double>& stamps, double first, double last,
                                       double own_seconds, double slack) {
  const std::vector<double> steps = stepsOf(sorted(stamps));
  const std::array<double, 5> candidates{own_seconds, 1.0, 1e-3, 1e-6, 1e-9};
  std::optional<double> best;
  std::ptrdiff_t most = 0;
  for (const double seconds : candidates) {
    // Near 0 every number is at a frame's time in a unit that is small enough.
    const bool is_squeezed = !unitSince1970(first) && !steps.empty() &&
                             seconds < std::min(own_seconds, 1.0) &&
                             median(steps) * seconds < kShortestStep;
    const std::ptrdiff_t inside = std::count_if(stamps.begin(), stamps.end(), [&](double stamp) {
      return stamp * seconds >= first - slack && stamp * seconds <= last + slack;
    });
    if (inside > most && !is_squeezed) {
      most = inside;
      best = seconds;
    }
    if (2 * inside > static_cast<std::ptrdiff_t>(stamps.size()) && !is_squeezed) {
      break;  // the file may begin earlier and end later
    }
  }
  return best;
}

std::string differenceOf(double a, double b) { return fmt::format("{:.3f} s", std::abs(a - b)); }

std::string nameOfUnit(double seconds) {
  const auto* const known = std::find_if(kUnits.begin(), kUnits.end(),
                                         [=](const Unit& unit) { return unit.seconds == seconds; });
  return known == kUnits.end() ? fmt::format("units of {:.4g} s", seconds) : toString(known->unit);
}

std::string guessOfStamp(const std::string& field) {
  double ignored = 0.0;
  if (parseNumber(field, ignored)) {
    return {};
  }
  if (std::string markup = guessOfMarkup(field); !markup.empty()) {
    return markup;
  }
  const auto has = [&field](const char* part) { return field.find(part) != std::string::npos; };
  const std::size_t digits = std::min(field.find_first_not_of("0123456789"), field.size());
  constexpr std::size_t kYear = 4;
  if ((digits == kYear && (field[digits] == '-' || field[digits] == '/')) ||
      (digits > 0 && digits < field.size() && field[digits] == ':')) {
    return "; is this a date or a time of day? Write seconds";
  }
  if (has("/") || has("\\") || has(".png") || has(".jpg")) {
    return "; is this a file's name? The time stamp comes first";
  }
  return {};
}

double parseStamp(const std::string& field, const std::string& what, const std::string& file,
                  std::size_t line) {
  const std::string guess = guessOfStamp(field);
  if (!guess.empty()) {
    throw errorAt(
        file, line,
        fmt::format("{} is '{}'; expected a finite number{}", what, printable(field), guess));
  }
  return parseFinite(field, what, file, line);
}

}  // namespace hmcdyn::support
