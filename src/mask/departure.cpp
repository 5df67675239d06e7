// SPDX-License-Identifier: BSD-3-Clause
#include "mask/departure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace hmcdyn::internal {
namespace {

constexpr int kSearch = 12;      // reduced pixels: 1 m/s across at 2 m in 0.2 s
constexpr float kAlike = 0.05f;  // depths of one thing differ by less near its edge (share)

/// Where a row of an earlier frame is now.
void placeRow(int row, const SmallFrame& earlier, const SmallCamera& of_frame,
              const RelativePose& motion, float max_depth, RowPlaces& places) {
  const SmallCamera camera = of_frame;
  const RelativePose to_now = motion;
  const int width = earlier.width;
  const int height = earlier.height;
  const float ray_y = (static_cast<float>(row) - camera.cy) / camera.fy;
  const float* depth = earlier.depth.data() + earlier.index(row, 0);
  const float* rays = places.ray.data();
  float* to_depth = places.depth.data();
  std::int32_t* to_pixel = places.pixel.data();
  for (int column = 0; column < width; ++column) {
    const float z = depth[column];
    const StaticPlace place = placeOnRay(rays[column], ray_y, z, camera, to_now);
    const bool has_place = allOf(z > 0.0f, z <= max_depth, place.depth >= kNearestPlace);
    to_depth[column] = place.depth;
    to_pixel[column] = pixelAround(place.u, place.v, has_place, width, height);
  }
}

/// The frame sees through the place, and around it: edges flicker by a pixel.
bool isSeenThrough(const MaskCell& cell, float depth, const SurfaceTolerance& tolerance) {
  return cell.nearest > depth + tolerance.at(depth) && cell.nearest < kNoNearest;
}

/// From a pixel towards a border.
struct Way {
  int step;  ///< From pixel to pixel.
  int room;  ///< Pixels to the border.
};

/// Steps to the first pixel of the same depth (m), at most `most`; nothing where something nearer
/// comes first.
std::optional<int> stepsToAlike(int pixel, float depth, const SmallFrame& frame, const Way& way,
                                int most) {
  const float alike = kAlike * depth;
  for (int first = 1; first <= most; first += 3) {
    // mostly all is farther: three pixels at a time, by what the cell in their middle knows
    if (first < way.room) {
      const auto middle = static_cast<std::size_t>(pixel + (first + 1) * way.step);
      if (frame.cells[middle].nearest - depth >= alike) {
        continue;
      }
    }
    for (int steps = first; steps <= std::min(first + 2, most); ++steps) {
      const float z = frame.depth[static_cast<std::size_t>(pixel + steps * way.step)];
      if (std::abs(z - depth) < alike) {  // so it is not 0
        return steps;
      }
      if (z > 0.0f && z < depth) {
        return std::nullopt;
      }
    }
  }
  return std::nullopt;
}

/// The nearest pixel to the left, right, above or below of the same depth (m); nothing where
/// something nearer comes first, which hides where the surface went.
std::optional<std::size_t> pixelBeside(int pixel, float depth, const SmallFrame& frame) {
  const int column = pixel % frame.width;
  const int row = pixel / frame.width;
  const std::array<Way, 4> ways = {{{1, frame.width - 1 - column},
                                    {-1, column},
                                    {frame.width, frame.height - 1 - row},
                                    {-frame.width, row}}};
  std::optional<std::size_t> found;
  int most = kSearch;
  for (const Way& way : ways) {
    if (const std::optional<int> steps =
            stepsToAlike(pixel, depth, frame, way, std::min(way.room, most))) {
      found = static_cast<std::size_t>(pixel + *steps * way.step);
      most = *steps - 1;
    }
  }
  return found;
}

}  // namespace

void addDepartures(const SmallFrame& frame, const SmallCamera& camera, const SmallFrame& earlier,
                   std::uint8_t bit, const SurfaceTolerance& tolerance, const MaskModel& model,
                   EvidenceImage& image) {
  const RelativePose motion = relativePose(frame.camera_from_world, earlier.camera_from_world);
  const float weight = model.evidence.departure_weight;
  for (int row = 0; row < earlier.height; ++row) {
    placeRow(row, earlier, camera, motion, model.options.max_depth, image.places);
    for (std::size_t x = 0; x < image.places.pixel.size(); ++x) {
      const std::int32_t place = image.places.pixel[x];
      const float depth = image.places.depth[x];
      if (place < 0 ||
          !isSeenThrough(frame.cells[static_cast<std::size_t>(place)], depth, tolerance)) {
        continue;
      }
      if (const std::optional<std::size_t> pixel = pixelBeside(place, depth, frame)) {
        image.evidence[*pixel].value += weight;
        image.evidence[*pixel].weight += weight;
        Comparisons& comparisons = image.comparisons[*pixel];
        comparisons.free = static_cast<std::uint8_t>(comparisons.free | bit);
      }
    }
  }
}

}  // namespace hmcdyn::internal
