// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/realtime_pacer.hpp"

#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

/// Frames that have time stamps and nothing else.
class StampsOnly final : public RecordedSource {
 public:
  explicit StampsOnly(std::vector<double> stamps) : stamps_(std::move(stamps)) {}

  std::optional<RgbdFrame> next() override {
    if (position_ == stamps_.size()) {
      return std::nullopt;
    }
    ++counts_.taken_up;
    RgbdFrame frame;
    frame.index = position_;
    frame.timestamp = stamps_[position_++];
    return frame;
  }
  std::optional<std::size_t> expectedFrames() const override { return stamps_.size(); }
  std::string name() const override { return "stamps"; }
  SourceCounts counts() const override { return counts_; }
  std::optional<double> nextTimestamp() const override { return at(position_); }
  std::optional<double> timestampAfterNext() const override { return at(position_ + 1); }
  void skip() override {
    ++position_;
    ++counts_.taken_up;
    ++counts_.dropped;
  }

 private:
  std::optional<double> at(std::size_t i) const {
    return i < stamps_.size() ? std::optional<double>(stamps_[i]) : std::nullopt;
  }

  std::vector<double> stamps_;
  std::size_t position_ = 0;
  SourceCounts counts_;
};

/// Time that passes only where somebody sleeps, or a test says so.
class FakeClock final : public SteadyClock {
 public:
  explicit FakeClock(double* time) : time_(time) {}
  double now() const override { return *time_; }
  void sleepUntil(double time) override {
    if (time > *time_) {
      *time_ = time;
    }
  }

 private:
  double* time_;
};

class Pacer : public testing::Test {
 protected:
  RealtimePacer pace(std::vector<double> stamps, double speed = 1.0) {
    return RealtimePacer(std::make_unique<StampsOnly>(std::move(stamps)),
                         std::make_unique<FakeClock>(&time_), speed);
  }

  double time_ = 50.0;  ///< Of the clock (s).
};

TEST_F(Pacer, EachFrameComesWhenItsStampSaysSo) {
  RealtimePacer pacer = pace({7.0, 7.25, 8.0});
  EXPECT_EQ(pacer.next().value().index, 0U);
  EXPECT_DOUBLE_EQ(time_, 50.0);
  EXPECT_EQ(pacer.next().value().index, 1U);
  EXPECT_DOUBLE_EQ(time_, 50.25);
  time_ = 50.5;  // a quarter of a second of work
  EXPECT_EQ(pacer.next().value().index, 2U);
  EXPECT_DOUBLE_EQ(time_, 51.0);
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_EQ(pacer.counts().dropped, 0U);
}

TEST_F(Pacer, SpeedDividesTheWaits) {
  RealtimePacer pacer = pace({7.0, 8.0}, 4.0);
  pacer.next();
  pacer.next();
  EXPECT_DOUBLE_EQ(time_, 50.25);
}

TEST_F(Pacer, SlowWorkDropsAllButTheNewestFrameThatIsDue) {
  RealtimePacer pacer = pace({0.0, 1.0, 2.0, 3.0, 4.0});
  pacer.next();
  time_ += 3.5;  // 1, 2 and 3 are due
  EXPECT_EQ(pacer.next().value().index, 3U);
  EXPECT_DOUBLE_EQ(time_, 53.5);  // at once
  EXPECT_EQ(pacer.counts().dropped, 2U);
  EXPECT_EQ(pacer.next().value().index, 4U);
  EXPECT_DOUBLE_EQ(time_, 54.0);
  EXPECT_EQ(pacer.counts().dropped, 2U);
  EXPECT_EQ(pacer.counts().taken_up, 5U);
}

TEST_F(Pacer, TheLastFrameIsDeliveredHoweverLate) {
  RealtimePacer pacer = pace({0.0, 1.0, 2.0});
  pacer.next();
  time_ += 1000.0;
  EXPECT_EQ(pacer.next().value().index, 2U);
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_EQ(pacer.counts().dropped, 1U);
}

TEST_F(Pacer, StampsThatStandStillOrGoBackNeverWait) {
  // 1 and 2 are due at once, as is what stands behind them: the camera's newest image is the last.
  RealtimePacer pacer = pace({5.0, 5.0, 3.0, 6.0});
  EXPECT_EQ(pacer.next().value().index, 0U);
  EXPECT_EQ(pacer.next().value().index, 2U);
  EXPECT_DOUBLE_EQ(time_, 50.0);
  EXPECT_EQ(pacer.counts().dropped, 1U);
  EXPECT_EQ(pacer.next().value().index, 3U);
  EXPECT_DOUBLE_EQ(time_, 51.0);
}

TEST_F(Pacer, AnEmptyRecordingEndsAtOnce) {
  RealtimePacer pacer = pace({});
  EXPECT_FALSE(pacer.next().has_value());
  EXPECT_DOUBLE_EQ(time_, 50.0);
}

TEST_F(Pacer, RefusesWhatCannotBe) {
  for (const double speed : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(pace({0.0}, speed), std::invalid_argument) << speed;
  }
  EXPECT_THROW(RealtimePacer(nullptr, std::make_unique<FakeClock>(&time_)), std::invalid_argument);
  EXPECT_THROW(RealtimePacer(std::make_unique<StampsOnly>(std::vector<double>{}), nullptr),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam
