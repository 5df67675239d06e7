// SPDX-License-Identifier: BSD-3-Clause
// Things on and at a desk.
#include <algorithm>
#include <cmath>
#include <utility>

#include "synthesize/furniture.hpp"
#include "synthesize/paint.hpp"

namespace hmcdyn::synthesize {

using Eigen::Isometry3f;
using Eigen::Vector3f;

Palette::Palette(TextureLibrary& t, std::uint64_t seed) {
  using paint::Color;
  std::uint64_t next = mixBits(seed);
  const auto fresh = [&next] { return next = mixBits(next); };
  const auto metalOf = [&](const Color& color) {
    return t.add([color, s = fresh()] { return paint::metal(color, s); });
  };
  const auto fabricOf = [&](const Color& color) {
    return t.add([color, s = fresh()] { return paint::fabric(color, s); });
  };
  const auto woodOf = [&](const Color& color) {
    return t.add([color, s = fresh()] { return paint::woodBoard(color, s); });
  };
  desk_wood = woodOf({185, 210, 222});
  dark_wood = woodOf({50, 75, 110});
  light_wood = woodOf({110, 165, 205});
  white_plastic = metalOf({205, 210, 212});
  black_plastic = metalOf({38, 36, 36});
  grey_metal = metalOf({150, 150, 148});
  dark_metal = metalOf({75, 72, 70});
  cable = metalOf({45, 45, 48});
  blue_fabric = fabricOf({120, 75, 45});
  red_fabric = fabricOf({50, 45, 140});
  grey_fabric = fabricOf({120, 140, 150});
  green_leaf = t.add([s = fresh()] { return paint::leaf(s); });
  soil = fabricOf({40, 50, 65});
  spines = t.add([s = fresh()] { return paint::bookSpines(s); });
  paper_white = metalOf({232, 236, 238});
  for (int i = 0; i < 8; ++i) {
    covers.push_back(t.add([s = fresh()] { return paint::bookCover(s); }));
  }
  for (int i = 0; i < 7; ++i) {
    pages.push_back(t.add([s = fresh()] { return paint::textPage(s); }));
  }
  for (int i = 0; i < 3; ++i) {
    keyboards.push_back(t.add([s = fresh()] { return paint::keyboard(s); }));
    screens.push_back(t.add([s = fresh()] { return paint::screen(s); }));
  }
  for (int i = 0; i < 4; ++i) {
    mugs.push_back(t.add([s = fresh()] { return paint::mugPrint(s); }));
    cardboards.push_back(t.add([s = fresh()] { return paint::cardboard(s); }));
  }
  for (int i = 0; i < 4; ++i) {
    posters.push_back(t.add([s = fresh()] { return paint::sciencePoster(s); }));
    posters.push_back(t.add([s = fresh()] { return paint::artPoster(s); }));
    posters.push_back(t.add(
        [s = fresh(), i] { return i % 2 == 0 ? paint::mapPoster(s) : paint::photoPoster(s); }));
  }
  posters.push_back(t.add([s = fresh()] { return paint::calendar(s); }));
}

Furnisher::Furnisher(std::vector<LitMesh>& room, const Lighting& lighting, const Palette& palette,
                     std::uint64_t seed)
    : room_(room), lighting_(lighting), palette_(palette), random_(seed, 9) {}

void Furnisher::add(Mesh mesh, float glow) {
  room_.push_back(litStill(std::move(mesh), lighting_, glow));
}

int Furnisher::pick(const std::vector<int>& from) {
  return from[static_cast<std::size_t>(random_.integer(0, static_cast<int>(from.size()) - 1))];
}

void Furnisher::desk(const Isometry3f& at, float width, float depth, float height) {
  Mesh mesh;
  const Material wood{palette_.desk_wood, 1.3f, {0, 0}, {1, 1}};
  const Material metal{palette_.grey_metal, 0.4f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, height - 0.0125f), {width, depth, 0.025f}, BoxMaterials::all(wood),
         0.25f);
  for (const float sx : {-1.0f, 1.0f}) {
    for (const float sy : {-1.0f, 1.0f}) {
      addBox(mesh,
             moved(at, sx * (0.5f * width - 0.06f), sy * (0.5f * depth - 0.06f),
                   0.5f * height - 0.0125f),
             {0.05f, 0.05f, height - 0.025f}, BoxMaterials::all(metal));
    }
    addBox(mesh, moved(at, sx * (0.5f * width - 0.06f), 0, height - 0.06f),
           {0.03f, depth - 0.12f, 0.06f}, BoxMaterials::all(metal));
  }
  addBox(mesh, moved(at, 0, 0.5f * depth - 0.08f, height - 0.2f), {width - 0.14f, 0.018f, 0.3f},
         BoxMaterials::all(wood));
  add(std::move(mesh));
}

void Furnisher::monitor(const Isometry3f& at, float width, bool on) {
  const float height = width * 0.62f;
  const Material black{palette_.black_plastic, 0.3f, {0, 0}, {1, 1}};
  const Material shell{
      random_.chance(0.5) ? palette_.black_plastic : palette_.grey_metal, 0.3f, {0, 0}, {1, 1}};
  Mesh mesh;
  addBox(mesh, moved(at, 0, 0.03f, 0.01f), {0.24f, 0.18f, 0.02f}, BoxMaterials::all(shell));
  addBox(mesh, moved(at, 0, 0.06f, 0.13f), {0.05f, 0.03f, 0.24f}, BoxMaterials::all(shell));
  const float centre = 0.12f + 0.5f * height;
  addBox(mesh, moved(at, 0, 0.03f, centre), {width, 0.04f, height}, BoxMaterials::all(shell));
  addBox(mesh, moved(at, 0, 0.06f, centre), {0.5f * width, 0.04f, 0.6f * height},
         BoxMaterials::all(black));
  Mesh panel;
  const Material picture{
      on ? pick(palette_.screens) : palette_.black_plastic, 0.0f, {0, 0}, {1, 1}};
  addQuad(panel, point(at, -0.5f * width + 0.016f, 0.008f, centre + 0.5f * height - 0.016f),
          at.linear() * Vector3f(width - 0.032f, 0, 0),
          at.linear() * Vector3f(0, 0, -height + 0.032f), picture);
  add(std::move(mesh));
  add(std::move(panel), on ? 0.95f : 0.0f);
}

void Furnisher::keyboard(const Isometry3f& at) {
  Mesh mesh;
  const Material top{pick(palette_.keyboards), 0.0f, {0, 0}, {1, 1}};
  const Material side{palette_.black_plastic, 0.3f, {0, 0}, {1, 1}};
  addBox(mesh, moved(at, 0, 0, 0.011f), {0.45f, 0.155f, 0.022f},
         BoxMaterials::topAndSides(top, side));
  add(std::move(mesh));
}

void Furnisher::mouse(const Isometry3f& at) {
  Mesh mesh;
  addEllipsoid(mesh, moved(at, 0, 0, 0.012f), {0.032f, 0.055f, 0.022f}, 14,
               {palette_.black_plastic, 0.0f, {0, 0}, {0.3f, 0.3f}});
  add(std::move(mesh));
  cable(
      {point(at, 0, 0.05f, 0.01f), point(at, 0.03f, 0.15f, 0.004f), point(at, 0.0f, 0.3f, 0.004f)},
      0.003f);
}

void Furnisher::mug(const Isometry3f& at) {
  Mesh mesh;
  const Material print{pick(palette_.mugs), 0.0f, {0, 0}, {1, 1}};
  addLoft(mesh, at, {{0, 0.038f, 0.038f}, {0.01f, 0.041f, 0.041f}, {0.095f, 0.042f, 0.042f}}, 18,
          print);
  addCylinder(mesh, point(at, 0.04f, 0, 0.075f), point(at, 0.068f, 0, 0.06f), 0.007f, 0.007f, 6,
              print);
  addCylinder(mesh, point(at, 0.068f, 0, 0.063f), point(at, 0.066f, 0, 0.03f), 0.007f, 0.007f, 6,
              print);
  addCylinder(mesh, point(at, 0.066f, 0, 0.032f), point(at, 0.04f, 0, 0.02f), 0.007f, 0.007f, 6,
              print);
  add(std::move(mesh));
}

void Furnisher::bottle(const Isometry3f& at) {
  Mesh mesh;
  addLoft(mesh, at,
          {{0, 0.033f, 0.033f},
           {0.15f, 0.034f, 0.034f},
           {0.19f, 0.024f, 0.024f},
           {0.22f, 0.013f, 0.013f},
           {0.25f, 0.014f, 0.014f}},
          16, {pick(palette_.mugs), 0.0f, {0, 0}, {1, 1}});
  add(std::move(mesh));
}

void Furnisher::paper(const Isometry3f& at) {
  Mesh mesh;
  addBox(mesh, moved(at, 0, 0, 0.002f), {0.21f, 0.297f, 0.004f},
         BoxMaterials::topAndSides({pick(palette_.pages), 0.0f, {0, 0}, {1, 1}},
                                   {palette_.paper_white, 0.3f, {0, 0}, {1, 1}}));
  add(std::move(mesh));
}

void Furnisher::bookPile(const Isometry3f& at, int books) {
  Mesh mesh;
  float z = 0.0f;
  for (int i = 0; i < books; ++i) {
    const auto thickness = static_cast<float>(random_.uniform(0.018, 0.05));
    const auto width = static_cast<float>(random_.uniform(0.15, 0.22));
    const int column = random_.integer(0, 15);
    const float u = static_cast<float>(column) / 16.0f;
    const Material cover{pick(palette_.covers), 0.0f, {0, 0}, {1, 1}};
    const Material spine{palette_.spines, 0.0f, {u, 0.0f}, {u + 1.0f / 16.0f, 1.0f}};
    const Material paper{palette_.paper_white, 0.2f, {0, 0}, {1, 1}};
    BoxMaterials faces{spine, paper, paper, paper, cover, cover};
    addBox(mesh,
           moved(at, 0, 0, z + 0.5f * thickness, static_cast<float>(random_.uniform(-0.3, 0.3))),
           {width * 1.3f, width, thickness}, faces);
    z += thickness;
  }
  add(std::move(mesh));
}

void Furnisher::penCup(const Isometry3f& at) {
  Mesh mesh;
  addCylinder(mesh, point(at, 0, 0, 0), point(at, 0, 0, 0.1f), 0.038f, 0.04f, 14,
              {pick(palette_.mugs), 0.0f, {0, 0}, {1, 1}});
  for (int i = 0; i < 6; ++i) {
    const auto x = static_cast<float>(random_.uniform(-0.02, 0.02));
    const auto y = static_cast<float>(random_.uniform(-0.02, 0.02));
    addCylinder(mesh, point(at, x, y, 0.05f), point(at, 2.4f * x, 2.4f * y, 0.17f), 0.004f, 0.004f,
                5, {pick(palette_.covers), 0.0f, {0.1f, 0.1f}, {0.2f, 0.2f}});
  }
  add(std::move(mesh));
}

void Furnisher::deskLamp(const Isometry3f& at) {
  Mesh mesh;
  const Material metal{palette_.dark_metal, 0.0f, {0, 0}, {1, 1}};
  addCylinder(mesh, point(at, 0, 0, 0), point(at, 0, 0, 0.025f), 0.09f, 0.085f, 20, metal);
  addCylinder(mesh, point(at, 0, 0, 0.02f), point(at, 0.05f, 0.12f, 0.3f), 0.009f, 0.009f, 8,
              metal);
  addCylinder(mesh, point(at, 0.05f, 0.12f, 0.3f), point(at, 0, -0.1f, 0.46f), 0.009f, 0.009f, 8,
              metal);
  addCylinder(mesh, point(at, 0, -0.17f, 0.37f), point(at, 0, -0.1f, 0.47f), 0.085f, 0.03f, 18,
              metal);
  add(std::move(mesh));
}

void Furnisher::telephone(const Isometry3f& at) {
  Mesh mesh;
  const Material black{palette_.black_plastic, 0.3f, {0, 0}, {1, 1}};
  const Material keys{pick(palette_.keyboards), 0.0f, {0, 0}, {0.3f, 1}};
  addBox(mesh, moved(at, 0, 0, 0.025f), {0.18f, 0.2f, 0.05f},
         BoxMaterials::topAndSides(keys, black));
  addBox(mesh, moved(at, -0.065f, 0, 0.065f), {0.045f, 0.2f, 0.035f}, BoxMaterials::all(black));
  add(std::move(mesh));
  cable({point(at, -0.065f, -0.1f, 0.05f), point(at, -0.1f, -0.13f, 0.01f),
         point(at, -0.13f, 0.0f, 0.008f), point(at, -0.09f, 0.1f, 0.02f)});
}

void Furnisher::cable(const std::vector<Vector3f>& points, float radius) {
  Mesh mesh;
  // Catmull-Rom through the points.
  const auto at = [&](std::ptrdiff_t i) {
    return points[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(points.size()) - 1))];
  };
  constexpr int kSteps = 5;
  for (std::ptrdiff_t i = 0; i + 1 < static_cast<std::ptrdiff_t>(points.size()); ++i) {
    Vector3f previous = at(i);
    for (int step = 1; step <= kSteps; ++step) {
      const float t = static_cast<float>(step) / static_cast<float>(kSteps);
      const Vector3f next =
          0.5f * ((2.0f * at(i)) + (at(i + 1) - at(i - 1)) * t +
                  (2.0f * at(i - 1) - 5.0f * at(i) + 4.0f * at(i + 1) - at(i + 2)) * t * t +
                  (3.0f * at(i) - at(i - 1) - 3.0f * at(i + 1) + at(i + 2)) * t * t * t);
      if ((next - previous).norm() > 1e-4f) {
        addCylinder(mesh, previous, next, radius, radius, 5,
                    {palette_.cable, 0.0f, {0, 0}, {1, 1}});
      }
      previous = next;
    }
  }
  add(std::move(mesh));
}

void Furnisher::clutter(const Isometry3f& desk_top, float width, float depth, int things) {
  for (int i = 0; i < things; ++i) {
    // A jittered row along the desk keeps things from standing in each other.
    const float x = width * ((static_cast<float>(i) + 0.5f) / static_cast<float>(things) - 0.5f) +
                    static_cast<float>(random_.uniform(-0.04, 0.04));
    const auto y = static_cast<float>(random_.uniform(-0.5, 0.5)) * (depth - 0.2f);
    const Isometry3f at = moved(desk_top, x, y, 0, static_cast<float>(random_.uniform(-0.6, 0.6)));
    switch (random_.integer(0, 8)) {
      case 0:
        mug(at);
        break;
      case 1:
        bottle(at);
        break;
      case 2:
        bookPile(at, random_.integer(1, 4));
        break;
      case 3:
        penCup(at);
        break;
      case 4:
        telephone(at);
        break;
      case 5:
        cardboardBox(at, {0.17f, 0.12f, 0.1f});
        break;
      default:
        paper(at);
        paper(moved(at, 0.06f, 0.05f, 0.004f, 0.5f));
    }
  }
}

}  // namespace hmcdyn::synthesize
