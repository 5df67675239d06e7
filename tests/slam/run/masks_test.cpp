// SPDX-License-Identifier: BSD-3-Clause
// Masks in place of boxes, from the file to the filter's labels.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "run/rendered_sequence.hpp"
#include "slam/run/detection_feed.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

constexpr int kFrames = 12;

/// A rendered crowd: people at rest (128) and moving (255), and the masks that say so.
class MaskedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new hmcdyn::test::TemporaryFolder();
    sequence_ = hmcdyn::test::renderedSequence(folder_->path(), "crowd", kFrames,
                                               synthesize::NoiseModel::kKinect);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static const std::filesystem::path& sequence() { return sequence_; }

  static SlamOptions masked() {
    SlamOptions options;
    options.dataset = sequence();
    options.camera = (sequence() / "calibration.yaml").string();
    options.detector.type = "masks";
    options.detector.masks = sequence() / "mask";
    options.output = folder_->path() / "out";
    options.write_keypoints = true;
    options.write_report = false;
    options.quiet = true;
    return options;
  }

  static std::vector<std::filesystem::path> maskFiles() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(sequence() / "mask")) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  /// What the run called dynamic, on people and off them, after the first frames.
  struct Dynamic {
    int on_people = 0;
    int off_people = 0;
    int kept_off_people = 0;
  };
  static Dynamic dynamicPoints() {
    Dynamic dynamic;
    std::ifstream rows(folder_->path() / "out" / "keypoints.csv");
    std::string row;
    std::getline(rows, row);
    std::string stamp;
    cv::Mat mask;
    int frame = -1;
    while (std::getline(rows, row)) {
      std::vector<std::string> fields;
      std::stringstream stream(row);
      for (std::string field; std::getline(stream, field, ',');) {
        fields.push_back(field);
      }
      if (fields.at(0) != stamp) {
        stamp = fields[0];
        ++frame;
        mask = cv::imread(maskFiles().at(static_cast<std::size_t>(frame)).string(),
                          cv::IMREAD_UNCHANGED);
        cv::dilate(mask, mask, cv::Mat::ones(9, 9, CV_8U));  // the default margin
      }
      const cv::Point at(static_cast<int>(std::lround(std::stod(fields.at(1)))),
                         static_cast<int>(std::lround(std::stod(fields.at(2)))));
      const bool is_dynamic = fields.at(6) == "dynamic";
      if (frame >= 4) {  // two frames to compare with, and a memory
        const bool on = mask.at<std::uint8_t>(at) != 0;
        dynamic.on_people += is_dynamic && on ? 1 : 0;
        dynamic.off_people += is_dynamic && !on ? 1 : 0;
        dynamic.kept_off_people += !is_dynamic && !on ? 1 : 0;
      }
    }
    return dynamic;
  }

  static hmcdyn::test::TemporaryFolder* folder_;
  static std::filesystem::path sequence_;
};
hmcdyn::test::TemporaryFolder* MaskedRun::folder_ = nullptr;
std::filesystem::path MaskedRun::sequence_;

TEST_F(MaskedRun, TheRendererMasksAreReadAndPointsOffThemStayInTheMap) {
  const nlohmann::json summary = runSlam(masked());
  const nlohmann::json& counts = summary.at("counts");
  EXPECT_EQ(summary.at("options").at("detector"), "masks");
  EXPECT_EQ(counts.at("frames_tracked"), kFrames);
  EXPECT_EQ(counts.at("frames_with_boxes"), kFrames);
  EXPECT_EQ(counts.at("detections").at("detected"), kFrames);
  EXPECT_EQ(counts.at("detections").at("failed"), 0);
  EXPECT_TRUE(summary.at("warnings").empty());
  EXPECT_GT(counts.at("dense_map_points").get<int>(), 0);
  EXPECT_LT(summary.at("evaluation").at("ate_m").at("rmse").get<double>(), 0.01);
  const Dynamic dynamic = dynamicPoints();
  EXPECT_GT(dynamic.on_people, 500);
  EXPECT_LT(dynamic.off_people, dynamic.on_people / 20);
  EXPECT_GT(dynamic.kept_off_people, 20 * dynamic.off_people);
}

TEST_F(MaskedRun, WhereAMaskIsMissingBoxesAroundEarlierOnesAreCarriedOn) {
  SlamOptions options = masked();
  options.detector.masks = folder_->path() / "some";
  std::filesystem::copy(sequence() / "mask", options.detector.masks);
  std::filesystem::remove(options.detector.masks / maskFiles().at(7).filename());
  cv::imwrite((options.detector.masks / maskFiles().at(8).filename()).string(),
              cv::Mat(10, 10, CV_8UC1, cv::Scalar(0)));
  const nlohmann::json counts = runSlam(options).at("counts");
  EXPECT_EQ(counts.at("detections").at("detected"), kFrames - 2);
  EXPECT_EQ(counts.at("detections").at("failed"), 2);
  EXPECT_EQ(counts.at("frames_with_boxes"), kFrames);
  EXPECT_EQ(counts.at("frames_tracked"), kFrames);
}

TEST_F(MaskedRun, TheFirstFrameWithoutAMaskIsReportedWithItsFile) {
  SlamOptions options = masked();
  options.detector.masks = folder_->path() / "one";
  std::filesystem::create_directory(options.detector.masks);
  std::filesystem::copy(maskFiles().front(), options.detector.masks);
  CameraCalibration calibration = loadCamera(options.camera);
  std::vector<std::string> reports;
  DetectionFeed feed(options, Rectifier(calibration),
                     [&](const std::string& line) { reports.push_back(line); });
  PreparedFrame frame;
  frame.raw.gray = cv::Mat::zeros(calibration.height, calibration.width, CV_8UC1);
  frame.raw.timestamp = std::stod(maskFiles().front().stem().string());
  frame.image = frame.raw;
  const FrameBoxes first = feed.boxesOf(frame);
  EXPECT_TRUE(first.detected);
  EXPECT_EQ(first.boxes.size(), first.mask.regions.size());
  EXPECT_FALSE(first.boxes.empty());
  EXPECT_TRUE(reports.empty());
  for (int k = 1; k <= 2; ++k) {
    frame.raw.index = static_cast<std::size_t>(k);
    frame.raw.timestamp += 0.0333;
    frame.image = frame.raw;
    const FrameBoxes missing = feed.boxesOf(frame);
    EXPECT_FALSE(missing.detected);
    EXPECT_TRUE(missing.mask.empty());
  }
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(mentions(reports.front(), {"frame 1", "one/", "is missing", "carried on"}));
}

TEST_F(MaskedRun, MasksOfAnotherCameraAreRefusedAtTheStart) {
  SlamOptions options = masked();
  options.detector.masks = folder_->path() / "small";
  std::filesystem::create_directory(options.detector.masks);
  cv::imwrite((options.detector.masks / "1.0.png").string(),
              cv::Mat(24, 32, CV_8UC1, cv::Scalar(1)));
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { runSlam(options); }),
                       {"1.0.png", "32 x 24", "640 x 480"}));
}

}  // namespace
}  // namespace hmcdyn::slam
