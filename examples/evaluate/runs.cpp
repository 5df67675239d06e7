// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/runs.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::evaluate {
namespace {

AteResult evaluateAte(const Arguments& arguments, const Trajectory& groundtruth,
                      const Trajectory& estimate) {
  AteOptions options;
  options.association.tolerance = arguments.tolerance.value_or(options.association.tolerance);
  options.association.offset = arguments.offset;
  options.alignment = arguments.scale ? AlignmentModel::kSimilarity : AlignmentModel::kRigid;
  return absoluteTrajectoryError(groundtruth, estimate, options);
}

RpeResult evaluateRpe(const Arguments& arguments, double scale, const Trajectory& groundtruth,
                      const Trajectory& estimate) {
  RpeOptions options;
  options.delta = arguments.delta;
  options.delta_unit = arguments.delta_unit;
  options.offset = arguments.offset;
  options.tolerance = arguments.tolerance;
  options.scale = scale;
  return relativePoseError(groundtruth, estimate, options);
}

/// Time stamps of the frames given to the system; none where only their number is known.
std::vector<double> readFrames(const Arguments& arguments) {
  return arguments.associations.empty() ? std::vector<double>()
                                        : readTimestamps(arguments.associations);
}

std::optional<Tracking> countTracked(const Arguments& arguments, const std::vector<double>& frames,
                                     const Trajectory& estimate) {
  if (arguments.frames) {
    if (estimate.size() > *arguments.frames) {
      throw std::runtime_error(fmt::format("has {} poses, more than the {} frames of --frames",
                                           estimate.size(), *arguments.frames));
    }
    return Tracking{*arguments.frames, estimate.size()};
  }
  if (frames.empty()) {
    return std::nullopt;
  }
  // Both are on the clock of the images, so the offset to the ground truth's plays no part.
  AssociationOptions options;
  options.tolerance = arguments.tolerance.value_or(options.tolerance);
  return Tracking{frames.size(), associate(frames, timestampsOf(estimate), options).size()};
}

}  // namespace

Evaluation evaluateRuns(const Arguments& arguments) {
  Evaluation evaluation;
  evaluation.groundtruth = readTrajectory(arguments.groundtruth);
  const std::vector<double> frames = readFrames(arguments);

  const auto evaluate = [&](const SystemFile& source, bool is_baseline) {
    const Trajectory estimate = readTrajectory(source.file);
    Run run;
    run.source = source;
    run.is_baseline = is_baseline;
    try {
      // RPE needs the alignment where its scale is to be fitted.
      if (arguments.command != Command::kRpe || arguments.scale) {
        run.ate = evaluateAte(arguments, evaluation.groundtruth, estimate);
      }
      if (arguments.command != Command::kAte) {
        const double scale = run.ate ? run.ate->alignment.scale : 1.0;
        run.rpe = evaluateRpe(arguments, scale, evaluation.groundtruth, estimate);
      }
      run.tracking = countTracked(arguments, frames, estimate);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(source.file.string() + ": " + error.what());
    }
    evaluation.runs.push_back(std::move(run));
  };
  for (const SystemFile& source : arguments.baselines) {
    evaluate(source, true);
  }
  for (const SystemFile& source : arguments.estimates) {
    evaluate(source, false);
  }
  return evaluation;
}

}  // namespace hmcdyn::evaluate
