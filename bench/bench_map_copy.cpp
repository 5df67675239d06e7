// SPDX-License-Identifier: BSD-3-Clause
// What a loop's correction costs the tracking thread, the copy of the map, and what it costs the
// loop thread to make a snapshot of it: by number of key frames.
#include <cstddef>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "loop/map_tour.hpp"
#include "slam/loop/map_snapshot.hpp"

namespace hmcdyn::slam {
namespace {

/// Key frames with 970 points each, of which one in six is new.
test::MapTour tourOf(std::int64_t key_frames) {
  constexpr int kLandmarks = 9000;
  test::MapTour tour(test::hall(77, kLandmarks), {});
  for (std::int64_t k = 0; k < key_frames; ++k) {
    tour.step();
  }
  return tour;
}

void copyMap(benchmark::State& state) {
  const test::MapTour tour = tourOf(state.range(0));
  MapCopier copier;
  copier.remember(tour.map);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(copier.copy(tour.map, {}));
  }
  state.counters["points"] = static_cast<double>(tour.map.points().size());
}

void makeSnapshot(benchmark::State& state) {
  const test::MapTour tour = tourOf(state.range(0));
  const MapCopy copy = MapCopier().copy(tour.map, {});
  std::size_t sightings = 0;
  for ([[maybe_unused]] auto _ : state) {
    sightings = toSnapshot(copy).sightings.size();
  }
  state.counters["sightings"] = static_cast<double>(sightings);
}

BENCHMARK(copyMap)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(makeSnapshot)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hmcdyn::slam
