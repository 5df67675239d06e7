// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "random.hpp"
#include "slam/loop/loop_key_frame.hpp"

namespace hmcdyn::slam::test {

using hmcdyn::test::Random;

inline const PinholeCamera kLens{525.0, 525.0, 319.5, 239.5};  // 640 x 480

/// What can be recognised: a point and what it looks like.
struct Landmark {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  cv::Mat descriptor;                                  // 1 x 32
};

using Landmarks = std::vector<Landmark>;

inline cv::Mat randomDescriptor(Random& random) {
  cv::Mat descriptor(1, 32, CV_8U);
  for (int j = 0; j < 32; ++j) {
    descriptor.at<std::uint8_t>(0, j) = static_cast<std::uint8_t>(random.integer(0, 255));
  }
  return descriptor;
}

/// Landmarks with looks of their own, anywhere in a box.
inline Landmarks scattered(Random& random, int n, const Eigen::Vector3d& low,
                           const Eigen::Vector3d& high) {
  Landmarks landmarks;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(low.x(), high.x());
    const double y = random.uniform(low.y(), high.y());
    const double z = random.uniform(low.z(), high.z());
    landmarks.push_back({{x, y, z}, randomDescriptor(random)});
  }
  return landmarks;
}

inline Landmarks movedBy(Landmarks landmarks, const Eigen::Isometry3d& motion) {
  for (Landmark& landmark : landmarks) {
    landmark.position = motion * landmark.position;
  }
  return landmarks;
}

inline void add(Landmarks& landmarks, const Landmarks& more) {
  landmarks.insert(landmarks.end(), more.begin(), more.end());
}

/// Errors of what is seen.
struct SightNoise {
  double pixel = 0.0;  ///< Standard deviation (px).
  double depth = 0.0;  ///< In sigmas of the sensor.
  int flips = 0;       ///< Bits of each descriptor that are drawn and turned over.
};

inline const SightNoise kUsualNoise{0.7, 1.0, 12};

/// What a camera sees of landmarks, those nearer than 0.3 m left out; a key point's map point is
/// its landmark's number.
inline LoopKeyFrame see(const Landmarks& landmarks, std::size_t id,
                        const Eigen::Isometry3d& camera_from_world, std::uint32_t seed = 1,
                        const SightNoise& noise = {}) {
  Random random(seed);
  LoopKeyFrame frame;
  frame.id = id;
  frame.timestamp = 0.1 * static_cast<double>(id);
  frame.camera_from_world = camera_from_world;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d p = camera_from_world * landmarks[i].position;
    if (p.z() < 0.3) {
      continue;
    }
    const Eigen::Vector2d pixel = kLens.project(p);
    const double u = pixel.x() + random.normal(noise.pixel);
    const double v = pixel.y() + random.normal(noise.pixel);
    const double depth = p.z() + random.normal(noise.depth * depthNoise(p.z(), DepthErrorModel{}));
    if (u < 0.0 || v < 0.0 || u > 639.0 || v > 479.0) {
      continue;
    }
    cv::Mat row = landmarks[i].descriptor.clone();
    for (int k = 0; k < noise.flips; ++k) {
      const int bit = random.integer(0, 255);
      std::uint8_t& byte = row.at<std::uint8_t>(0, bit / 8);
      byte = static_cast<std::uint8_t>(byte ^ (1U << (bit % 8)));
    }
    frame.descriptors.push_back(row);
    frame.points.push_back(static_cast<float>(u), static_cast<float>(v), static_cast<float>(depth));
    frame.sigma.push_back(1.0f);
    frame.map_point.push_back(static_cast<int>(i));
  }
  return frame;
}

/// (Exp(rotation), translation), by Eigen's AngleAxis.
inline Eigen::Isometry3d motionOf(const Eigen::Vector3d& rotation,
                                  const Eigen::Vector3d& translation) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (rotation.norm() > 0.0) {
    motion.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  }
  motion.translation() = translation;
  return motion;
}

inline double radiansBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear() * b.linear().transpose())).angle();
}

inline double metresBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

}  // namespace hmcdyn::slam::test
