// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam {

inline const PinholeCamera kCamera{300.0, 300.0, 159.5, 119.5};

/// Points of a room, each with a random descriptor of its own, and frames that see them exactly; a
/// key point's class_id is its point's number.
class Room {
 public:
  explicit Room(std::uint32_t seed, int points = 300) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
    };
    for (int i = 0; i < points; ++i) {
      points_.emplace_back(uniform(-1.0, 1.0), uniform(-0.7, 0.7), uniform(1.5, 3.0));
      Descriptor descriptor;
      for (std::uint8_t& byte : descriptor) {
        byte = static_cast<std::uint8_t>(random());
      }
      descriptors_.push_back(descriptor);
    }
  }

  Frame see(std::size_t index, const Eigen::Isometry3d& camera_from_world) const {
    Features features;
    cv::Mat depth = cv::Mat::zeros(240, 320, CV_32F);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d point = camera_from_world * points_[i];
      const Eigen::Vector2d pixel = kCamera.project(point);
      if (pixel.x() < 1.0 || pixel.y() < 1.0 || pixel.x() > 318.0 || pixel.y() > 238.0) {
        continue;
      }
      features.key_points.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                                       31.0f);
      features.key_points.back().octave = 0;
      features.key_points.back().class_id = static_cast<int>(i);
      cv::Mat row(1, 32, CV_8U);
      std::memcpy(row.data, descriptors_[i].data(), 32);
      features.descriptors.push_back(row);
      depth.at<float>(cvRound(pixel.y()), cvRound(pixel.x())) = static_cast<float>(point.z());
    }
    return makeFrame(index, 0.033 * static_cast<double>(index), features, depth, 1.2f);
  }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> descriptors_;
};

/// Gives the frame's key points the map points that the first key frame has for the same points of
/// the room.
inline Frame tied(Frame frame, const Map& map) {
  const Frame& first = map.keyFrames().front().frame;
  std::map<int, int> map_point_of;
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    map_point_of[first.features.key_points[i].class_id] = first.map_point[i];
  }
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const auto found = map_point_of.find(frame.features.key_points[i].class_id);
    frame.map_point[i] = found == map_point_of.end() ? kNoMapPoint : found->second;
  }
  return frame;
}

inline Eigen::Isometry3d movedBy(double x, double turn) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(-x, 0.0, 0.0);
  return pose;
}

inline double distanceBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

}  // namespace hmcdyn::slam
