// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <utility>

#include "arrays.hpp"

namespace hmcdyn::python {

/// An object that serves one thread at a time. Python's lock is released during work, so two
/// threads of Python may call at once: the second waits.
template <class T>
class Guarded {
 public:
  explicit Guarded(T object) : object_(std::move(object)) {}

  /// Works on the object without Python's lock. The order matters: whoever waited for the object
  /// while holding Python's lock would keep the other thread from ever finishing.
  template <class Work>
  auto with(const Work& work) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    return work(object_);
  }

 private:
  T object_;
  std::mutex mutex_;
};

}  // namespace hmcdyn::python
