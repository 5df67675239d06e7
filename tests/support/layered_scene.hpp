// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <hmcdyn/types.hpp>

#include "texture.hpp"

namespace hmcdyn::test {

/// Images of a camera that moves sideways past a background of three walls, one above the other and
/// of different depths, with a textured thing in front that moves on its own. Frame 0 is the
/// current one; everything about earlier frames is exact up to the rounding of gray values.
class LayeredScene {
 public:
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr PinholeCamera kCamera{300.0, 300.0, 160.0, 120.0};
  static constexpr double kThingDepth = 1.5;  ///< (m)
  /// A camera's step a frame (m): the walls move by 1, 2 and 3 px, and what stands at kThingDepth
  /// by 4.
  static constexpr double kUsualStep = 0.02;

  /// @param camera_step sideways motion of the camera between two frames (m).
  /// @param thing_step motion of the thing in the image between two frames (px).
  LayeredScene(double camera_step, Eigen::Vector2d thing_step)
      : camera_step_(camera_step), thing_step_(std::move(thing_step)) {}

  /// What `frames` frames ago was seen.
  cv::Mat grayOf(int frames) const {
    const double thing_x = frames * thing_step_.x();
    const double thing_y = frames * thing_step_.y();
    return drawImage(kWidth, kHeight, [&](double x, double y) {
      if (isThing(x + thing_x, y + thing_y)) {
        return thing_(x + thing_x, y + thing_y);
      }
      const double shift = shiftOf(depthOfWall(y), frames);
      return walls_[wallAt(y)](x + shift, y);
    });
  }

  /// The depth image of that frame (m, CV_32FC1).
  cv::Mat depthOf(int frames) const {
    const double thing_x = frames * thing_step_.x();
    const double thing_y = frames * thing_step_.y();
    cv::Mat depth(kHeight, kWidth, CV_32FC1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depth.at<float>(y, x) =
            static_cast<float>(isThing(x + thing_x, y + thing_y) ? kThingDepth : depthOfWall(y));
      }
    }
    return depth;
  }

  /// Motion of the camera since then.
  Eigen::Isometry3d motionSince(int frames) const {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.translation().x() = frames * camera_step_;
    return motion;
  }

  /// How far things at a depth moved to the right since then (px), if they stand.
  double shiftOf(double depth, int frames) const {
    return frames * kCamera.fx * camera_step_ / depth;
  }

  /// Key points of the current frame on a grid, away from all edges; depths as seen.
  static KeyPoints keyPoints() {
    constexpr int kMargin = 12;
    KeyPoints points;
    for (int v = kMargin; v < kHeight - kMargin; v += 6) {
      for (int u = kMargin; u < kWidth - kMargin; u += 6) {
        const bool thing = isThing(u, v);
        bool uniform = true;
        for (const int du : {-kMargin, kMargin}) {
          for (const int dv : {-kMargin, kMargin}) {
            uniform = uniform && isThing(u + du, v + dv) == thing &&
                      (thing || wallAt(v + dv) == wallAt(v));
          }
        }
        if (uniform) {
          points.push_back(static_cast<float>(u), static_cast<float>(v),
                           static_cast<float>(thing ? kThingDepth : depthOfWall(v)));
        }
      }
    }
    return points;
  }

  /// True on the thing in the current frame.
  static bool isThing(double x, double y) {
    return x >= 110.0 && x <= 190.0 && y >= 50.0 && y <= 190.0;
  }

  /// A person's box around the thing that holds some wall at its right, too.
  static DetectionBox boxOfThing() { return {105.0f, 45.0f, 250.0f, 195.0f, kPersonClassId, 1.0f}; }

 private:
  static int wallAt(double y) { return y < 80.0 ? 0 : y < 160.0 ? 1 : 2; }
  static double depthOfWall(double y) {
    constexpr double kDepths[] = {6.0, 3.0, 2.0};
    return kDepths[wallAt(y)];
  }

  double camera_step_;
  Eigen::Vector2d thing_step_;
  Texture thing_{11};
  Texture walls_[3] = {Texture(12), Texture(13), Texture(14)};
};

}  // namespace hmcdyn::test
