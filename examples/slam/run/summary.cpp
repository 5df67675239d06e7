// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/summary.hpp"

#include <algorithm>
#include <cstdlib>

#include <Eigen/Core>
#include <ceres/version.h>
#include <fmt/format.h>
#include <nanoflann.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>

#include "slam/run/evaluation.hpp"
#include "slam/run/input_check.hpp"

namespace hmcdyn::slam {
namespace {

nlohmann::json toJson(const std::vector<PartError>& errors) {
  nlohmann::json json = nlohmann::json::array();
  for (const PartError& error : errors) {
    json.push_back({{"part", error.part}, {"error", error.error}, {"times", error.times}});
  }
  return json;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

bool isByMemory(MatchSource source) {
  return source == MatchSource::kAtRest || source == MatchSource::kNotMoving;
}

}  // namespace

void RunCounts::add(const DynamicFeatureFilterResult& filtered) {
  const FrameDecision& frame = filtered.stage.frame;
  frames_with_boxes += frame.boxes > 0 ? 1 : 0;
  frames_with_distances += frame.measured > 0 ? 1 : 0;
  frames_camera_unknown += filtered.camera_unknown ? 1 : 0;
  boxes += frame.boxes;
  dynamic_boxes += frame.dynamic_boxes;
  key_points += frame.points;
  for (const PointLabel label : filtered.stage.label) {
    ++labels[hmcdyn::toString(label)];
  }
  for (const EarlierFrameReport& report : filtered.earlier) {
    ++models[hmcdyn::toString(report.motion.model.kind)];
    models_by_memory += isByMemory(report.motion.source) ? 1 : 0;
    models_by_prediction += report.motion.source == MatchSource::kPrediction ? 1 : 0;
    ++fundamental[hmcdyn::toString(report.motion.verdict)];
  }
}

void RunCounts::add(double timestamp, const TrackingResult& tracked) {
  if (tracked.failure == TrackingFailure::kNone) {
    ++frames_tracked;
  } else {
    ++failures[toString(tracked.failure)];
    constexpr std::size_t kMostNamed = 1000;
    if (lost.size() < kMostNamed) {
      lost.push_back(timestamp);
    }
  }
  key_frames += tracked.new_key_frame ? 1 : 0;
  relocalized += tracked.relocalized ? 1 : 0;
  frames_carried += tracked.carried ? 1 : 0;
}

namespace {

/// Which rule left out a file's boxes, or that the detector found none, or failed.
std::string whyNoBox(const RunCounts& counts, const DetectorOptions& detector) {
  const BoxCounts& boxes = counts.box_file;
  if (counts.detections.failed > 0 && counts.detections.detected == 0) {
    return "the detector failed at every frame";
  }
  if (detector.type == "file" && boxes.in_file == 0) {
    return fmt::format("{} holds no box", detector.boxes.string());
  }
  if (boxes.in_file == 0 || boxes.kept > 0) {
    return boxes.kept == 0
               ? "the detector found no box in any frame"
               : fmt::format("all {} boxes of the file are of other frames", boxes.kept);
  }
  return fmt::format(
      "of the {} boxes in the file {} are of other classes than --classes, {} have too low a "
      "score, {} belong to no frame, {} cannot be boxes",
      boxes.in_file, boxes.other_class, boxes.low_score, boxes.other_time,
      boxes.shares + boxes.inverted + boxes.outside);
}

}  // namespace

std::string whyFewPoses(const RunCounts& counts) {
  const std::size_t frames = counts.source.taken_up;
  if (2 * counts.frames_tracked >= frames && frames > 0) {
    return {};
  }
  std::vector<std::string> reasons;
  const auto reason = [&](std::size_t count, const std::string& what) {
    if (4 * count > frames) {  // less explains nothing
      reasons.push_back(fmt::format("{} {}", count, what));
    }
  };
  reason(counts.source.unreadable, "frames could not be read");
  reason(counts.source.dropped, "came too late and were dropped (--mode realtime)");
  reason(counts.source.without_depth,
         "frames have no depth at any pixel, without which no map begins");
  for (const auto& [failure, count] : counts.failures) {
    reason(count, fmt::format("frames had {}{}", failure,
                              failure == toString(TrackingFailure::kTooFewKeyPoints)
                                  ? " with a depth, outside of what moves"
                                  : " with the map"));
  }
  return fmt::format(
      "{} of {} frames have a pose{}", counts.frames_tracked, frames,
      reasons.empty() ? std::string() : fmt::format(": {}", fmt::join(reasons, "; ")));
}

std::string laterFailures(const DetectionCounts& counts) {
  if (counts.failed < 2 || counts.last_failure.empty()) {
    return {};
  }
  return fmt::format("the detector failed at {} of {} frames, the last time {}", counts.failed,
                     counts.requested, counts.last_failure);
}

std::vector<std::string> filterWarnings(const RunCounts& counts, const SlamOptions& options) {
  std::vector<std::string> warnings;
  const FilterRule rule = options.filter.rule;
  if (rule == FilterRule::kNone) {
    return warnings;
  }
  const std::string asked =
      std::string("the filter '") + hmcdyn::toString(rule) + "' had nothing to do: ";
  const bool has_masks = counts.motion_masks.count(toString(MaskState::kGood)) > 0;
  if (counts.frames_with_boxes == 0 && options.detector.type != "none") {
    warnings.push_back((has_masks ? "without a box, only the motion mask spoke: " : asked) +
                       whyNoBox(counts, options.detector));
  } else if (counts.frames_with_boxes == 0 && !has_masks && counts.frames_tracked > 0) {
    warnings.push_back(asked + "there is no detector (--detector none)");
  }
  if (counts.frames_with_boxes > 0 && counts.frames_with_distances == 0 &&
      rule != FilterRule::kBox && rule != FilterRule::kDepthRansac) {
    warnings.push_back(asked + "no key point could be matched with an earlier frame");
  }
  return warnings;
}

namespace {

/// As --filter has it, or as the options say that were made otherwise.
std::string filterName(const SlamOptions& options) {
  const FilterRule rule = options.filter.rule;
  return rule == FilterRule::kHmc || options.ablation != Ablation::kNone ? options.filter_name
                                                                         : hmcdyn::toString(rule);
}

nlohmann::json toJson(const std::vector<support::StageSummary>& stages) {
  nlohmann::json json;
  for (const support::StageSummary& stage : stages) {
    json[stage.stage] = {{"frames", stage.frames},
                         {"mean_ms", stage.wall_ms.mean},
                         {"median_ms", stage.wall_ms.median},
                         {"p95_ms", stage.wall_ms.p95},
                         {"max_ms", stage.wall_ms.max},
                         {"mean_cpu_ms", stage.cpu_ms.mean}};
  }
  return json;
}

/// CPU time of the tracking thread a frame (ms): all stages but the detector's.
double trackingCpuMs(const std::vector<support::StageSummary>& stages) {
  double sum = 0.0;
  for (const support::StageSummary& stage : stages) {
    sum += stage.stage == "detect" ? 0.0 : stage.cpu_ms.mean;
  }
  return sum;
}

}  // namespace

nlohmann::json summarizeRun(const SlamOptions& options, const RunNames& names,
                            const RunCounts& counts, const Pipeline& pipeline,
                            const support::StageHistory& times,
                            const std::filesystem::path& groundtruth) {
  const std::vector<support::StageSummary> stages = times.summarize();
  nlohmann::json summary;
  summary["source"] = names.source;
  summary["counts"] = toJson(counts);
  summary["counts"]["key_frames_kept"] =
      std::count_if(pipeline.map().keyFrames().begin(), pipeline.map().keyFrames().end(),
                    [](const KeyFrame& key_frame) { return !key_frame.removed; });
  summary["counts"]["map_points"] = pipeline.map().points().held();
  summary["counts"]["map_points_made"] = pipeline.map().points().size();
  summary["counts"]["local_adjustments"] = pipeline.mapper().adjustments();
  summary["counts"]["loops_closed"] = pipeline.loops().loopsClosed();
  summary["stages"] = toJson(stages);
  if (!counts.latency_ms.empty()) {
    const support::TimeStatistics latency = support::timeStatistics(counts.latency_ms);
    summary["latency_ms"] = {{"mean", latency.mean},
                             {"median", latency.median},
                             {"p95", latency.p95},
                             {"max", latency.max}};
  }
  summary["tracking_cpu_ms"] = trackingCpuMs(stages);
  summary["options"] = toJson(options, names.detector);
  summary["versions"] = libraryVersions();
  summary["warnings"] = counts.notes;
  for (const std::string& warning : filterWarnings(counts, options)) {
    summary["warnings"].push_back(warning);
  }
  if (const std::string reason = whyFewPoses(counts); !reason.empty()) {
    summary["warnings"].push_back(reason);
  }
  for (const PartError& error : counts.errors) {
    summary["warnings"].push_back(
        fmt::format("{} failed {} times, at first with: {}", error.part, error.times, error.error));
  }
  if (!counts.detections.first_failure.empty()) {
    summary["warnings"].push_back(fmt::format("the detector failed at {} of {} frames, first {}",
                                              counts.detections.failed, counts.detections.requested,
                                              counts.detections.first_failure));
  }
  if (const std::string reason = laterFailures(counts.detections); !reason.empty()) {
    summary["warnings"].push_back(reason);
  }
  summary["errors"] = toJson(counts.errors);
  if (!groundtruth.empty() && counts.frames_tracked == 0) {
    summary["evaluation"] = {{"error", "no frame has a pose"}};
  } else if (!groundtruth.empty()) {
    summary["evaluation"] = evaluateTrajectory(groundtruth, options.output / "trajectory.txt");
    summary["evaluation_online"] =
        evaluateTrajectory(groundtruth, options.output / "trajectory_online.txt");
  }
  return summary;
}

nlohmann::json toJson(const SlamOptions& options, const std::string& detector_name) {
  const FilterStageOptions& stage = options.filter.expert.stage;
  const OpticalFlowOptions& flow = options.filter.expert.flow;
  return {{"dataset", options.dataset.string()},
          {"camera", options.camera},
          {"detector", detector_name},
          {"classes", options.detector.classes},
          {"score_threshold", options.detector.score_threshold},
          {"nms_threshold", options.detector.nms_threshold},
          {"bridge_s", options.bridge},
          {"mode", options.mode == RunMode::kOffline ? "offline" : "realtime"},
          {"held_images", options.held_images},
          {"filter", filterName(options)},
          {"rule", hmcdyn::toString(options.filter.rule)},
          {"ablation", hmcdyn::toString(options.ablation)},
          {"min_kept", options.filter.min_kept},
          {"soft_weight_gate", options.filter.soft_weight_gate},
          {"motion_model", options.tracker.fuse_motion},
          {"mapping", options.mapping.enabled},
          {"loops", options.loops.enabled},
          {"baselines_s", options.filter.baselines},
          {"flow", {{"window_px", flow.window}, {"max_level", flow.max_level}}},
          {"box_test",
           {{"distance_threshold_px", stage.boxes.distance_threshold},
            {"person_distance_threshold_px", stage.boxes.person_distance_threshold},
            {"dynamic_ratio", stage.boxes.dynamic_ratio}}},
          {"clustering",
           {{"depth_scale_per_m", stage.clustering.depth_scale},
            {"distance_scale_per_px", stage.clustering.distance_scale},
            {"epsilon", stage.clustering.epsilon},
            {"min_points", stage.clustering.min_points},
            {"order", stage.clustering.order}}},
          {"cluster_filter",
           {{"min_cluster_size", stage.cluster_filter.min_cluster_size},
            {"min_strongest_distance_px", stage.cluster_filter.min_strongest_distance},
            {"screening_ratio", stage.cluster_filter.screening_ratio},
            {"screening_floor_px", stage.cluster_filter.screening_floor},
            {"place_unmatched_by_depth", stage.cluster_filter.place_unmatched_by_depth}}},
          {"features", options.features.features},
          {"max_depth_m", options.tracker.map.max_depth},
          {"seed", options.seed},
          {"max_frames", options.max_frames}};
}

nlohmann::json toJson(const RunCounts& counts) {
  return {{"frames_in", counts.source.taken_up},
          {"frames_tracked", counts.frames_tracked},
          {"frames_unreadable", counts.source.unreadable},
          {"frames_dropped", counts.source.dropped},
          {"frames_without_depth", counts.source.without_depth},
          {"color_images_without_depth_image", counts.source.unpaired},
          {"tracking_rate", share(counts.frames_tracked, counts.source.taken_up)},
          {"key_frames", counts.key_frames},
          {"frames_with_boxes", counts.frames_with_boxes},
          {"frames_with_distances", counts.frames_with_distances},
          {"boxes", counts.boxes},
          {"dynamic_boxes", counts.dynamic_boxes},
          {"key_points", counts.key_points},
          {"labels", counts.labels},
          {"motion_masks", counts.motion_masks},
          {"motion_models", counts.models},
          {"motion_models_by_memory", counts.models_by_memory},
          {"motion_models_by_prediction", counts.models_by_prediction},
          {"frames_camera_unknown", counts.frames_camera_unknown},
          {"frames_starved", counts.frames_starved},
          {"fundamental_verdicts", counts.fundamental},
          {"tracking_failures", counts.failures},
          {"lost_frames", counts.lost},
          {"relocalized", counts.relocalized},
          {"frames_carried", counts.frames_carried},
          {"detections",
           {{"requested", counts.detections.requested},
            {"detected", counts.detections.detected},
            {"replaced", counts.detections.replaced},
            {"failed", counts.detections.failed}}},
          {"boxes_bridged", counts.boxes_bridged},
          {"box_file",
           {{"boxes", counts.box_file.in_file},
            {"kept", counts.box_file.kept},
            {"shares", counts.box_file.shares},
            {"inverted", counts.box_file.inverted},
            {"outside", counts.box_file.outside},
            {"other_class", counts.box_file.other_class},
            {"low_score", counts.box_file.low_score},
            {"other_time", counts.box_file.other_time},
            {"weaker", counts.box_file.weaker}}},
          {"dense_map_points", counts.map_points},
          {"stopped_by_signal", counts.stopped},
          {"frames_expected", counts.frames_expected},
          {"write_failures", counts.write_failures}};
}

int exitCodeOf(const nlohmann::json& summary) {
  const nlohmann::json& counts = summary.at("counts");
  if (!counts.at("write_failures").empty() || !summary.at("errors").empty()) {
    return EXIT_FAILURE;
  }
  const auto tracked = counts.at("frames_tracked").get<std::size_t>();
  const auto frames = counts.value("frames_in", tracked);
  return tracked == 0 || 2 * tracked < frames ? kFewPoses : EXIT_SUCCESS;
}

nlohmann::json libraryVersions() {
  return {
      {"hmcdyn", HMCDYN_VERSION},
      {"opencv", CV_VERSION},
      {"ceres", CERES_VERSION_STRING},
      {"eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                    "." + std::to_string(EIGEN_MINOR_VERSION)},
      {"nanoflann", std::to_string((NANOFLANN_VERSION >> 8) & 0xF) + "." +
                        std::to_string((NANOFLANN_VERSION >> 4) & 0xF) + "." +
                        std::to_string(NANOFLANN_VERSION & 0xF)}};
}

}  // namespace hmcdyn::slam
