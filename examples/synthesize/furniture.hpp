// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "synthesize/lighting.hpp"
#include "synthesize/mesh.hpp"
#include "synthesize/random.hpp"
#include "synthesize/texture.hpp"

namespace hmcdyn::synthesize {

/// Pictures that many things share.
struct Palette {
  explicit Palette(TextureLibrary& textures, std::uint64_t seed);

  int desk_wood = 0;
  int dark_wood = 0;
  int light_wood = 0;
  int white_plastic = 0;
  int black_plastic = 0;
  int grey_metal = 0;
  int dark_metal = 0;
  int blue_fabric = 0;
  int red_fabric = 0;
  int grey_fabric = 0;
  int green_leaf = 0;
  int soil = 0;
  int spines = 0;
  int cable = 0;
  int paper_white = 0;
  std::vector<int> covers, pages, keyboards, screens, mugs, cardboards, posters;
};

/// Puts things into a room. Floor things are placed by the middle of their footprint, desk things
/// by the middle of what touches the desk; yaw 0 faces -y, towards the usual camera.
class Furnisher {
 public:
  Furnisher(std::vector<LitMesh>& room, const Lighting& lighting, const Palette& palette,
            std::uint64_t seed);

  void desk(const Eigen::Isometry3f& at, float width, float depth, float height = 0.74f);
  void monitor(const Eigen::Isometry3f& at, float width, bool on);
  void keyboard(const Eigen::Isometry3f& at);
  void mouse(const Eigen::Isometry3f& at);
  void mug(const Eigen::Isometry3f& at);
  void bottle(const Eigen::Isometry3f& at);
  void paper(const Eigen::Isometry3f& at);
  void bookPile(const Eigen::Isometry3f& at, int books);
  void penCup(const Eigen::Isometry3f& at);
  void deskLamp(const Eigen::Isometry3f& at);
  void telephone(const Eigen::Isometry3f& at);
  void cable(const std::vector<Eigen::Vector3f>& points, float radius = 0.006f);
  /// Scatters small things over a strip of `width` x `depth` (m) of a desk top.
  void clutter(const Eigen::Isometry3f& desk_top, float width, float depth, int things);

  void bookcase(const Eigen::Isometry3f& at, float width, float height);
  void cabinet(const Eigen::Isometry3f& at, float width, float height);
  void officeChair(const Eigen::Isometry3f& at, bool red);
  void woodenChair(const Eigen::Isometry3f& at);
  void computer(const Eigen::Isometry3f& at);
  void bin(const Eigen::Isometry3f& at);
  void backpack(const Eigen::Isometry3f& at, bool red);
  void plant(const Eigen::Isometry3f& at, float height);
  void cardboardBox(const Eigen::Isometry3f& at, const Eigen::Vector3f& size);
  void broom(const Eigen::Vector3f& foot, const Eigen::Vector3f& top);
  void stepLadder(const Eigen::Isometry3f& at, float height);
  void partition(const Eigen::Isometry3f& at, float width, float height);

  /// A thing that hangs on a wall: `centre` (m) on the wall, `normal` of the wall into the room.
  void onWall(const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, float width,
              float height, int texture, float thickness = 0.006f, float glow = 0.0f);
  /// Adds any mesh.
  void add(Mesh mesh, float glow = 0.0f);

 private:
  int pick(const std::vector<int>& from);

  std::vector<LitMesh>& room_;
  const Lighting& lighting_;
  const Palette& palette_;
  Random random_;
};

}  // namespace hmcdyn::synthesize
