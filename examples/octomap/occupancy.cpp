// SPDX-License-Identifier: BSD-3-Clause
#include "octomap/occupancy.hpp"

#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include <hmcdyn/motion_mask.hpp>

#include "mask/mask_run.hpp"
#include "slam/detect/mask_folder.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/input/dataset/recording.hpp"
#include "slam/input/source/folder_source.hpp"

namespace hmcdyn::occupancy {
namespace {

constexpr double kMaxPoseGap = 0.1;      // (s) between two poses that are interpolated
constexpr double kMaskTolerance = 0.01;  // (s) between an image's stamp and its mask's

/// A frame with its mask (empty where none is asked for) and its pose.
struct PosedFrame {
  slam::RgbdFrame image;
  cv::Mat mask;
  Eigen::Isometry3d world_from_camera;
};

void check(const OccupancyOptions& options) {
  if (!(options.resolution > 0.0)) {
    throw std::invalid_argument("OccupancyOptions::resolution is " +
                                std::to_string(options.resolution) + " m; expected more than 0");
  }
  if (!(options.max_depth > 0.0f)) {
    throw std::invalid_argument("OccupancyOptions::max_depth is " +
                                std::to_string(options.max_depth) + " m; expected more than 0");
  }
  if (options.pixel_step < 1) {
    throw std::invalid_argument("OccupancyOptions::pixel_step is " +
                                std::to_string(options.pixel_step) + "; expected 1 or more");
  }
}

/// @return an empty image where the frame has no mask.
cv::Mat maskAt(const slam::MaskFolder& masks, double timestamp) {
  cv::Mat mask;
  if (masks.has(timestamp)) {
    masks.at(timestamp).convertTo(mask, CV_8U);  // 16 bit as well
  }
  return mask;
}

void forEachFrame(const OccupancyOptions& options,
                  const std::function<void(const PosedFrame&, const PinholeCamera&)>& take) {
  check(options);
  slam::Recording recording = slam::openRecording(options.dataset, options.camera);
  const slam::Rectifier rectifier(recording.calibration);
  const evaluate::Trajectory trajectory =
      evaluate::readTrajectoryFor(options.trajectory, recording.list.frames.front().timestamp,
                                  recording.list.frames.back().timestamp)
          .poses;
  std::optional<slam::MaskFolder> masks;
  if (!options.masks.empty()) {
    masks.emplace(options.masks, rectifier.size(), kMaskTolerance);
  }
  slam::TumFolderSource source(std::move(recording.list), options.dataset, recording.calibration,
                               [](const std::string&) {});
  while (const auto raw = source.next()) {
    const auto pose = masking::poseAt(trajectory, raw->timestamp, kMaxPoseGap);
    const cv::Mat mask = masks ? maskAt(*masks, raw->timestamp) : cv::Mat();
    if (pose && (!masks || !mask.empty())) {
      take({slam::rectify(*raw, rectifier), mask, *pose}, recording.calibration.pinhole);
    }
  }
}

/// Points (m, world) of every pixel_step-th pixel whose mask is below `least`.
octomap::Pointcloud pointsOf(const PosedFrame& frame, const PinholeCamera& camera,
                             const OccupancyOptions& options, int step, int least) {
  octomap::Pointcloud points;
  for (int v = step / 2; v < frame.image.depth.rows; v += step) {
    for (int u = step / 2; u < frame.image.depth.cols; u += step) {
      const float z = frame.image.depth.at<float>(v, u);
      if (!(z > 0.0f) || z > options.max_depth ||
          (!frame.mask.empty() && frame.mask.at<std::uint8_t>(v, u) >= least)) {
        continue;
      }
      const double depth = static_cast<double>(z);
      const Eigen::Vector3d at =
          frame.world_from_camera * Eigen::Vector3d((u - camera.cx) / camera.fx * depth,
                                                    (v - camera.cy) / camera.fy * depth, depth);
      points.push_back(static_cast<float>(at.x()), static_cast<float>(at.y()),
                       static_cast<float>(at.z()));
    }
  }
  return points;
}

}  // namespace

std::unique_ptr<octomap::OcTree> buildMap(const OccupancyOptions& options) {
  check(options);
  auto map = std::make_unique<octomap::OcTree>(options.resolution);
  constexpr int kLeftOut = static_cast<int>(MaskLabel::kStanding);
  forEachFrame(options, [&](const PosedFrame& frame, const PinholeCamera& camera) {
    const Eigen::Vector3d from = frame.world_from_camera.translation();
    map->insertPointCloud(
        pointsOf(frame, camera, options, options.pixel_step, kLeftOut),
        {static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())},
        -1.0, true);
  });
  map->updateInnerOccupancy();
  return map;
}

GhostCount countGhosts(const octomap::OcTree& map, const OccupancyOptions& options) {
  if (options.masks.empty()) {
    throw std::invalid_argument(
        "OccupancyOptions::masks is empty; expected a folder of true masks");
  }
  octomap::KeySet surfaces;
  forEachFrame(options, [&](const PosedFrame& frame, const PinholeCamera& camera) {
    for (const octomap::point3d& point : pointsOf(frame, camera, options, 1, 1)) {
      surfaces.insert(map.coordToKey(point));
    }
  });
  const auto isBesideASurface = [&](const octomap::OcTreeKey& key) {
    for (int n = 0; n < 27; ++n) {
      const auto moved = [&](unsigned axis, int offset) {
        return static_cast<octomap::key_type>(key[axis] + offset - 1);
      };
      if (surfaces.count({moved(0, n % 3), moved(1, n / 3 % 3), moved(2, n / 9)}) != 0) {
        return true;
      }
    }
    return false;
  };
  GhostCount count;
  for (auto leaf = map.begin_leafs(); leaf != map.end_leafs(); ++leaf) {
    if (map.isNodeOccupied(*leaf)) {
      ++count.occupied;
      count.ghosts += isBesideASurface(leaf.getKey()) ? 0 : 1;
    }
  }
  return count;
}

}  // namespace hmcdyn::occupancy
