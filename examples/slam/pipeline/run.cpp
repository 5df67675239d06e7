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
#include "slam/detection/coco_classes.hpp"
#include "slam/output/annotate.hpp"
#include "slam/output/run_folder.hpp"
#include "slam/pipeline/pipeline.hpp"
#include "slam/pipeline/summary.hpp"
#include "support/progress_bar.hpp"

namespace hmcdyn::slam {
namespace {

/// Stages of Pipeline::process(), the columns of timings.csv.
const std::vector<std::string> kStages = {"rectify", "detect", "features", "filter", "track", "map"};

/// The names of COCO's classes, by number.
std::vector<std::string> classNames() {
  std::vector<std::string> names;
  names.reserve(kCocoClassCount);
  for (int id = 0; id < kCocoClassCount; ++id) {
    names.push_back(cocoClassName(id));
  }
  return names;
}

/// The files of a run, written as frames are done.
class RunWriter {
 public:
  explicit RunWriter(const SlamOptions& options)
      : folder_(options.output),
        trajectory_(folder_.trajectory()),
        timings_(folder_.timings(kStages)) {
    if (options.write_keypoints) {
      key_points_.emplace(folder_.keyPoints());
    }
    if (options.annotate) {
      pictures_ = options.output / "frames";
      std::filesystem::create_directories(pictures_);
    }
  }

  void write(const FrameOutcome& outcome) {
    const double timestamp = outcome.image.timestamp;
    if (outcome.tracking.failure == TrackingFailure::kNone) {
      trajectory_.write(timestamp, outcome.tracking.camera_from_world);
    }
    timings_.write(timestamp, outcome.times);
    const FilterStageResult& stage = outcome.filtered.stage;
    if (key_points_) {
      key_points_->write(timestamp, {outcome.points.view(), outcome.filtered.distance,
                                     stage.cluster, stage.label, outcome.weight});
    }
    if (!pictures_.empty()) {
      writePicture(outcome);
    }
  }

  void finishTrajectory(const std::vector<StampedPose>& poses) { trajectory_.finish(poses); }
  void writeSummary(const nlohmann::json& summary) const { folder_.writeSummary(summary); }

 private:
  void writePicture(const FrameOutcome& outcome) const {
    const FilterStageResult& stage = outcome.filtered.stage;
    std::vector<std::uint8_t> box_is_dynamic;
    for (const BoxDecision& box : stage.boxes) {
      box_is_dynamic.push_back(box.verdict.is_dynamic ? 1 : 0);
    }
    AnnotationText text;
    text.frame = outcome.image.index;
    text.class_names = class_names_;
    if (!outcome.filtered.earlier.empty()) {
      text.model = toString(outcome.filtered.earlier.front().motion.model.kind);
    }
    const std::filesystem::path file = pictures_ / fmt::format("{:06d}.png", outcome.image.index);
    if (!cv::imwrite(file.string(),
                     annotateFrame(outcome.image.bgr, outcome.points.view(), stage.label,
                                   stage.cluster, outcome.boxes, box_is_dynamic, text))) {
      throw std::runtime_error(file.string() + ": cannot be written");
    }
  }

  RunFolder folder_;
  TrajectoryWriter trajectory_;
  TimingsWriter timings_;
  std::optional<KeyPointsWriter> key_points_;
  std::filesystem::path pictures_;  ///< Empty = no pictures.
  std::vector<std::string> class_names_ = classNames();
};

nlohmann::json toJson(const std::vector<StageSummary>& stages) {
  nlohmann::json json;
  for (const StageSummary& stage : stages) {
    json[stage.stage] = {{"frames", stage.frames},
                         {"mean_ms", stage.wall_ms.mean},
                         {"median_ms", stage.wall_ms.median},
                         {"p95_ms", stage.wall_ms.p95},
                         {"mean_cpu_ms", stage.cpu_ms.mean}};
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
  summary["stages"] = toJson(summarizeStages(times));
  summary["options"] = toJson(options, pipeline.detectorName());
  summary["versions"] = libraryVersions();
  summary["warnings"] = filterWarnings(counts, options);
  const std::filesystem::path groundtruth = groundtruthFile(options);
  if (!groundtruth.empty()) {
    summary["evaluation"] = evaluateTrajectory(groundtruth, options.output / "trajectory.txt");
    summary["evaluation_online"] =
        evaluateTrajectory(groundtruth, options.output / "trajectory_online.txt");
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
  pipeline.finish();
  writer.finishTrajectory(pipeline.trajectory());
  nlohmann::json summary = summarizeRun(options, pipeline, counts, times);
  writer.writeSummary(summary);
  return summary;
}

}  // namespace hmcdyn::slam
