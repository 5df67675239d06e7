// SPDX-License-Identifier: BSD-3-Clause
// A front end with key points and a detector of its own: copy the coordinates into arrays (no more
// than that crosses the border), keep the pyramid and the workspace from frame to frame, and refine
// the pose with the weights. Needs hmcdyn::hmcdyn.
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/hmcdyn.hpp>

namespace mine {

/// The key point of a SLAM system that has never heard of this library.
struct Feature {
  float x, y;                  // px
  double range;                // m, negative where the sensor saw nothing
  Eigen::Vector3f landmark;    // the map point it was matched with (m, world)
  float earlier_x, earlier_y;  // where it was in the last frame (px)
};

struct Detection {
  int left, top, width, height;
  const char* name;
};

/// A made-up frame: a room, and a walker whose landmarks have moved since they were mapped.
std::vector<Feature> observe(const hmcdyn::PinholeCamera& camera, const Eigen::Isometry3d& earlier,
                             const Eigen::Isometry3d& current, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  const Eigen::Vector3d walked(0.0, -0.03, 0.02);  // m since the last frame
  std::vector<Feature> features;
  for (int i = 0; i < 400; ++i) {
    const bool walker = i < 120;
    const Eigen::Vector3d mapped =
        walker ? Eigen::Vector3d(uniform(-0.2, 0.2), uniform(-0.7, 0.7), uniform(1.9, 2.1))
               : Eigen::Vector3d(uniform(-2.0, 2.0), uniform(-1.4, 1.4), uniform(2.5, 5.0));
    const Eigen::Vector3d now = walker ? Eigen::Vector3d(mapped + walked) : mapped;
    const Eigen::Vector2d before = camera.project(earlier * mapped);
    const Eigen::Vector2d after = camera.project(current * now);
    const double depth = (current * now).z();
    features.push_back({static_cast<float>(after.x() + uniform(-0.2, 0.2)),
                        static_cast<float>(after.y() + uniform(-0.2, 0.2)),
                        i % 10 == 0 ? -1.0 : depth, mapped.cast<float>(),
                        static_cast<float>(before.x()), static_cast<float>(before.y())});
  }
  return features;
}

}  // namespace mine

int main() {
  const hmcdyn::PinholeCamera camera{535.4, 539.2, 320.1, 247.6};
  const Eigen::Isometry3d earlier = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d current = Eigen::Isometry3d::Identity();
  current.translation() = Eigen::Vector3d(-0.03, 0.005, -0.01);
  const std::vector<mine::Feature> features = mine::observe(camera, earlier, current, 7);
  const std::vector<mine::Detection> detections = {{240, 40, 160, 420, "person"}};

  // Into arrays.
  hmcdyn::KeyPoints points;
  hmcdyn::FlowMatches matches;
  std::vector<float> x, y, z;
  points.reserve(features.size());
  for (const mine::Feature& feature : features) {
    points.push_back(feature.x, feature.y, static_cast<float>(feature.range));
    matches.u.push_back(feature.earlier_x);
    matches.v.push_back(feature.earlier_y);
    x.push_back(feature.landmark.x());
    y.push_back(feature.landmark.y());
    z.push_back(feature.landmark.z());
  }
  std::vector<hmcdyn::DetectionBox> boxes;
  boxes.reserve(detections.size());
  for (const mine::Detection& detection : detections) {
    boxes.push_back({static_cast<float>(detection.left), static_cast<float>(detection.top),
                     static_cast<float>(detection.left + detection.width),
                     static_cast<float>(detection.top + detection.height)});
  }

  // Steps 2 to 7, with matches of one's own.
  const hmcdyn::PointPairsView pairs{matches.u, matches.v, points.u, points.v};
  const hmcdyn::TwoViewEstimate motion = hmcdyn::estimateTwoViewModel(pairs, boxes);
  const std::vector<float> distance = hmcdyn::modelDistances(motion.model, pairs);
  hmcdyn::FilterStageWorkspace workspace;  // kept from frame to frame
  const hmcdyn::FilterStageResult& filtered =
      hmcdyn::filterKeyPoints(points.view(), distance, boxes, {}, workspace);

  // Step 8, with and without the weights.
  hmcdyn::PoseObservations observations;
  observations.x = x;
  observations.y = y;
  observations.z = z;
  observations.u = points.u;
  observations.v = points.v;
  const auto error = [&](const hmcdyn::PoseRefinementResult& refined) {
    return 1000.0 * (refined.camera_from_world.translation() - current.translation()).norm();
  };
  hmcdyn::PoseRefinementOptions plain;
  plain.loss = hmcdyn::RobustLoss::kNone;
  plain.rounds = 1;
  const hmcdyn::PoseRefinementResult without = refinePose(observations, camera, earlier, plain);
  observations.weight = filtered.weight;
  const hmcdyn::PoseRefinementResult with = refinePose(observations, camera, earlier, plain);

  std::printf("%zu of %zu key points dynamic\n", filtered.frame.dynamic, filtered.frame.points);
  std::printf("position error without weights %.1f mm, with weights %.1f mm\n", error(without),
              error(with));
  return error(with) < error(without) ? 0 : 1;
}
