// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include "evaluate/trajectory.hpp"
#include "slam/detect/file_detector.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/input/dataset/image_file.hpp"
#include "slam/output/dense/dense_map.hpp"
#include "slam/output/mask_files.hpp"
#include "support/command_line.hpp"

// The dense map of a rendered sequence with its true poses and boxes: what fusion alone does,
// without the errors of tracking. hmcdyn_map_score says how good it is.

namespace hmcdyn::slam {
namespace {

struct Arguments {
  std::filesystem::path sequence;
  std::filesystem::path output;
  std::size_t every = 5;
  std::filesystem::path motion_masks;
  bool no_masks = false;
  bool no_checks = false;
};

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

cv::Mat staticMaskOf(const Arguments& arguments, const RgbdFrame& frame,
                     const std::vector<DetectionBox>& boxes) {
  if (!arguments.motion_masks.empty()) {
    const cv::Mat motion = readImage(stampedImage(arguments.motion_masks, frame.timestamp));
    return staticMaskByMotion(motion, frame.depth,
                              arguments.no_masks ? std::vector<DetectionBox>{} : boxes, {});
  }
  return arguments.no_masks ? cv::Mat() : staticMask(frame.bgr.size(), boxes, {});
}

void run(const Arguments& arguments) {
  const CameraCalibration calibration =
      loadCamera((arguments.sequence / "calibration.yaml").string());
  const evaluate::Trajectory truth =
      evaluate::readTrajectory(arguments.sequence / "groundtruth.txt");
  std::map<std::string, Eigen::Isometry3d> poses;
  for (const evaluate::StampedPose& pose : truth) {
    poses[formatTimestamp(pose.timestamp)] = pose.pose;
  }
  std::map<std::string, std::vector<DetectionBox>> boxes;
  for (const TimedBox& box : readBoxFile(arguments.sequence / "boxes.txt")) {
    boxes[formatTimestamp(box.timestamp)].push_back(box.box);
  }

  DenseMap map;
  std::vector<KeyFramePose> final_poses;
  double thinning = 0.0;
  for (const FrameEntry& entry : listFrames(arguments.sequence)) {
    const std::string stamp = formatTimestamp(entry.timestamp);
    if (entry.index % arguments.every != 0 || poses.count(stamp) == 0) {
      continue;
    }
    const RgbdFrame frame = loadFrame(entry, calibration);
    const auto start = std::chrono::steady_clock::now();
    const cv::Mat mask = staticMaskOf(arguments, frame, boxes[stamp]);
    map.add(entry.index, thinKeyFrame(frame.bgr, frame.depth, mask));
    thinning += millisecondsSince(start);
    final_poses.push_back({entry.index, poses[stamp].inverse()});
  }
  FusionOptions options;
  if (arguments.no_checks) {
    options.min_sightings = 0;
    options.max_free_share = 1.0;
  }
  const auto start = std::chrono::steady_clock::now();
  const FusionResult result = map.fuse(final_poses, calibration.pinhole, options);
  const double fusing = millisecondsSince(start);
  writePly(arguments.output, result.cloud);
  const auto count = static_cast<double>(final_poses.size());
  std::printf(
      "%zu key frames: %.1f ms each to keep, %.1f ms each to fuse\n"
      "%zu voxels, %zu rarely seen, %zu looked through, %zu points\n",
      final_poses.size(), thinning / count, fusing / count, result.voxels, result.rare, result.free,
      result.cloud.position.size());
}

}  // namespace
}  // namespace hmcdyn::slam

int main(int argc, char** argv) {
  hmcdyn::slam::Arguments arguments;
  CLI::App app("Dense map of a rendered sequence with its true poses and boxes.");
  app.add_option("sequence", arguments.sequence, "Folder of hmcdyn_synthesize")->required();
  app.add_option("--output", arguments.output, "PLY file")->required();
  app.add_option("--every", arguments.every, "Every so many frames is a key frame")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_flag("--no-masks", arguments.no_masks, "Boxes are not left out");
  app.add_option("--motion-masks", arguments.motion_masks,
                 "Folder of motion masks (hmcdyn_mask, hmcdyn_slam), in place of whole boxes; with "
                 "--no-masks without any box");
  app.add_flag("--no-checks", arguments.no_checks,
               "Points that are rarely seen or looked through stay");
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  try {
    hmcdyn::slam::run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measure_dense_map: %s\n", error.what());
    return 1;
  }
}
