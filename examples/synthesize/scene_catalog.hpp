// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "synthesize/rooms.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

struct SceneInfo {
  std::string name;
  std::string description;  ///< One line.
};

/// Every scene that buildScene() knows, in the order of the documentation.
const std::vector<SceneInfo>& sceneCatalog();

struct SceneOptions {
  std::uint64_t seed = 1;  ///< Of pictures, clothes, small movements and the camera's hand.
  double seconds = 10.0;   ///< How long people must have something to do (s).
  int threads = 1;         ///< For painting; the result does not depend on it.
  int max_texture = 1024;  ///< Largest side of a surface's picture (px).
  bool paint = true;       ///< false: geometry and motion only, not fit for a Renderer.
};

/// A scene, ready to render, and where in it a camera may be.
struct BuiltScene {
  Scene scene;
  RoomBounds bounds;
};

/// @throws std::invalid_argument for an unknown name; the message lists the known ones.
BuiltScene buildScene(const std::string& name, const SceneOptions& options);

}  // namespace hmcdyn::synthesize
