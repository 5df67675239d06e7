// SPDX-License-Identifier: BSD-3-Clause
// Every component once: a filter call on two images, and a pose refinement with a known answer.
#include <cmath>
#include <cstdio>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/hmcdyn.hpp>

namespace {

/// Two equal images: nothing moves, so that nothing may be dynamic.
bool filterFindsNothing() {
  cv::Mat gray(480, 640, CV_8UC1);
  cv::RNG random(1);
  random.fill(gray, cv::RNG::UNIFORM, 0, 255);
  hmcdyn::KeyPoints points;
  for (int i = 0; i < 200; ++i) {
    points.push_back(static_cast<float>(40 + (i % 20) * 28), static_cast<float>(40 + i / 20 * 40),
                     2.0f);
  }
  const std::vector<hmcdyn::DetectionBox> boxes = {{100, 100, 400, 400}};
  const hmcdyn::DynamicFeatureFilterResult result =
      hmcdyn::filterDynamicFeatures(gray, gray, points.view(), boxes);
  return result.stage.label.size() == points.size() && result.stage.frame.dynamic == 0;
}

/// Exact projections from 2 cm beside the starting pose.
bool refinementFindsThePose() {
  const hmcdyn::PinholeCamera camera{525.0, 525.0, 319.5, 239.5};
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translation().x() = 0.02;
  std::vector<float> x, y, z, u, v;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point(-1.0 + 0.2 * (i % 10), -0.6 + 0.2 * (i / 10), 2.0 + 0.05 * i);
    const Eigen::Vector2d pixel = camera.project(truth * point);
    x.push_back(static_cast<float>(point.x()));
    y.push_back(static_cast<float>(point.y()));
    z.push_back(static_cast<float>(point.z()));
    u.push_back(static_cast<float>(pixel.x()));
    v.push_back(static_cast<float>(pixel.y()));
  }
  hmcdyn::PoseObservations observations;
  observations.x = x;
  observations.y = y;
  observations.z = z;
  observations.u = u;
  observations.v = v;
  const hmcdyn::PoseRefinementResult refined =
      hmcdyn::refinePose(observations, camera, Eigen::Isometry3d::Identity());
  return std::abs(refined.camera_from_world.translation().x() - 0.02) < 1e-4;
}

}  // namespace

int main() {
  const bool filter = filterFindsNothing();
  const bool pose = refinementFindsThePose();
  std::printf("hmcdyn %s: filter %s, pose %s\n", HMCDYN_VERSION_STRING, filter ? "good" : "BAD",
              pose ? "good" : "BAD");
  return filter && pose ? 0 : 1;
}
