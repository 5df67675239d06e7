// SPDX-License-Identifier: BSD-3-Clause
// The whole filter over some frames and pose refinements, every result printed as "name value": the
// same program is built with other flags than the library, and must say the same.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/hmcdyn.hpp>

namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kFocal = 260.0;        // px
constexpr double kSpeed = 0.02;         // m a frame, along the rows
constexpr double kThingSpeed = 3.0;     // px a frame, down the columns
constexpr double kFrameInterval = 0.1;  // s
const hmcdyn::PinholeCamera kCamera{kFocal, kFocal, 159.5, 119.5};

void print(const std::string& name, double value) { std::printf("%s %.9g\n", name.c_str(), value); }

/// Waves of 9 to 30 px that repeat nowhere in the image.
double texture(double x, double y, double seed) {
  double sum = 0.0;
  for (int k = 0; k < 12; ++k) {
    const double angle = 2.4 * k + seed;
    const double frequency = 6.283185307 / (9.0 + 1.9 * k);
    sum += std::sin(frequency * (std::cos(angle) * x + std::sin(angle) * y) + seed * k);
  }
  return 128.0 + 22.0 * sum;
}

bool isThing(double u, double v, int frame) {
  const double top = 70.0 + kThingSpeed * frame;
  return u >= 120.0 && u < 200.0 && v >= top && v < top + 90.0;
}

/// Depth (m): a thing before a wall, and a nearer wall below.
double depthAt(double u, double v, int frame) {
  return isThing(u, v, frame) ? 1.5 : v < 120.0 ? 4.0 : 2.5;
}

struct Images {
  cv::Mat gray;
  cv::Mat depth;
};

/// What the camera sees, `kSpeed` farther to the right with every frame.
Images imagesOf(int frame) {
  Images images{cv::Mat(kHeight, kWidth, CV_8UC1), cv::Mat(kHeight, kWidth, CV_32FC1)};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double z = depthAt(u, v, frame);
      const double moved = kFocal * kSpeed * frame / z;
      const double down = isThing(u, v, frame) ? kThingSpeed * frame : 0.0;
      images.gray.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(texture(u + moved, v - down, z));
      images.depth.at<float>(v, u) = static_cast<float>(z);
    }
  }
  return images;
}

hmcdyn::KeyPoints keyPointsOf(int frame) {
  hmcdyn::KeyPoints points;
  for (int v = 16; v < kHeight - 16; v += 9) {
    for (int u = 16; u < kWidth - 16; u += 9) {
      points.push_back(static_cast<float>(u), static_cast<float>(v),
                       static_cast<float>(depthAt(u, v, frame)));
    }
  }
  return points;
}

void printResult(int frame, const hmcdyn::DynamicFeatureFilterResult& result) {
  const std::string prefix = "frame" + std::to_string(frame);
  for (std::size_t i = 0; i < result.stage.label.size(); ++i) {
    const std::string point = prefix + ".point" + std::to_string(i);
    print(point + ".label", static_cast<double>(result.stage.label[i]));
    print(point + ".weight", result.stage.weight[i]);
    print(point + ".distance", result.distance[i]);
    if (!result.belief.belief.empty()) {
      print(point + ".belief", result.belief.belief[i]);
    }
  }
  for (const hmcdyn::EarlierFrameReport& report : result.earlier) {
    print(prefix + ".model", static_cast<double>(report.motion.model.kind));
    print(prefix + ".median", report.motion.median_distance);
    for (const double value : report.motion.model.matrix.values) {
      print(prefix + ".matrix", value);
    }
  }
}

/// Six frames against the two before each, with beliefs that are handed on.
bool filterFrames() {
  hmcdyn::DynamicFeatureFilterOptions options;
  options.distance = hmcdyn::DistanceKind::kLarger;
  hmcdyn::DynamicFeatureFilterWorkspace workspace;
  hmcdyn::MotionBelief memory;
  std::vector<Images> images;
  std::vector<hmcdyn::FlowPyramid> pyramids;
  std::size_t dynamic = 0;
  for (int frame = 0; frame < 6; ++frame) {
    images.push_back(imagesOf(frame));
    pyramids.push_back(hmcdyn::buildFlowPyramid(images.back().gray, options.flow));
    std::vector<hmcdyn::EarlierFrame> earlier;
    for (int ago = 1; ago <= 2 && ago <= frame; ++ago) {
      const auto index = static_cast<std::size_t>(frame - ago);
      Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
      motion.translation().x() = -kSpeed * ago;
      hmcdyn::EarlierFrame one;
      one.pyramid = &pyramids[index];
      one.depth = images[index].depth;
      one.current_from_earlier = motion;
      one.age = kFrameInterval * ago;
      earlier.push_back(one);
    }
    const hmcdyn::KeyPoints points = keyPointsOf(frame);
    const auto top = static_cast<float>(70.0 + kThingSpeed * frame);
    const std::vector<hmcdyn::DetectionBox> boxes = {{110.0f, top - 10.0f, 210.0f, top + 100.0f}};
    hmcdyn::DynamicFeatureFilterInput input;
    input.pyramid = &pyramids.back();
    input.points = points.view();
    input.regions = boxes;
    input.earlier = earlier;
    input.camera = kCamera;
    input.depth = {images.back().depth.ptr<float>(), kWidth, kHeight,
                   static_cast<std::size_t>(kWidth)};
    input.memory = &memory;
    hmcdyn::DynamicFeatureFilterResult result =
        hmcdyn::filterDynamicFeatures(input, options, workspace);
    printResult(frame, result);
    dynamic += result.stage.frame.dynamic;
    memory = std::move(result.belief);
  }
  return dynamic > 100;  // the thing was found: there is something to compare
}

void printRefinement(const std::string& name, const hmcdyn::PoseRefinementResult& refined) {
  for (const double value : refined.camera_from_world.matrix.values) {
    print(name + ".pose", value);
  }
  if (refined.covariance) {
    const Eigen::Matrix<double, 6, 6> covariance = *refined.covariance;
    for (int k = 0; k < 6; ++k) {
      print(name + ".sigma", std::sqrt(covariance(k, k)));
    }
  }
  for (const float weight : refined.weight) {
    print(name + ".weight", weight);
  }
  print(name + ".inliers", static_cast<double>(refined.inliers));
}

/// Points seen with half a pixel of noise, a tenth of them wrong, from 2 cm and 1 degree beside.
bool refinePoses() {
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translation() = Eigen::Vector3d(0.02, -0.01, 0.015);
  truth.linear() = Eigen::AngleAxisd(0.0175, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0).matrix();
  std::vector<float> x, y, z, u, v, depth, weight;
  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector3d point(-1.0 + 0.2 * (i % 11), -0.6 + 0.1 * (i / 11), 2.0 + 0.013 * i);
    const Eigen::Vector3d seen = truth * point;
    const Eigen::Vector2d pixel = kCamera.project(seen);
    const double wrong = i % 10 == 3 ? 12.0 : 0.0;
    x.push_back(static_cast<float>(point.x()));
    y.push_back(static_cast<float>(point.y()));
    z.push_back(static_cast<float>(point.z()));
    u.push_back(static_cast<float>(pixel.x() + wrong + 0.5 * std::sin(12.9898 * i)));
    v.push_back(static_cast<float>(pixel.y() + 0.5 * std::cos(78.233 * i)));
    depth.push_back(static_cast<float>(seen.z()));
    weight.push_back(i % 4 == 0 ? 0.5f : 1.0f);
  }
  hmcdyn::PoseObservations observations;
  observations.x = x;
  observations.y = y;
  observations.z = z;
  observations.u = u;
  observations.v = v;
  observations.depth = depth;
  observations.weight = weight;
  hmcdyn::PoseRefinementOptions options;
  options.depth_row = hmcdyn::DepthRow::kDepth;
  options.weight_mode = hmcdyn::WeightMode::kJoint;
  hmcdyn::PoseRefinementWorkspace workspace;
  bool good = true;
  for (const auto solver : {hmcdyn::PoseSolver::kCollapsed, hmcdyn::PoseSolver::kCeresProblem}) {
    options.solver = solver;
    hmcdyn::PoseRefinementResult refined;
    for (int repetition = 0; repetition < 2; ++repetition) {
      refined =
          refinePose(observations, kCamera, Eigen::Isometry3d::Identity(), options, workspace);
    }
    printRefinement("solver" + std::to_string(static_cast<int>(solver)), refined);
    const Eigen::Isometry3d error = truth.inverse() * Eigen::Isometry3d(refined.camera_from_world);
    good = good && refined.succeeded() && error.translation().norm() < 0.005;
  }
  return good;
}

}  // namespace

int main() {
  const bool filter = filterFrames();
  const bool pose = refinePoses();
  std::fprintf(stderr, "filter %s, pose %s\n", filter ? "good" : "BAD", pose ? "good" : "BAD");
  return filter && pose ? 0 : 1;
}
