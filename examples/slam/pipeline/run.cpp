// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/run.hpp"

#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <spdlog/spdlog.h>

#include "slam/camera/calibration.hpp"
#include "slam/dataset/tum_dataset.hpp"
#include "slam/output/annotate.hpp"
#include "slam/output/run_folder.hpp"
#include "slam/pipeline/pipeline.hpp"
#include "slam/pipeline/summary.hpp"
#include "support/progress_bar.hpp"

namespace hmcdyn::slam {
namespace {

/// The files of a run, written as frames are done.
class RunWriter {
 public:
  explicit RunWriter(const SlamOptions& options) : options_(options) {
    makeRunFolder(options.output);
    trajectory_.emplace(options.output / "trajectory.txt");
    timings_.emplace(options.output / "timings.csv");
    if (options.write_keypoints) {
      key_points_.emplace(options.output / "keypoints.csv");
      key_points_->append(keyPointsHeader());
    }
    if (options.annotate) {
      makeRunFolder(options.output / "frames");
    }
  }

  void write(const FrameOutcome& outcome) {
    const double timestamp = outcome.image.timestamp;
    if (outcome.tracking.failure == TrackingFailure::kNone) {
      trajectory_->append(trajectoryLine(timestamp, outcome.tracking.camera_from_world));
    }
    if (!timings_started_) {
      timings_->append(timingsHeader(outcome.times));
      timings_started_ = true;
    }
    timings_->append(timingsRow(timestamp, outcome.times));
    const FilterStageResult& stage = outcome.filtered.stage;
    if (key_points_) {
      key_points_->append(keyPointRows(timestamp, outcome.points.view(), outcome.filtered.distance,
                                       stage.cluster, stage.label, outcome.weight));
    }
    if (options_.annotate) {
      writePicture(outcome);
    }
  }

 private:
  void writePicture(const FrameOutcome& outcome) const {
    const FilterStageResult& stage = outcome.filtered.stage;
    std::vector<std::uint8_t> box_is_dynamic;
    for (const BoxDecision& box : stage.boxes) {
      box_is_dynamic.push_back(box.verdict.is_dynamic ? 1 : 0);
    }
    Annotation annotation;
    annotation.points = outcome.points.view();
    annotation.label = stage.label;
    annotation.cluster = stage.cluster;
    annotation.boxes = outcome.boxes;
    annotation.box_is_dynamic = box_is_dynamic;
    annotation.status = fmt::format("frame {}  {} of {} points dynamic", outcome.image.index,
                                    stage.frame.dynamic, stage.frame.points);
    if (!outcome.filtered.earlier.empty()) {
      annotation.status +=
          fmt::format("  model: {}", toString(outcome.filtered.earlier.front().motion.model.kind));
    }
    annotation.status += outcome.tracking.failure == TrackingFailure::kNone
                             ? fmt::format("  {} map points", outcome.tracking.inliers)
                             : fmt::format("  LOST: {}", toString(outcome.tracking.failure));
    const std::filesystem::path file =
        options_.output / "frames" / fmt::format("{:06d}.png", outcome.image.index);
    if (!cv::imwrite(file.string(), annotateFrame(outcome.image.bgr, annotation))) {
      throw std::runtime_error(file.string() + ": cannot be written");
    }
  }

  const SlamOptions& options_;
  std::optional<LineFile> trajectory_;
  std::optional<LineFile> timings_;
  std::optional<LineFile> key_points_;
  bool timings_started_ = false;
};

nlohmann::json toJson(const std::map<std::string, StageSummary>& stages) {
  nlohmann::json json;
  for (const auto& [stage, summary] : stages) {
    json[stage] = {{"frames", summary.frames},
                   {"mean_ms", summary.mean_ms},
                   {"median_ms", summary.median_ms},
                   {"p95_ms", summary.p95_ms},
                   {"mean_cpu_ms", summary.mean_cpu_ms}};
  }
  return json;
}

/// The data set's own ground truth, where the user named none.
std::filesystem::path groundtruthFile(const SlamOptions& options) {
  if (!options.groundtruth.empty()) {
    return options.groundtruth;
  }
  const std::filesystem::path own = options.dataset / "groundtruth.txt";
  return std::filesystem::exists(own) ? own : std::filesystem::path{};
}

nlohmann::json summarizeRun(const SlamOptions& options, const Pipeline& pipeline,
                            const RunCounts& counts, const std::vector<StageTimes>& times) {
  nlohmann::json summary;
  summary["counts"] = toJson(counts);
  summary["stages"] = toJson(summarize(times));
  summary["options"] = toJson(options, pipeline.detectorName());
  summary["versions"] = libraryVersions();
  summary["warnings"] = filterWarnings(counts, options);
  const std::filesystem::path groundtruth = groundtruthFile(options);
  if (!groundtruth.empty()) {
    summary["evaluation"] = evaluateTrajectory(groundtruth, options.output / "trajectory.txt");
  }
  return summary;
}

/// The frame, or nothing where it cannot be read.
std::optional<RgbdFrame> tryLoad(const FrameEntry& entry, const CameraCalibration& calibration) {
  try {
    return loadFrame(entry, calibration);
  } catch (const std::runtime_error& error) {
    spdlog::warn("frame {} is left out: {}", entry.index, error.what());
    return std::nullopt;
  }
}

}  // namespace

nlohmann::json runSlam(SlamOptions options) {
  distributeSeed(options);
  std::vector<FrameEntry> entries = listFrames(options.dataset, options.association);
  if (options.max_frames > 0 && entries.size() > options.max_frames) {
    entries.resize(options.max_frames);
  }
  const CameraCalibration calibration = loadCamera(options.camera);
  Pipeline pipeline(options, calibration);
  RunWriter writer(options);

  RunCounts counts;
  std::vector<StageTimes> times;
  support::ProgressBar progress("frames", entries.size(), !options.quiet);
  for (const FrameEntry& entry : entries) {
    ++counts.frames_in;
    const std::optional<RgbdFrame> raw = tryLoad(entry, calibration);
    if (!raw) {
      ++counts.frames_unreadable;
      continue;
    }
    const FrameOutcome outcome = pipeline.process(*raw);
    writer.write(outcome);
    counts.add(outcome.filtered);
    counts.add(outcome.tracking);
    times.push_back(outcome.times);
    progress.update(counts.frames_in, fmt::format("{} tracked", counts.frames_tracked));
  }
  for (const std::string& warning : filterWarnings(counts, options)) {
    spdlog::warn("{}", warning);
  }
  const nlohmann::json summary = summarizeRun(options, pipeline, counts, times);
  writeJson(options.output / "summary.json", summary);
  return summary;
}

}  // namespace hmcdyn::slam
