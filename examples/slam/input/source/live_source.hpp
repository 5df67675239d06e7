// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "slam/input/camera/calibration.hpp"
#include "slam/input/source/depth_camera.hpp"
#include "slam/input/source/frame_source.hpp"

namespace hmcdyn::slam {

struct LiveSourceOptions {
  /// So many frames in a row that cannot be used are the end: the camera is not the one that the
  /// calibration describes, or it is broken. At least 1.
  std::size_t max_unusable = 30;
};

/// The frames of a live depth camera, depth in metres. Frames that cannot be used are counted and
/// left out; the first of a row of them is reported. A frame without depth is delivered with depth
/// 0 everywhere, so that tracking may go on. The calibration's depth factor is not used: the camera
/// says what its unit is.
class LiveSource final : public FrameSource {
 public:
  /// @throws std::invalid_argument for a null camera or a bad option.
  LiveSource(std::unique_ptr<DepthCamera> camera, CameraCalibration calibration, Report report,
             const LiveSourceOptions& options = {});

  /// Nothing when the camera gives no more images, or only such as cannot be used; failure() says
  /// so, and it stays so.
  std::optional<RgbdFrame> next() override;
  std::optional<std::size_t> expectedFrames() const override { return std::nullopt; }
  std::string name() const override { return camera_->name(); }
  SourceCounts counts() const override { return counts_; }
  std::string failure() const override { return failure_; }

 private:
  void fail(const std::string& reason);

  std::unique_ptr<DepthCamera> camera_;
  CameraCalibration calibration_;
  Report report_;
  LiveSourceOptions options_;
  SourceCounts counts_;
  std::size_t unusable_in_row_ = 0;
  bool had_depth_ = true;  ///< The last frame had depth: the first one without is reported.
  std::optional<double> last_timestamp_;
  std::string failure_;
};

}  // namespace hmcdyn::slam
