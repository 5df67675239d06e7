// SPDX-License-Identifier: BSD-3-Clause
// What the recipes of scenes share.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "synthesize/camera_path.hpp"
#include "synthesize/cast.hpp"
#include "synthesize/pi.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/unknown_things.hpp"

namespace hmcdyn::synthesize {

inline constexpr double kLeft = kPi;
inline constexpr double kRight = 0.0;
inline constexpr double kTowards = -0.5 * kPi;  // the usual camera

/// A scene while it is put together.
struct Stage {
  SceneOptions options;
  BuiltScene built;
  std::optional<Palette> palette;  ///< Of the room.
  int people = 0;

  std::shared_ptr<const Performance> person(Behaviour behaviour) {
    const std::uint64_t seed = mixBits(options.seed * 1000 + static_cast<std::uint64_t>(people++));
    if (behaviour.seed == 0) {
      behaviour.seed = seed;
    }
    return addPerson(built.scene, randomLook(seed), behaviour, options.seconds);
  }
  void office(bool occluders = false) {
    palette.emplace(built.scene.textures, options.seed);
    built.bounds = furnishOffice(built.scene, *palette, options.seed, occluders);
  }
  void bareOffice() {
    palette.emplace(built.scene.textures, options.seed);
    built.bounds = furnishBareOffice(built.scene, *palette, options.seed);
  }
  void hall() {
    palette.emplace(built.scene.textures, options.seed);
    built.bounds = furnishHall(built.scene, *palette, options.seed);
  }
  /// After one of the rooms.
  Workshop workshop() { return {built.scene, palette.value(), options.seed}; }
  void camera(CameraPath path) { built.scene.camera = std::move(path); }
  /// With the unsteadiness of somebody who moves the camera on purpose, or holds it still.
  void carried(CameraPath path) { camera(handHeld(std::move(path), 0.004, 0.0045, options.seed)); }
  void held(CameraPath path) { camera(handHeld(std::move(path), 0.0015, 0.0022, options.seed)); }
};

inline const Eigen::Vector3d kOfficeEye(0.0, -2.5, 1.45);
inline const Eigen::Vector3d kOfficeTarget(0.0, 0.6, 0.95);
inline const Eigen::Vector3d kHallEye(0.0, -2.6, 1.45);
inline const Eigen::Vector3d kHallTarget(0.0, 2.2, 1.05);

inline Eigen::Isometry3d officeView() { return lookAt(kOfficeEye, kOfficeTarget); }
inline Eigen::Isometry3d hallView() { return lookAt(kHallEye, kHallTarget); }

/// A scene and how it is put together.
struct Recipe {
  SceneInfo info;
  std::function<void(Stage&)> stage;
};

/// Appends the scenes of things that no detector knows.
void addThingRecipes(std::vector<Recipe>& recipes);

}  // namespace hmcdyn::synthesize
