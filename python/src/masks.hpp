// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::python {

/// An estimator writes its images anew with each frame; Python's are its own.
inline MotionMask copyOf(const MotionMask& mask) {
  MotionMask copy = mask;
  copy.label = mask.label.clone();
  copy.belief = mask.belief.clone();
  return copy;
}

}  // namespace hmcdyn::python
