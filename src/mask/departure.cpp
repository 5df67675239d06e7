// SPDX-License-Identifier: BSD-3-Clause
#include "departure.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace hmcdyn::internal {
namespace {

constexpr int kSearch = 12;      // reduced pixels: 1 m/s across at 2 m in 0.2 s
constexpr float kAlike = 0.05f;  // depths of one thing differ by less near its edge (share)

/// The frame sees through the place, and around it: edges flicker by a pixel.
bool isSeenThrough(const StaticPlace& place, const SmallFrame& frame,
                   const SurfaceTolerance& tolerance) {
  if (!(place.u >= 0.0f && place.v >= 0.0f && place.u < static_cast<float>(frame.width) &&
        place.v < static_cast<float>(frame.height))) {
    return false;
  }
  const MaskCell& cell =
      frame.cells[frame.index(static_cast<int>(place.v), static_cast<int>(place.u))];
  return cell.nearest > place.depth + tolerance.at(place.depth) && cell.nearest < kNoNearest;
}

/// The nearest pixel to the left, right, above or below with the depth of the place; nothing where
/// something nearer comes first, which hides where the surface went.
std::optional<std::size_t> pixelBeside(const StaticPlace& place, const SmallFrame& frame) {
  constexpr std::array<std::array<int, 2>, 4> kWays = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  std::optional<std::size_t> found;
  int nearest = kSearch + 1;
  for (const auto& [right, down] : kWays) {
    int column = static_cast<int>(place.u);
    int row = static_cast<int>(place.v);
    for (int steps = 1; steps < nearest; ++steps) {
      column += right;
      row += down;
      if (column < 0 || row < 0 || column >= frame.width || row >= frame.height) {
        break;
      }
      const std::size_t pixel = frame.index(row, column);
      const float z = frame.depth[pixel];
      if (z > 0.0f && std::abs(z - place.depth) < kAlike * place.depth) {
        found = pixel;
        nearest = steps;
      } else if (z > 0.0f && z < place.depth) {
        break;
      }
    }
  }
  return found;
}

}  // namespace

void addDepartures(const SmallFrame& frame, const SmallCamera& camera, const SmallFrame& earlier,
                   std::uint8_t bit, const MotionMaskOptions& options, EvidenceImage& image) {
  const RelativePose motion = relativePose(frame.camera_from_world, earlier.camera_from_world);
  const SurfaceTolerance tolerance = surfaceTolerance(options.depth);
  const float weight = options.evidence.departure_weight;
  for (int row = 0; row < earlier.height; ++row) {
    for (int column = 0; column < earlier.width; ++column) {
      const float z = earlier.depth[earlier.index(row, column)];
      if (!(z > 0.0f) || z > options.depth.max_depth) {
        continue;
      }
      const StaticPlace place = staticPlace(row, column, z, camera, motion);
      if (!isSeenThrough(place, frame, tolerance)) {
        continue;
      }
      if (const std::optional<std::size_t> pixel = pixelBeside(place, frame)) {
        image.evidence[*pixel].value += weight;
        image.evidence[*pixel].weight += weight;
        Comparisons& comparisons = image.comparisons[*pixel];
        comparisons.free = static_cast<std::uint8_t>(comparisons.free | bit);
      }
    }
  }
}

}  // namespace hmcdyn::internal
