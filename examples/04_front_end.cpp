// SPDX-License-Identifier: BSD-3-Clause
// A front end in a hundred lines (cv::ORB, brute-force matching with the last key frame,
// solvePnPRansac and the weighted refinement), and what FrameFilter does for it: tracks a folder in
// TUM format without and with the filter, and prints the error of both trajectories. It has no map
// and no loops, so it drifts; docs/integration.md explains it. Needs hmcdyn::hmcdyn.
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>

#include <hmcdyn/hmcdyn.hpp>

// Images, boxes and the error's computation; a system has its own.
#include "evaluate/absolute_trajectory_error.hpp"
#include "slam/detect/detector_factory.hpp"
#include "slam/input/dataset/frame.hpp"

namespace {

using hmcdyn::evaluate::Trajectory;

/// The points of the last key frame in the world, and what they look like.
struct KeyFrame {
  std::vector<cv::Point3f> points;
  cv::Mat descriptors;
};

class FrontEnd {
 public:
  FrontEnd(const hmcdyn::PinholeCamera& camera, bool filters) : camera_(camera) {
    hmcdyn::FrameFilterOptions options;
    options.camera = camera;
    if (!filters) {
      options.rule = hmcdyn::FilterRule::kNone;
    }
    filter_ = std::make_unique<hmcdyn::FrameFilter>(options);
  }

  /// Where the camera is in the frame: camera from world. False where it is lost.
  bool track(const hmcdyn::slam::RgbdFrame& frame, const std::vector<hmcdyn::DetectionBox>& boxes,
             Eigen::Isometry3d& pose) {
    // More features where people cover the image: about 1000 are to be left.
    const double factor = hmcdyn::featureFactor(boxes, frame.gray.size());
    std::vector<cv::KeyPoint> key_points;
    cv::Mat descriptors;
    cv::ORB::create(cvRound(1000 * factor))
        ->detectAndCompute(frame.gray, cv::noArray(), key_points, descriptors);

    hmcdyn::FrameInput input;
    input.timestamp = frame.timestamp;
    input.gray = frame.gray;
    input.depth = frame.depth;
    input.key_points = key_points;
    hmcdyn::FrameFilterResult filtered = filter_->filter(input, boxes);
    hmcdyn::compact(filtered.keep, key_points, descriptors, filtered.weight, filtered.lambda);

    std::size_t inliers = 0;
    if (!key_frame_.points.empty()) {
      inliers = locate(key_points, descriptors, filtered.weight);
      if (inliers < kLeastInliers) {
        return false;
      }
    }
    filter_->setPose(frame.timestamp, hmcdyn::Pose(pose_));
    if (2 * inliers < key_frame_.points.size() || inliers < 4 * kLeastInliers) {
      makeKeyFrame(frame, key_points, descriptors, filtered.lambda);
    }
    pose = pose_;
    return true;
  }

 private:
  static constexpr std::size_t kLeastInliers = 15;  ///< Fewer, and the camera is lost.

  /// @return how many points agree with the pose that was found; 0 where none was.
  std::size_t locate(const std::vector<cv::KeyPoint>& key_points, const cv::Mat& descriptors,
                     const std::vector<float>& weights) {
    std::vector<cv::DMatch> matches;
    cv::BFMatcher(cv::NORM_HAMMING, true).match(descriptors, key_frame_.descriptors, matches);
    std::vector<cv::Point3f> world;
    std::vector<cv::Point2f> pixels;
    std::vector<float> x, y, z, u, v, weight;
    for (const cv::DMatch& match : matches) {
      if (match.distance > 64.0f) {  // of 256 bits: not the same point
        continue;
      }
      const auto i = static_cast<std::size_t>(match.queryIdx);
      world.push_back(key_frame_.points[static_cast<std::size_t>(match.trainIdx)]);
      pixels.push_back(key_points[i].pt);
      x.push_back(world.back().x);
      y.push_back(world.back().y);
      z.push_back(world.back().z);
      u.push_back(pixels.back().x);
      v.push_back(pixels.back().y);
      weight.push_back(weights[i]);
    }
    const cv::Matx33d k(camera_.fx, 0.0, camera_.cx, 0.0, camera_.fy, camera_.cy, 0.0, 0.0, 1.0);
    cv::Mat rotation;
    cv::Mat translation;
    if (world.size() < kLeastInliers ||
        !cv::solvePnPRansac(world, pixels, k, cv::noArray(), rotation, translation, false, 1000,
                            3.0f, 0.999, cv::noArray(), cv::SOLVEPNP_AP3P)) {
      return 0;
    }
    cv::Mat matrix;
    cv::Rodrigues(rotation, matrix);
    Eigen::Matrix3d turn;
    Eigen::Vector3d shift;
    cv::cv2eigen(matrix, turn);
    cv::cv2eigen(translation, shift);
    Eigen::Isometry3d found = Eigen::Isometry3d::Identity();
    found.linear() = turn;
    found.translation() = shift;
    const hmcdyn::PoseRefinementResult refined =
        hmcdyn::refinePose({x, y, z, u, v, {}, {}, weight}, camera_, found);
    if (!refined.succeeded() || refined.inliers < kLeastInliers) {
      return 0;
    }
    pose_ = refined.camera_from_world;
    return refined.inliers;
  }

  /// A point that is not trusted to stand still (lambda) is no landmark.
  void makeKeyFrame(const hmcdyn::slam::RgbdFrame& frame,
                    const std::vector<cv::KeyPoint>& key_points, const cv::Mat& descriptors,
                    const std::vector<float>& lambda) {
    KeyFrame now;
    for (std::size_t i = 0; i < key_points.size(); ++i) {
      const cv::Point2f pixel = key_points[i].pt;
      const float depth = frame.depth.at<float>(cv::Point(pixel));
      if (hmcdyn::hasDepth(depth) && lambda[i] > 0.5f) {
        const Eigen::Vector3f point =
            (pose_.inverse() * camera_.unproject(pixel.x, pixel.y, depth)).cast<float>();
        now.points.emplace_back(point.x(), point.y(), point.z());
        now.descriptors.push_back(descriptors.row(static_cast<int>(i)));
      }
    }
    if (now.points.size() > key_frame_.points.size() / 4) {
      key_frame_ = now;
    }
  }

  hmcdyn::PinholeCamera camera_;
  std::unique_ptr<hmcdyn::FrameFilter> filter_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();  ///< Of the last tracked frame.
  KeyFrame key_frame_;
};

/// Both front ends go through the folder side by side: each frame is read and searched once.
void run(const std::string& folder, const std::string& camera,
         const hmcdyn::slam::DetectorOptions& detection) {
  const hmcdyn::slam::CameraCalibration calibration = hmcdyn::slam::loadCamera(camera);
  const std::unique_ptr<hmcdyn::slam::ObjectDetector> detector =
      hmcdyn::slam::makeDetector(detection);
  FrontEnd front_ends[] = {FrontEnd(calibration.pinhole, false),
                           FrontEnd(calibration.pinhole, true)};
  Trajectory trajectories[2];
  const std::vector<hmcdyn::slam::FrameEntry> frames = hmcdyn::slam::listFrames(folder);
  for (const hmcdyn::slam::FrameEntry& entry : frames) {
    const hmcdyn::slam::RgbdFrame frame = hmcdyn::slam::loadFrame(entry, calibration);
    const std::vector<hmcdyn::DetectionBox> boxes = detector->detect(frame.bgr, frame.timestamp);
    for (std::size_t k = 0; k < 2; ++k) {
      Eigen::Isometry3d pose;
      if (front_ends[k].track(frame, boxes, pose)) {
        trajectories[k].push_back({frame.timestamp, pose.inverse()});
      }
    }
  }
  const auto truth = hmcdyn::evaluate::readTrajectory(folder + "/groundtruth.txt");
  for (std::size_t k = 0; k < 2; ++k) {
    std::printf("%s the filter: ATE %.4f m, %zu of %zu frames tracked\n",
                k == 0 ? "without" : "with   ",
                hmcdyn::evaluate::absoluteTrajectoryError(truth, trajectories[k]).error.rmse,
                trajectories[k].size(), frames.size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) {
    std::puts(
        "usage: 04_front_end FOLDER CAMERA BOXES.txt | FOLDER CAMERA YOLO.cfg YOLO.weights\n"
        "FOLDER in TUM format with groundtruth.txt, CAMERA such as tum3 or a calibration file");
    return 2;
  }
  hmcdyn::slam::DetectorOptions detection;
  detection.classes = {hmcdyn::kPersonClassId};
  detection.type = argc == 4 ? "file" : "darknet";
  (argc == 4 ? detection.boxes : detection.model) = argv[3];
  detection.weights = argc == 5 ? argv[4] : "";
  try {
    run(argv[1], argv[2], detection);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
