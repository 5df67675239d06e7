// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/run_writer.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/trajectory.hpp"
#include "slam/detect/coco_classes.hpp"
#include "slam/output/annotate.hpp"
#include "slam/run/input_check.hpp"

namespace hmcdyn::slam {
namespace {

/// The names of COCO's classes, by number.
std::vector<std::string> classNames() {
  std::vector<std::string> names;
  names.reserve(kCocoClassCount);
  for (int id = 0; id < kCocoClassCount; ++id) {
    names.push_back(cocoClassName(id));
  }
  return names;
}

cv::Mat pictureOf(const FrameOutcome& outcome, const std::vector<std::string>& class_names) {
  const FilterStageResult& stage = outcome.filtered.stage;
  std::vector<std::uint8_t> box_is_dynamic;
  for (const BoxDecision& box : stage.boxes) {
    box_is_dynamic.push_back(box.verdict.is_dynamic ? 1 : 0);
  }
  AnnotationText text;
  text.frame = outcome.image.index;
  text.class_names = class_names;
  if (!outcome.filtered.earlier.empty()) {
    text.model = toString(outcome.filtered.earlier.front().motion.model.kind);
  }
  return annotateFrame(outcome.image.bgr, outcome.points.view(), stage.label, stage.cluster,
                       outcome.boxes, box_is_dynamic, text);
}

/// The error of each frame, where there is a ground truth that fits.
std::vector<ReportFrame> evaluated(std::vector<ReportFrame> frames,
                                   const std::filesystem::path& groundtruth,
                                   const std::filesystem::path& trajectory) {
  if (groundtruth.empty()) {
    return frames;
  }
  try {
    const evaluate::Trajectory tracked = evaluate::readTrajectory(trajectory);
    const evaluate::NotedTrajectory truth = evaluate::readTrajectoryFor(
        groundtruth, tracked.front().timestamp, tracked.back().timestamp);
    return withGroundTruth(std::move(frames),
                           evaluate::absoluteTrajectoryError(truth.poses, tracked));
  } catch (const std::exception&) {
    return frames;  // summary.json says why there is no error
  }
}

}  // namespace

std::vector<std::string> frameStages() {
  return {"rectify", "detect", "boxes", "features", "filter", "track", "map"};
}

RunWriter::RunWriter(const SlamOptions& options)
    : folder_(options.output),
      trajectory_(folder_.trajectory()),
      timings_(folder_.timings(frameStages())),
      key_frames_(folder_.keyFrames()),
      loops_(folder_.loops()),
      class_names_(classNames()),
      reports_(options.write_report) {
  if (options.write_keypoints) {
    key_points_.emplace(folder_.keyPoints());
  }
  if (options.write_boxes) {
    boxes_.emplace(options.output / "boxes.txt");
    boxes_->append("# timestamp class x_min y_min x_max y_max score\n");
  }
  if (options.annotate) {
    pictures_ = options.output / "frames";
    std::filesystem::create_directories(pictures_);
  }
}

void RunWriter::write(const FrameOutcome& outcome, const Map& map, LoopClosing& loops) {
  const double timestamp = outcome.image.timestamp;
  if (outcome.tracking.failure == TrackingFailure::kNone) {
    trajectory_.write(timestamp, outcome.tracking.camera_from_world);
  }
  timings_.write(timestamp, outcome.times);
  if (outcome.tracking.new_key_frame) {
    key_frames_.write({timestamp, outcome.tracking.camera_from_world});
  }
  writeLoops(map, loops);
  if (key_points_) {
    writeKeyPoints(outcome);
  }
  writePicture(outcome);
  if (reports_) {
    record(outcome);
  }
}

void RunWriter::writeBoxes(const std::string& lines) {
  if (boxes_ && !lines.empty()) {
    boxes_->append(lines);
  }
}

void RunWriter::writeLoops(const Map& map, LoopClosing& loops) {
  bool closed = false;
  for (const LoopEvent& event : loops.takeEvents()) {
    const LoopRow row{event.timestamp, event.matched_timestamp, event.score, event.inliers,
                      event.refusal};
    loops_.write(row);
    loop_rows_.push_back(row);
    closed = closed || event.refusal.empty();
  }
  if (closed) {
    rewriteKeyFrames(map);
  }
}

void RunWriter::writeKeyPoints(const FrameOutcome& outcome) {
  const FilterStageResult& stage = outcome.filtered.stage;
  key_points_->write(outcome.image.timestamp,
                     {outcome.points.view(), outcome.filtered.distance, stage.cluster, stage.label,
                      outcome.weight, outcome.size});
}

void RunWriter::writePicture(const FrameOutcome& outcome) {
  const std::size_t number = report_frames_.added();
  const bool for_report = reports_ && reel_.wants(number);
  if (pictures_.empty() && !for_report) {
    return;
  }
  const cv::Mat picture = pictureOf(outcome, class_names_);
  if (for_report) {
    reel_.add(number, encodeJpeg(picture));
  }
  if (!pictures_.empty()) {
    const std::filesystem::path file = pictures_ / fmt::format("{:06d}.png", outcome.image.index);
    if (!cv::imwrite(file.string(), picture)) {
      throw std::runtime_error(file.string() + ": cannot be written");
    }
  }
}

void RunWriter::record(const FrameOutcome& outcome) {
  ReportFrame frame;
  frame.timestamp = outcome.image.timestamp;
  for (const std::string& stage : frameStages()) {
    const support::StageTime* time = outcome.times.find(stage);
    frame.stage_ms.push_back(time != nullptr ? time->wall_ms
                                             : std::numeric_limits<double>::quiet_NaN());
  }
  const FrameDecision& decision = outcome.filtered.stage.frame;
  frame.dynamic_points = decision.dynamic;
  frame.suspect_points = decision.suspect;
  frame.unmatched_points = decision.unmatched;
  frame.static_points = decision.points - decision.dynamic - decision.suspect - decision.unmatched;
  frame.boxes = decision.boxes;
  frame.dynamic_boxes = decision.dynamic_boxes;
  if (!outcome.filtered.earlier.empty()) {
    frame.model = toString(outcome.filtered.earlier.front().motion.model.kind);
  }
  if (outcome.tracking.failure != TrackingFailure::kNone) {
    frame.failure = toString(outcome.tracking.failure);
  }
  frame.key_frame = outcome.tracking.new_key_frame;
  report_frames_.add(std::move(frame));
}

void RunWriter::rewriteKeyFrames(const Map& map) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    poses.push_back({map.keyFrames()[k].frame.timestamp, map.poseOf(static_cast<int>(k))});
  }
  key_frames_.rewrite(poses);
}

void RunWriter::finish(const std::vector<StampedPose>& poses, const Map& map) {
  trajectory_.finish(poses);
  rewriteKeyFrames(map);
  std::map<double, Eigen::Vector3d> position;
  for (const StampedPose& pose : poses) {
    position[pose.timestamp] = pose.camera_from_world.inverse().translation();
  }
  for (ReportFrame& frame : report_frames_.frames()) {
    const auto found = position.find(frame.timestamp);
    if (found != position.end()) {
      frame.position = found->second;
    }
  }
}

void RunWriter::writeMap(const PointCloud& cloud) const { folder_.writeMap(cloud); }

void RunWriter::writeReport(const nlohmann::json& summary, const std::filesystem::path& groundtruth,
                            const SlamOptions& options) {
  if (!reports_) {
    return;
  }
  ReportInput input;
  input.title = options.dataset.filename().string();
  input.stages = frameStages();
  input.frames_in_all = report_frames_.added();
  input.frames =
      evaluated(std::move(report_frames_.frames()), groundtruth, folder_.path() / "trajectory.txt");
  input.loops = std::move(loop_rows_);
  input.pictures = choosePictures(byPlace(reel_.pictures(), input.frames), input.frames);
  input.summary = summary;
  slam::writeReport(folder_.path() / "report.html", input);
}

}  // namespace hmcdyn::slam
