// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/read_ahead.hpp"

#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "input/source/fake_recording.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn::slam {
namespace {

std::unique_ptr<RecordedSource> recording(std::vector<double> stamps) {
  return std::make_unique<FakeRecording>(std::move(stamps));
}

TEST(ReadAhead, HandsOutEveryFrameInOrderWithTheStampsInSight) {
  ReadAhead source(recording({1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0}));
  EXPECT_EQ(source.name(), "recording");
  EXPECT_EQ(source.expectedFrames(), 7U);
  std::vector<double> stamps;
  while (const std::optional<double> expected = source.upcomingTimestamp(0)) {
    EXPECT_EQ(source.upcomingTimestamp(1),
              *expected < 64.0 ? std::optional<double>(2.0 * *expected) : std::nullopt);
    EXPECT_FALSE(source.upcomingTimestamp(2)) << "out of sight";
    const std::optional<RgbdFrame> frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->timestamp, *expected);
    EXPECT_EQ(frame->index, stamps.size());
    stamps.push_back(frame->timestamp);
  }
  EXPECT_EQ(stamps.size(), 7U);
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next()) << "the end stays the end";
}

TEST(ReadAhead, CountsWhatWasHandedOutOrSkippedAndNotWhatWaits) {
  ReadAhead source(recording({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}), 1);
  EXPECT_EQ(source.counts().taken_up, 0U);
  source.next();
  EXPECT_EQ(source.counts().taken_up, 1U);
  source.skip();
  EXPECT_EQ(source.counts().taken_up, 2U);
  EXPECT_EQ(source.counts().dropped, 1U);
  EXPECT_EQ(source.upcomingTimestamp(0), 3.0);
  for (int k = 0; k < 10; ++k) {
    source.skip();  // beyond the end there is nothing to skip
  }
  EXPECT_EQ(source.counts().taken_up, 6U);
  EXPECT_EQ(source.counts().dropped, 5U);
}

TEST(ReadAhead, OfNothingIsAtItsEnd) {
  ReadAhead source(recording({}));
  EXPECT_FALSE(source.upcomingTimestamp(0));
  EXPECT_FALSE(source.next());
}

/// Loads two frames, and then fails.
class Failing final : public RecordedSource {
 public:
  explicit Failing(std::thread::id& loader) : loader_(loader) {}
  std::optional<RgbdFrame> next() override {
    loader_ = std::this_thread::get_id();
    if (++loaded_ > 2) {
      throw std::runtime_error("the disk is gone");
    }
    return RgbdFrame{};
  }
  std::optional<std::size_t> expectedFrames() const override { return std::nullopt; }
  std::string name() const override { return "failing"; }
  SourceCounts counts() const override { return {}; }
  std::optional<double> upcomingTimestamp(std::size_t /*before*/) const override { return 0.0; }
  void skip() override {}

 private:
  std::thread::id& loader_;
  int loaded_ = 0;
};

TEST(ReadAhead, LoadsOnAnotherThreadAndRethrowsWhatThatThrew) {
  std::thread::id loader;
  {
    ReadAhead source(std::make_unique<Failing>(loader));
    EXPECT_THROW(source.next(), std::runtime_error);
  }
  EXPECT_NE(loader, std::this_thread::get_id());
  EXPECT_NE(loader, std::thread::id{});
}

TEST(ReadAhead, RefusesNoSourceAndNothingInSight) {
  EXPECT_EQ(hmcdyn::test::invalidArgumentOf([] { ReadAhead source(nullptr); }),
            "ReadAhead: source is null");
  EXPECT_EQ(hmcdyn::test::invalidArgumentOf([] { ReadAhead source(recording({1.0}), 0); }),
            "ReadAhead: in_sight is 0; expected 1 or more");
}

}  // namespace
}  // namespace hmcdyn::slam
