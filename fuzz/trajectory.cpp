// SPDX-License-Identifier: BSD-3-Clause
// TUM trajectories: what is read is a trajectory.
#include "evaluate/trajectory.hpp"

#include <sstream>
#include <stdexcept>
#include <string>

#include "evaluate/pose_convention.hpp"
#include "fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::istringstream text(std::string(bytes, bytes + size));
  try {
    const hmcdyn::evaluate::Trajectory poses = hmcdyn::evaluate::readTrajectory(text, "fuzzed");
    hmcdyn::fuzz::require(!poses.empty(), "a trajectory has a pose");
    checkTrajectory(poses, "poses");
    hmcdyn::fuzz::require(hmcdyn::evaluate::otherConvention(poses, poses).empty(),
                          "a trajectory is in its own convention");
    for (const hmcdyn::evaluate::StampedPose& pose : poses) {
      hmcdyn::fuzz::require(!hmcdyn::evaluate::toTumLine(pose).empty(), "a pose has a line");
    }
  } catch (const std::runtime_error&) {  // as documented
  }
  return 0;
}
