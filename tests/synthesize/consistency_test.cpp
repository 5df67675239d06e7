// SPDX-License-Identifier: BSD-3-Clause
// Depth, pose, colour, masks and boxes of rendered scenes tell one story.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "synthesize/renderer.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/sensor.hpp"
#include "synthesize/sequence.hpp"

namespace hmcdyn::synthesize {
namespace {

constexpr int kImageWidth = 320;
constexpr int kImageHeight = 240;

RenderOptions options() {
  RenderOptions o;
  o.width = kImageWidth;
  o.height = kImageHeight;
  o.camera = scaledCamera(kImageWidth, kImageHeight);
  return o;
}

BuiltScene scene(const std::string& name) {
  SceneOptions o;
  o.seconds = 5.0;
  o.threads = 2;
  o.max_texture = 512;
  return buildScene(name, o);
}

struct Agreement {
  int points = 0;
  std::vector<double> depth_errors;  ///< Of points seen in both frames (m).
  std::vector<double> color_errors;  ///< Of the same points (0..255).
  int hidden = 0;                    ///< Points behind what the second frame sees.
  int in_front = 0;                  ///< Points in front of what the second frame sees: impossible.
};

/// Takes the static points of one frame into another by the true poses, and compares them with the
/// other's depth, interpolated where its four neighbours lie on one surface.
Agreement compare(const RenderedFrame& a, const cv::Mat& depth_a, const RenderedFrame& b,
                  double tolerance) {
  const PinholeCamera camera = options().camera;
  const Eigen::Isometry3d b_from_a = b.camera_to_world.inverse() * a.camera_to_world;
  Agreement result;
  for (int v = 0; v < kImageHeight; v += 3) {
    for (int u = 0; u < kImageWidth; u += 3) {
      const float z = depth_a.at<float>(v, u);
      if (z <= 0.0f || a.mask.at<std::uint8_t>(v, u) != kMaskStatic) {
        continue;
      }
      const Eigen::Vector3d p = b_from_a * camera.unproject(u, v, static_cast<double>(z));
      const Eigen::Vector2d pixel = camera.project(p);
      const int x = static_cast<int>(std::floor(pixel.x()));
      const int y = static_cast<int>(std::floor(pixel.y()));
      if (p.z() < 0.1 || x < 0 || y < 0 || x + 1 >= kImageWidth || y + 1 >= kImageHeight) {
        continue;
      }
      const auto at = [&](int i, int j) {
        return static_cast<double>(b.depth.at<float>(y + j, x + i));
      };
      const auto [low, high] = std::minmax({at(0, 0), at(1, 0), at(0, 1), at(1, 1)});
      ++result.points;
      if (p.z() > high + tolerance) {
        ++result.hidden;
      } else if (p.z() < low - tolerance) {
        ++result.in_front;
      }
      if (high - low > 0.02) {
        continue;  // across an edge there is no depth between
      }
      const double s = pixel.x() - x;
      const double t = pixel.y() - y;
      // Inverse depth is linear over a plane's image.
      const double inverse =
          (1 - t) * ((1 - s) / at(0, 0) + s / at(1, 0)) + t * ((1 - s) / at(0, 1) + s / at(1, 1));
      const double error = std::abs(1.0 / inverse - p.z());
      if (error < 0.05) {
        result.depth_errors.push_back(error);
        const auto& ca = a.color.at<cv::Vec3b>(v, u);
        const auto& cb = b.color.at<cv::Vec3b>(static_cast<int>(std::lround(pixel.y())),
                                               static_cast<int>(std::lround(pixel.x())));
        result.color_errors.push_back(std::abs(static_cast<double>(ca[1]) - cb[1]));
      }
    }
  }
  return result;
}

double quantile(std::vector<double> values, double q) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

TEST(Consistency, StaticPointsLandOnTheSameSurfaceInAnotherFrame) {
  const BuiltScene built = scene("walking_xyz");
  Renderer renderer(built.scene, options());
  const RenderedFrame a = renderer.render(0.5);
  const RenderedFrame b = renderer.render(1.4);
  ASSERT_GT((a.camera_to_world.translation() - b.camera_to_world.translation()).norm(), 0.1);
  const Agreement agreement = compare(a, a.depth, b, 1e-3);
  ASSERT_GT(agreement.points, 4000);
  // Cables and pens thinner than a pixel fall between the other frame's pixels.
  EXPECT_LT(agreement.in_front, agreement.points / 200);
  EXPECT_GT(agreement.depth_errors.size(), static_cast<std::size_t>(agreement.points) * 6 / 10);
  EXPECT_LT(quantile(agreement.depth_errors, 0.5), 1e-6);
  EXPECT_LT(quantile(agreement.depth_errors, 0.95), 1e-3);
  EXPECT_LT(quantile(agreement.color_errors, 0.5), 8.0);
}

TEST(Consistency, NoisyDepthAgreesWithinTheNoiseModel) {
  const BuiltScene built = scene("empty");
  Renderer renderer(built.scene, options());
  const RenderedFrame a = renderer.render(0.5);
  const RenderedFrame b = renderer.render(1.4);
  const Sensor sensor(NoiseModel::kKinect, {}, {kImageWidth, kImageHeight}, 3);
  cv::Mat measured;
  sensor.measure(a, 0, 0.5).depth.convertTo(measured, CV_32FC1, 1.0 / kDepthFactor);
  const Agreement agreement = compare(a, measured, b, 0.15);
  ASSERT_GT(agreement.depth_errors.size(), 1000U);
  // At 2.5-5 m the model's standard deviation is 1-4 cm with its steps.
  EXPECT_GT(quantile(agreement.depth_errors, 0.5), 1e-3);
  EXPECT_LT(quantile(agreement.depth_errors, 0.5), 0.03);
}

TEST(Consistency, MovingPixelsBelongToAMoverAndStaticOnesToTheRoom) {
  const BuiltScene built = scene("walking_xyz");
  Renderer renderer(built.scene, options());
  const RenderedFrame frame = renderer.render(2.0);
  int moving = 0;
  for (int v = 0; v < kImageHeight; ++v) {
    for (int u = 0; u < kImageWidth; ++u) {
      const bool of_mover = frame.mover.at<std::int16_t>(v, u) >= 0;
      ASSERT_EQ(frame.mask.at<std::uint8_t>(v, u) != kMaskStatic, of_mover);
      moving += frame.mask.at<std::uint8_t>(v, u) == kMaskMoving ? 1 : 0;
    }
  }
  EXPECT_GT(moving, 1000);
}

TEST(Consistency, SubPixelShiftOfTheCameraShiftsTheColourAsItShould) {
  // The centroid of a bright square at (0.003, 1, 0) m is 0.3 px right of the principal point.
  Scene scene;
  scene.textures.add([] { return cv::Mat(cv::Size(8, 8), CV_8UC3, cv::Scalar(200, 200, 200)); });
  scene.textures.paint(1, 8);
  scene.camera = [](double) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return pose;
  };
  Mesh mesh;
  addQuad(mesh, {-0.097f, 1.0f, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, {});
  scene.room.push_back(litStill(std::move(mesh), Lighting{}, 1.0f));
  RenderOptions o;
  o.width = 81;
  o.height = 61;
  o.camera = {100.0, 100.0, 40.0, 30.0};
  const cv::Mat color = Renderer(scene, o).render(0.0).color;
  double sum = 0.0;
  double moment_u = 0.0;
  double moment_v = 0.0;
  for (int v = 0; v < color.rows; ++v) {
    for (int u = 0; u < color.cols; ++u) {
      const double level = color.at<cv::Vec3b>(v, u)[1];
      sum += level;
      moment_u += level * u;
      moment_v += level * v;
    }
  }
  EXPECT_NEAR(moment_u / sum, 40.3, 0.08);  // four samples resolve a quarter of a pixel
  EXPECT_NEAR(moment_v / sum, 30.0, 0.08);
}

}  // namespace
}  // namespace hmcdyn::synthesize
