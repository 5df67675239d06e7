// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <yaml-cpp/yaml.h>

#include "evaluate/map_score.hpp"
#include "evaluate/trajectory.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::evaluate {
namespace {

struct Calibration {
  PinholeCamera camera;
  double depth_factor = 0.0;
};

Calibration readCalibration(const std::filesystem::path& file) {
  try {
    const YAML::Node node = YAML::LoadFile(file.string());
    const auto number = [&](const char* key) {
      if (!node[key]) {
        throw std::runtime_error(std::string("'") + key + "' is missing");
      }
      return node[key].as<double>();
    };
    const Calibration result{{number("fx"), number("fy"), number("cx"), number("cy")},
                             number("depth_factor")};
    if (!(result.depth_factor > 0.0 && result.camera.fx > 0.0 && result.camera.fy > 0.0)) {
      throw std::runtime_error("expected fx, fy and depth_factor above 0");
    }
    return result;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

cv::Mat readImage(const std::filesystem::path& file, int type) {
  cv::Mat image =
      std::filesystem::exists(file) ? cv::imread(file.string(), cv::IMREAD_UNCHANGED) : cv::Mat();
  if (image.type() != type || image.empty()) {
    throw std::runtime_error(file.string() + ": is missing, or no PNG of the expected type");
  }
  return image;
}

/// Poses by microsecond, as stamps in files are rounded.
std::map<long long, Eigen::Isometry3d> posesByTime(const std::filesystem::path& file) {
  std::map<long long, Eigen::Isometry3d> poses;
  for (const StampedPose& pose : readTrajectory(file)) {
    poses[std::llround(1e6 * pose.timestamp)] = pose.pose;
  }
  return poses;
}

}  // namespace

MapScore scoreMap(std::vector<Eigen::Vector3f> points, const std::filesystem::path& sequence,
                  const MapScoreOptions& options) {
  const Calibration calibration = readCalibration(sequence / "calibration.yaml");
  const auto poses = posesByTime(sequence / "groundtruth.txt");
  MapScorer scorer(std::move(points), calibration.camera, options);
  const std::filesystem::path list = sequence / "associations.txt";
  std::size_t frames = 0;
  std::size_t entry = 0;
  const support::TextTable table =
      support::readTable(list, [](std::size_t fields) { return fields == 4; });
  for (const support::TextRow& row : table.rows) {
    if (entry++ % options.every != 0) {
      continue;
    }
    if (row.fields.size() != 4) {
      throw support::errorAt(list.string(), row.line, "expected 'time rgb_file time depth_file'");
    }
    const double stamp = support::parseFinite(row.fields[0], "time stamp", list.string(), row.line);
    const std::string& depth = row.fields[3];
    const auto pose = poses.find(std::llround(1e6 * stamp));
    if (pose == poses.end()) {
      continue;
    }
    TrueFrame frame;
    readImage(sequence / depth, CV_16UC1)
        .convertTo(frame.depth, CV_32F, 1.0 / calibration.depth_factor);
    frame.mask = readImage(sequence / "mask" / std::filesystem::path(depth).filename(), CV_8UC1);
    frame.camera_from_world = pose->second.inverse();
    scorer.add(frame);
    ++frames;
  }
  if (frames == 0) {
    throw std::runtime_error(list.string() + ": is missing, or none of its frames has a pose");
  }
  return scorer.score();
}

}  // namespace hmcdyn::evaluate
