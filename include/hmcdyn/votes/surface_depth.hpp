// SPDX-License-Identifier: BSD-3-Clause
// Step 6, extended: which surface a key point lies on, where its own pixel does not say.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// A depth image (m), borrowed: row r starts at data + r * stride. 0, negative or not finite =
/// none.
struct DepthImageView {
  const float* data = nullptr;  ///< Depths (m) of the upper left pixel and those after it.
  int width = 0;                ///< Columns (px).
  int height = 0;               ///< Rows (px).
  std::size_t stride = 0;       ///< Elements from a row to the next, >= width.

  /// True where there is no pixel.
  bool empty() const noexcept { return data == nullptr || width <= 0 || height <= 0; }
  /// Depth (m) at a pixel, which must lie in the image.
  float at(int column, int row) const noexcept {
    return data[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
  }
};

/// Which neighbours say on which surface a point lies.
struct SurfaceDepthOptions {
  int own_radius = 2;      ///< Half side of the window that gives a point's own depth (px).
  float own_share = 0.4f;  ///< Share of its pixels that must have a depth, in (0, 1].

  /// Half side of the window that is asked next (px), every second pixel; below 2 it holds too few
  /// to be asked.
  int wide_radius = 12;
  float enclosed_share = 0.5f;  ///< Of all its pixels, near ones that enclose the point.
  float behind_share = 0.1f;    ///< Of all its pixels, far ones that let the point lie behind.

  /// Half side of the window that optical flow compares (px): a nearer surface within it drags the
  /// point along. A flow window of 11 px reaches 5 px, and 10 px one pyramid level up.
  int flow_radius = 10;
  /// Two depths z belong to two surfaces when they differ by gap_floor + gap_quadratic z^2 (m).
  float gap_floor = 0.1f;
  float gap_quadratic = 0.03f;  ///< (1/m), as the noise of a depth camera grows.
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const SurfaceDepthOptions& options) {
  const auto require = [](bool good, const char* name, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("SurfaceDepthOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  const auto share = [](float value) { return value > 0.0f && value <= 1.0f; };
  require(options.own_radius >= 0 && options.own_radius <= 25, "own_radius",
          static_cast<float>(options.own_radius), "a radius in [0, 25] (px)");
  require(options.wide_radius >= 0 && options.wide_radius <= 50, "wide_radius",
          static_cast<float>(options.wide_radius), "a radius in [0, 50] (px)");
  require(options.flow_radius >= 0 && options.flow_radius <= 250, "flow_radius",
          static_cast<float>(options.flow_radius), "a radius in [0, 250] (px)");
  require(share(options.own_share), "own_share", options.own_share, "a share in (0, 1]");
  require(share(options.enclosed_share), "enclosed_share", options.enclosed_share,
          "a share in (0, 1]");
  require(share(options.behind_share), "behind_share", options.behind_share, "a share in (0, 1]");
  require(options.gap_floor >= 0.0f && std::isfinite(options.gap_floor), "gap_floor",
          options.gap_floor, "a finite value >= 0 (m)");
  require(options.gap_quadratic >= 0.0f && std::isfinite(options.gap_quadratic), "gap_quadratic",
          options.gap_quadratic, "a finite value >= 0 (1/m)");
}

/// How well the depth of a point's surface is known.
enum class SurfaceSupport : std::uint8_t {
  kMeasured,  ///< At the point itself.
  kEnclosed,  ///< Not there, but all around it lies one near surface: a hole in it (dark cloth).
  kBehind,    ///< Not there, beside an edge: it is the farther surface that lies in shadow.
  kBeside,    ///< Not there, beside a near surface, and nothing shows what lies behind.
  kNone,      ///< Hardly a depth all around: out of the sensor's range; or not in the image.
};

/// "measured", "enclosed", "behind", "beside" or "none".
inline const char* toString(SurfaceSupport support) noexcept {
  switch (support) {
    case SurfaceSupport::kMeasured:
      return "measured";
    case SurfaceSupport::kEnclosed:
      return "enclosed";
    case SurfaceSupport::kBehind:
      return "behind";
    case SurfaceSupport::kBeside:
      return "beside";
    case SurfaceSupport::kNone:
      return "none";
  }
  return "invalid";
}

/// What lies at N key points.
struct SurfaceDepths {
  std::vector<float> depth;              ///< N depths of the surface (m); 0 for kBeside and kNone.
  std::vector<SurfaceSupport> support;   ///< N.
  std::vector<std::uint8_t> is_dragged;  ///< N flags: a nearer surface within the flow's window.
};

namespace detail {

/// Depths in a window of a depth image.
class DepthWindow {
 public:
  /// Collects every `step`-th pixel of the window of half side `radius` around a pixel, cut at the
  /// image's border.
  void collect(const DepthImageView& image, int column, int row, int radius, int step) {
    count_ = 0;
    pixels_ = 0;
    for (int r = std::max(0, row - radius); r <= std::min(image.height - 1, row + radius);
         r += step) {
      for (int c = std::max(0, column - radius); c <= std::min(image.width - 1, column + radius);
           c += step) {
        ++pixels_;
        if (hasDepth(image.at(c, r)) && count_ < kMost) {
          depth_[count_++] = image.at(c, r);
        }
      }
    }
  }

  std::size_t count() const { return count_; }
  float share(std::size_t count) const {
    return pixels_ == 0 ? 0.0f : static_cast<float>(count) / static_cast<float>(pixels_);
  }
  /// The depth that `share` of the depths do not exceed; count() > 0.
  float quantile(float share) {
    const auto k =
        static_cast<std::ptrdiff_t>(share * static_cast<float>(count_ - 1));  // 0..count_ - 1
    std::nth_element(depth_.begin(), depth_.begin() + k,
                     depth_.begin() + static_cast<std::ptrdiff_t>(count_));
    return depth_[static_cast<std::size_t>(k)];
  }
  /// Moves the depths up to `limit` to the front and says how many they are.
  std::size_t partition(float limit) {
    auto* const end = depth_.data() + static_cast<std::ptrdiff_t>(count_);
    return static_cast<std::size_t>(
        std::partition(depth_.data(), end, [limit](float z) { return z <= limit; }) -
        depth_.data());
  }
  /// Median of the depths [from, to), the farther of the two middle ones of an even number.
  float median(std::size_t from, std::size_t to) {
    auto* const first = depth_.data() + static_cast<std::ptrdiff_t>(from);
    auto* const last = depth_.data() + static_cast<std::ptrdiff_t>(to);
    auto* const middle = first + (last - first) / 2;
    std::nth_element(first, middle, last);
    return *middle;
  }

 private:
  static constexpr std::size_t kMost = 2601;  // 51 x 51: the largest windows
  std::array<float, kMost> depth_{};
  std::size_t count_ = 0;
  std::size_t pixels_ = 0;
};

inline float surfaceGap(float depth, const SurfaceDepthOptions& options) {
  return options.gap_floor + options.gap_quadratic * depth * depth;
}

struct Surface {
  float depth = 0.0f;
  SurfaceSupport support = SurfaceSupport::kNone;
};

/// Where the point has no depth of its own: what the wide window says.
inline Surface surfaceAround(DepthWindow& window, const SurfaceDepthOptions& options) {
  constexpr std::size_t kFewest = 5;
  constexpr float kNearest = 0.1f;  // the nearest tenth, so that one bad pixel decides nothing
  if (window.count() < kFewest) {
    return {};
  }
  const float near = window.quantile(kNearest);
  const std::size_t on_near = window.partition(near + surfaceGap(near, options));
  if (window.share(on_near) >= options.enclosed_share) {
    return {window.median(0, on_near), SurfaceSupport::kEnclosed};
  }
  const std::size_t on_far = window.count() - on_near;
  if (on_far > 0 && window.share(on_far) >= options.behind_share) {
    return {window.median(on_near, window.count()), SurfaceSupport::kBehind};
  }
  return {0.0f, SurfaceSupport::kBeside};
}

/// Whether a surface in front of the point reaches into its flow window.
inline bool nearerSurfaceWithin(const DepthImageView& image, int column, int row, float depth,
                                const SurfaceDepthOptions& options) {
  const float limit = depth - surfaceGap(depth, options);
  const int radius = options.flow_radius;
  constexpr int kStep = 2;  // a quarter of the pixels show it as well
  for (int r = std::max(0, row - radius); r <= std::min(image.height - 1, row + radius);
       r += kStep) {
    for (int c = std::max(0, column - radius); c <= std::min(image.width - 1, column + radius);
         c += kStep) {
      const float z = image.at(c, r);
      if (z > 0.0f && z < limit) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace detail

/// Finds the surface that each key point lies on. A depth camera is blind just where it matters
/// here: in the shadow beside a silhouette, on dark cloth and hair, and out of its range. What
/// casts the shadow is nearer, so the shadow lies on the farther surface (structured light:
/// Khoshelham and Oude Elberink, Sensors 12, 2012).
///
/// @param image of the frame (m).
/// @param u, v N pixels; a NaN or a pixel outside the image has kNone.
/// @param reuse a result whose memory is taken over.
/// @throws std::invalid_argument for an empty image, a stride below the width, u and v of different
/// sizes, or an option out of range.
inline SurfaceDepths surfaceDepths(const DepthImageView& image, Span<const float> u,
                                   Span<const float> v, const SurfaceDepthOptions& options = {},
                                   SurfaceDepths reuse = {}) {
  checkOptions(options);
  if (image.empty() || image.stride < static_cast<std::size_t>(image.width)) {
    throw std::invalid_argument("surfaceDepths: depth image of " + std::to_string(image.width) +
                                " x " + std::to_string(image.height) + ", stride " +
                                std::to_string(image.stride) +
                                "; expected pixels and a stride of at least the width");
  }
  if (u.size() != v.size()) {
    throw std::invalid_argument("surfaceDepths: " + std::to_string(u.size()) + " columns, but " +
                                std::to_string(v.size()) + " rows; expected equal sizes");
  }
  reuse.depth.assign(u.size(), 0.0f);
  reuse.support.assign(u.size(), SurfaceSupport::kNone);
  reuse.is_dragged.assign(u.size(), 0);
  detail::DepthWindow window;
  for (std::size_t i = 0; i < u.size(); ++i) {
    // -0.5 rounds away from the image; false for NaN, too
    const bool inside = u[i] > -0.5f && v[i] > -0.5f &&
                        u[i] < static_cast<float>(image.width) - 0.5f &&
                        v[i] < static_cast<float>(image.height) - 0.5f;
    if (!inside) {
      continue;
    }
    const int column = static_cast<int>(std::lround(u[i]));
    const int row = static_cast<int>(std::lround(v[i]));
    window.collect(image, column, row, options.own_radius, 1);
    if (window.count() > 0 && window.share(window.count()) >= options.own_share) {
      reuse.depth[i] = window.median(0, window.count());
      reuse.support[i] = SurfaceSupport::kMeasured;
    } else {
      constexpr int kStep = 2;
      window.collect(image, column, row, options.wide_radius, kStep);
      const detail::Surface surface = detail::surfaceAround(window, options);
      reuse.depth[i] = surface.depth;
      reuse.support[i] = surface.support;
    }
    const bool is_dragged =
        hasDepth(reuse.depth[i])
            ? detail::nearerSurfaceWithin(image, column, row, reuse.depth[i], options)
            : reuse.support[i] == SurfaceSupport::kBeside;
    reuse.is_dragged[i] = is_dragged ? 1 : 0;
  }
  return reuse;
}

}  // namespace hmcdyn
