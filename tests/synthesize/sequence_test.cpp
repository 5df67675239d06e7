// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/sequence.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <yaml-cpp/yaml.h>

#include "file_content.hpp"
#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

namespace fs = std::filesystem;
using hmcdyn::test::contentOf;
using test::shortSequence;
using test::TemporaryFolder;

/// Lines without comments.
std::vector<std::string> linesOf(const fs::path& path) {
  std::vector<std::string> lines;
  std::istringstream text(contentOf(path));
  for (std::string line; std::getline(text, line);) {
    if (!line.empty() && line[0] != '#') {
      lines.push_back(line);
    }
  }
  return lines;
}

TEST(Sequence, WritesTheTumFormat) {
  const TemporaryFolder folder;
  const SequenceOptions options = shortSequence(folder / "out");
  writeSequence(options);
  const auto both = linesOf(options.output / "associations.txt");
  ASSERT_EQ(both.size(), 3U);
  EXPECT_EQ(both[1],
            "1700000000.033333 rgb/1700000000.033333.png 1700000000.033333 "
            "depth/1700000000.033333.png");
  EXPECT_EQ(linesOf(options.output / "rgb.txt")[2], "1700000000.066667 rgb/1700000000.066667.png");
  EXPECT_EQ(linesOf(options.output / "depth.txt")[0],
            "1700000000.000000 depth/1700000000.000000.png");
  const auto truth = linesOf(options.output / "groundtruth.txt");
  ASSERT_EQ(truth.size(), 3U);
  for (const std::string& line : truth) {
    std::istringstream words(line);
    std::vector<double> values;
    for (double value = 0.0; words >> value;) {
      values.push_back(value);
    }
    ASSERT_EQ(values.size(), 8U);
    EXPECT_NEAR(Eigen::Vector4d(values[4], values[5], values[6], values[7]).norm(), 1.0, 1e-8);
  }
  for (const std::string name : {"1700000000.000000.png", "1700000000.066667.png"}) {
    const cv::Mat rgb = cv::imread((options.output / "rgb" / name).string(), cv::IMREAD_UNCHANGED);
    const cv::Mat depth =
        cv::imread((options.output / "depth" / name).string(), cv::IMREAD_UNCHANGED);
    const cv::Mat mask =
        cv::imread((options.output / "mask" / name).string(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(rgb.type(), CV_8UC3);
    EXPECT_EQ(depth.type(), CV_16UC1);
    EXPECT_EQ(mask.type(), CV_8UC1);
    EXPECT_EQ(rgb.size(), cv::Size(160, 120));
    EXPECT_EQ(depth.size(), cv::Size(160, 120));
    EXPECT_EQ(mask.size(), cv::Size(160, 120));
  }
}

TEST(Sequence, CalibrationIsTumsCameraScaledToTheSize) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "out");
  options.frames = 1;
  options.scene = "empty";
  writeSequence(options);
  const YAML::Node file = YAML::LoadFile((options.output / "calibration.yaml").string());
  EXPECT_NEAR(file["fx"].as<double>(), 535.4 / 4.0, 1e-6);
  EXPECT_NEAR(file["fy"].as<double>(), 539.2 / 4.0, 1e-6);
  // (320.1 + 0.5) / 4 - 0.5: whole numbers are pixel centres.
  EXPECT_NEAR(file["cx"].as<double>(), 79.65, 1e-6);
  EXPECT_NEAR(file["cy"].as<double>(), 61.525, 1e-6);
  EXPECT_EQ(file["distortion"].as<std::vector<double>>(), std::vector<double>(5, 0.0));
  EXPECT_EQ(file["depth_factor"].as<double>(), 5000.0);
  EXPECT_EQ(file["width"].as<int>(), 160);
  EXPECT_EQ(file["height"].as<int>(), 120);
  EXPECT_EQ(file["frame_rate"].as<double>(), 30.0);
  const PinholeCamera full = scaledCamera(640, 480);
  EXPECT_DOUBLE_EQ(full.fx, 535.4);
  EXPECT_DOUBLE_EQ(full.cx, 320.1);
  EXPECT_DOUBLE_EQ(full.cy, 247.6);
}

TEST(Sequence, AnotherSeedGivesOtherBytes) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "one");
  options.frames = 1;
  writeSequence(options);
  options.output = folder / "two";
  options.seed = 2;
  writeSequence(options);
  EXPECT_NE(contentOf(folder / "one/rgb/1700000000.000000.png"),
            contentOf(folder / "two/rgb/1700000000.000000.png"));
}

struct Box {
  std::string stamp;
  int class_id = -1;
  double x_min = 0.0, y_min = 0.0, x_max = 0.0, y_max = 0.0, score = 0.0;
};

std::vector<Box> boxesOf(const fs::path& folder) {
  std::vector<Box> boxes;
  for (const std::string& line : linesOf(folder / "boxes.txt")) {
    Box b;
    std::istringstream words(line);
    words >> b.stamp >> b.class_id >> b.x_min >> b.y_min >> b.x_max >> b.y_max >> b.score;
    EXPECT_FALSE(words.fail()) << line;
    boxes.push_back(b);
  }
  return boxes;
}

TEST(Sequence, TrueBoxesHoldEveryMaskedPixelTightly) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "out");
  options.scene = "sitting_static";
  options.box_pixels = 1;
  writeSequence(options);
  const auto boxes = boxesOf(options.output);
  ASSERT_EQ(boxes.size(), 2U * 3U);
  const std::string stamp = "1700000000.033333";
  const cv::Mat mask =
      cv::imread((options.output / "mask" / (stamp + ".png")).string(), cv::IMREAD_UNCHANGED);
  const auto inside = [](const Box& b, int u, int v) {
    return u >= b.x_min && u <= b.x_max && v >= b.y_min && v <= b.y_max;
  };
  for (const Box& b : boxes) {
    EXPECT_EQ(b.class_id, 0);
    EXPECT_EQ(b.score, 1.0);
    if (b.stamp != stamp) {
      continue;
    }
    // Each border touches a pixel of a person.
    const cv::Rect area(cv::Point(static_cast<int>(b.x_min), static_cast<int>(b.y_min)),
                        cv::Point(static_cast<int>(b.x_max) + 1, static_cast<int>(b.y_max) + 1));
    EXPECT_GT(cv::countNonZero(mask(area).row(0)), 0);
    EXPECT_GT(cv::countNonZero(mask(area).row(area.height - 1)), 0);
    EXPECT_GT(cv::countNonZero(mask(area).col(0)), 0);
    EXPECT_GT(cv::countNonZero(mask(area).col(area.width - 1)), 0);
  }
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (mask.at<std::uint8_t>(v, u) != 0) {
        bool held = false;
        for (const Box& b : boxes) {
          held = held || (b.stamp == stamp && inside(b, u, v));
        }
        ASSERT_TRUE(held) << "(" << u << ", " << v << ")";
      }
    }
  }
}

TEST(Sequence, BoxesCanBeDroppedAndJittered) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "true");
  options.scene = "sitting_static";
  options.frames = 20;
  options.width = 64;
  options.height = 48;
  options.box_pixels = 1;
  writeSequence(options);
  options.output = folder / "dropped";
  options.box_drop = 0.5;
  writeSequence(options);
  options.output = folder / "jittered";
  options.box_drop = 0.0;
  options.box_jitter = 2.0;
  writeSequence(options);
  const auto truth = boxesOf(folder / "true");
  const auto dropped = boxesOf(folder / "dropped");
  const auto jittered = boxesOf(folder / "jittered");
  ASSERT_EQ(truth.size(), 40U);
  EXPECT_GT(dropped.size(), 10U);
  EXPECT_LT(dropped.size(), 30U);
  ASSERT_EQ(jittered.size(), truth.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    squares += std::pow(jittered[i].y_min - truth[i].y_min, 2.0);
    EXPECT_LT(jittered[i].score, 1.0);
    EXPECT_GT(jittered[i].score, 0.4);
  }
  EXPECT_NEAR(std::sqrt(squares / 40.0), 2.0, 0.8);
}

TEST(Sequence, WithoutNoiseEveryPixelOfTheRoomHasItsDepth) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "out");
  options.scene = "empty";
  options.frames = 1;
  options.noise = NoiseModel::kNone;
  writeSequence(options);
  const cv::Mat depth =
      cv::imread((options.output / "depth/1700000000.000000.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::countNonZero(depth == 0), 0);
}

std::string argumentErrorOf(const SequenceOptions& options) {
  try {
    writeSequence(options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(Sequence, FilledFolderIsAnErrorUnlessOverwritingIsAsked) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "out");
  options.scene = "empty";
  options.frames = 2;
  writeSequence(options);
  options.frames = 1;
  EXPECT_NE(argumentErrorOf(options).find("not empty"), std::string::npos);
  options.overwrite = true;
  writeSequence(options);
  // Nothing of the longer sequence stays behind.
  EXPECT_FALSE(fs::exists(options.output / "rgb/1700000000.033333.png"));
  EXPECT_EQ(linesOf(options.output / "rgb.txt").size(), 1U);
}

TEST(Sequence, FolderThatCannotBeMadeIsAnError) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  SequenceOptions options = shortSequence(folder / "file");
  EXPECT_NE(argumentErrorOf(options).find("a file"), std::string::npos);
  options.output = folder / "file/below";
  EXPECT_THROW(writeSequence(options), std::runtime_error);
}

TEST(Sequence, OptionsOutOfRangeAreNamed) {
  const TemporaryFolder folder;
  const SequenceOptions good = shortSequence(folder / "out");
  SequenceOptions bad = good;
  bad.frames = 0;
  EXPECT_NE(argumentErrorOf(bad).find("frames is 0"), std::string::npos);
  bad = good;
  bad.width = 8;
  EXPECT_NE(argumentErrorOf(bad).find("width is 8"), std::string::npos);
  bad = good;
  bad.box_drop = 1.5;
  EXPECT_NE(argumentErrorOf(bad).find("box drop is 1.5"), std::string::npos);
  bad = good;
  bad.box_jitter = -1.0;
  EXPECT_NE(argumentErrorOf(bad).find("box jitter is -1"), std::string::npos);
  bad = good;
  bad.scene = "walking";
  EXPECT_NE(argumentErrorOf(bad).find("scene is 'walking'"), std::string::npos);
  bad = good;
  bad.output.clear();
  EXPECT_NE(argumentErrorOf(bad).find("output is empty"), std::string::npos);
  EXPECT_FALSE(fs::exists(good.output));
}

}  // namespace
}  // namespace hmcdyn::synthesize
