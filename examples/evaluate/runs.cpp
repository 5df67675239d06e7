// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/runs.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "evaluate/pose_convention.hpp"
#include "evaluate/truth_frame.hpp"
#include "support/time_stamps.hpp"

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

using Note = std::function<void(const std::string&)>;

/// The unit of a ground truth's stamps (s): the user's, or what is plausible.
double unitOf(const Arguments& arguments, const Trajectory& groundtruth, const Note& note) {
  if (arguments.time_unit) {
    return support::secondsOf(*arguments.time_unit, 1.0);
  }
  const support::StampReview review = support::reviewStamps(timestampsOf(groundtruth));
  if (!review.doubt.empty() || review.unit == support::TimeUnit::kSeconds) {
    return 1.0;  // sparse poses are none of a camera's
  }
  note(fmt::format("{}: the time stamps are read as {} (--time-unit says otherwise)",
                   arguments.groundtruth.string(), toString(review.unit)));
  return support::secondsOf(review.unit, 1.0);
}

/// The factor that makes seconds of the stamps of a file that goes with a ground truth.
double unitBeside(const Arguments& arguments, const std::vector<double>& stamps,
                  const Trajectory& groundtruth, double own, const std::string& file,
                  const Note& note) {
  if (arguments.time_unit) {
    return support::secondsOf(*arguments.time_unit, 1.0);
  }
  constexpr double kSlack = 1.0;  // s; systems begin before the truth and end after it
  const double first = groundtruth.front().timestamp - arguments.offset;
  const double last = groundtruth.back().timestamp - arguments.offset;
  const double seconds = support::secondsByOverlap(stamps, first, last, own, kSlack).value_or(1.0);
  if (seconds != own) {
    note(
        fmt::format("{}: a time stamp of 1 is read as {:g} s, since that fits the ground truth "
                    "(--time-unit says otherwise)",
                    file, seconds));
  }
  return seconds;
}

Trajectory readPoses(const std::filesystem::path& file, const Note& note) {
  NotedTrajectory read = readNotedTrajectory(file);
  for (const std::string& sentence : read.notes) {
    note(sentence);
  }
  return std::move(read.poses);
}

/// Time stamps of the frames given to the system; none where only their number is known.
std::vector<double> readFrames(const Arguments& arguments, const Trajectory& groundtruth,
                               double unit, const Note& note) {
  if (arguments.associations.empty()) {
    return {};
  }
  std::vector<double> frames = readTimestamps(arguments.associations);
  const double seconds =
      unitBeside(arguments, frames, groundtruth, unit, arguments.associations.string(), note);
  for (double& frame : frames) {
    frame *= seconds;
  }
  return frames;
}

/// An error over few of the poses says little of the others.
void noteFewPairs(const Run& run, const Trajectory& estimate, const Note& note) {
  if (run.ate && 2 * run.ate->error.count < estimate.size()) {
    note(fmt::format("{}: {} of {} poses have a ground truth in time; the error is of those alone",
                     run.source.file.string(), run.ate->error.count, estimate.size()));
  }
}

void noteConvention(const Arguments& arguments, const Trajectory& groundtruth,
                    const Trajectory& estimate, const std::filesystem::path& file,
                    const Note& note) {
  AssociationOptions options;
  options.tolerance = arguments.tolerance.value_or(options.tolerance);
  options.offset = arguments.offset;
  const std::string other = otherConvention(groundtruth, estimate, options);
  if (!other.empty()) {
    note(fmt::format("{} against {}: {}", file.string(), arguments.groundtruth.string(), other));
  }
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

Evaluation evaluateRuns(const Arguments& arguments, const Note& note) {
  Evaluation evaluation;
  evaluation.groundtruth = ofCamera(readPoses(arguments.groundtruth, note), arguments.truth_frame);
  const double unit = unitOf(arguments, evaluation.groundtruth, note);
  evaluation.groundtruth = withStampsTimes(std::move(evaluation.groundtruth), unit);
  const std::vector<double> frames = readFrames(arguments, evaluation.groundtruth, unit, note);

  const auto evaluate = [&](const SystemFile& source, bool is_baseline) {
    Trajectory estimate = readPoses(source.file, note);
    const double seconds = unitBeside(arguments, timestampsOf(estimate), evaluation.groundtruth,
                                      unit, source.file.string(), note);
    estimate = withStampsTimes(std::move(estimate), seconds);
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
      noteFewPairs(run, estimate, note);
      noteConvention(arguments, evaluation.groundtruth, estimate, source.file, note);
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
