// SPDX-License-Identifier: BSD-3-Clause
#include "support/worker.hpp"

#include <atomic>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

int twice(int value) { return 2 * value; }

/// Work that a test lets go on when it wants to: it says that it began, then waits.
class Gate {
 public:
  int operator()(int value) {
    began_.set_value();
    opened_.wait();
    return twice(value);
  }
  void awaitBegin() { began_.get_future().wait(); }
  void open() { open_.set_value(); }

 private:
  std::promise<void> began_;
  std::promise<void> open_;
  std::shared_future<void> opened_ = open_.get_future().share();
};

/// The first job waits at the gate, the others do not.
std::function<int(int)> behind(Gate& gate) {
  return [&gate, first = std::make_shared<std::atomic<bool>>(true)](int value) {
    return first->exchange(false) ? gate(value) : twice(value);
  };
}

TEST(Worker, GivesResultsInTheOrderOfSubmission) {
  support::Worker<int, int> worker(twice, 4);
  std::vector<int> results;
  for (int i = 0; i < 100; ++i) {
    worker.submit(i);
    if (i >= 3) {
      results.push_back(worker.take());
    }
  }
  while (worker.pending() > 0) {
    results.push_back(worker.take());
  }
  ASSERT_EQ(results.size(), 100u);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(results[static_cast<std::size_t>(i)], 2 * i);
  }
}

TEST(Worker, RunsJobsOnOneThreadThatIsNotTheCallers) {
  support::Worker<int, std::thread::id> worker([](int) { return std::this_thread::get_id(); }, 2);
  worker.submit(0);
  worker.submit(1);
  const std::thread::id first = worker.take();
  EXPECT_NE(first, std::this_thread::get_id());
  EXPECT_EQ(worker.take(), first);
}

TEST(Worker, RefusesAJobWhereTheQueueIsFull) {
  Gate gate;
  support::Worker<int, int> worker(behind(gate), 2);
  worker.submit(1);
  gate.awaitBegin();  // the running job is not in the queue
  EXPECT_TRUE(worker.trySubmit(2));
  EXPECT_TRUE(worker.trySubmit(3));
  EXPECT_FALSE(worker.trySubmit(4));
  EXPECT_EQ(worker.pending(), 3u);
  gate.open();
  EXPECT_EQ(worker.take(), 2);
  EXPECT_EQ(worker.take(), 4);
  EXPECT_EQ(worker.take(), 6);
  EXPECT_EQ(worker.pending(), 0u);
}

TEST(Worker, SubmitWaitsForRoom) {
  Gate gate;
  support::Worker<int, int> worker(behind(gate), 1);
  worker.submit(1);
  gate.awaitBegin();
  worker.submit(2);
  std::thread producer([&worker] { worker.submit(3); });  // no room until the gate is open
  EXPECT_FALSE(worker.trySubmit(4));
  gate.open();
  producer.join();
  EXPECT_EQ(worker.take(), 2);
  EXPECT_EQ(worker.take(), 4);
  EXPECT_EQ(worker.take(), 6);
}

TEST(Worker, TheOldestQueuedJobMakesRoomForTheNewest) {
  Gate gate;
  support::Worker<int, int> worker(behind(gate), 1);
  worker.submit(1);
  gate.awaitBegin();
  EXPECT_EQ(worker.submitReplacingOldest(2), std::nullopt);
  EXPECT_EQ(worker.submitReplacingOldest(3), 2);
  EXPECT_EQ(worker.submitReplacingOldest(4), 3);
  EXPECT_EQ(worker.pending(), 2u);
  gate.open();
  EXPECT_EQ(worker.take(), 2);
  EXPECT_EQ(worker.take(), 8);
  EXPECT_EQ(worker.pending(), 0u);
}

TEST(Worker, TryTakeDoesNotWait) {
  Gate gate;
  support::Worker<int, int> worker(behind(gate), 1);
  EXPECT_EQ(worker.tryTake(), std::nullopt);
  worker.submit(1);
  gate.awaitBegin();
  EXPECT_EQ(worker.tryTake(), std::nullopt);
  worker.submit(2);
  gate.open();
  EXPECT_EQ(worker.take(), 2);
  EXPECT_EQ(worker.take(), 4);
  EXPECT_EQ(worker.tryTake(), std::nullopt);
}

TEST(Worker, RethrowsWhatAJobThrewInItsPlaceAndGoesOn) {
  support::Worker<int, int> worker(
      [](int value) {
        if (value == 2) {
          throw std::runtime_error("job " + std::to_string(value));
        }
        return twice(value);
      },
      3);
  worker.submit(1);
  worker.submit(2);
  worker.submit(3);
  EXPECT_EQ(worker.take(), 2);
  try {
    worker.take();
    FAIL() << "expected an exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "job 2");
  }
  EXPECT_EQ(worker.take(), 6);
  EXPECT_EQ(worker.pending(), 0u);
}

TEST(Worker, AThrowingJobIsTakenOnce) {
  support::Worker<int, int> worker(
      [first = true](int value) mutable {
        if (std::exchange(first, false)) {
          throw std::domain_error("first");
        }
        return twice(value);
      },
      2);
  worker.submit(1);
  worker.submit(2);
  EXPECT_THROW(worker.take(), std::domain_error);
  EXPECT_EQ(worker.take(), 4);
  EXPECT_EQ(worker.tryTake(), std::nullopt);
}

TEST(Worker, TakesMoveOnlyJobsAndGivesMoveOnlyResults) {
  support::Worker<std::unique_ptr<int>, std::unique_ptr<int>> worker(
      [](std::unique_ptr<int> value) { return std::make_unique<int>(twice(*value)); }, 1);
  worker.submit(std::make_unique<int>(21));
  EXPECT_EQ(*worker.take(), 42);
}

TEST(Worker, AnExceptionThatIsAResultIsNotThrown) {
  support::Worker<int, std::exception_ptr> worker(
      [](int) { return std::make_exception_ptr(std::runtime_error("kept")); }, 1);
  worker.submit(0);
  EXPECT_THROW(std::rethrow_exception(worker.take()), std::runtime_error);
}

/// A job that opens a gate when it is destroyed.
using GateOpener = std::unique_ptr<Gate, void (*)(Gate*)>;

TEST(Worker, TheDestructorFinishesTheRunningJobAndDiscardsTheQueued) {
  Gate gate;
  std::atomic<int> begun{0};
  std::atomic<int> done{0};
  {
    support::Worker<GateOpener, int> worker(
        [&](const GateOpener& /*job*/) {
          ++begun;
          const int result = gate(0);
          ++done;
          return result;
        },
        2);
    worker.submit(GateOpener(nullptr, [](Gate*) {}));
    gate.awaitBegin();
    // Only when the destructor discards this one may the running job go on.
    worker.submit(GateOpener(&gate, [](Gate* closed) { closed->open(); }));
  }
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(done, 1);
}

TEST(Worker, ServesSeveralProducersAtOnce) {
  support::Worker<int, int> worker(twice, 2);
  std::vector<std::thread> producers;
  constexpr int kProducers = 4;
  constexpr int kJobs = 200;
  producers.reserve(kProducers);
  for (int p = 0; p < kProducers; ++p) {
    producers.emplace_back([&worker, p] {
      for (int i = 0; i < kJobs; ++i) {
        worker.submit(p * kJobs + i);
      }
    });
  }
  for (std::thread& producer : producers) {
    producer.join();
  }
  long sum = 0;
  while (worker.pending() > 0) {
    sum += worker.take();
  }
  constexpr long kCount = kProducers * kJobs;
  EXPECT_EQ(sum, kCount * (kCount - 1));  // 2 (0 + 1 + ... + kCount - 1)
}

// Which of the two comes first is open; that one has to wait for the gate, and the other must not.
TEST(Worker, OfTwoTakersOfOneResultOneIsTurnedAway) {
  Gate gate;
  support::Worker<int, int> worker(behind(gate), 1);
  worker.submit(21);
  gate.awaitBegin();
  std::promise<std::string> turned_away;
  std::atomic<int> taken{0};
  const auto take = [&] {
    try {
      taken += worker.take();
    } catch (const std::logic_error& error) {
      turned_away.set_value(error.what());
    }
  };
  std::thread one(take);
  std::thread other(take);
  EXPECT_EQ(turned_away.get_future().get(),
            "Worker::take: no job is pending but the 1 that others wait for; submit one first");
  EXPECT_EQ(worker.tryTake(), std::nullopt);
  gate.open();
  one.join();
  other.join();
  EXPECT_EQ(taken, 42);
  EXPECT_EQ(worker.pending(), 0u);
}

TEST(Worker, RefusesWhatCannotBe) {
  EXPECT_THROW((support::Worker<int, int>(nullptr, 1)), std::invalid_argument);
  EXPECT_THROW((support::Worker<int, int>(twice, 0)), std::invalid_argument);
  support::Worker<int, int> idle(twice, 1);
  EXPECT_THROW(idle.take(), std::logic_error);
}

}  // namespace
}  // namespace hmcdyn::slam
