// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/run.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "slam/input/source/depth_camera.hpp"
#include "slam/input/source/folder_source.hpp"
#include "slam/input/source/live_source.hpp"
#include "slam/input/source/read_ahead.hpp"
#include "slam/input/source/realtime_pacer.hpp"
#include "slam/run/dense_mapper.hpp"
#include "slam/run/detection_feed.hpp"
#include "slam/run/input_check.hpp"
#include "slam/run/mask_writer.hpp"
#include "slam/run/pipeline.hpp"
#include "slam/run/run_writer.hpp"
#include "slam/run/summary.hpp"
#include "support/progress_bar.hpp"

namespace hmcdyn::slam {
namespace {

void warn(const std::string& message) { spdlog::warn("{}", message); }

std::unique_ptr<FrameSource> makeSource(const SlamOptions& options, const RunInput& input,
                                        const std::function<bool()>& stop) {
  if (options.source == SourceKind::kLive) {
    return std::make_unique<LiveSource>(openDepthCamera(options.live), input.calibration, warn);
  }
  auto folder =
      std::make_unique<TumFolderSource>(input.list, options.dataset, input.calibration, warn);
  folder->limit(options.max_frames);
  if (options.mode == RunMode::kRealtime) {
    auto ahead = std::make_unique<ReadAhead>(std::move(folder), options.held_images + 1);
    return std::make_unique<RealtimePacer>(std::move(ahead), makeWallClock(), options.speed,
                                           options.held_images, stop, warn);
  }
  return folder;
}

/// Takes frames from their source and keeps the detector busy one frame ahead; in real time the
/// next frame does not exist yet.
class FrameFeed {
 public:
  FrameFeed(FrameSource& source, const Rectifier& rectifier, DetectionFeed& detections,
            bool look_ahead)
      : source_(source), rectifier_(rectifier), detections_(detections), look_ahead_(look_ahead) {}

  std::optional<PreparedFrame> next() {
    std::optional<PreparedFrame> frame =
        ahead_ ? std::exchange(ahead_, std::nullopt) : takeAndAsk();
    if (look_ahead_ && frame) {
      ahead_ = takeAndAsk();
    }
    return frame;
  }

  /// Taken from the source, and not yet handed out.
  std::size_t framesAhead() const noexcept { return ahead_ ? 1 : 0; }

 private:
  std::optional<PreparedFrame> takeAndAsk() {
    std::optional<RgbdFrame> raw = source_.next();
    if (!raw) {
      return std::nullopt;
    }
    PreparedFrame frame;
    const support::StageTimer timer;
    frame.image = rectify(*raw, rectifier_);
    frame.rectify_time = timer.elapsed("rectify");
    frame.raw = std::move(*raw);
    detections_.ask(frame);
    return frame;
  }

  FrameSource& source_;
  const Rectifier& rectifier_;
  DetectionFeed& detections_;
  bool look_ahead_;
  std::optional<PreparedFrame> ahead_;
};

FrameOutcome trackFrame(const PreparedFrame& frame, FrameBoxes boxes, Pipeline& pipeline) {
  support::StageTimes before;
  before.add(frame.rectify_time);
  before.add({"detect", boxes.detect_wall_ms, boxes.detect_cpu_ms});
  before.add(boxes.carry_time);
  FrameOutcome outcome =
      pipeline.process(frame.image, std::move(boxes.boxes), std::move(boxes.mask));
  outcome.times.prepend(before);
  return outcome;
}

/// Tries to write results: what fails is reported and remembered, and is no end of the others.
class WriteAttempts {
 public:
  template <class Write>
  bool attempt(const Write& write) {
    try {
      write();
      return true;
    } catch (const std::exception& error) {
      spdlog::error("{}", error.what());
      failures_.emplace_back(error.what());
      return false;
    }
  }
  const std::vector<std::string>& failures() const noexcept { return failures_; }

 private:
  std::vector<std::string> failures_;
};

constexpr const char* kDenseMapping = "dense mapping";
constexpr const char* kMapLacksOne = "the dense map lacks a key frame";

/// All parts of a run.
struct Run {
  Run(const SlamOptions& run_options, RunInput run_input, const std::function<bool()>& stop,
      std::unique_ptr<ObjectDetector> detector)
      : options(run_options),
        input(std::move(run_input)),
        source(makeSource(options, input, stop)),
        rectifier(input.calibration),
        detections(options, rectifier, warn, std::move(detector)),
        errors([](const std::string& message) { spdlog::error("{}", message); }),
        pipeline(options, input.calibration, cornerMask(rectifier), errors),
        writer(options) {
    if (options.dense_map) {
      dense.emplace();
    }
    if (options.write_masks || options.write_static_depth) {
      masks.emplace(options, input.calibration.depth_factor);
    }
  }

  const SlamOptions& options;
  RunInput input;
  std::unique_ptr<FrameSource> source;
  Rectifier rectifier;
  DetectionFeed detections;
  PartErrors errors;
  Pipeline pipeline;
  std::optional<DenseMapper> dense;
  RunWriter writer;
  std::optional<MaskWriter> masks;
  WriteAttempts writing;
  RunCounts counts;
  support::StageHistory times;
};

/// False where the frame's results could not be written.
bool doFrame(Run& run, const PreparedFrame& frame) {
  FrameBoxes boxes = run.detections.boxesOf(frame);
  run.counts.boxes_bridged += boxes.bridged;
  if (!run.writing.attempt([&] { run.writer.writeBoxes(boxes.found); })) {
    return false;
  }
  const FrameOutcome outcome = trackFrame(frame, std::move(boxes), run.pipeline);
  run.counts.add(outcome.filtered);
  run.counts.frames_starved += outcome.kept_for_number > 0 ? 1 : 0;
  run.counts.add(outcome.image.timestamp, outcome.tracking);
  if (outcome.motion != nullptr) {
    ++run.counts.motion_masks[toString(outcome.motion->state)];
  }
  run.times.add(outcome.times);
  if (const std::optional<double> lag = run.source->secondsSinceDue()) {
    run.counts.latency_ms.push_back(1e3 * *lag);
  }
  if (run.dense && outcome.tracking.new_key_frame) {
    run.errors.attempt(kDenseMapping, kMapLacksOne,
                       [&] { run.dense->add(run.pipeline.map().keyFrames().size() - 1, outcome); });
  }
  return run.writing.attempt([&] {
    run.writer.write(outcome, run.pipeline.map(), run.pipeline.loops());
    if (run.masks) {
      run.masks->add(outcome);
    }
  });
}

void doFrames(Run& run, const std::function<bool()>& stop) {
  FrameFeed feed(*run.source, run.rectifier, run.detections, run.options.mode == RunMode::kOffline);
  support::ProgressBar progress("frames", run.source->expectedFrames().value_or(0),
                                !run.options.quiet);
  bool goes_on = true;
  const auto next = [&] {
    run.counts.stopped = stop && stop();
    const std::optional<PreparedFrame> frame = run.counts.stopped ? std::nullopt : feed.next();
    if (!run.counts.stopped && !frame && stop && stop()) {  // in the middle of a wait for a frame
      run.counts.stopped = run.source->counts().taken_up < run.source->expectedFrames().value_or(0);
    }
    goes_on = frame && doFrame(run, *frame);
  };
  while (goes_on) {
    if (run.counts.frames_tracked == 0) {
      next();  // what it throws is the caller's: there is nothing to lose yet
    } else if (!run.errors.attempt("tracking", "the frames end here", next)) {
      goes_on = false;
    }
    progress.update(run.source->counts().taken_up,
                    fmt::format("{} tracked", run.counts.frames_tracked));
  }
  run.counts.source = run.source->counts();
  run.counts.frames_expected = run.source->expectedFrames().value_or(0);
  run.counts.source.taken_up -= feed.framesAhead();
  run.counts.detections = run.detections.counts();
  if (!run.source->failure().empty()) {
    warn(run.source->failure());
  }
}

void finishDenseMap(Run& run) {
  while (!run.errors.attempt(kDenseMapping, kMapLacksOne, [&] { run.dense->finish(); })) {
  }
  run.errors.attempt(kDenseMapping, "there is no map.ply", [&] {
    const FusionResult map = run.dense->fuse(run.pipeline.map());
    run.counts.map_points = map.cloud.position.size();
    run.writing.attempt([&] { run.writer.writeMap(map.cloud); });
  });
}

nlohmann::json finish(Run& run) {
  const SlamOptions& options = run.options;
  run.pipeline.finish();
  if (run.masks) {
    while (!run.writing.attempt([&] { run.masks->finish(); })) {
    }
  }
  run.writer.releaseReserve();
  run.writing.attempt([&] { run.writer.writeLoops(run.pipeline.map(), run.pipeline.loops()); });
  run.writing.attempt([&] { run.writer.finish(run.pipeline.trajectory(), run.pipeline.map()); });
  if (run.dense) {
    finishDenseMap(run);
  }
  std::vector<std::string> warnings = filterWarnings(run.counts, options);
  for (const std::string& reason :
       {whyFewPoses(run.counts), laterFailures(run.counts.detections)}) {
    if (!reason.empty()) {
      warnings.push_back(reason);
    }
  }
  for (const std::string& warning : warnings) {
    warn(warning);
  }
  const std::filesystem::path& groundtruth = run.input.groundtruth;
  run.counts.notes = run.input.notes;
  run.counts.write_failures = run.writing.failures();
  run.counts.errors = run.errors.all();
  nlohmann::json summary =
      summarizeRun(options, {run.source->name(), run.detections.detectorName()}, run.counts,
                   run.pipeline, run.times, groundtruth);
  if (summary.contains("evaluation") && summary.at("evaluation").contains("error")) {
    const std::string why = "no ATE: " + summary.at("evaluation").at("error").get<std::string>();
    warn(why);
    summary["warnings"].push_back(why);
  }
  run.writing.attempt([&] { run.writer.writeSummary(summary); });
  if (!run.writing.attempt([&] { run.writer.writeReport(summary, groundtruth, options); })) {
    summary["counts"]["write_failures"] = run.writing.failures();
    run.writing.attempt([&] { run.writer.writeSummary(summary); });
  }
  summary["counts"]["write_failures"] = run.writing.failures();
  return summary;
}

}  // namespace

nlohmann::json runSlam(SlamOptions options, const std::function<bool()>& stop,
                       std::unique_ptr<ObjectDetector> detector) {
  prepareOptions(options);
  if (detector) {
    options.detector.type = "own";
  }
  RunInput input = checkInput(options, detector != nullptr);
  for (const std::string& note : input.notes) {
    warn(note);
  }
  options = withDepthError(std::move(options), input.calibration.depth_error);
  Run run(options, std::move(input), stop, std::move(detector));
  run.counts.box_file = run.input.boxes;
  doFrames(run, stop);
  return finish(run);
}

}  // namespace hmcdyn::slam
