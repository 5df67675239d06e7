// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/annotate.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

const cv::Vec3b kBackground(90, 90, 90);

/// A frame to annotate; tests change what they are about.
struct Scene {
  cv::Mat image{200, 300, CV_8UC3, cv::Scalar(90, 90, 90)};
  KeyPoints points;
  std::vector<PointLabel> labels;
  std::vector<int> clusters;
  std::vector<DetectionBox> boxes;
  std::vector<std::uint8_t> dynamic;

  void add(float u, float v, PointLabel label, int cluster = -1) {
    points.push_back(u, v, 1.0f);
    labels.push_back(label);
    clusters.push_back(cluster);
  }
  cv::Mat annotated(const AnnotationText& text = {}) const {
    return annotateFrame(image, points.view(), labels, clusters, boxes, dynamic, text);
  }
};

bool isGreen(const cv::Vec3b& c) { return c[1] > 180 && c[0] < 120 && c[2] < 120; }
bool isYellow(const cv::Vec3b& c) { return c[1] > 180 && c[0] < 120 && c[2] > 180; }
bool isRed(const cv::Vec3b& c) { return c[2] > 180 && c[0] < 120 && c[1] < 120; }
bool isBlue(const cv::Vec3b& c) { return c[0] > 180 && c[2] < 150; }

TEST(AnnotateFrame, AddsAStripAndLeavesTheImageAlone) {
  Scene scene;
  const cv::Mat before = scene.image.clone();
  scene.add(50.0f, 50.0f, PointLabel::kDynamic);
  const cv::Mat picture = scene.annotated({7, "fundamental", {}});
  EXPECT_EQ(picture.size(), cv::Size(300, 200 + kAnnotationRows));
  EXPECT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(cv::norm(scene.image, before, cv::NORM_L1), 0.0);
}

TEST(AnnotateFrame, PointsHaveTheirLabelsColour) {
  Scene scene;
  scene.add(40.0f, 100.0f, PointLabel::kStatic);
  scene.add(80.0f, 100.0f, PointLabel::kSuspect);
  scene.add(120.0f, 100.0f, PointLabel::kDynamic);
  scene.add(160.0f, 100.0f, PointLabel::kUnmatched);
  const cv::Mat picture = scene.annotated();
  EXPECT_TRUE(isGreen(picture.at<cv::Vec3b>(100, 40)));
  EXPECT_TRUE(isYellow(picture.at<cv::Vec3b>(100, 80)));
  EXPECT_TRUE(isRed(picture.at<cv::Vec3b>(100, 120)));
  EXPECT_TRUE(isBlue(picture.at<cv::Vec3b>(100, 160)));
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 200), kBackground) << "no point here";
}

TEST(AnnotateFrame, ClustersHaveRingsOfTheirOwnColour) {
  Scene scene;
  scene.add(40.0f, 100.0f, PointLabel::kDynamic, 0);
  scene.add(80.0f, 100.0f, PointLabel::kDynamic, 0);
  scene.add(120.0f, 100.0f, PointLabel::kDynamic, 1);
  scene.add(160.0f, 100.0f, PointLabel::kDynamic, -1);
  const cv::Mat picture = scene.annotated();
  const auto ring = [&](int u) { return picture.at<cv::Vec3b>(100, u + 6); };
  EXPECT_EQ(ring(40), ring(80)) << "one cluster, one colour";
  EXPECT_NE(ring(40), ring(120));
  EXPECT_NE(ring(40), kBackground);
  EXPECT_EQ(ring(160), kBackground) << "no cluster, no ring";
}

TEST(AnnotateFrame, BoxesAreRedWhereDynamicAndGreenElsewhere) {
  Scene scene;
  scene.boxes = {{20.0f, 40.0f, 100.0f, 160.0f, 0, 0.9f},
                 {150.0f, 40.0f, 250.0f, 160.0f, 62, 0.5f}};
  scene.dynamic = {1, 0};
  const cv::Mat picture = scene.annotated({1, "fundamental", {"person"}});
  EXPECT_TRUE(isRed(picture.at<cv::Vec3b>(160, 60)));
  EXPECT_TRUE(isRed(picture.at<cv::Vec3b>(100, 20)));
  EXPECT_TRUE(isGreen(picture.at<cv::Vec3b>(160, 200)));
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 60), kBackground) << "only the outline";
}

TEST(AnnotateFrame, SaysClassAndScoreAndTheStatus) {
  Scene scene;
  scene.boxes = {{20.0f, 60.0f, 150.0f, 160.0f, 0, 0.9f}};
  scene.dynamic = {0};
  const auto differ = [](const cv::Mat& a, const cv::Mat& b) {
    return cv::norm(a, b, cv::NORM_L1) > 0.0;
  };
  const cv::Mat picture = scene.annotated({1, "fundamental", {"person"}});
  EXPECT_TRUE(differ(picture, scene.annotated({1, "fundamental", {"chair"}})));
  EXPECT_TRUE(differ(picture, scene.annotated({2, "fundamental", {"person"}})));
  EXPECT_TRUE(differ(picture, scene.annotated({1, "homography", {"person"}})));
  scene.boxes[0].score = 0.4f;
  EXPECT_TRUE(differ(picture, scene.annotated({1, "fundamental", {"person"}})));
}

TEST(AnnotateFrame, LeavesOutWhatHasNoPlace) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.boxes = {{100.0f, 50.0f, 20.0f, 160.0f},  // inverted
                 {kNaN, 50.0f, 20.0f, 160.0f}};
  scene.dynamic = {1, 1};
  scene.add(kNaN, 50.0f, PointLabel::kDynamic);
  scene.add(50.0f, kInfinity, PointLabel::kDynamic);
  scene.add(-20.0f, 50.0f, PointLabel::kDynamic);
  scene.add(1e9f, 50.0f, PointLabel::kDynamic);
  const cv::Mat picture = scene.annotated().rowRange(0, 200);
  EXPECT_EQ(cv::norm(picture, scene.image, cv::NORM_L1), 0.0);
}

TEST(AnnotateFrame, CutsBoxesThatReachOutside) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.boxes = {{-1e9f, 50.0f, 1e9f, 150.0f}, {-kInfinity, -kInfinity, kInfinity, kInfinity}};
  scene.dynamic = {1, 0};
  const cv::Mat picture = scene.annotated();
  EXPECT_TRUE(isRed(picture.at<cv::Vec3b>(150, 150)));
}

TEST(AnnotateFrame, DrawsPointsAtTheBorder) {
  Scene scene;
  scene.add(0.0f, 0.0f, PointLabel::kStatic, 3);
  scene.add(299.9f, 199.9f, PointLabel::kDynamic, 3);
  EXPECT_TRUE(isGreen(scene.annotated().at<cv::Vec3b>(0, 0)));
}

TEST(AnnotateFrame, RefusesOtherImages) {
  Scene scene;
  scene.image = cv::Mat();
  EXPECT_THROW(scene.annotated(), std::invalid_argument);
  scene.image = cv::Mat(10, 10, CV_8U);
  EXPECT_THROW(scene.annotated(), std::invalid_argument);
}

TEST(AnnotateFrame, RefusesUnequalSizes) {
  Scene scene;
  scene.add(10.0f, 10.0f, PointLabel::kStatic);
  Scene labels = scene;
  labels.labels.clear();
  EXPECT_THROW(labels.annotated(), std::invalid_argument);
  Scene clusters = scene;
  clusters.clusters.push_back(0);
  EXPECT_THROW(clusters.annotated(), std::invalid_argument);
  Scene depths = scene;
  depths.points.depth.clear();
  EXPECT_THROW(depths.annotated(), std::invalid_argument);
  Scene flags = scene;
  flags.dynamic = {1};
  EXPECT_THROW(flags.annotated(), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam
