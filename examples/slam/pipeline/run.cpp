// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/run.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "slam/camera/calibration.hpp"
#include "slam/pipeline/dense_mapper.hpp"
#include "slam/pipeline/detection_feed.hpp"
#include "slam/pipeline/pipeline.hpp"
#include "slam/pipeline/run_writer.hpp"
#include "slam/pipeline/summary.hpp"
#include "slam/source/depth_camera.hpp"
#include "slam/source/folder_source.hpp"
#include "slam/source/live_source.hpp"
#include "slam/source/realtime_pacer.hpp"
#include "support/progress_bar.hpp"

namespace hmcdyn::slam {
namespace {

void warn(const std::string& message) { spdlog::warn("{}", message); }

std::unique_ptr<FrameSource> makeSource(const SlamOptions& options,
                                        const CameraCalibration& calibration) {
  if (options.source == SourceKind::kLive) {
    return std::make_unique<LiveSource>(openDepthCamera(options.live), calibration, warn);
  }
  if (options.dataset.empty()) {
    throw std::invalid_argument("--dataset is missing; expected a folder in TUM format");
  }
  auto folder =
      std::make_unique<TumFolderSource>(options.dataset, options.association, calibration, warn);
  folder->limit(options.max_frames);
  if (options.mode == RunMode::kRealtime) {
    return std::make_unique<RealtimePacer>(std::move(folder), makeWallClock(), options.speed);
  }
  return folder;
}

/// The data set's own ground truth, where the user named none.
std::filesystem::path groundtruthFile(const SlamOptions& options) {
  if (!options.groundtruth.empty()) {
    return options.groundtruth;
  }
  const std::filesystem::path own = options.dataset / "groundtruth.txt";
  return !options.dataset.empty() && std::filesystem::exists(own) ? own : std::filesystem::path{};
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

 private:
  std::optional<PreparedFrame> takeAndAsk() {
    std::optional<RgbdFrame> raw = source_.next();
    if (!raw) {
      return std::nullopt;
    }
    PreparedFrame frame;
    const StageTimer timer;
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
  StageTimes before;
  before.add(frame.rectify_time);
  before.add({"detect", boxes.detect_wall_ms, boxes.detect_cpu_ms});
  before.add(boxes.carry_time);
  FrameOutcome outcome = pipeline.process(frame.image, std::move(boxes.boxes));
  outcome.times.prepend(before);
  return outcome;
}

}  // namespace

nlohmann::json runSlam(SlamOptions options, const std::function<bool()>& stop) {
  prepareOptions(options);
  const CameraCalibration calibration = loadCamera(options.camera);
  const std::unique_ptr<FrameSource> source = makeSource(options, calibration);
  const Rectifier rectifier(calibration);
  DetectionFeed detections(options, rectifier, warn);
  Pipeline pipeline(options, calibration, cornerMask(rectifier));
  std::optional<DenseMapper> dense;
  if (options.dense_map) {
    dense.emplace();
  }
  RunWriter writer(options);
  FrameFeed feed(*source, rectifier, detections, options.mode == RunMode::kOffline);

  RunCounts counts;
  std::vector<StageTimes> times;
  {
    support::ProgressBar progress("frames", source->expectedFrames().value_or(0), !options.quiet);
    while (!(stop && stop())) {
      const std::optional<PreparedFrame> frame = feed.next();
      if (!frame) {
        break;
      }
      FrameBoxes boxes = detections.boxesOf(*frame);
      counts.boxes_bridged += boxes.bridged;
      const FrameOutcome outcome = trackFrame(*frame, std::move(boxes), pipeline);
      writer.write(outcome, pipeline.map(), pipeline.loops());
      if (dense && outcome.tracking.new_key_frame) {
        dense->add(pipeline.map().keyFrames().size() - 1, outcome);
      }
      counts.add(outcome.filtered);
      counts.add(outcome.image.timestamp, outcome.tracking);
      times.push_back(outcome.times);
      progress.update(source->counts().taken_up, fmt::format("{} tracked", counts.frames_tracked));
    }
  }
  counts.stopped = stop && stop();
  counts.source = source->counts();
  counts.detections = detections.counts();
  if (!source->failure().empty()) {
    warn(source->failure());
  }

  pipeline.finish();
  writer.writeLoops(pipeline.map(), pipeline.loops());
  writer.finish(pipeline.trajectory(), pipeline.map());
  if (dense) {
    const FusionResult map = dense->fuse(pipeline.map());
    counts.map_points = map.cloud.position.size();
    writer.writeMap(map.cloud);
  }
  for (const std::string& warning : filterWarnings(counts, options)) {
    warn(warning);
  }
  const std::filesystem::path groundtruth = groundtruthFile(options);
  nlohmann::json summary = summarizeRun(options, {source->name(), detections.detectorName()},
                                        counts, pipeline, times, groundtruth);
  writer.writeSummary(summary);
  writer.writeReport(summary, groundtruth, options);
  return summary;
}

}  // namespace hmcdyn::slam
