// SPDX-License-Identifier: BSD-3-Clause
// Pixels that are believed to move, joined to things that have a number.
#pragma once

#include <cstdint>
#include <vector>

#include "mask/evidence.hpp"

namespace hmcdyn::internal {

struct ThingsInput {
  const SmallFrame& frame;  ///< With beliefs in its cells.
  const SmallCamera& camera;
  const EvidenceImage& evidence;
  const std::vector<std::uint8_t>& named;
  const std::vector<const SmallFrame*>& earlier;  ///< Youngest first; not empty.
  const MaskModel& model;
  int reduction;
};

struct ThingsWorkspace {
  std::vector<std::uint32_t> pixels;    ///< Of all things, one after the other.
  std::vector<std::uint32_t> first;     ///< Of each thing; one more than things.
  std::vector<std::int16_t> component;  ///< Of each pixel; -1 = none.
  std::vector<std::uint8_t> label;      ///< MaskLabel of each pixel.
  std::vector<int> taken;               ///< Numbers in use in this frame.
  std::vector<int> moved;               ///< Numbers of what moved in the frame before.
  std::vector<std::uint32_t> order;
};

/// Things of the frame, largest first, without velocities. Fills workspace.label (static, standing,
/// moving). @param next_number the first number that was never given; grows.
std::vector<MaskInstance> findThings(const ThingsInput& input, int& next_number,
                                     ThingsWorkspace& workspace, std::vector<MaskInstance> reuse);

}  // namespace hmcdyn::internal
