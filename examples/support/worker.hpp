// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <variant>

namespace hmcdyn::support {

/// One thread that runs jobs one after the other, in the order in which they were submitted, and
/// hands out their results in that order. Any thread may submit and take. The queue of jobs is
/// bounded; results wait until they are taken, so take as many as are submitted.
///
/// The destructor lets the running job finish, discards those in the queue and joins.
template <class Job, class Result>
class Worker {
  static_assert(!std::is_void_v<Result>, "a job without a result: let it give a std::monostate");

 public:
  /// Starts the thread.
  /// @param work what is done with a job, on the worker's thread. What it captures must outlive the
  /// worker, or be owned by it.
  /// @param capacity most jobs that wait in the queue, the running one not counted; at least 1.
  /// @throws std::invalid_argument for an empty function or a capacity of 0.
  explicit Worker(std::function<Result(Job)> work, std::size_t capacity)
      : work_(std::move(work)), capacity_(capacity) {
    if (!work_) {
      throw std::invalid_argument("Worker: work is empty; expected a function");
    }
    if (capacity_ == 0) {
      throw std::invalid_argument("Worker: capacity is 0; expected 1 or more");
    }
    thread_ = std::thread([this] { run(); });
  }

  ~Worker() {
    std::deque<Job> discarded;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
      discarded.swap(queue_);
    }
    job_came_.notify_one();
    discarded.clear();  // without the lock, and before the running job is waited for
    thread_.join();
  }

  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  Worker(Worker&&) = delete;
  Worker& operator=(Worker&&) = delete;

  /// Queues a job, without waiting.
  /// @return false where the queue is full; the job is gone then.
  bool trySubmit(Job job) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (queue_.size() >= capacity_) {
        return false;
      }
      push(std::move(job));
    }
    job_came_.notify_one();
    return true;
  }

  /// Queues a job; waits for room where the queue is full.
  void submit(Job job) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      room_came_.wait(lock, [this] { return queue_.size() < capacity_; });
      push(std::move(job));
    }
    job_came_.notify_one();
  }

  /// Queues a job, without waiting: where the queue is full, the job that waited longest makes room
  /// and will have no result.
  /// @return the job that made room, if one had to.
  std::optional<Job> submitReplacingOldest(Job job) {
    std::optional<Job> replaced;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (queue_.size() >= capacity_) {
        replaced.emplace(std::move(queue_.front()));
        queue_.pop_front();
        --pending_;
      }
      push(std::move(job));
    }
    job_came_.notify_one();
    return replaced;
  }

  /// The next result, if it is there already and nobody waits for it in take(). Rethrows what its
  /// job threw; the next call goes on with the next job's.
  std::optional<Result> tryTake() {
    std::optional<Outcome> outcome;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (outcomes_.size() <= takers_) {
        return std::nullopt;
      }
      outcome.emplace(popOutcome());
    }
    return unwrap(std::move(*outcome));
  }

  /// The next result; waits for it. Rethrows what its job threw, as tryTake() does.
  /// @throws std::logic_error where no job is pending but those whose results others wait for
  /// already: it would be waited for without end.
  Result take() {
    std::optional<Outcome> outcome;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (pending_ <= takers_) {
        throw std::logic_error(
            "Worker::take: no job is pending" +
            (takers_ == 0 ? std::string()
                          : " but the " + std::to_string(takers_) + " that others wait for") +
            "; submit one first");
      }
      ++takers_;
      result_came_.wait(lock, [this] { return !outcomes_.empty(); });
      --takers_;
      outcome.emplace(popOutcome());
    }
    return unwrap(std::move(*outcome));
  }

  /// Jobs whose result was not taken yet: queued, running or done.
  std::size_t pending() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return pending_;
  }

 private:
  using Outcome = std::variant<Result, std::exception_ptr>;

  // Index and not type: a Result may be an exception_ptr itself.
  static constexpr std::size_t kResult = 0;
  static constexpr std::size_t kThrown = 1;

  void push(Job job) {
    queue_.push_back(std::move(job));
    ++pending_;
  }

  Outcome popOutcome() {
    Outcome outcome = std::move(outcomes_.front());
    outcomes_.pop_front();
    --pending_;
    return outcome;
  }

  static Result unwrap(Outcome outcome) {
    if (outcome.index() == kThrown) {
      std::rethrow_exception(std::move(std::get<kThrown>(outcome)));
    }
    return std::move(std::get<kResult>(outcome));
  }

  Outcome runJob(Job job) {
    try {
      return Outcome(std::in_place_index<kResult>, work_(std::move(job)));
    } catch (...) {
      return Outcome(std::in_place_index<kThrown>, std::current_exception());
    }
  }

  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      job_came_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
      if (stopping_) {
        return;
      }
      std::optional<Job> job(std::move(queue_.front()));
      queue_.pop_front();
      lock.unlock();
      room_came_.notify_one();
      Outcome outcome = runJob(std::move(*job));
      job.reset();
      lock.lock();
      outcomes_.push_back(std::move(outcome));
      result_came_.notify_one();
    }
  }

  std::function<Result(Job)> work_;
  std::size_t capacity_;

  mutable std::mutex mutex_;             ///< Guards what follows, up to stopping_.
  std::condition_variable job_came_;     ///< A job was queued, or the end has come.
  std::condition_variable room_came_;    ///< A job left the queue.
  std::condition_variable result_came_;  ///< A job is done.
  std::deque<Job> queue_;
  std::deque<Outcome> outcomes_;
  std::size_t pending_ = 0;
  std::size_t takers_ = 0;  ///< Threads that wait in take(), each for a result of its own.
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace hmcdyn::support
