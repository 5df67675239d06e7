// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <utility>

#include "synthesize/body.hpp"
#include "synthesize/body_proportions.hpp"
#include "synthesize/mesh.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

/// A limb from its joint at 0 down to -length, rounded at both ends.
Mesh limb(float length, float upper, float middle, float lower, const Material& material) {
  Mesh mesh;
  addLoft(mesh, Isometry3f::Identity(),
          {{-length - 0.9f * lower, 0.2f * lower, 0.2f * lower},
           {-length - 0.5f * lower, 0.85f * lower, 0.85f * lower},
           {-length, lower, lower},
           {-0.55f * length, middle, middle},
           {-0.2f * length, upper, upper},
           {0.0f, upper, upper},
           {0.6f * upper, 0.8f * upper, 0.8f * upper},
           {0.95f * upper, 0.2f * upper, 0.2f * upper}},
          14, material);
  return mesh;
}

Mesh pelvisMesh(float h, float girth, const Material& cloth) {
  Mesh mesh;
  const float g = h * girth;
  addLoft(mesh, Isometry3f::Identity(),
          {{-0.055f * h, 0.03f * g, 0.05f * g},
           {-0.03f * h, 0.06f * g, 0.088f * g},
           {0.02f * h, 0.068f * g, 0.096f * g},
           {0.07f * h, 0.06f * g, 0.085f * g},
           {0.1f * h, 0.05f * g, 0.075f * g}},
          22, cloth);
  return mesh;
}

Mesh chestMesh(float h, float girth, const Material& cloth) {
  Mesh mesh;
  const float g = h * girth;
  addLoft(mesh, Isometry3f::Identity(),
          {{-0.045f * h, 0.064f * g, 0.091f * g, 0, 0, 2.4f},
           {0.0f, 0.067f * g, 0.092f * g, 0, 0, 2.4f},
           {0.07f * h, 0.066f * g, 0.096f * g, 0, 0, 2.4f},
           {0.14f * h, 0.07f * g, 0.108f * g, 0.004f * h, 0, 2.6f},
           {0.19f * h, 0.066f * g, 0.116f * g, 0, 0, 2.6f},
           {0.22f * h, 0.056f * g, 0.114f * g, 0, 0, 2.4f},
           {0.245f * h, 0.042f * g, 0.075f * g, 0, 0, 2.0f},
           {0.258f * h, 0.034f * h, 0.04f * h}},
          26, cloth);
  return mesh;
}

/// Neck and head, from the base of the neck.
Mesh headMesh(float h, const Material& face) {
  Mesh mesh;
  const float f = 0.006f * h;
  addLoft(mesh, Isometry3f::Identity(),
          {{-0.012f * h, 0.036f * h, 0.04f * h},
           {0.02f * h, 0.03f * h, 0.031f * h},
           {0.036f * h, 0.034f * h, 0.033f * h, f},
           {0.048f * h, 0.046f * h, 0.038f * h, f},
           {0.075f * h, 0.053f * h, 0.043f * h, f},
           {0.1f * h, 0.056f * h, 0.045f * h, 0.5f * f},
           {0.122f * h, 0.055f * h, 0.044f * h},
           {0.143f * h, 0.047f * h, 0.038f * h},
           {0.156f * h, 0.032f * h, 0.027f * h},
           {0.163f * h, 0.012f * h, 0.011f * h}},
          28, face);
  Isometry3f nose = Isometry3f::Identity();
  nose.translation() = Vector3f(0.06f * h, 0, 0.083f * h);
  addEllipsoid(mesh, nose, {0.011f * h, 0.008f * h, 0.014f * h}, 10,
               {face.texture, 0.0f, {0.46f, 0.5f}, {0.54f, 0.68f}});
  for (const float side : {-1.0f, 1.0f}) {
    Isometry3f ear = Isometry3f::Identity();
    ear.translation() = Vector3f(-0.002f * h, side * 0.046f * h, 0.088f * h);
    const float u = side < 0.0f ? 0.25f : 0.75f;
    addEllipsoid(mesh, ear, {0.01f * h, 0.005f * h, 0.018f * h}, 10,
                 {face.texture, 0.0f, {u - 0.03f, 0.5f}, {u + 0.03f, 0.7f}});
  }
  return mesh;
}

Mesh forearmMesh(float h, float girth, const Material& sleeve, const Material& skin) {
  Mesh mesh = limb(proportions::kForearm * h, 0.024f * h * girth, 0.022f * h, 0.016f * h, sleeve);
  Isometry3f hand = Isometry3f::Identity();
  hand.translation() = Vector3f(0.004f * h, 0, -(proportions::kForearm + 0.045f) * h);
  addEllipsoid(mesh, hand, {0.013f * h, 0.024f * h, 0.05f * h}, 14, skin);
  Isometry3f thumb = Isometry3f::Identity();
  thumb.translation() = Vector3f(0.02f * h, 0, -(proportions::kForearm + 0.03f) * h);
  addEllipsoid(mesh, thumb, {0.014f * h, 0.008f * h, 0.02f * h}, 8, skin);
  return mesh;
}

Mesh footMesh(float h, const Material& leather) {
  Mesh mesh;
  const float sole = -proportions::kAnkle * h;
  addLoft(mesh, Isometry3f::Identity(),
          {{sole, 0.074f * h, 0.025f * h, 0.04f * h, 0, 3},
           {sole + 0.012f * h, 0.078f * h, 0.028f * h, 0.04f * h, 0, 3},
           {sole + 0.026f * h, 0.066f * h, 0.026f * h, 0.028f * h, 0, 2.5f},
           {sole + 0.042f * h, 0.036f * h, 0.023f * h, 0.002f * h},
           {sole + 0.06f * h, 0.024f * h, 0.02f * h, -0.004f * h}},
          18, leather);
  return mesh;
}

}  // namespace

BodyLook randomLook(std::uint64_t seed) {
  using paint::Cloth;
  using paint::Color;
  Random random(seed, 3);
  static const std::array<Color, 5> kSkins{Color{150, 178, 222}, Color{135, 160, 205},
                                           Color{115, 145, 195}, Color{80, 108, 155},
                                           Color{55, 75, 110}};
  static const std::array<Color, 5> kHairs{Color{30, 32, 38}, Color{35, 52, 75}, Color{60, 95, 130},
                                           Color{95, 150, 185}, Color{120, 122, 125}};
  static const std::array<Cloth, 6> kShirts{Cloth::kChecks, Cloth::kStripes,    Cloth::kPrint,
                                            Cloth::kChecks, Cloth::kCamouflage, Cloth::kKnit};
  static const std::array<Cloth, 3> kTrousers{Cloth::kDenim, Cloth::kPlain, Cloth::kCamouflage};
  const auto any = [&random](const auto& from) {
    return from[static_cast<std::size_t>(random.integer(0, static_cast<int>(from.size()) - 1))];
  };
  BodyLook look;
  look.height = random.uniform(1.65, 1.9);
  look.girth = random.uniform(0.93, 1.12);
  look.shirt = any(kShirts);
  look.shirt_color = paint::randomColor(random, 40.0, 210.0);
  look.shirt_second = paint::randomColor(random, 60.0, 250.0);
  look.trousers = any(kTrousers);
  look.trousers_color = paint::scaled(paint::randomColor(random, 60.0, 150.0), 0.8);
  look.skin = any(kSkins);
  look.hair = any(kHairs);
  look.long_sleeves = random.chance(0.45);
  look.beard = random.chance(0.3);
  look.glasses = random.chance(0.3);
  look.seed = random.bits();
  return look;
}

std::vector<LitMesh> buildBody(TextureLibrary& textures, const BodyLook& look) {
  const auto h = static_cast<float>(look.height);
  const auto g = static_cast<float>(look.girth);
  const auto cloth = [&](paint::Cloth kind, const paint::Color& color, const paint::Color& second,
                         std::uint64_t stream) {
    return textures.add([=, seed = mixBits(look.seed + stream)] {
      return paint::cloth(kind, color, second, seed);
    });
  };
  const Material shirt{cloth(look.shirt, look.shirt_color, look.shirt_second, 1)};
  const Material trousers{
      cloth(look.trousers, look.trousers_color, paint::scaled(look.trousers_color, 1.6), 2)};
  const Material skin{textures.add(
      [color = look.skin, seed = mixBits(look.seed + 3)] { return paint::skin(color, seed); })};
  const Material face{textures.add([look] {
    return paint::head(look.skin, look.hair, look.beard, look.glasses, mixBits(look.seed + 4));
  })};
  const Material shoe{
      textures.add([color = paint::scaled(look.trousers_color, 0.6),
                    seed = mixBits(look.seed + 5)] { return paint::shoe(color, seed); })};
  // A limb shows part of the cloth's picture, so that its pattern is as coarse as the trunk's.
  const auto part = [](Material m, float u, float width, float height) {
    m.uv_min = {u, 0.2f};
    m.uv_max = {u + width, 0.2f + height};
    return m;
  };
  std::vector<LitMesh> parts;
  parts.push_back(bounded(pelvisMesh(h, g, part(trousers, 0.0f, 1.0f, 0.3f))));
  parts.push_back(bounded(chestMesh(h, g, shirt)));
  parts.push_back(bounded(headMesh(h, face)));
  for (const float u : {0.0f, 0.5f}) {
    parts.push_back(bounded(limb(proportions::kUpperArm * h, 0.031f * h * g, 0.028f * h * g,
                                 0.025f * h * g, part(shirt, u, 0.35f, 0.55f))));
    parts.push_back(bounded(
        forearmMesh(h, g, look.long_sleeves ? part(shirt, u + 0.1f, 0.3f, 0.5f) : skin, skin)));
  }
  for (const float u : {0.0f, 0.5f}) {
    parts.push_back(bounded(limb(proportions::kThigh * h, 0.053f * h * g, 0.046f * h * g,
                                 0.035f * h * g, part(trousers, u, 0.5f, 0.7f))));
    parts.push_back(bounded(limb(proportions::kShin * h, 0.036f * h * g, 0.035f * h * g, 0.026f * h,
                                 part(trousers, u, 0.4f, 0.75f))));
    parts.push_back(bounded(footMesh(h, shoe)));
  }
  return parts;
}

}  // namespace hmcdyn::synthesize
