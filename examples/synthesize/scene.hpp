// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "synthesize/lighting.hpp"
#include "synthesize/texture.hpp"

namespace hmcdyn::synthesize {

/// A thing of rigid parts that may move: a person, a box that is pushed.
struct Mover {
  bool is_person = true;
  std::vector<LitMesh> parts;
  /// Places of the parts in the world at a time (s), a pure function of the time.
  std::function<std::vector<Eigen::Isometry3d>(double)> poses;
};

/// Camera in the world at a time (s): z forward, x right, y down. A pure function of the time.
using CameraPath = std::function<Eigen::Isometry3d(double)>;

/// All that a frame depends on. Time 0 is the first frame. World: metres, z up, floor at z = 0.
struct Scene {
  TextureLibrary textures;
  Lighting lighting;
  std::vector<LitMesh> room;
  std::vector<Mover> movers;
  CameraPath camera;
};

}  // namespace hmcdyn::synthesize
