// SPDX-License-Identifier: BSD-3-Clause
// Runs in which something goes wrong in the middle: tracking goes on, or the frames without a pose
// are counted and named; what was computed is on disk.
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "file_content.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"
#include "slam/detect/detector.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::contentOf;
using test::ToySequence;
using test::toyStamp;
using test::writeToySequence;

constexpr double kExact = 0.003;  // m: the toy has exact depths and no noise

class Fault : public testing::Test {
 protected:
  SlamOptions optionsFor(const ToySequence& toy) const {
    writeToySequence(folder_.path() / "sequence", toy);
    SlamOptions options;
    options.dataset = folder_.path() / "sequence";
    options.camera = (options.dataset / "calibration.yaml").string();
    options.output = folder_.path() / "out";
    options.features.features = 400;
    options.quiet = true;
    return options;
  }

  /// One box over the whole image in these frames.
  void coverWithBoxes(SlamOptions& options, int first, int end) const {
    options.detector.type = "file";
    options.detector.boxes = folder_.path() / "boxes.txt";
    std::ofstream boxes(options.detector.boxes);
    for (int k = first; k < end; ++k) {
      boxes << toyStamp(k) << " person 0 0 320 240 0.9\n";
    }
  }

  /// Time stamps of trajectory.txt, as they stand there.
  std::vector<std::string> stampsOf(const std::string& file = "trajectory.txt") const {
    std::ifstream lines(folder_.path() / "out" / file);
    std::vector<std::string> stamps;
    for (std::string line; std::getline(lines, line);) {
      stamps.push_back(line.substr(0, line.find(' ')));
    }
    return stamps;
  }

  hmcdyn::test::TemporaryFolder folder_;
};

/// The frames from first to end are lost, all others tracked, and both files and summary say so.
void expectLost(const nlohmann::json& summary, const std::vector<std::string>& stamps, int frames,
                int first, int end) {
  const nlohmann::json& counts = summary.at("counts");
  EXPECT_EQ(counts.at("frames_in"), frames);
  EXPECT_EQ(counts.at("frames_tracked"), frames - (end - first));
  std::vector<std::string> tracked;
  std::vector<std::string> lost;
  for (int k = 0; k < frames; ++k) {
    (k >= first && k < end ? lost : tracked).push_back(toyStamp(k));
  }
  EXPECT_EQ(stamps, tracked);
  std::vector<std::string> named;
  for (const nlohmann::json& stamp : counts.at("lost_frames")) {
    named.push_back(fmt::format("{:.6f}", stamp.get<double>()));
  }
  EXPECT_EQ(named, lost);
}

double worstError(const nlohmann::json& summary) {
  return summary.at("evaluation").at("ate_m").at("max").get<double>();
}

TEST_F(Fault, WithoutDepthForASecondTrackingGoesOnByPixels) {
  ToySequence toy;
  toy.frames = 50;
  toy.step = 0.003;
  toy.spoil = [](int k, cv::Mat&, cv::Mat& depth) {
    if (k >= 10 && k < 40) {
      depth.setTo(0);
    }
  };
  const nlohmann::json summary = runSlam(optionsFor(toy));
  EXPECT_EQ(summary.at("counts").at("frames_without_depth"), 30);
  expectLost(summary, stampsOf(), 50, 0, 0);
  EXPECT_LT(worstError(summary), 2.0 * kExact);  // no depth to hold the scale by
}

TEST_F(Fault, ABlackFrameIsLostAndTheNextOneIsFoundAgain) {
  ToySequence toy;
  toy.frames = 12;
  toy.spoil = [](int k, cv::Mat& color, cv::Mat&) {
    if (k == 6) {
      color.setTo(cv::Scalar::all(0));
    }
  };
  const nlohmann::json summary = runSlam(optionsFor(toy));
  expectLost(summary, stampsOf(), 12, 6, 7);
  EXPECT_EQ(summary.at("counts").at("relocalized"), 1);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, ABlackSecondIsLostAndThePlaceBehindItIsFoundAgain) {
  ToySequence toy;
  toy.frames = 50;
  toy.step = 0.003;
  toy.spoil = [](int k, cv::Mat& color, cv::Mat& depth) {
    if (k >= 10 && k < 40) {
      color.setTo(cv::Scalar::all(0));
      depth.setTo(0);
    }
  };
  const nlohmann::json summary = runSlam(optionsFor(toy));
  expectLost(summary, stampsOf(), 50, 10, 41);  // the first one found has to be confirmed
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, ARunThatBeginsBlackStartsWithTheFirstPicture) {
  ToySequence toy;
  toy.frames = 10;
  toy.spoil = [](int k, cv::Mat& color, cv::Mat&) {
    if (k < 3) {
      color.setTo(cv::Scalar::all(0));
    }
  };
  const nlohmann::json summary = runSlam(optionsFor(toy));
  expectLost(summary, stampsOf(), 10, 0, 3);
  EXPECT_EQ(summary.at("counts").at("tracking_failures").at("too few key points"), 3);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, WithEveryKeyPointInAPersonsBoxFromTheStartNoMapBeginsAndTheReasonIsCounted) {
  ToySequence toy;
  SlamOptions options = optionsFor(toy);
  coverWithBoxes(options, 0, toy.frames);
  const nlohmann::json summary = runSlam(options);
  expectLost(summary, stampsOf(), toy.frames, 0, toy.frames);
  EXPECT_EQ(summary.at("counts").at("tracking_failures").at("too few key points"), toy.frames);
}

TEST_F(Fault, WhenAPersonsBoxComesToCoverEverythingTheKnownMapIsStillTracked) {
  ToySequence toy;
  toy.frames = 30;
  toy.step = 0.003;
  SlamOptions options = optionsFor(toy);
  coverWithBoxes(options, 10, 20);
  options.bridge = 0.0;
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(summary.at("counts").at("frames_with_boxes"), 10);
  expectLost(summary, stampsOf(), 30, 0, 0);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, WhilePeopleFillTheImageForSecondsFramesAreLostAndThenThePoseIsRightAgain) {
  // Two seconds of somebody's patterned back, half a metre away, that moves; behind it the camera
  // has turned back on its way, and stands where it once was.
  ToySequence toy;
  toy.frames = 100;
  toy.position = [](int k) { return k < 25 ? 0.005 * k : k < 75 ? 0.12 : 0.12 - 0.005 * (k - 75); };
  const cv::Mat back = test::makeTexture({640, 480}, 77);
  toy.spoil = [&back](int k, cv::Mat& color, cv::Mat& depth) {
    if (k >= 20 && k < 80) {
      cv::cvtColor(back(cv::Rect(3 * (k - 20), 2 * (k - 20), 320, 240)), color, cv::COLOR_GRAY2BGR);
      depth.setTo(0.5 * 5000.0);
    }
  };
  SlamOptions options = optionsFor(toy);
  coverWithBoxes(options, 20, 80);
  const nlohmann::json summary = runSlam(options);
  expectLost(summary, stampsOf(), 100, 20, 81);  // the first one found has to be confirmed
  EXPECT_EQ(summary.at("counts").at("tracking_failures").at("not confirmed"), 1);
  EXPECT_GE(summary.at("counts").at("relocalized").get<int>(), 1);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, AfterAJumpToAPlaceSeenBeforeTrackingGoesOnThere) {
  ToySequence toy;
  toy.frames = 80;
  toy.position = [](int k) { return k < 70 ? 0.006 * k : 0.006 * (k - 70); };  // 0.42 m back
  const nlohmann::json summary = runSlam(optionsFor(toy));
  expectLost(summary, stampsOf(), 80, 0, 0);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, AfterAJumpToAnUnknownPlaceFramesAreLostUntilTheCameraIsBack) {
  ToySequence toy;
  toy.frames = 40;
  toy.step = 0.003;
  const cv::Mat elsewhere = test::makeTexture({640, 480}, 99);
  toy.spoil = [&elsewhere](int k, cv::Mat& color, cv::Mat& depth) {
    if (k >= 15 && k < 30) {
      cv::cvtColor(elsewhere(cv::Rect(2 * k, 0, 320, 240)), color, cv::COLOR_GRAY2BGR);
      depth.setTo(2.0 * 5000.0);
    }
  };
  const nlohmann::json summary = runSlam(optionsFor(toy));
  expectLost(summary, stampsOf(), 40, 15, 30);
  EXPECT_EQ(summary.at("counts").at("tracking_failures").at("too few matches"), 15);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, OneFrameIsARun) {
  ToySequence toy;
  toy.frames = 1;
  const SlamOptions options = optionsFor(toy);
  const nlohmann::json summary = runSlam(options);
  expectLost(summary, stampsOf(), 1, 0, 0);
  EXPECT_EQ(summary.at("counts").at("key_frames"), 1);
  for (const char* file : {"keyframes.txt", "map.ply", "report.html", "summary.json"}) {
    EXPECT_TRUE(std::filesystem::exists(options.output / file)) << file;
  }
}

/// Finds a person over the left third, until it breaks.
class BreakingDetector final : public ObjectDetector {
 public:
  explicit BreakingDetector(double breaks_at) : breaks_at_(breaks_at) {}

  std::vector<DetectionBox> detect(const cv::Mat& /*bgr*/, double timestamp) override {
    if (timestamp >= breaks_at_) {
      throw std::runtime_error("the network is gone");
    }
    DetectionBox box;
    box.x_max = 100.0f;
    box.y_max = 239.0f;
    box.score = 0.9f;
    box.class_id = kPersonClassId;
    return {box};
  }
  std::string name() const override { return "breaking"; }

 private:
  double breaks_at_;
};

TEST_F(Fault, ADetectorThatThrowsInTheMiddleIsCountedAndTrackingGoesOn) {
  ToySequence toy;
  toy.frames = 30;
  toy.step = 0.003;
  const SlamOptions options = optionsFor(toy);
  const nlohmann::json summary =
      runSlam(options, {}, std::make_unique<BreakingDetector>(1000.0 + 9.5 / 30.0));
  const nlohmann::json& counts = summary.at("counts");
  EXPECT_EQ(counts.at("detections").at("detected"), 10);
  EXPECT_EQ(counts.at("detections").at("failed"), 20);
  EXPECT_GE(counts.at("frames_with_boxes").get<int>(), 10);  // and those that are carried on
  EXPECT_EQ(
      summary.at("warnings").back(),
      "the detector failed at 20 of 30 frames, the last time at frame 29: the network is gone");
  expectLost(summary, stampsOf(), 30, 0, 0);
  EXPECT_LT(worstError(summary), kExact);
}

TEST_F(Fault, ADetectorThatAlwaysThrowsIsNotSaidToHaveFoundNothing) {
  ToySequence toy;
  toy.frames = 3;
  const nlohmann::json summary =
      runSlam(optionsFor(toy), {}, std::make_unique<BreakingDetector>(0.0));
  ASSERT_FALSE(summary.at("warnings").empty());
  EXPECT_EQ(summary.at("warnings").front(),
            "without a box, only the motion mask spoke: the detector failed at every frame");
}

TEST_F(Fault, InRealTimeADetectorThatThrowsIsNoEndEither) {
  ToySequence toy;
  toy.frames = 20;
  toy.step = 0.003;
  SlamOptions options = optionsFor(toy);
  options.mode = RunMode::kRealtime;
  const nlohmann::json summary = runSlam(options, {}, std::make_unique<BreakingDetector>(0.0));
  const nlohmann::json& counts = summary.at("counts");
  EXPECT_EQ(counts.at("detections").at("detected"), 0);
  EXPECT_GE(counts.at("detections").at("failed").get<int>(), 1);
  // How many frames are dropped is the machine's affair; the others are tracked.
  EXPECT_EQ(counts.at("frames_tracked").get<int>() + counts.at("frames_dropped").get<int>(), 20);
  EXPECT_EQ(stampsOf().size(), counts.at("frames_tracked").get<std::size_t>());
}

TEST_F(Fault, ListsOutOfOrderAndLinesThatComeTwiceChangeNothing) {
  ToySequence toy;
  toy.frames = 10;
  SlamOptions options = optionsFor(toy);
  runSlam(options);
  const std::string in_order = contentOf(options.output / "trajectory.txt");
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    std::ifstream lines(options.dataset / list);
    std::vector<std::string> reversed;
    for (std::string line; std::getline(lines, line);) {
      reversed.insert(reversed.begin(), line + "\n");
    }
    std::ofstream out(options.dataset / list);
    for (const std::string& line : reversed) {
      out << line << line;
    }
  }
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(summary.at("counts").at("frames_in"), 10);
  EXPECT_EQ(contentOf(options.output / "trajectory.txt"), in_order);
}

TEST_F(Fault, OneTimeStampForTwoPicturesIsRefusedWithFileAndLine) {
  const SlamOptions options = optionsFor({});
  std::ofstream(options.dataset / "rgb.txt", std::ios::app)
      << toyStamp(3) << " rgb/" << toyStamp(4) << ".png\n";
  EXPECT_TRUE(
      hmcdyn::test::mentions(hmcdyn::test::messageOf<std::runtime_error>([&] { runSlam(options); }),
                             {"rgb.txt:9", toyStamp(3), "line 4"}));
}

TEST_F(Fault, ARunThatIsStoppedCountsOnlyWhatItTookUp) {
  ToySequence toy;
  toy.frames = 10;
  int asked = 0;
  const nlohmann::json summary = runSlam(optionsFor(toy), [&asked] { return ++asked > 4; });
  EXPECT_EQ(summary.at("counts").at("stopped_by_signal"), true);
  EXPECT_EQ(summary.at("counts").at("frames_in"), 4);
  EXPECT_EQ(summary.at("counts").at("frames_expected"), 10);
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 4);
  EXPECT_EQ(stampsOf().size(), 4U);
}

}  // namespace
}  // namespace hmcdyn::slam
