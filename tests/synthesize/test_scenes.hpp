// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "synthesize/camera_path.hpp"
#include "synthesize/renderer.hpp"
#include "synthesize/scene.hpp"
#include "synthesize/sequence.hpp"

namespace hmcdyn::synthesize::test {

/// Camera at the world's origin that looks along +y: pixel right = +x, pixel down = -z.
inline CameraPath cameraAtOrigin() {
  return stillPath(lookAt(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY()));
}

inline PinholeCamera smallCamera() { return {100.0, 100.0, 40.0, 30.0}; }

inline RenderOptions smallImage() {
  RenderOptions options;
  options.width = 81;
  options.height = 61;
  options.camera = smallCamera();
  return options;
}

/// A scene with one white texture (number 0) and one black one (number 1), lit fully.
inline Scene plainScene() {
  Scene scene;
  scene.textures.add([] { return cv::Mat(cv::Size(8, 8), CV_8UC3, cv::Scalar(200, 200, 200)); });
  scene.textures.add([] { return cv::Mat(cv::Size(8, 8), CV_8UC3, cv::Scalar(0, 0, 0)); });
  scene.textures.paint(1, 8);
  scene.camera = cameraAtOrigin();
  return scene;
}

/// A rectangle that faces the camera, at distance y, centred on (x, z).
inline LitMesh frontalQuad(float x, float y, float z, float width, float height, int texture) {
  Mesh mesh;
  addQuad(mesh, {x - 0.5f * width, y, z + 0.5f * height}, {width, 0, 0}, {0, 0, -height},
          {texture, 0.0f, {0, 0}, {1, 1}});
  return litStill(std::move(mesh), Lighting{}, 1.0f);
}

/// A moving thing of one part.
inline Mover moverOf(LitMesh part, std::function<Eigen::Isometry3d(double)> pose,
                     bool is_person = true) {
  Mover mover;
  mover.is_person = is_person;
  mover.parts.push_back(std::move(part));
  mover.poses = [pose = std::move(pose)](double t) { return std::vector{pose(t)}; };
  return mover;
}

inline Eigen::Isometry3d shifted(double x, double y, double z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::random_device device;
    path_ = std::filesystem::temp_directory_path() /
            ("hmcdyn_synthesize_" + std::to_string(device()) + std::to_string(device()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Three small frames of walking_xyz, written by two threads.
inline SequenceOptions shortSequence(const std::filesystem::path& output) {
  SequenceOptions options;
  options.scene = "walking_xyz";
  options.output = output;
  options.frames = 3;
  options.width = 160;
  options.height = 120;
  options.threads = 2;
  return options;
}

}  // namespace hmcdyn::synthesize::test
