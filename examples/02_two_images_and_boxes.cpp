// SPDX-License-Identifier: BSD-3-Clause
// Two images and boxes: the library tracks the key points, finds the camera's motion, measures the
// distances, and labels the points. Needs hmcdyn::vision.
//
//   02_two_images_and_boxes [PICTURE.png]
//
// The images are made up: a wall seen by a camera that moves sideways, and a person-sized patch in
// front of it that moves on its own.
#include <cstdio>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

namespace {

/// Random blobs at several scales, which corners can be tracked on.
cv::Mat makeTexture(cv::Size size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat texture = cv::Mat::zeros(size, CV_32F);
  for (const double blur : {2.0, 4.0, 8.0}) {
    cv::Mat noise(size, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 40.0 * blur);
    cv::GaussianBlur(noise, noise, cv::Size(), blur);
    texture += noise;
  }
  texture += 128.0;
  cv::Mat gray;
  texture.convertTo(gray, CV_8U);
  return gray;
}

struct Scene {
  cv::Mat gray;
  cv::Mat depth;  // m
};

/// Four slabs of wall at different depths slide by as the camera moves; the patch also moves down.
Scene renderScene(const cv::Mat& wall, const cv::Mat& patch, float camera_x, float patch_y) {
  constexpr float kFocal = 500.0f;
  Scene scene{cv::Mat(480, 640, CV_8U), cv::Mat(480, 640, CV_32F)};
  const auto paste = [&](const cv::Mat& texture, const cv::Rect& area, float depth, float du,
                         float dv) {
    const cv::Matx23f shift(1, 0, du, 0, 1, dv);
    cv::Mat moved;
    cv::warpAffine(texture, moved, shift, scene.gray.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    moved(area).copyTo(scene.gray(area));
    scene.depth(area).setTo(depth);
  };
  for (int slab = 0; slab < 4; ++slab) {
    const float depth = 2.5f + 0.5f * static_cast<float>(slab);
    paste(wall, cv::Rect(0, 120 * slab, 640, 120), depth, -kFocal * camera_x / depth, 0.0f);
  }
  const float du = -kFocal * camera_x / 1.8f;
  paste(patch, cv::Rect(cvRound(250 + du), cvRound(100 + patch_y), 140, 300), 1.8f, du, patch_y);
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  const cv::Mat wall = makeTexture({640, 480}, 1);
  const cv::Mat patch = makeTexture({640, 480}, 2);
  const Scene earlier = renderScene(wall, patch, 0.0f, 0.0f);
  const Scene current = renderScene(wall, patch, 0.02f, 6.0f);

  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(current.gray, corners, 600, 0.01, 8.0);
  hmcdyn::KeyPoints points;
  for (const cv::Point2f& corner : corners) {
    points.push_back(corner.x, corner.y, current.depth.at<float>(corner));
  }
  const std::vector<hmcdyn::DetectionBox> boxes = {{200, 80, 440, 440}};  // from your detector

  const hmcdyn::DynamicFeatureFilterResult result =
      hmcdyn::filterDynamicFeatures(earlier.gray, current.gray, points.view(), boxes);

  const hmcdyn::EarlierFrameReport& report = result.earlier.front();
  std::printf("%zu of %zu key points matched; model: %s (%s), median distance %.2f px\n",
              report.flow.found, points.size(), toString(report.motion.model.kind),
              toString(report.motion.verdict), report.motion.median_distance);
  std::printf("%zu dynamic, %zu kept in the moving box, %zu static outside\n",
              result.stage.frame.dynamic, result.stage.frame.suspect,
              points.size() - result.stage.frame.points_in_dynamic_boxes);

  if (argc > 1) {
    cv::Mat picture;
    cv::cvtColor(current.gray, picture, cv::COLOR_GRAY2BGR);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool dynamic = result.stage.label[i] == hmcdyn::PointLabel::kDynamic;
      const bool suspect = result.stage.label[i] == hmcdyn::PointLabel::kSuspect;
      const cv::Scalar color = dynamic   ? cv::Scalar(40, 40, 230)
                               : suspect ? cv::Scalar(0, 220, 255)
                                         : cv::Scalar(60, 200, 60);
      cv::circle(picture, cv::Point2f(points.u[i], points.v[i]), 3, color, cv::FILLED, cv::LINE_AA);
    }
    if (!cv::imwrite(argv[1], picture)) {
      std::fprintf(stderr, "cannot write %s\n", argv[1]);
      return 1;
    }
    std::printf("wrote %s: static green, suspect yellow, dynamic red\n", argv[1]);
  }
  return result.stage.frame.dynamic > 0 ? 0 : 1;
}
