// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/local_mapper.hpp"

#include <utility>

namespace hmcdyn::slam {

LocalMapper::LocalMapper(const LocalMapperOptions& options)
    : options_(options),
      worker_(
          [adjustment = options.adjustment](const LocalBundle& bundle) {
            return toCorrection(bundle, adjustBundle(bundle.problem, adjustment));
          },
          1) {}

bool LocalMapper::busy() const { return worker_.pending() > 0; }

void LocalMapper::adjust(const Map& map) {
  if (!options_.enabled || busy()) {
    return;
  }
  LocalBundle bundle = makeLocalBundle(map, options_.bundle);
  if (!bundle.points.empty()) {
    worker_.submit(std::move(bundle));
    frames_waited_ = 0;
  }
}

std::optional<MapCorrection> LocalMapper::poll() {
  if (!busy()) {
    return std::nullopt;
  }
  std::optional<MapCorrection> correction;
  if (options_.delay == 0) {
    correction = worker_.tryTake();
  } else if (++frames_waited_ >= options_.delay) {
    correction = worker_.take();
  }
  adjustments_ += correction ? 1 : 0;
  return correction;
}

std::optional<MapCorrection> LocalMapper::finish() {
  if (!busy()) {
    return std::nullopt;
  }
  MapCorrection correction = worker_.take();
  ++adjustments_;
  return correction;
}

}  // namespace hmcdyn::slam
