// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

constexpr double kMetres = 1e-3;  // of the stored millimetres

void check(const std::vector<PosedKeyFrame>& key_frames, const FusionOptions& options) {
  if (!(options.voxel_size > 0.0) || !(options.tolerance_base >= 0.0) ||
      !(options.tolerance_slope >= 0.0) ||
      !(options.max_free_share >= 0.0 && options.max_free_share <= 1.0)) {
    throw std::invalid_argument(fmt::format(
        "dense map: voxel size {} m, tolerance {} m + {} / m, free share {}; expected a "
        "size above 0, tolerances of at least 0, a share in 0..1",
        options.voxel_size, options.tolerance_base, options.tolerance_slope,
        options.max_free_share));
  }
  for (const PosedKeyFrame& key_frame : key_frames) {
    if (key_frame.images == nullptr) {
      throw std::invalid_argument("dense map: a key frame is null; expected images");
    }
  }
}

/// A voxel's place, 21 bits an axis: 20 km to each side at 2 cm.
std::uint64_t voxelKey(const Eigen::Vector3d& point, double size) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::int64_t>(std::floor(point[axis] / size));
    key = key << 21U | (static_cast<std::uint64_t>(cell) & 0x1FFFFFU);
  }
  return key;
}

/// Mixes the bits: neighbouring voxels should not share a bucket (Steele et al. 2014, SplitMix64).
struct KeyHash {
  std::size_t operator()(std::uint64_t key) const noexcept {
    key = (key ^ key >> 30U) * 0xbf58476d1ce4e5b9U;
    key = (key ^ key >> 27U) * 0x94d049bb133111ebU;
    return static_cast<std::size_t>(key ^ key >> 31U);
  }
};

struct Voxel {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // weighted sum, then mean
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();    // red, green, blue
  double weight = 0.0;
  std::uint32_t seen = 0;
  std::uint32_t looked_through = 0;
};

class VoxelGrid {
 public:
  explicit VoxelGrid(const FusionOptions& options) : options_(options) {}

  void add(const Eigen::Vector3d& point, const cv::Vec3b& bgr, double weight) {
    const auto [place, is_new] =
        index_.try_emplace(voxelKey(point, options_.voxel_size), voxels_.size());
    if (is_new) {
      if (voxels_.size() >= options_.max_voxels) {
        index_.erase(place);
        is_truncated_ = true;
        return;
      }
      voxels_.emplace_back();
    }
    Voxel& voxel = voxels_[place->second];
    voxel.position += weight * point;
    voxel.colour += weight * Eigen::Vector3d(bgr[2], bgr[1], bgr[0]);
    voxel.weight += weight;
  }

  std::vector<Voxel> means() && {
    for (Voxel& voxel : voxels_) {
      voxel.position /= voxel.weight;
      voxel.colour /= voxel.weight;
    }
    return std::move(voxels_);
  }

  bool isTruncated() const noexcept { return is_truncated_; }

 private:
  FusionOptions options_;
  std::unordered_map<std::uint64_t, std::size_t, KeyHash> index_;
  std::vector<Voxel> voxels_;  // in the order of their first point
  bool is_truncated_ = false;
};

void integrate(const PosedKeyFrame& key_frame, const PinholeCamera& camera, VoxelGrid& grid) {
  const ThinnedKeyFrame& images = *key_frame.images;
  const Eigen::Isometry3d world_from_camera = key_frame.camera_from_world.inverse();
  for (int r = 0; r < images.depth.rows; ++r) {
    for (int c = 0; c < images.depth.cols; ++c) {
      if (images.usable.at<std::uint8_t>(r, c) == 0) {
        continue;
      }
      const double z = kMetres * images.depth.at<std::uint16_t>(r, c);
      const Eigen::Vector3d point = camera.unproject(c * images.stride, r * images.stride, z);
      grid.add(world_from_camera * point, images.colour.at<cv::Vec3b>(r, c), 1.0 / (z * z));
    }
  }
}

/// The nearest depth around each pixel (mm): at a silhouette, a point is not looked through because
/// of a pixel beside it. No depth at the pixel itself stays no depth.
cv::Mat nearestAround(const cv::Mat& depth) {
  cv::Mat nearest = depth.clone();
  nearest.setTo(std::numeric_limits<std::uint16_t>::max(), depth == 0);
  cv::erode(nearest, nearest, cv::Mat::ones(3, 3, CV_8U));
  nearest.setTo(0, depth == 0);
  return nearest;
}

/// Counts for each voxel whether the key frame sees a surface there, or looks through.
void vote(const PosedKeyFrame& key_frame, const PinholeCamera& camera, const FusionOptions& options,
          std::vector<Voxel>& voxels) {
  const ThinnedKeyFrame& images = *key_frame.images;
  const cv::Mat nearest = nearestAround(images.depth);
  for (Voxel& voxel : voxels) {
    const Eigen::Vector3d point = key_frame.camera_from_world * voxel.position;
    if (point.z() <= 0.0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.project(point) / images.stride;
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < images.depth.cols - 0.5 &&
          pixel.y() < images.depth.rows - 0.5)) {
      continue;
    }
    const int column = static_cast<int>(std::lround(pixel.x()));
    const int row = static_cast<int>(std::lround(pixel.y()));
    const double measured = kMetres * images.depth.at<std::uint16_t>(row, column);
    if (measured <= 0.0) {
      continue;
    }
    const double tolerance = options.tolerance_base + options.tolerance_slope * measured * measured;
    if (std::abs(point.z() - measured) <= tolerance) {
      voxel.seen += images.usable.at<std::uint8_t>(row, column) != 0 ? 1 : 0;
    } else if (point.z() < kMetres * nearest.at<std::uint16_t>(row, column) - tolerance) {
      ++voxel.looked_through;
    }
  }
}

FusionResult collect(const std::vector<Voxel>& voxels, std::size_t key_frames,
                     const FusionOptions& options) {
  FusionResult result;
  result.voxels = voxels.size();
  const std::size_t needed = std::min(options.min_sightings, key_frames);
  for (const Voxel& voxel : voxels) {
    if (voxel.seen < needed) {
      ++result.rare;
    } else if (voxel.looked_through >
               options.max_free_share * (voxel.seen + voxel.looked_through)) {
      ++result.free;
    } else {
      result.cloud.position.emplace_back(voxel.position.cast<float>());
      Colour colour{};
      for (std::size_t i = 0; i < colour.size(); ++i) {
        colour[i] = static_cast<std::uint8_t>(std::lround(voxel.colour[static_cast<int>(i)]));
      }
      result.cloud.colour.push_back(colour);
    }
  }
  return result;
}

}  // namespace

FusionResult fuseKeyFrames(const std::vector<PosedKeyFrame>& key_frames,
                           const PinholeCamera& camera, const FusionOptions& options) {
  check(key_frames, options);
  std::vector<PosedKeyFrame> posed;
  std::copy_if(key_frames.begin(), key_frames.end(), std::back_inserter(posed),
               [](const PosedKeyFrame& k) { return k.camera_from_world.matrix().allFinite(); });
  VoxelGrid grid(options);
  for (const PosedKeyFrame& key_frame : posed) {
    integrate(key_frame, camera, grid);
  }
  const bool is_truncated = grid.isTruncated();
  std::vector<Voxel> voxels = std::move(grid).means();
  for (const PosedKeyFrame& key_frame : posed) {
    vote(key_frame, camera, options, voxels);
  }
  FusionResult result = collect(voxels, posed.size(), options);
  result.is_truncated = is_truncated;
  return result;
}

}  // namespace hmcdyn::slam
