// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/evaluation.hpp"

#include <exception>
#include <stdexcept>

#include <fmt/format.h>

#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/relative_pose_error.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::slam {
namespace {

nlohmann::json statisticsOf(const evaluate::Statistics& statistics) {
  return {{"rmse", statistics.rmse},  {"mean", statistics.mean}, {"median", statistics.median},
          {"std", statistics.std},    {"min", statistics.min},   {"max", statistics.max},
          {"pairs", statistics.count}};
}

/// The ground truth, of which checkInput() knows that it overlaps the frames' time. That it is
/// another recording's is no guess any more.
evaluate::Trajectory truthAtTimeOf(const evaluate::Trajectory& tracked,
                                   const std::filesystem::path& groundtruth) {
  const double first = tracked.front().timestamp;
  const double last = tracked.back().timestamp;
  try {
    return evaluate::readTrajectoryFor(groundtruth, first, last).poses;
  } catch (const std::runtime_error&) {
    if (!std::filesystem::exists(groundtruth)) {
      throw;
    }
    throw std::runtime_error(fmt::format(
        "{}: has no pose between {:.6f} and {:.6f} s, the first and the last frame that "
        "have one here",
        groundtruth.string(), first, last));
  }
}

}  // namespace

nlohmann::json evaluateTrajectory(const std::filesystem::path& groundtruth,
                                  const std::filesystem::path& estimate) {
  nlohmann::json result;
  evaluate::Trajectory truth;
  evaluate::Trajectory tracked;
  try {
    tracked = evaluate::readTrajectory(estimate);
    truth = truthAtTimeOf(tracked, groundtruth);
    result["ate_m"] = statisticsOf(evaluate::absoluteTrajectoryError(truth, tracked).error);
  } catch (const std::exception& error) {
    result["error"] = error.what();
    return result;
  }
  // A short clip has an ATE but no pair of poses 1 s apart.
  try {
    const evaluate::RpeResult rpe = evaluate::relativePoseError(truth, tracked);
    result["rpe_translation_m_per_s"] = statisticsOf(rpe.translation);
    result["rpe_rotation_deg_per_s"] = statisticsOf(rpe.rotation);
  } catch (const std::exception& error) {
    result["rpe_error"] = error.what();
  }
  return result;
}

}  // namespace hmcdyn::slam
