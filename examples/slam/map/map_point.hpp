// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slam/map/landmark_trust.hpp"

namespace hmcdyn::slam {

/// An ORB descriptor.
using Descriptor = std::array<std::uint8_t, 32>;

/// A key frame that saw a map point, and the key point that it saw.
struct Observation {
  int key_frame = 0;
  std::size_t key_point = 0;
};

/// A point of the world, as far as it is believed to stand still.
struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World (m).
  /// Systematic error of its depths, which its views share (1/m): at depth z they measure
  /// z + depth_offset z^2. The bundle adjustment finds it.
  double depth_offset = 0.0;
  Descriptor descriptor{};  ///< Of its latest key frame.
  int octave = 0;           ///< Pyramid level at which that key frame saw it ...
  double distance = 0.0;    ///< ... from this distance (m).
  int first_key_frame = 0;
  int last_key_frame = 0;  ///< Latest key frame that saw it.
  std::vector<Observation> observations;
  std::size_t visible = 0;  ///< Frames in which it should have been seen.
  std::size_t found = 0;    ///< Frames in which it was matched and agreed.
  LandmarkTrust trust;      ///< That it stands still.
  bool removed = false;
};

}  // namespace hmcdyn::slam
