// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/stop_request.hpp"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

TEST(StopRequest, IsAskedForByEitherSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const StopRequest stop;
    EXPECT_FALSE(stop.requested());
    EXPECT_EQ(stop.signal(), 0);
    EXPECT_FALSE(stop.flag());
    std::raise(signal);
    EXPECT_TRUE(stop.requested());
    EXPECT_TRUE(stop.flag());
    EXPECT_EQ(stop.signal(), signal);
  }
}

TEST(StopRequest, IsForgottenWithItsObject) {
  {
    const StopRequest stop;
    std::raise(SIGTERM);
  }
  const StopRequest next;
  EXPECT_FALSE(next.requested());
}

TEST(StopRequestDeathTest, ASecondSignalKills) {
  const auto twice = [](int first, int second) {
    const StopRequest stop;
    std::raise(first);
    std::raise(second);
    std::_Exit(0);
  };
  EXPECT_EXIT(twice(SIGINT, SIGINT), testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(twice(SIGINT, SIGTERM), testing::KilledBySignal(SIGTERM), "");
}

TEST(StopRequestDeathTest, TheFirstSignalDoesNotKill) {
  const auto finish = [] {
    const StopRequest stop;
    std::raise(SIGTERM);
    std::_Exit(stop.requested() ? 7 : 8);
  };
  EXPECT_EXIT(finish(), testing::ExitedWithCode(7), "");
}

TEST(StopRequestDeathTest, AfterItsEndASignalKillsAsBefore) {
  const auto outlive = [] {
    { const StopRequest stop; }
    std::raise(SIGTERM);
    std::_Exit(0);
  };
  EXPECT_EXIT(outlive(), testing::KilledBySignal(SIGTERM), "");
}

TEST(StopRequest, OneAtATime) {
  const StopRequest stop;
  EXPECT_THROW(StopRequest(), std::logic_error);
  std::raise(SIGINT);  // the first still serves
  EXPECT_TRUE(stop.requested());
}

}  // namespace
}  // namespace hmcdyn::slam
