// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::test {

/// Exact images of a board of 0.5 m x 0.6 m, 1.5 m in front of a camera that looks along z at a
/// wall 3 m away; board and camera move along x only.
class SlidingThing {
 public:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr PinholeCamera kCamera{140.0, 140.0, 80.0, 60.0};
  static constexpr double kBoard = 1.5;       ///< (m)
  static constexpr double kWall = 3.0;        ///< (m)
  static constexpr double kBoardWidth = 0.5;  ///< (m)

  /// @param camera_x, board_x where the camera and the board's left edge are (m).
  SlidingThing(double timestamp, double camera_x, double board_x)
      : camera_x_(camera_x), board_x_(board_x) {
    frame_.timestamp = timestamp;
    frame_.camera_from_world.matrix(0, 3) = -camera_x;
    frame_.depth.create(kHeight, kWidth, CV_32FC1);
    frame_.gray.create(kHeight, kWidth, CV_8UC1);
    truth_.create(kHeight, kWidth, CV_8UC1);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const bool on_board = isBoard(u, v);
        truth_.at<std::uint8_t>(v, u) = on_board ? 255 : 0;
        frame_.depth.at<float>(v, u) = static_cast<float>(on_board ? kBoard : kWall);
        frame_.gray.at<std::uint8_t>(v, u) = gray(u, v, on_board);
      }
    }
  }

  const MotionMaskFrame& frame() const { return frame_; }
  MotionMaskFrame& frame() { return frame_; }
  const cv::Mat& truth() const { return truth_; }  ///< 255 on the board.
  /// Around the board's pixels.
  DetectionBox box() const {
    const auto column = [&](double x) {
      return static_cast<float>((x - camera_x_) / kBoard * kCamera.fx + kCamera.cx);
    };
    return {column(board_x_), 32.0f, column(board_x_ + kBoardWidth), 88.0f};
  }

 private:
  static double rayX(int u) { return (u - kCamera.cx) / kCamera.fx; }
  static double rayY(int v) { return (v - kCamera.cy) / kCamera.fy; }

  bool isBoard(int u, int v) const {
    const double x = camera_x_ + rayX(u) * kBoard - board_x_;
    return x >= 0.0 && x < kBoardWidth && std::abs(rayY(v) * kBoard) < 0.3;
  }
  /// A texture that is fixed to the surface, with waves of some 10 pixels.
  std::uint8_t gray(int u, int v, bool on_board) const {
    const double z = on_board ? kBoard : kWall;
    const double x = camera_x_ + rayX(u) * z - (on_board ? board_x_ : 0.0);
    const double y = rayY(v) * z;
    const double scale = 40.0 / z * kBoard;
    return static_cast<std::uint8_t>(128.0 + 50.0 * std::sin(scale * x) +
                                     40.0 * std::cos(scale * y));
  }

  double camera_x_;
  double board_x_;
  MotionMaskFrame frame_;
  cv::Mat truth_;
};

/// Share of the pixels of `region` (not 0) that have this label.
inline double shareOf(const cv::Mat& label, MaskLabel value, const cv::Mat& region) {
  const cv::Mat same = (label == static_cast<int>(value)) & region;
  return static_cast<double>(cv::countNonZero(same)) / std::max(1, cv::countNonZero(region));
}

}  // namespace hmcdyn::test
