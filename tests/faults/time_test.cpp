// SPDX-License-Identifier: BSD-3-Clause
// Kind 3: what clock stamps are of is found out by what is plausible, said, or asked.
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fault_input.hpp"
#include "input/source/fake_recording.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
#include "slam/input/source/realtime_pacer.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;
using support::TimeUnit;

class Time : public ToyFolder {
 protected:
  /// Both lists with the stamps that a text has for each second.
  void restampBoth(const std::function<std::string(double, std::size_t)>& stamp) const {
    restamp("rgb.txt", stamp);
    restamp("depth.txt", stamp);
  }
};

TEST_F(Time, StampsInSmallerUnitsAreReadAndNamed) {
  struct Kind {
    const char* what;
    std::function<std::string(double, std::size_t)> stamp;
    double first;  // s
    const char* named;
    double rounded = 2e-6;  // s
  };
  const double k2012 = 1341846434.0;
  const std::vector<Kind> kinds{
      {"ms since 1970",
       [&](double t, std::size_t) { return fmt::format("{:.0f}", 1e3 * (k2012 + t - 1000.0)); },
       k2012, "milliseconds", 1e-3},
      {"us since 1970",
       [&](double t, std::size_t) { return fmt::format("{:.0f}", 1e6 * (k2012 + t - 1000.0)); },
       k2012, "microseconds"},
      {"19 digits",
       [&](double t, std::size_t) {
         return fmt::format("1341846434{:09d}", std::llround(1e9 * (t - 1000.0)));
       },
       k2012, "nanoseconds"},
      {"through a double",
       [&](double t, std::size_t) { return fmt::format("{:.17e}", 1e9 * (k2012 + t - 1000.0)); },
       k2012, "nanoseconds"},
      {"ms since the start",
       [](double t, std::size_t) { return fmt::format("{:.3f}", 1e3 * (t - 1000.0)); }, 0.0,
       "milliseconds"},
      {"us since boot",
       [](double t, std::size_t) { return fmt::format("{:.0f}", 1e6 * (t - 900.0)); }, 100.0,
       "microseconds"},
      {"ns since boot",
       [](double t, std::size_t) { return fmt::format("{:.0f}", 1e9 * (t - 900.0)); }, 100.0,
       "nanoseconds"},
  };
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    restore();
    restampBoth(kind.stamp);
    const slam::FrameList list = slam::readFrameList(toy());
    ASSERT_EQ(list.frames.size(), 8U);
    EXPECT_NEAR(list.frames.front().timestamp, kind.first, 1e-6);
    EXPECT_NEAR(list.frames.back().timestamp - list.frames.front().timestamp, 7.0 / 30.0,
                kind.rounded);
    EXPECT_TRUE(oneMentions(list.notes, {"rgb.txt", kind.named}));
  }
}

TEST(Stamps, StampsInSecondsAreLeftAsTheyAre) {
  for (const double step : {0.001, 1.0 / 240, 1.0 / 30, 0.2, 2.5}) {
    std::vector<double> stamps;
    for (int i = 0; i < 20; ++i) {
      stamps.push_back(7.0 + step * i);
    }
    const support::StampReview review = support::reviewStamps(stamps);
    EXPECT_EQ(review.unit, TimeUnit::kSeconds) << step;
    EXPECT_EQ(review.doubt, "") << step;
  }
}

TEST(Stamps, AnUnusualRateAndAGapAreSaid) {
  std::vector<double> stamps;
  for (int i = 0; i < 20; ++i) {
    stamps.push_back(1341846434.0 + 0.001 * i);
  }
  EXPECT_TRUE(oneMentions(support::reviewStamps(stamps).notes, {"1000 frames a second"}));
  stamps = {10.0, 10.1, 10.2, 3610.2, 3610.3};
  EXPECT_TRUE(oneMentions(support::reviewStamps(stamps).notes, {"gap of 3600.0 s"}));
  stamps = {0.0, 1341846434.7, 1341846434.8, 1341846434.9};
  EXPECT_TRUE(oneMentions(support::reviewStamps(stamps).notes,
                          {"the first time stamp is 0", "1341846434.7 s later"}));
}

TEST_F(Time, WhatNobodyCanTellIsAskedFor) {
  struct Kind {
    const char* what;
    std::function<std::string(double, std::size_t)> stamp;
    std::vector<std::string> said;
  };
  const std::vector<Kind> kinds{
      {"frame numbers",
       [](double, std::size_t i) { return std::to_string(i); },
       {"frame numbers", "--time-unit"}},
      {"frame numbers with zeros",
       [](double, std::size_t i) { return fmt::format("{:06d}", i); },
       {"frame numbers", "--time-unit"}},
      {"every third frame's",
       [](double, std::size_t i) { return std::to_string(3 * i + 1); },
       {"step by 3", "--time-unit"}},
      {"no camera's",
       [](double, std::size_t i) { return fmt::format("{:.7f}", 1e-5 * double(i)); },
       {"step by 1e-05", "--time-unit"}},
      {"durations",
       [](double, std::size_t i) { return fmt::format("0.03{}", 33 + 2 * (i * 5 % 8)); },
       {"how long each frame lasted", "running sum"}},
      {"equal durations",
       [](double, std::size_t) { return std::string("0.0333"); },
       {"other files than in line 1", "how long each frame lasted"}},
      {"each three times",
       [](double t, std::size_t i) { return fmt::format("{:.6f}", t - double(i % 3) / 30.0); },
       {"other files than in line 1", "8 lines have 3 different stamps"}},
      {"ticks of Windows",
       [](double t, std::size_t) { return fmt::format("{:.0f}", 1e7 * (12986320034.0 + t)); },
       {"ticks of 100 ns", "in seconds"}},
      {"ticks of .NET",
       [](double t, std::size_t) { return fmt::format("{:.0f}", 1e7 * (63477443234.0 + t)); },
       {"ticks of 100 ns", "in seconds"}},
      {"dates",
       [](double t, std::size_t) { return fmt::format("2012-07-09T15:07:{:09.6f}", t - 990.0); },
       {"rgb.txt:1: time stamp is '2012-07-09T15", "date"}},
      {"dates with a blank",
       [](double t, std::size_t) { return fmt::format("2012-07-09 15:07:{:09.6f}", t - 990.0); },
       {"rgb.txt:1: 3 fields", "date"}},
      {"rounded to seconds",
       [](double t, std::size_t) { return fmt::format("{:.0f}", t); },
       {"other files than in line 1", "rounded to seconds"}},
      {"through a float of 32 bits",
       [](double t, std::size_t) {
         return fmt::format("{:.6f}", double{static_cast<float>(t + 1341845434.0)});
       },
       {"other files than in line 1", "multiples of 128", "float of 32 bits"}},
      {"through %.6e",
       [](double t, std::size_t) { return fmt::format("{:.6e}", t + 1341845434.0); },
       {"other files than in line 1", "multiples of 1000", "%e"}},
  };
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    restore();
    restampBoth(kind.stamp);
    const std::string message = messageOf<std::runtime_error>([&] { slam::readFrameList(toy()); });
    EXPECT_TRUE(mentions(message, {"rgb.txt"}));
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
}

TEST_F(Time, StampsThatGoBackAreSaidAndUnpaddedFractionsNamed) {
  restampBoth([](double, std::size_t i) {
    return fmt::format("{:.2f}", 5.0 + (i == 3 ? -0.5 : 0.0) + 0.1 * static_cast<double>(i));
  });
  const slam::FrameList list = slam::readFrameList(toy());
  EXPECT_EQ(list.frames.size(), 8U);
  EXPECT_TRUE(oneMentions(list.notes, {"rgb.txt", "go back 1 times, first from 5.20 to 4.80"}));
  for (const auto& [digits, unit] :
       std::vector<std::pair<int, const char*>>{{6, "microseconds"}, {9, "nanoseconds"}}) {
    restore();
    const double per_second = std::pow(10.0, digits);
    restampBoth([&](double, std::size_t i) {  // sec and nsec of ROS, joined as they are
      const auto behind = std::llround(per_second * (0.9 + static_cast<double>(i) / 30.0));
      const auto whole = std::llround(per_second);
      return fmt::format("{}.{}", 7 + behind / whole, behind % whole);
    });
    EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { slam::readFrameList(toy()); }),
                         {"rgb.txt", "go back", unit, "without leading zeros"}));
  }
}

TEST_F(Time, ATimeStampBehindItsFileIsNamed) {
  write("associations.txt", "rgb/1.png 1.0 depth/1.png 1.0\n");
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { slam::readFrameList(toy()); }),
                       {"associations.txt:1: time stamp is 'rgb/1.png'", "comes first"}));
}

TEST_F(Time, TheUserDecidesWhatIsAsked) {
  restampBoth([](double, std::size_t i) { return std::to_string(i); });
  slam::DatasetOptions options;
  options.time_unit = TimeUnit::kFrames;
  options.frame_rate = 15.0;
  EXPECT_NEAR(slam::readFrameList(toy(), options).frames.back().timestamp, 7.0 / 15.0, 1e-12);
  options.time_unit = TimeUnit::kSeconds;
  EXPECT_EQ(slam::readFrameList(toy(), options).frames.back().timestamp, 7.0);
  options.time_unit = TimeUnit::kMilliseconds;
  EXPECT_NEAR(slam::readFrameList(toy(), options).frames.back().timestamp, 0.007, 1e-12);
}

TEST_F(Time, ALineThatIsThereThreeTimesCountsOnce) {
  const std::string once = content("rgb.txt");
  std::string thrice;
  for (const std::string& line : linesOf(once)) {
    thrice += line + "\n" + line + "\n" + line + "\n";
  }
  write("rgb.txt", thrice);
  EXPECT_EQ(slam::readFrameList(toy()).frames.size(), 8U);
}

TEST(Stamps, TheUnitOfAnotherFileIsTheOneInWhichItFitsTheFrames) {
  EXPECT_EQ(support::secondsByOverlap({100.0, 100.5}, 100.0, 101.0, 1e-3, 0.02), 1.0);
  EXPECT_EQ(support::secondsByOverlap({100000.0, 100500.0}, 100.0, 101.0, 1.0, 0.02), 1e-3);
  EXPECT_EQ(support::secondsByOverlap({0.0, 5e8}, 0.0, 1.0, 1.0, 0.02), 1e-9);
  EXPECT_EQ(support::secondsByOverlap({30.0, 31.0}, 1.0, 2.0, 1.0 / 30, 0.1), 1.0 / 30);
  // Longer than the other file, in the same unit: not thousandths of it.
  EXPECT_EQ(support::secondsByOverlap({0.0, 1.0, 3.0, 7.0}, 0.0, 3.0, 1.0, 1.0), 1.0);
  // Another recording: 1000 s are not the milliseconds of the first second.
  EXPECT_FALSE(support::secondsByOverlap({1000.0, 1001.0, 1002.0}, 0.0, 3.0, 1.0, 1.0).has_value());
  EXPECT_FALSE(support::secondsByOverlap({7.0}, 100.0, 101.0, 1.0, 0.02).has_value());
}

/// Time as a test sets it; sleeping is over at once.
class FakeClock final : public slam::SteadyClock {
 public:
  explicit FakeClock(double& now) : now_(now) {}
  double now() const override { return now_; }
  void sleepUntil(double time) override { now_ = std::max(now_, time); }

 private:
  double& now_;
};

TEST(Stamps, InRealTimeAGapOfAnHourIsWaitedForNoLongerThanForSeconds) {
  double now = 0.0;
  std::vector<std::string> reports;
  slam::RealtimePacer pacer(
      std::make_unique<slam::FakeRecording>(std::vector<double>{0.0, 0.5, 3600.5, 3601.0, 9000.0}),
      std::make_unique<FakeClock>(now), 1.0, 1, {},
      [&](const std::string& line) { reports.push_back(line); });
  constexpr double kWait = slam::RealtimePacer::kLongestWait;
  for (const double due : {0.0, 0.5, 0.5 + kWait, 1.0 + kWait, 1.0 + 2.0 * kWait}) {
    ASSERT_TRUE(pacer.next().has_value());
    EXPECT_DOUBLE_EQ(now, due);
  }
  EXPECT_EQ(pacer.counts().dropped, 0U);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(mentions(reports[0], {"gap of 3600.0 s"}));
}

TEST(Stamps, AStopEndsTheWaitForAFrame) {
  double now = 0.0;
  int asked = 0;
  slam::RealtimePacer pacer(std::make_unique<slam::FakeRecording>(std::vector<double>{0.0, 3600.0}),
                            std::make_unique<FakeClock>(now), 1.0, 1, [&] { return ++asked > 3; });
  ASSERT_TRUE(pacer.next().has_value());
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_LT(now, 0.5);
  EXPECT_EQ(pacer.counts().taken_up, 1U);
}

}  // namespace
}  // namespace hmcdyn::faults
