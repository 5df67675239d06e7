// SPDX-License-Identifier: BSD-3-Clause
// Rendered images hold what a visual front end needs.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "synthesize/renderer.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/sensor.hpp"
#include "synthesize/sequence.hpp"

namespace hmcdyn::synthesize {
namespace {

struct Camera {
  explicit Camera(const std::string& name) {
    SceneOptions scene_options;
    scene_options.seconds = 4.0;
    scene_options.threads = 2;
    built = buildScene(name, scene_options);
    options.exposure = 0.012;
  }
  BuiltScene built;
  RenderOptions options;
};

cv::Mat greyOf(const cv::Mat& color) {
  cv::Mat grey;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

std::vector<cv::Point2f> corners(const cv::Mat& grey) {
  std::vector<cv::KeyPoint> key_points;
  cv::ORB::create(1000)->detect(grey, key_points);
  std::vector<cv::Point2f> points;
  cv::KeyPoint::convert(key_points, points);
  return points;
}

TEST(Tracking, EmptyOfficeGivesPlentifulKeyPointsSpreadOverTheImage) {
  const Camera camera("empty");
  Renderer renderer(camera.built.scene, camera.options);
  const RenderedFrame frame = renderer.render(1.0);
  const Sensor sensor(NoiseModel::kKinect, {}, frame.color.size(), 1);
  // As a front end spreads them: the best of each of 8 x 6 cells.
  const cv::Mat grey = greyOf(sensor.measure(frame, 0, 1.0).color);
  std::vector<cv::KeyPoint> all;
  cv::FAST(grey, all, 12);
  std::vector<int> cells(48, 0);
  for (const cv::KeyPoint& p : all) {
    const int cell = static_cast<int>(p.pt.x / 80.0f) + 8 * static_cast<int>(p.pt.y / 80.0f);
    ++cells[static_cast<std::size_t>(cell)];
  }
  EXPECT_GE(corners(grey).size(), 800U);
  EXPECT_GE(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 10; }), 34);
  EXPECT_LT(*std::max_element(cells.begin(), cells.end()), static_cast<int>(all.size()) / 8);
}

TEST(Tracking, OpticalFlowAgreesWithTheTrueMotionOfTheRoom) {
  const Camera camera("walking_xyz");
  Renderer renderer(camera.built.scene, camera.options);
  const Sensor sensor(NoiseModel::kKinect, {}, {640, 480}, 1);
  const PinholeCamera& pinhole = camera.options.camera;
  const double first_time = 1.5;
  const double second_time = first_time + 1.0 / 30.0;
  const RenderedFrame a = renderer.render(first_time);
  const RenderedFrame b = renderer.render(second_time);
  const cv::Mat grey_a = greyOf(sensor.measure(a, 0, first_time).color);
  const cv::Mat grey_b = greyOf(sensor.measure(b, 1, second_time).color);
  const std::vector<cv::Point2f> from = corners(grey_a);
  std::vector<cv::Point2f> to;
  std::vector<std::uint8_t> found;
  std::vector<float> residuals;
  cv::calcOpticalFlowPyrLK(grey_a, grey_b, from, to, found, residuals);

  const Eigen::Isometry3d b_from_a = b.camera_to_world.inverse() * a.camera_to_world;
  std::vector<double> errors;
  double motion = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const int u = static_cast<int>(std::lround(from[i].x));
    const int v = static_cast<int>(std::lround(from[i].y));
    if (found[i] == 0 || a.mask.at<std::uint8_t>(v, u) != kMaskStatic) {
      continue;
    }
    const Eigen::Vector2d expected = pinhole.project(
        b_from_a * pinhole.unproject(static_cast<double>(from[i].x), static_cast<double>(from[i].y),
                                     static_cast<double>(a.depth.at<float>(v, u))));
    errors.push_back(std::hypot(expected.x() - static_cast<double>(to[i].x),
                                expected.y() - static_cast<double>(to[i].y)));
    motion += std::hypot(expected.x() - static_cast<double>(from[i].x),
                         expected.y() - static_cast<double>(from[i].y));
  }
  ASSERT_GT(errors.size(), 500U);
  EXPECT_GT(motion / static_cast<double>(errors.size()), 0.5);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.3);
  RecordProperty("median_error_px", std::to_string(errors[errors.size() / 2]));
}

TEST(Tracking, LowTextureSceneHasFewKeyPoints) {
  const Camera camera("low_texture");
  Renderer renderer(camera.built.scene, camera.options);
  const Camera rich("empty");
  Renderer rich_renderer(rich.built.scene, rich.options);
  std::vector<cv::KeyPoint> few;
  std::vector<cv::KeyPoint> many;
  cv::FAST(greyOf(renderer.render(1.0).color), few, 20);
  cv::FAST(greyOf(rich_renderer.render(1.0).color), many, 20);
  EXPECT_LT(few.size(), many.size() / 3);
  EXPECT_GT(few.size(), 60U);
}

}  // namespace
}  // namespace hmcdyn::synthesize
