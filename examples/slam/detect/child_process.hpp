// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include <sys/types.h>

#include <hmcdyn/span.hpp>

namespace hmcdyn::slam {

/// A command of the shell that runs beside us, written to and read from in turns (POSIX). What it
/// writes to its standard error is read all along, so that it never waits for us, and its end kept.
/// It has a process group of its own: Ctrl-C reaches us and not it, and what it started ends with
/// it. One thread at a time. Where we are killed it finds its standard input at its end.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  /// Starts it.
  /// @throws std::runtime_error where the system has no process or pipe left.
  explicit ChildProcess(const std::string& command);
  /// Ends it: its standard input is closed, it has `kPatience` to go, then it and its group are
  /// killed. It is waited for, so no zombie stays.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ChildProcess(ChildProcess&&) = delete;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// Writes all of it, and reads meanwhile what comes back.
  /// @throws std::runtime_error where it ends before, or does not take it until the deadline.
  void write(Span<const char> bytes, Clock::time_point deadline);

  /// The next line of its standard output, without the line's end.
  /// @throws std::runtime_error where it ends before, says nothing until the deadline, or says more
  /// than `most` bytes without a line's end.
  std::string readLine(Clock::time_point deadline, std::size_t most);

  /// The next bytes of its standard output.
  /// @throws std::runtime_error where it ends before, or until the deadline.
  std::string read(std::size_t bytes, Clock::time_point deadline);

  /// Kills it and its group at once, and waits for it.
  void kill();

  /// The last of what it wrote to its standard error.
  const std::string& lastWords() const noexcept { return errors_; }

  /// How long a process may take to end of itself.
  static constexpr std::chrono::milliseconds kPatience{2000};

 private:
  /// Waits until something can be read or written, and does it.
  /// @return false where the standard output is at its end.
  /// @throws std::runtime_error at the deadline, which `what` describes.
  bool exchange(Span<const char>& to_write, Clock::time_point deadline, const char* what);
  /// What became of it, for a message; waits for it.
  std::string endAsText();
  /// Reads what is left of its standard error.
  void collectLastWords();
  void closePipes() noexcept;

  pid_t pid_ = -1;
  int input_ = -1;   ///< Its standard input, our end.
  int output_ = -1;  ///< Its standard output.
  int error_ = -1;   ///< Its standard error.
  std::string output_read_;
  std::string errors_;
  int status_ = 0;  ///< Of waitpid, once it was waited for.
};

}  // namespace hmcdyn::slam
