// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/realtime_pacer.hpp"

#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "input/source/fake_recording.hpp"

namespace hmcdyn::slam {
namespace {

/// Time as a test sets it; sleeping is over at once.
struct FakeTime {
  double now = 50.0;
  std::vector<double> sleeps;  ///< Where each sleep ended.
};

class FakeClock final : public SteadyClock {
 public:
  explicit FakeClock(FakeTime& time) : time_(time) {}
  double now() const override { return time_.now; }
  void sleepUntil(double time) override {
    if (time > time_.now) {
      time_.now = time;
      time_.sleeps.push_back(time);
    }
  }

 private:
  FakeTime& time_;
};

RealtimePacer pace(std::vector<double> stamps, FakeTime& time, double speed = 1.0,
                   std::size_t held = 1) {
  return {std::make_unique<FakeRecording>(std::move(stamps)), std::make_unique<FakeClock>(time),
          speed, held};
}

TEST(RealtimePacer, WaitsForEachTimeStamp) {
  FakeTime time;
  RealtimePacer pacer = pace({1000.0, 1000.25, 1000.75}, time);
  EXPECT_EQ(pacer.next()->index, 0u);
  EXPECT_EQ(pacer.next()->index, 1u);
  EXPECT_EQ(pacer.next()->index, 2u);
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_EQ(time.sleeps, (std::vector<double>{50.25, 50.75}));
  EXPECT_EQ(pacer.counts().dropped, 0u);
}

TEST(RealtimePacer, DoesNotWaitForAFrameThatIsDueNorDropItWhileTheNextIsNot) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25, 0.5}, time);
  pacer.next();
  time.now = 50.4375;  // busy: frame 1 is due since 50.25, frame 2 is not
  EXPECT_EQ(pacer.next()->index, 1u);
  EXPECT_EQ(time.now, 50.4375);
  EXPECT_EQ(pacer.counts().dropped, 0u);
}

TEST(RealtimePacer, DropsWhatTheNextFrameHasOvertaken) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25, 0.5, 0.75, 1.0}, time);
  pacer.next();
  time.now = 50.75;  // frames 1, 2 and 3 are due: 3 is the newest
  EXPECT_EQ(pacer.next()->index, 3u);
  EXPECT_EQ(pacer.counts().dropped, 2u);
  EXPECT_EQ(pacer.counts().taken_up, 4u);
  EXPECT_EQ(pacer.next()->index, 4u);
  EXPECT_EQ(time.sleeps, (std::vector<double>{51.0}));
}

TEST(RealtimePacer, HoldsAsManyImagesAsTheCameraAndDropsTheOldest) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5}, time, 1.0, 3);
  pacer.next();
  time.now = 50.75;  // frames 1, 2 and 3 wait
  EXPECT_EQ(pacer.next()->index, 1u);
  EXPECT_EQ(pacer.counts().dropped, 0u);
  time.now = 51.25;  // 2 to 5 would wait: 2 had to go
  EXPECT_EQ(pacer.next()->index, 3u);
  EXPECT_EQ(pacer.counts().dropped, 1u);
  EXPECT_EQ(pacer.next()->index, 4u);
  EXPECT_EQ(pacer.next()->index, 5u);
  EXPECT_TRUE(time.sleeps.empty());
  EXPECT_EQ(pacer.next()->index, 6u);
  EXPECT_EQ(time.sleeps, (std::vector<double>{51.5}));
  EXPECT_EQ(pacer.counts().dropped, 1u);
}

TEST(RealtimePacer, TellsHowLongAgoTheLastFrameWasDue) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25, 0.5, 0.125}, time, 1.0, 3);
  EXPECT_FALSE(pacer.secondsSinceDue());
  pacer.next();
  time.now = 50.0625;  // tracked
  EXPECT_EQ(pacer.secondsSinceDue(), 0.0625);
  time.now = 50.5;  // late
  pacer.next();
  EXPECT_EQ(pacer.secondsSinceDue(), 0.25);
  pacer.next();
  time.now = 50.75;
  EXPECT_EQ(pacer.secondsSinceDue(), 0.25);
  pacer.next();  // its stamp goes back: it came with the frame before
  EXPECT_EQ(pacer.secondsSinceDue(), 0.25);
}

TEST(RealtimePacer, AlwaysDeliversTheLastFrame) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25, 0.5}, time);
  pacer.next();
  time.now = 99.0;
  EXPECT_EQ(pacer.next()->index, 2u);
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_EQ(pacer.counts().dropped, 1u);
}

TEST(RealtimePacer, CountsTimeFromTheFirstFrameTakenUp) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.25}, time);
  time.now = 80.0;  // models were loaded meanwhile
  pacer.next();
  EXPECT_EQ(pacer.next()->index, 1u);
  EXPECT_EQ(time.sleeps, (std::vector<double>{80.25}));
}

TEST(RealtimePacer, GoesFasterWhereAsked) {
  FakeTime time;
  RealtimePacer pacer = pace({0.0, 0.5}, time, 2.0);
  pacer.next();
  pacer.next();
  EXPECT_EQ(time.sleeps, (std::vector<double>{50.25}));
}

TEST(RealtimePacer, TimeStampsThatGoBackAreDueAtOnce) {
  FakeTime time;
  RealtimePacer pacer = pace({10.0, 9.0, 10.5}, time);
  pacer.next();
  EXPECT_EQ(pacer.next()->index, 1u);
  EXPECT_TRUE(time.sleeps.empty());
  EXPECT_EQ(pacer.next()->index, 2u);
  EXPECT_EQ(time.sleeps, (std::vector<double>{50.5}));
}

TEST(RealtimePacer, OfAnEmptyRecordingIsAtItsEnd) {
  FakeTime time;
  RealtimePacer pacer = pace({}, time);
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_EQ(pacer.expectedFrames(), 0u);
  EXPECT_EQ(pacer.name(), "recording in real time");
}

TEST(RealtimePacer, RefusesWhatCannotBe) {
  FakeTime time;
  for (const double speed : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(pace({0.0}, time, speed), std::invalid_argument);
  }
  EXPECT_THROW(pace({0.0}, time, 1.0, 0), std::invalid_argument);
  EXPECT_THROW(RealtimePacer(nullptr, std::make_unique<FakeClock>(time)), std::invalid_argument);
  EXPECT_THROW(RealtimePacer(std::make_unique<FakeRecording>(std::vector<double>{}), nullptr),
               std::invalid_argument);
}

TEST(WallClock, NeverGoesBackAndReachesWhatItSleepsFor) {
  const std::unique_ptr<SteadyClock> clock = makeWallClock();
  const double before = clock->now();
  EXPECT_GE(before, 0.0);
  clock->sleepUntil(before - 1.0);  // past: at once
  const double target = clock->now() + 0.001;
  clock->sleepUntil(target);
  EXPECT_GE(clock->now(), target - 1e-9);  // the clock counts nanoseconds
}

}  // namespace
}  // namespace hmcdyn::slam
