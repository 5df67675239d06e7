// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "loop/place_scene.hpp"

namespace hmcdyn::slam::test {

/// A poster of 1.1 m x 0.8 m with n points, the same one wherever it hangs; at the origin of its
/// own frame.
inline Landmarks poster(int n) {
  Random random(100);
  return scattered(random, n, {-0.55, -0.4, 0.0}, {0.55, 0.4, 0.0});
}

/// A place with the poster in it.
inline Landmarks withPoster(Landmarks place, const Eigen::Vector3d& where, int on_poster) {
  add(place, movedBy(poster(on_poster), motionOf(Eigen::Vector3d::Zero(), where)));
  return place;
}

/// A bare wall, 2.4 m away, with pictures on it.
inline Landmarks pictureWall(std::uint32_t seed, int n = 250) {
  Random random(seed);
  return scattered(random, n, {-1.5, -1.1, 2.4}, {1.5, 1.1, 2.4});
}

}  // namespace hmcdyn::slam::test
