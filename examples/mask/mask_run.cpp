// SPDX-License-Identifier: BSD-3-Clause
#include "mask/mask_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/detect/box_plausibility.hpp"
#include "slam/detect/file_detector.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/input/dataset/recording.hpp"
#include "slam/input/source/folder_source.hpp"
#include "slam/output/mask_files.hpp"

namespace hmcdyn::masking {
namespace {

constexpr double kSameStamp = 0.005;  // (s): stamps of one frame in two files

double threadSeconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(folder.string() + ": " + error.message());
  }
}

void writeImage(const std::filesystem::path& file, const cv::Mat& image) {
  if (!cv::imwrite(file.string(), image)) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

std::vector<DetectionBox> boxesAt(const std::vector<slam::TimedBox>& boxes, double timestamp) {
  std::vector<DetectionBox> found;
  for (const slam::TimedBox& box : boxes) {
    if (std::abs(box.timestamp - timestamp) < kSameStamp) {
      found.push_back(box.box);
    }
  }
  return found;
}

using Report = std::function<void(const std::string&)>;

void reportAll(const std::vector<std::string>& notes, const Report& report) {
  std::for_each(notes.begin(), notes.end(), report);
}

evaluate::Trajectory readPoses(const std::filesystem::path& file, const slam::FrameList& list,
                               const Report& report) {
  evaluate::NotedTrajectory read = evaluate::readTrajectoryFor(file, list.frames.front().timestamp,
                                                               list.frames.back().timestamp);
  reportAll(read.notes, report);
  return std::move(read.poses);
}

/// Boxes of any class and score that can be the frames'; none where there is no file.
std::vector<slam::TimedBox> readBoxes(const std::filesystem::path& file,
                                      const slam::Recording& recording, const Report& report) {
  if (file.empty()) {
    return {};
  }
  slam::DetectorOptions detector;
  detector.score_threshold = 0.0f;
  detector.time_tolerance = kSameStamp;
  detector.frames = slam::framesOfBoxes(recording.calibration, recording.list);
  slam::BoxReview review = slam::reviewBoxFile(file, detector);
  reportAll(review.notes, report);
  return std::move(review.kept);
}

/// Red where it moves, yellow where it stands but may move; dark where nothing is known.
cv::Mat annotated(const cv::Mat& bgr, const MotionMask& mask) {
  cv::Mat picture = bgr.clone();
  for (int row = 0; row < picture.rows; ++row) {
    auto* pixel = picture.ptr<cv::Vec3b>(row);
    const std::uint8_t* label = mask.label.ptr(row);
    for (int column = 0; column < picture.cols; ++column) {
      cv::Vec3b& color = pixel[column];
      const auto half = [](int a, int b) { return static_cast<std::uint8_t>((a + b) / 2); };
      switch (static_cast<MaskLabel>(label[column])) {
        case MaskLabel::kMoving:
          color = {half(color[0], 0), half(color[1], 0), half(color[2], 255)};
          break;
        case MaskLabel::kStanding:
          color = {half(color[0], 0), half(color[1], 220), half(color[2], 255)};
          break;
        case MaskLabel::kUnknown:
          color = {half(color[0], 0), half(color[1], 0), half(color[2], 0)};
          break;
        default:
          break;
      }
    }
  }
  for (const MaskInstance& thing : mask.instances) {
    const auto& v = thing.velocity;
    const std::string text = thing.has_velocity ? fmt::format("{} {:.1f} m/s", thing.number,
                                                              std::hypot(v[0], v[1], v[2]))
                                                : fmt::format("{}", thing.number);
    cv::putText(picture, text, {thing.box.x + 4, thing.box.y + 24}, cv::FONT_HERSHEY_SIMPLEX, 0.7,
                {255, 255, 255}, 2);
  }
  return picture;
}

class MaskWriter {
 public:
  MaskWriter(const MaskRunOptions& options, double depth_factor)
      : options_(options), depth_factor_(depth_factor) {
    makeFolder(options.output / "mask");
    if (options.write_static_depth) {
      makeFolder(options.output / "depth");
    }
    if (options.annotate) {
      makeFolder(options.output / "annotated");
    }
    things_.open(options.output / "things.csv");
    things_ << "timestamp,state,number,moves,x,y,width,height,area,depth_m,vx_mps,vy_mps,vz_mps,"
               "decided_by\n";
  }

  void write(const slam::RgbdFrame& frame, const MotionMask& mask) {
    const std::string stamp = slam::formatTimestamp(frame.timestamp);
    slam::writeMask(options_.output / "mask", frame.timestamp, mask.label);
    if (options_.write_static_depth) {
      slam::writeStaticDepth(options_.output / "depth", frame.timestamp, frame.depth, mask.label,
                             depth_factor_);
    }
    if (options_.annotate) {
      writeImage(options_.output / "annotated" / (stamp + ".jpg"), annotated(frame.bgr, mask));
    }
    for (const MaskInstance& thing : mask.instances) {
      const std::string velocity = thing.has_velocity
                                       ? fmt::format("{:.3f},{:.3f},{:.3f}", thing.velocity[0],
                                                     thing.velocity[1], thing.velocity[2])
                                       : ",,";
      things_ << fmt::format("{},{},{},{},{},{},{},{},{:.4f},{:.3f},{},{}\n", stamp,
                             toString(mask.state), thing.number, thing.moves ? 1 : 0, thing.box.x,
                             thing.box.y, thing.box.width, thing.box.height, thing.area,
                             thing.depth, velocity, toString(thing.decided_by));
    }
  }

  void finish() {
    things_.close();
    if (!things_) {
      throw std::runtime_error((options_.output / "things.csv").string() + ": cannot be written");
    }
  }

 private:
  const MaskRunOptions& options_;
  double depth_factor_;
  std::ofstream things_;
};

void count(const MotionMask& mask, MaskRunCounts& counts) {
  ++counts.frames;
  counts.moving_share += static_cast<double>(mask.moving_share);
  switch (mask.state) {
    case MaskState::kGood:
      ++counts.judged;
      break;
    case MaskState::kTooLarge:
      ++counts.too_large;
      break;
    default:
      ++counts.unknown;
      break;
  }
}

}  // namespace

std::optional<Eigen::Isometry3d> poseAt(const evaluate::Trajectory& trajectory, double timestamp,
                                        double max_gap) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), timestamp,
      [](const evaluate::StampedPose& pose, double t) { return pose.timestamp < t; });
  for (const auto& near : {after, after == trajectory.begin() ? after : after - 1}) {
    if (near != trajectory.end() && std::abs(near->timestamp - timestamp) < kSameStamp) {
      return near->pose;
    }
  }
  if (after == trajectory.begin() || after == trajectory.end()) {
    return std::nullopt;
  }
  const auto before = after - 1;
  const double gap = after->timestamp - before->timestamp;
  if (gap > max_gap) {
    return std::nullopt;
  }
  const double share = (timestamp - before->timestamp) / gap;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(before->pose.linear())
                      .slerp(share, Eigen::Quaterniond(after->pose.linear()))
                      .toRotationMatrix();
  pose.translation() =
      (1.0 - share) * before->pose.translation() + share * after->pose.translation();
  return pose;
}

MaskRunCounts writeMasks(const MaskRunOptions& options,
                         const std::function<void(std::size_t, std::size_t)>& progress,
                         const std::function<void(const std::string&)>& report) {
  slam::Recording recording = slam::openRecording(options.dataset, options.camera.string());
  const slam::CameraCalibration calibration = recording.calibration;
  const slam::Rectifier rectifier(calibration);
  const evaluate::Trajectory trajectory = readPoses(options.trajectory, recording.list, report);
  const std::vector<slam::TimedBox> boxes = readBoxes(options.boxes, recording, report);
  slam::TumFolderSource source(std::move(recording.list), options.dataset, calibration, report);
  source.limit(options.max_frames);
  const std::size_t total = source.expectedFrames().value_or(0);
  MotionMaskEstimator estimator(calibration.pinhole, options.mask);
  MaskWriter writer(options, calibration.depth_factor);
  MaskRunCounts counts;
  while (const auto raw = source.next()) {
    const slam::RgbdFrame frame = slam::rectify(*raw, rectifier);
    std::vector<DetectionBox> frame_boxes = boxesAt(boxes, frame.timestamp);
    std::transform(frame_boxes.begin(), frame_boxes.end(), frame_boxes.begin(),
                   [&](const DetectionBox& box) { return rectifier.box(box); });
    MotionMaskFrame input;
    input.timestamp = frame.timestamp;
    input.depth = frame.depth;
    input.gray = frame.gray;
    input.regions = frame_boxes;
    const auto pose = poseAt(trajectory, frame.timestamp, options.max_pose_gap);
    input.pose_is_known = pose.has_value();
    if (pose) {
      input.camera_from_world = pose->inverse();
    }
    const double start = threadSeconds();
    const MotionMask& mask = estimator.update(input);
    counts.milliseconds += 1e3 * (threadSeconds() - start);
    count(mask, counts);
    writer.write(frame, mask);
    progress(counts.frames, total);
  }
  writer.finish();
  const auto frames = static_cast<double>(std::max<std::size_t>(counts.frames, 1));
  counts.milliseconds /= frames;
  counts.moving_share /= frames;
  return counts;
}

}  // namespace hmcdyn::masking
