// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Colour samples of a pixel: where in the pixel, when in the exposure, and which way the pyramid
/// level is rounded. Each adds up to nothing, so the picture is neither shifted nor late.
struct Sample {
  double du;
  double dv;
  double time;
  float level_dither;
};
constexpr std::array<Sample, 4> kSamples{{{0.125, 0.375, -0.375, 0.125},
                                          {-0.375, -0.375, -0.125, 0.625},
                                          {0.375, -0.125, 0.125, 0.375},
                                          {-0.125, 0.125, 0.375, 0.875}}};

/// log2 to within 0.09, from the bits of a float.
float roughLog2(float x) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<float>(bits) * 0x1.0p-23f - 127.0f;
}

/// A surface's attributes over its depth: linear in the column, along one row.
struct RowAttributes {
  struct Linear {
    float start = 0.0f;
    float slope = 0.0f;
    float at(int column) const { return start + slope * static_cast<float>(column); }
  };
  Linear inverse_depth, u, v, light;
  // Change of inverse depth and of u, v over the depth from row to row.
  float inverse_depth_down = 0.0f, u_down = 0.0f, v_down = 0.0f;
};

RowAttributes attributesOf(const Surface& surface, const Instance& instance, int row,
                           const PinholeCamera& camera) {
  const Mesh& mesh = instance.body->mesh;
  const auto& corners = mesh.triangles[surface.triangle].corners;
  Eigen::Matrix<double, 4, 3> values;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t corner = corners[static_cast<std::size_t>(i)];
    const Vertex& vertex = mesh.vertices[corner];
    values.col(i) << 1.0, static_cast<double>(vertex.uv.x()), static_cast<double>(vertex.uv.y()),
        static_cast<double>(instance.light[corner]);
  }
  const Eigen::Matrix<double, 4, 3> planes = values * surface.barycentric;
  const Vector3d first_ray(-camera.cx / camera.fx, (row - camera.cy) / camera.fy, 1.0);
  const Eigen::Vector4f start = (planes * first_ray).cast<float>();
  const Eigen::Vector4f slope = (planes.col(0) / camera.fx).cast<float>();
  const Eigen::Vector4f down = (planes.col(1) / camera.fy).cast<float>();
  RowAttributes row_attributes;
  row_attributes.inverse_depth = {start[0], slope[0]};
  row_attributes.u = {start[1], slope[1]};
  row_attributes.v = {start[2], slope[2]};
  row_attributes.light = {start[3], slope[3]};
  row_attributes.inverse_depth_down = down[0];
  row_attributes.u_down = down[1];
  row_attributes.v_down = down[2];
  return row_attributes;
}

/// Which copy of the texture suits a pixel: by the mean of its footprint's two sides, so that
/// floors stay sharp at a grazing view, but never more than twice finer than the longer side.
int levelAt(const RowAttributes& a, int column, const Texture& texture, float dither) {
  const float z = 1.0f / std::max(1e-6f, a.inverse_depth.at(column));
  const float u = a.u.at(column) * z;
  const float v = a.v.at(column) * z;
  const auto width = static_cast<float>(texture.width());
  const auto height = static_cast<float>(texture.height());
  const float ux = (a.u.slope - u * a.inverse_depth.slope) * z * width;
  const float vx = (a.v.slope - v * a.inverse_depth.slope) * z * height;
  const float uy = (a.u_down - u * a.inverse_depth_down) * z * width;
  const float vy = (a.v_down - v * a.inverse_depth_down) * z * height;
  const float across = ux * ux + vx * vx + 1e-12f;
  const float down = uy * uy + vy * vy + 1e-12f;
  const float mean = 0.25f * (roughLog2(across) + roughLog2(down));
  const float longer = 0.5f * roughLog2(std::max(across, down)) - 1.0f;
  // Four samples share the pixel: each needs half its footprint.
  const float level = std::max(mean, longer) - 0.6f + dither;
  return std::clamp(static_cast<int>(level), 0, texture.levelCount() - 1);
}

void shadeRun(const RowAttributes& a, const Texture& texture, int first, int last, float dither,
              std::uint16_t* sums) {
  constexpr int kBlock = 8;  // pixels that share a pyramid level
  for (int block = first; block <= last; block += kBlock) {
    const int end = std::min(last, block + kBlock - 1);
    const int level = levelAt(a, (block + end) / 2, texture, dither);
    for (int u = block; u <= end; ++u) {
      const float z = 1.0f / a.inverse_depth.at(u);
      const PackedColor color = texture.sample(a.u.at(u) * z, a.v.at(u) * z, level);
      const auto light =
          static_cast<std::uint32_t>(std::clamp(a.light.at(u) * z, 0.0f, 2.0f) * 256.0f);
      std::uint16_t* sum = sums + 3 * static_cast<std::ptrdiff_t>(u);
      for (unsigned channel = 0; channel < 3; ++channel) {
        const std::uint32_t lit = (((color >> (8U * channel)) & 0xffU) * light) >> 8U;
        sum[channel] = static_cast<std::uint16_t>(sum[channel] + std::min(255U, lit));
      }
    }
  }
}

void check(const RenderOptions& o) {
  const auto require = [](bool ok, const char* name, double value, const char* expected) {
    if (!ok) {
      throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                  ", expected " + expected);
    }
  };
  require(o.width > 0, "width", o.width, "> 0 px");
  require(o.height > 0, "height", o.height, "> 0 px");
  require(o.camera.fx > 0.0, "fx", o.camera.fx, "> 0 px");
  require(o.camera.fy > 0.0, "fy", o.camera.fy, "> 0 px");
  require(o.exposure >= 0.0, "exposure", o.exposure, ">= 0 s");
  require(o.moving_speed >= 0.0, "moving_speed", o.moving_speed, ">= 0 m/s");
}

/// Speed (m/s) of the points of one rigid part around a time.
class PartMotion {
 public:
  PartMotion(const Isometry3d& before, const Isometry3d& now, const Isometry3d& after,
             double seconds)
      : difference_((after.matrix() - before.matrix()) * now.inverse().matrix() / seconds) {}
  double speedAt(const Vector3d& world) const {
    return (difference_.topLeftCorner<3, 3>() * world + difference_.topRightCorner<3, 1>()).norm();
  }

 private:
  Eigen::Matrix4d difference_;
};

}  // namespace

Renderer::Renderer(const Scene& scene, const RenderOptions& options)
    : scene_(scene),
      options_((check(options), options)),
      rasterizer_(options.width, options.height) {
  sums_.resize(3U * static_cast<std::size_t>(options.width) *
               static_cast<std::size_t>(options.height));
}

std::vector<Instance> Renderer::instancesAt(double time,
                                            const std::vector<std::vector<float>>& light) const {
  std::vector<Instance> instances;
  for (const LitMesh& piece : scene_.room) {
    instances.push_back({&piece, piece.light.data(), Isometry3d::Identity(), -1});
  }
  std::size_t part = 0;
  for (std::size_t m = 0; m < scene_.movers.size(); ++m) {
    const std::vector<Isometry3d> poses = scene_.movers[m].poses(time);
    for (std::size_t i = 0; i < poses.size(); ++i, ++part) {
      instances.push_back({&scene_.movers[m].parts[i], light.empty() ? nullptr : light[part].data(),
                           poses[i], static_cast<int>(m)});
    }
  }
  return instances;
}

RenderedFrame Renderer::render(double time) {
  RenderedFrame frame;
  frame.camera_to_world = scene_.camera(time);
  std::vector<std::vector<float>> light;
  const std::vector<Instance> instances = instancesAt(time, {});
  for (const Instance& instance : instances) {
    if (instance.mover >= 0) {
      light.push_back(lightOf(*instance.body, instance.to_world, scene_.lighting));
    }
  }
  std::fill(sums_.begin(), sums_.end(), std::uint16_t{0});
  for (const Sample& sample : kSamples) {
    const double sample_time = time + sample.time * options_.exposure;
    PinholeCamera shifted = options_.camera;
    shifted.cx -= sample.du;
    shifted.cy -= sample.dv;
    const std::vector<Instance> moved = instancesAt(sample_time, light);
    rasterizer_.draw(moved, scene_.camera(sample_time).inverse(), shifted);
    accumulateColor(sample.level_dither);
  }
  frame.color.create(options_.height, options_.width, CV_8UC3);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    frame.color.data[i] = static_cast<std::uint8_t>((sums_[i] + 2U) >> 2U);
  }
  rasterizer_.draw(instances, frame.camera_to_world.inverse(), options_.camera);
  fillMaps(time, instances, frame);
  return frame;
}

void Renderer::accumulateColor(double dither) {
  for (int v = 0; v < options_.height; ++v) {
    const std::uint32_t* ids = rasterizer_.row(v);
    std::uint16_t* sums =
        sums_.data() + 3U * static_cast<std::size_t>(v) * static_cast<std::size_t>(options_.width);
    for (int first = 0; first < options_.width;) {
      int last = first;
      while (last + 1 < options_.width && ids[last + 1] == ids[first]) {
        ++last;
      }
      if (ids[first] != kNoSurface) {
        const Surface& surface = rasterizer_.surface(ids[first]);
        const Instance& instance = rasterizer_.instance(surface);
        const int texture = instance.body->mesh.triangles[surface.triangle].texture;
        shadeRun(attributesOf(surface, instance, v, rasterizer_.camera()), scene_.textures[texture],
                 first, last, static_cast<float>(dither), sums);
      }
      first = last + 1;
    }
  }
}

void Renderer::fillMaps(double time, const std::vector<Instance>& instances,
                        RenderedFrame& frame) const {
  constexpr double kHalfStep = 1.0 / 60.0;  // the motion over one frame of a 30 Hz camera (s)
  const std::vector<Instance> before = instancesAt(time - kHalfStep, {});
  const std::vector<Instance> after = instancesAt(time + kHalfStep, {});
  std::vector<PartMotion> motions;
  for (std::size_t i = scene_.room.size(); i < instances.size(); ++i) {
    motions.emplace_back(before[i].to_world, instances[i].to_world, after[i].to_world,
                         2.0 * kHalfStep);
  }
  const cv::Size size(options_.width, options_.height);
  frame.depth = cv::Mat::zeros(size, CV_32FC1);
  frame.facing = cv::Mat::zeros(size, CV_32FC1);
  frame.mask = cv::Mat::zeros(size, CV_8UC1);
  frame.mover = cv::Mat(size, CV_16SC1, cv::Scalar(-1));
  const PinholeCamera& camera = options_.camera;
  for (int v = 0; v < size.height; ++v) {
    const std::uint32_t* ids = rasterizer_.row(v);
    Vector3d plane = Vector3d::Zero();
    double plane_norm = 1.0;
    for (int u = 0; u < size.width; ++u) {
      if (ids[u] == kNoSurface) {
        continue;
      }
      const Surface& surface = rasterizer_.surface(ids[u]);
      if (u == 0 || ids[u] != ids[u - 1]) {
        plane = surface.barycentric.colwise().sum();
        plane_norm = plane.norm();
      }
      const Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
      const double inverse_depth = plane.dot(ray);
      frame.depth.at<float>(v, u) = static_cast<float>(1.0 / inverse_depth);
      frame.facing.at<float>(v, u) = static_cast<float>(inverse_depth / (plane_norm * ray.norm()));
      const int mover = instances[surface.instance].mover;
      if (mover < 0) {
        continue;
      }
      const Vector3d world = frame.camera_to_world * Vector3d(ray / inverse_depth);
      const double speed = motions[surface.instance - scene_.room.size()].speedAt(world);
      frame.mask.at<std::uint8_t>(v, u) =
          speed > options_.moving_speed ? kMaskMoving : kMaskStanding;
      frame.mover.at<std::int16_t>(v, u) = static_cast<std::int16_t>(mover);
    }
  }
}

}  // namespace hmcdyn::synthesize
