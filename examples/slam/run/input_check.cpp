// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/input_check.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "slam/detect/file_detector.hpp"

namespace hmcdyn::slam {
namespace {

void checkBoxes(const DetectorOptions& detector, RunInput& input) {
  if (detector.type != "file" || detector.boxes.empty()) {
    return;
  }
  const BoxReview review = reviewBoxFile(detector.boxes, detector);
  input.boxes = review.counts;
  input.notes.insert(input.notes.end(), review.notes.begin(), review.notes.end());
}

/// What keeps the filter from making motion masks; empty if it makes them (see FrameFilterOptions).
std::string whyNoMotionMask(const SlamOptions& options) {
  if (options.filter.rule != FilterRule::kHmc) {
    return options.ablation == Ablation::kNone
               ? fmt::format("--filter {}", hmcdyn::toString(options.filter.rule))
               : fmt::format("--ablation {}", hmcdyn::toString(options.ablation));
  }
  if (!options.filter.expert.use_belief) {
    return options.filter_name == "hmc" ? "--filter hmc" : "--no-belief";
  }
  return {};
}

bool isOneFolder(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) ==
         std::filesystem::weakly_canonical(b, ignored);
}

void checkMaskOutput(const SlamOptions& options) {
  if (!options.write_masks && !options.write_static_depth) {
    return;
  }
  const char* option = options.write_masks ? "--write-masks" : "--write-static-depth";
  if (const std::string why = whyNoMotionMask(options); !why.empty()) {
    throw std::invalid_argument(
        fmt::format("{} is given with {}, which makes no motion mask; expected --filter robust, "
                    "without --no-belief, --ablation rs and --ablation df",
                    option, why));
  }
  const std::filesystem::path& read = options.detector.masks;
  if (options.write_masks && !read.empty() && isOneFolder(options.output / kMaskFolder, read)) {
    throw std::invalid_argument(fmt::format(
        "--write-masks would overwrite --masks {}; expected another --output", read.string()));
  }
}

/// The ground truth that the user named, or the data set's own where it can be used.
void checkGroundTruth(const SlamOptions& options, RunInput& input) {
  const std::vector<FrameEntry>& frames = input.list.frames;
  const auto check = [&](const std::filesystem::path& file) {
    const evaluate::NotedTrajectory truth =
        frames.empty()
            ? evaluate::readNotedTrajectory(file)
            : evaluate::readTrajectoryFor(file, frames.front().timestamp, frames.back().timestamp);
    input.notes.insert(input.notes.end(), truth.notes.begin(), truth.notes.end());
    input.groundtruth = file;
  };
  if (!options.groundtruth.empty()) {
    check(options.groundtruth);
    return;
  }
  const std::filesystem::path own = options.dataset / "groundtruth.txt";
  if (options.dataset.empty() || !std::filesystem::exists(own)) {
    return;
  }
  try {
    check(own);
  } catch (const std::runtime_error& error) {
    input.notes.push_back(
        fmt::format("there will be no ATE, since the data set's ground truth cannot be used: {}",
                    error.what()));
  }
}

}  // namespace

RunInput checkInput(SlamOptions& options, bool own_detector) {
  checkMaskOutput(options);
  RunInput input;
  if (options.source == SourceKind::kFolder) {
    if (options.dataset.empty()) {
      throw std::invalid_argument("--dataset is missing; expected a folder in TUM format");
    }
    Recording recording = openRecording(options.dataset, options.camera, options.association);
    input.calibration = std::move(recording.calibration);
    input.list = std::move(recording.list);
    input.notes = std::exchange(input.list.notes, {});
  } else {
    input.calibration = loadCamera(options.camera);
    requireSize(input.calibration, options.camera, "a live camera does not say them");
  }
  options.detector.frames = framesOfBoxes(input.calibration, input.list);
  if (!own_detector) {
    checkBoxes(options.detector, input);
  }
  checkGroundTruth(options, input);
  return input;
}

}  // namespace hmcdyn::slam
