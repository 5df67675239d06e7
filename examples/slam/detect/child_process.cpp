// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <sys/wait.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kLastWords = 4096;  // as much as a stack trace of Python

[[noreturn]] void failSystem(const char* what) {
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

/// The two ends of a pipe, closed where nobody takes them.
class Pipe {
 public:
  Pipe() {
    // Not inherited by what others start at the same time; dup2 takes the mark off.
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) {
      failSystem("cannot make a pipe");
    }
  }
  ~Pipe() {
    for (const int end : ends_) {
      if (end >= 0) {
        close(end);
      }
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  Pipe(Pipe&&) = delete;
  Pipe& operator=(Pipe&&) = delete;

  int readEnd() const { return ends_[0]; }
  int writeEnd() const { return ends_[1]; }
  int take(std::size_t end) {
    const int taken = std::exchange(ends_[end], -1);
    fcntl(taken, F_SETFL, O_NONBLOCK);
    return taken;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// Between fork and exec of a program with threads: nothing but system calls.
[[noreturn]] void becomeCommand(const char* command, int input, int output, int error) {
  setpgid(0, 0);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(error, STDERR_FILENO);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    std::signal(number, SIG_DFL);
  }
  const char* const arguments[] = {"sh", "-c", command, nullptr};
  execv("/bin/sh", const_cast<char* const*>(arguments));  // NOLINT: as POSIX declares it
  _exit(127);
}

/// Writing to a process that has gone gives EPIPE, and no signal to the whole program.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~NoPipeSignal() {
    constexpr timespec kAtOnce{0, 0};
    while (sigtimedwait(&set_, nullptr, &kAtOnce) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;
  NoPipeSignal(NoPipeSignal&&) = delete;
  NoPipeSignal& operator=(NoPipeSignal&&) = delete;

 private:
  sigset_t set_{};
  sigset_t before_{};
};

enum class Drained { kSome, kNothingYet, kEnd };

/// Appends what can be read.
Drained drain(int from, std::string& to) {
  std::array<char, 65536> buffer{};
  const ssize_t got = ::read(from, buffer.data(), buffer.size());
  if (got > 0) {
    to.append(buffer.data(), static_cast<std::size_t>(got));
    return Drained::kSome;
  }
  return got < 0 && (errno == EAGAIN || errno == EINTR) ? Drained::kNothingYet : Drained::kEnd;
}

}  // namespace

ChildProcess::ChildProcess(const std::string& command) {
  Pipe input;
  Pipe output;
  Pipe error;
  // NOLINTNEXTLINE(cppcoreguidelines-prefer-member-initializer): the pipes come first
  pid_ = fork();
  if (pid_ < 0) {
    failSystem("cannot start a process");
  }
  if (pid_ == 0) {
    becomeCommand(command.c_str(), input.readEnd(), output.writeEnd(), error.writeEnd());
  }
  setpgid(pid_, pid_);  // here as well: whoever comes first
  input_ = input.take(1);
  output_ = output.take(0);
  error_ = error.take(0);
}

ChildProcess::~ChildProcess() {
  if (pid_ < 0) {
    return;
  }
  if (input_ >= 0) {
    close(std::exchange(input_, -1));
  }
  try {  // its standard output ends with it
    Span<const char> nothing;
    const Clock::time_point deadline = Clock::now() + kPatience;
    while (exchange(nothing, deadline, "")) {
    }
  } catch (const std::exception&) {
    errors_.clear();  // it does not go by itself
  }
  kill();
}

void ChildProcess::closePipes() noexcept {
  for (int* const end : {&input_, &output_, &error_}) {
    if (*end >= 0) {
      close(std::exchange(*end, -1));
    }
  }
}

void ChildProcess::collectLastWords() {
  while (error_ >= 0 && drain(error_, errors_) == Drained::kSome) {
  }
  errors_.erase(0, errors_.size() - std::min(errors_.size(), kLastWords));
}

void ChildProcess::kill() {
  if (pid_ >= 0) {
    ::kill(-pid_, SIGKILL);  // the group, of which a child of the shell may be left
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    collectLastWords();
  }
  closePipes();
}

std::string ChildProcess::endAsText() {
  // Its standard output is closed: it goes, or has gone. It keeps its status until it is asked.
  bool gone = pid_ < 0;
  const Clock::time_point deadline = Clock::now() + kPatience;
  while (!gone && Clock::now() < deadline) {
    gone = waitpid(pid_, &status_, WNOHANG) == pid_;
    if (!gone) {
      poll(nullptr, 0, 1);
    }
  }
  if (!gone) {
    kill();
    return "it closed its standard input or output";
  }
  if (pid_ >= 0) {
    ::kill(-pid_, SIGKILL);  // what it left behind
    pid_ = -1;
    collectLastWords();
    closePipes();
  }
  if (WIFSIGNALED(status_)) {
    return fmt::format("it was ended by signal {} ({})", WTERMSIG(status_),
                       strsignal(WTERMSIG(status_)));
  }
  constexpr int kNoCommand = 127;
  constexpr int kSignalled = 128;  // and the signal: the shell's answer for what it ran
  const int code = WEXITSTATUS(status_);
  std::string meaning;
  if (code == kNoCommand) {
    meaning = " (there is no such command)";
  } else if (code > kSignalled && code < kSignalled + NSIG) {
    const int number = code - kSignalled;
    meaning = fmt::format(" (as after signal {}, {})", number, strsignal(number));
  }
  return fmt::format("it ended with exit code {}{}", code, meaning);
}

bool ChildProcess::exchange(Span<const char>& to_write, Clock::time_point deadline,
                            const char* what) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  if (left.count() <= 0) {  // also where it never stops writing to its standard error
    throw std::runtime_error(what);
  }
  std::array<pollfd, 3> ends{
      {{output_, POLLIN, 0}, {error_, POLLIN, 0}, {to_write.empty() ? -1 : input_, POLLOUT, 0}}};
  const int ready = poll(ends.data(), ends.size(), static_cast<int>(left.count()));
  if (ready < 0 && errno != EINTR) {
    failSystem("cannot wait for a process");
  }
  if (ready <= 0) {
    return true;
  }
  if (ends[1].revents != 0) {
    if (drain(error_, errors_) == Drained::kEnd) {
      close(std::exchange(error_, -1));
    }
    errors_.erase(0, errors_.size() - std::min(errors_.size(), kLastWords));
  }
  if (ends[2].revents != 0) {
    const NoPipeSignal blocked;
    const ssize_t sent = ::write(input_, to_write.data(), to_write.size());
    if (sent > 0) {
      const auto done = static_cast<std::size_t>(sent);
      to_write = {to_write.data() + done, to_write.size() - done};
    } else if (errno != EAGAIN && errno != EINTR) {
      return false;
    }
  }
  return ends[0].revents == 0 || drain(output_, output_read_) != Drained::kEnd;
}

void ChildProcess::write(Span<const char> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    if (pid_ < 0 || !exchange(bytes, deadline, "it did not read the image in time")) {
      throw std::runtime_error(endAsText());
    }
  }
}

std::string ChildProcess::readLine(Clock::time_point deadline, std::size_t most) {
  std::size_t end = output_read_.find('\n');
  Span<const char> nothing;
  while (end == std::string::npos) {
    if (output_read_.size() > most) {
      throw std::runtime_error(
          fmt::format("it wrote {} bytes without the end of a line", output_read_.size()));
    }
    const std::size_t looked_at = output_read_.size();
    if (pid_ < 0 || !exchange(nothing, deadline, "it did not answer in time")) {
      throw std::runtime_error(endAsText());
    }
    end = output_read_.find('\n', looked_at);
  }
  std::string line = output_read_.substr(0, end);
  output_read_.erase(0, end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.pop_back();
  }
  return line;
}

std::string ChildProcess::read(std::size_t bytes, Clock::time_point deadline) {
  Span<const char> nothing;
  while (output_read_.size() < bytes) {
    if (pid_ < 0 || !exchange(nothing, deadline, "it did not send its mask in time")) {
      throw std::runtime_error(endAsText());
    }
  }
  std::string data = output_read_.substr(0, bytes);
  output_read_.erase(0, bytes);
  return data;
}

}  // namespace hmcdyn::slam
