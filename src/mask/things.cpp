// SPDX-License-Identifier: BSD-3-Clause
#include "mask/things.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "mask/named.hpp"

namespace hmcdyn::internal {
namespace {

constexpr float kJoin = 0.1f;  // neighbours of one thing differ by less (share of their depth)
constexpr std::size_t kDepthSamples = 200;  // pixels of a thing that look for its earlier number
constexpr int kMostNumbers = std::numeric_limits<std::int16_t>::max();

/// Appends the pixels that hang together with the seed. @return true for a thing.
bool grow(std::uint32_t seed, const ThingsInput& in, std::int16_t number, ThingsWorkspace& w) {
  const auto& depth = in.frame.depth;
  const auto& cells = in.frame.cells;
  const auto width = static_cast<std::uint32_t>(in.frame.width);
  const float least = in.model.segment.belief;
  const std::size_t start = w.pixels.size();
  float strongest = -1.0f;
  w.pixels.push_back(seed);
  w.component[seed] = number;
  for (std::size_t k = start; k < w.pixels.size(); ++k) {
    const std::uint32_t at = w.pixels[k];
    strongest = std::max(strongest, cells[at].belief);
    const std::uint32_t column = at % width;
    const auto visit = [&](bool inside, std::uint32_t next) {
      if (inside && w.component[next] < 0 && cells[next].belief > least &&
          std::abs(depth[next] - depth[at]) <= kJoin * depth[at]) {
        w.component[next] = number;
        w.pixels.push_back(next);
      }
    };
    visit(column > 0, at - 1);
    visit(column + 1 < width, at + 1);
    visit(at >= width, at - width);
    visit(at + width < depth.size(), at + width);
  }
  const auto area = static_cast<float>(w.pixels.size() - start);
  if (strongest > in.model.segment.seed_belief &&
      area >= in.model.options.min_area * static_cast<float>(depth.size())) {
    return true;
  }
  w.pixels.resize(start);
  return false;
}

void growAll(const ThingsInput& in, ThingsWorkspace& w) {
  w.pixels.clear();
  w.first.assign(1, 0);
  w.component.assign(in.frame.size(), -1);
  for (std::uint32_t i = 0; i < in.frame.size(); ++i) {
    if (w.component[i] < 0 && in.frame.cells[i].belief > in.model.segment.belief &&
        w.first.size() < static_cast<std::size_t>(kMostNumbers)) {
      if (grow(i, in, static_cast<std::int16_t>(w.first.size() - 1), w)) {
        w.first.push_back(static_cast<std::uint32_t>(w.pixels.size()));
      }
    }
  }
}

/// What the pixels of a thing say together.
struct Votes {
  std::size_t seen = 0;   ///< Pixels that young frames can say anything of.
  std::size_t fresh = 0;  ///< That were not there then.
  std::size_t free = 0;
  std::size_t mismatch = 0;
  std::size_t named = 0;
};

Votes votesOf(const ThingsInput& in, const std::uint32_t* begin, const std::uint32_t* end) {
  Votes votes;
  const std::uint8_t young = in.evidence.fresh;
  for (const auto* pixel = begin; pixel != end; ++pixel) {
    const Comparisons& c = in.evidence.comparisons[*pixel];
    const bool fresh = ((c.free | c.mismatch) & young) != 0;
    votes.fresh += fresh ? 1 : 0;
    votes.seen += fresh || (c.same & young) != 0 ? 1 : 0;
    votes.free += c.free != 0 ? 1 : 0;
    votes.mismatch += c.mismatch != 0 ? 1 : 0;
    votes.named += !in.named.empty() && in.named[*pixel] == kNamed ? 1 : 0;
  }
  return votes;
}

MaskReason reasonOf(const Votes& votes, std::size_t pixels) {
  constexpr std::size_t kTenth = 10;  // of the pixels are enough to speak for all
  if (votes.free * kTenth >= pixels) {
    return MaskReason::kFreeSpace;
  }
  if (votes.named * 2 >= pixels) {
    return MaskReason::kNamed;
  }
  return votes.mismatch * kTenth >= pixels ? MaskReason::kGray : MaskReason::kMemory;
}

/// What moved in the frame before moves on by a smaller share: what drifts slowly would flicker.
bool doesMove(const Votes& votes, bool moved, const SegmentModel& model) {
  const float least = moved ? model.min_fresh_on : model.min_fresh;
  return static_cast<float>(votes.fresh) > least * static_cast<float>(votes.seen);
}

MaskInstance describe(const ThingsInput& in, const Votes& votes, const std::uint32_t* begin,
                      const std::uint32_t* end) {
  const auto width = static_cast<std::uint32_t>(in.frame.width);
  int left = in.frame.width;
  int right = 0;
  double depth = 0.0;
  for (const auto* pixel = begin; pixel != end; ++pixel) {
    left = std::min(left, static_cast<int>(*pixel % width));
    right = std::max(right, static_cast<int>(*pixel % width));
    depth += static_cast<double>(in.frame.depth[*pixel]);
  }
  const auto rows = std::minmax_element(begin, end);  // pixels are numbered row by row
  const int top = static_cast<int>(*rows.first / width);
  const int bottom = static_cast<int>(*rows.second / width);
  const auto pixels = static_cast<std::size_t>(end - begin);
  MaskInstance thing;
  thing.box = cv::Rect(left * in.reduction, top * in.reduction, (right + 1 - left) * in.reduction,
                       (bottom + 1 - top) * in.reduction);
  thing.area = static_cast<float>(pixels) / static_cast<float>(in.frame.size());
  thing.depth = static_cast<float>(depth / static_cast<double>(pixels));
  thing.decided_by = reasonOf(votes, pixels);
  return thing;
}

/// The number that most of a thing's pixels had in the frame before; 0 = none.
int earlierNumber(const ThingsInput& in, const std::uint32_t* begin, const std::uint32_t* end,
                  const std::vector<int>& taken) {
  const SmallFrame& before = *in.earlier.front();
  const RelativePose motion = relativePose(before.camera_from_world, in.frame.camera_from_world);
  const auto pixels = static_cast<std::size_t>(end - begin);
  const std::size_t step = std::max<std::size_t>(1, pixels / kDepthSamples);
  struct Candidate {
    int number = 0;
    std::size_t votes = 0;
  };
  std::array<Candidate, 8> candidates;  // more than meet in one place
  std::size_t samples = 0;
  for (std::size_t k = 0; k < pixels; k += step) {
    ++samples;
    const StaticPlace place = staticPlace(begin[k], in.frame, in.camera, motion);
    if (!(place.u >= 0.0f && place.v >= 0.0f && place.u < static_cast<float>(before.width) &&
          place.v < static_cast<float>(before.height))) {
      continue;
    }
    const MaskCell& cell =
        before.cells[static_cast<std::size_t>(place.v) * static_cast<std::size_t>(before.width) +
                     static_cast<std::size_t>(place.u)];
    if (cell.thing == 0 || cell.nearest > place.depth * (1.0f + kJoin) ||
        cell.farthest < place.depth * (1.0f - kJoin) ||
        std::find(taken.begin(), taken.end(), cell.thing) != taken.end()) {
      continue;
    }
    for (Candidate& candidate : candidates) {
      if (candidate.number == cell.thing || candidate.number == 0) {
        candidate.number = cell.thing;
        ++candidate.votes;
        break;
      }
    }
  }
  const auto* const best =
      std::max_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.votes < b.votes; });
  constexpr std::size_t kFifth = 5;  // of the samples: a thing that appears from behind another
  return best->votes * kFifth >= samples ? best->number : 0;
}

}  // namespace

std::vector<MaskInstance> findThings(const ThingsInput& in, int& next_number, ThingsWorkspace& w,
                                     std::vector<MaskInstance> reuse) {
  std::vector<MaskInstance> things = std::move(reuse);
  w.moved.clear();
  for (const MaskInstance& thing : things) {
    if (thing.moves) {
      w.moved.push_back(thing.number);
    }
  }
  things.clear();
  w.label.assign(in.frame.size(), static_cast<std::uint8_t>(MaskLabel::kStatic));
  w.taken.clear();
  growAll(in, w);
  const std::size_t count = w.first.size() - 1;
  w.order.resize(count);
  std::iota(w.order.begin(), w.order.end(), 0U);
  std::sort(w.order.begin(), w.order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t size_a = w.first[a + 1] - w.first[a];
    const std::uint32_t size_b = w.first[b + 1] - w.first[b];
    return size_a != size_b ? size_a > size_b : a < b;
  });
  for (const std::uint32_t k : w.order) {  // the largest chooses its number first
    const std::uint32_t* begin = w.pixels.data() + w.first[k];
    const std::uint32_t* end = w.pixels.data() + w.first[k + 1];
    const Votes votes = votesOf(in, begin, end);
    MaskInstance thing = describe(in, votes, begin, end);
    thing.number = earlierNumber(in, begin, end, w.taken);
    if (thing.number == 0) {
      thing.number = next_number;
      next_number = next_number < kMostNumbers ? next_number + 1 : 1;
    }
    w.taken.push_back(thing.number);
    const bool moved = std::find(w.moved.begin(), w.moved.end(), thing.number) != w.moved.end();
    thing.moves = doesMove(votes, moved, in.model.segment);
    for (const auto* pixel = begin; pixel != end; ++pixel) {
      w.label[*pixel] =
          static_cast<std::uint8_t>(thing.moves ? MaskLabel::kMoving : MaskLabel::kStanding);
    }
    things.push_back(thing);
  }
  return things;
}

}  // namespace hmcdyn::internal
