// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "slam/map/bundle_adjustment.hpp"
#include "slam/map/local_bundle.hpp"
#include "slam/map/map.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

struct LocalMapperOptions {
  bool enabled = true;
  LocalBundleOptions bundle;
  BundleOptions adjustment;
  /// A result is taken up this many frames after its key frame, and waited for if it is not there
  /// yet, so that runs repeat; 0 = whenever it is there (real time).
  std::size_t delay = 2;
};

/// Local bundle adjustment on a thread of its own, over copies of parts of the map: tracking waits
/// for no lock, and nothing is shared.
class LocalMapper {
 public:
  explicit LocalMapper(const LocalMapperOptions& options);

  /// True while a result is outstanding; a key frame that comes then is adjusted with the next one.
  bool busy() const;

  /// Hands the latest key frame's surroundings to the thread; nothing where it is busy, or
  /// switched off.
  void adjust(const Map& map);

  /// What is to be taken up at this frame; call it once a frame, before tracking. Rethrows what the
  /// adjustment threw; it is over and done with then, and the next one may begin.
  std::optional<MapCorrection> poll();

  /// Waits for what is outstanding. Rethrows as poll() does.
  std::optional<MapCorrection> finish();

  std::size_t adjustments() const noexcept { return adjustments_; }  ///< Results taken up.

 private:
  LocalMapperOptions options_;
  std::size_t frames_waited_ = 0;
  std::size_t adjustments_ = 0;
  support::Worker<LocalBundle, MapCorrection> worker_;
};

}  // namespace hmcdyn::slam
