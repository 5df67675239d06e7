// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/run_folder.hpp"

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>

#include "file_content.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;
using test::contentOf;

/// A fresh folder that is removed at the end.
class RunFolderTest : public ::testing::Test {
 protected:
  RunFolderTest() {
    std::string name = (fs::temp_directory_path() / "hmcdyn_output_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~RunFolderTest() override { fs::remove_all(folder_); }
  RunFolderTest(const RunFolderTest&) = delete;
  RunFolderTest& operator=(const RunFolderTest&) = delete;
  RunFolderTest(RunFolderTest&&) = delete;
  RunFolderTest& operator=(RunFolderTest&&) = delete;

  fs::path file(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

std::vector<std::string> linesOf(const fs::path& path) {
  std::istringstream stream(contentOf(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

/// What the action's exception says; empty where it throws none.
template <class Exception>
std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  }
  return {};
}

LabelledKeyPoints noKeyPoints() { return {}; }

TEST_F(RunFolderTest, CreatesTheFolderWithItsParents) {
  const RunFolder run(file("a/b/c"));
  EXPECT_TRUE(fs::is_directory(file("a/b/c")));
  EXPECT_EQ(run.path(), file("a/b/c"));
  EXPECT_TRUE(fs::is_empty(file("a/b/c"))) << "the write test leaves nothing";
}

TEST_F(RunFolderTest, AnEarlierRunsFilesGoAndOthersStay) {
  fs::create_directories(file("out"));
  for (const char* name : {"trajectory.txt", "timings.csv", "keypoints.csv", "summary.json",
                           "keyframes.txt", "loops.csv", "map.ply", "report.html", "notes.txt"}) {
    std::ofstream(file("out") / name) << "old\n";
  }
  const RunFolder run(file("out"));
  EXPECT_FALSE(fs::exists(file("out/summary.json")));
  EXPECT_FALSE(fs::exists(file("out/keypoints.csv")));
  for (const char* name : {"keyframes.txt", "loops.csv", "map.ply", "report.html"}) {
    EXPECT_FALSE(fs::exists(file("out") / name)) << name;
  }
  EXPECT_EQ(contentOf(file("out/notes.txt")), "old\n");
  run.trajectory();
  EXPECT_EQ(contentOf(file("out/trajectory.txt")), "");
}

TEST_F(RunFolderTest, AFileInThePlaceOfTheFolderIsAnError) {
  std::ofstream(file("taken")) << "x";
  for (const fs::path& path : {file("taken"), file("taken/below")}) {
    const std::string message = messageOf<std::runtime_error>([&] { const RunFolder run(path); });
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  }
  EXPECT_EQ(contentOf(file("taken")), "x");
}

TEST_F(RunFolderTest, AFolderThatCannotBeWrittenIsAnError) {
  if (!fs::is_directory("/proc/self")) {
    GTEST_SKIP() << "needs /proc, where even root cannot create files";
  }
  for (const char* path : {"/proc/self", "/proc/self/hmcdyn_output"}) {
    const std::string message = messageOf<std::runtime_error>([&] { const RunFolder run(path); });
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_GT(message.size(), std::string("output folder : ").size() + std::string(path).size());
  }
}

TEST_F(RunFolderTest, TrajectoryHoldsTheCameraInTheWorld) {
  // A camera at (1, 2, 3), turned by 90 degrees about z: camera_from_world is the inverse.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  world_from_camera.linear() =
      Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  TrajectoryWriter writer(file("trajectory.txt"));
  writer.write(1341846434.7101842, world_from_camera.inverse());
  writer.write(1341846434.75, Eigen::Isometry3d::Identity());
  const std::vector<std::string> lines = linesOf(file("trajectory.txt"));
  ASSERT_EQ(lines.size(), 2U);
  std::istringstream line(lines[0]);
  std::string stamp;
  double tx, ty, tz, qx, qy, qz, qw;
  line >> stamp >> tx >> ty >> tz >> qx >> qy >> qz >> qw;
  EXPECT_TRUE(line && (line >> std::ws).eof());
  EXPECT_EQ(stamp, "1341846434.710184") << "six decimals";
  EXPECT_NEAR(tx, 1.0, 1e-9);
  EXPECT_NEAR(ty, 2.0, 1e-9);
  EXPECT_NEAR(tz, 3.0, 1e-9);
  EXPECT_NEAR(qx, 0.0, 1e-9);
  EXPECT_NEAR(qy, 0.0, 1e-9);
  EXPECT_NEAR(qz, std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(qw, std::sqrt(0.5), 1e-9);
  EXPECT_EQ(lines[1].substr(0, 17), "1341846434.750000");
}

TEST_F(RunFolderTest, RowsAreInTheFileAsSoonAsTheyAreWritten) {
  TrajectoryWriter trajectory(file("trajectory.txt"));
  TimingsWriter timings(file("timings.csv"), {"track"});
  KeyPointsWriter key_points(file("keypoints.csv"));
  for (std::size_t frame = 1; frame <= 3; ++frame) {
    trajectory.write(static_cast<double>(frame), Eigen::Isometry3d::Identity());
    timings.write(static_cast<double>(frame), {});
    EXPECT_EQ(linesOf(file("trajectory.txt")).size(), frame) << "the writers are still open";
    EXPECT_EQ(linesOf(file("timings.csv")).size(), frame + 1);
  }
  key_points.write(1.0, noKeyPoints());
  EXPECT_EQ(linesOf(file("keypoints.csv")).size(), 1U) << "a frame without points has no rows";
}

TEST_F(RunFolderTest, AKilledRunKeepsItsRows) {
  const pid_t child = fork();
  if (child == 0) {
    TrajectoryWriter writer(file("trajectory.txt"));
    writer.write(1.0, Eigen::Isometry3d::Identity());
    writer.write(2.0, Eigen::Isometry3d::Identity());
    raise(SIGKILL);
  }
  ASSERT_GT(child, 0);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(linesOf(file("trajectory.txt")).size(), 2U);
}

TEST_F(RunFolderTest, TrajectoryRefusesWhatIsNotFinite) {
  TrajectoryWriter writer(file("trajectory.txt"));
  Eigen::Isometry3d lost = Eigen::Isometry3d::Identity();
  lost.translation().x() = std::nan("");
  EXPECT_THROW(writer.write(1.0, lost), std::invalid_argument);
  EXPECT_THROW(writer.write(std::nan(""), Eigen::Isometry3d::Identity()), std::invalid_argument);
  EXPECT_EQ(contentOf(file("trajectory.txt")), "");
}

TEST_F(RunFolderTest, TimingsHaveAColumnAStage) {
  TimingsWriter writer(file("timings.csv"), {"features", "track"});
  support::StageTimes all;
  all.add({"track", 2.5, 1.25});  // in another order than the columns
  all.add({"features", 5.0, 4.5});
  writer.write(1.5, all);
  support::StageTimes some;
  some.add({"features", 6.0, 5.5});
  writer.write(2.5, some);
  EXPECT_EQ(linesOf(file("timings.csv")),
            (std::vector<std::string>{
                "timestamp,features_wall_ms,track_wall_ms,features_cpu_ms,track_cpu_ms",
                "1.500000,5.0000,2.5000,4.5000,1.2500", "2.500000,6.0000,nan,5.5000,nan"}));
}

TEST_F(RunFolderTest, TimingsRefuseUnknownAndUnusableStages) {
  TimingsWriter writer(file("timings.csv"), {"track"});
  support::StageTimes times;
  times.add({"loop", 1.0, 1.0});
  EXPECT_EQ(messageOf<std::invalid_argument>([&] { writer.write(1.0, times); }),
            "timings: stage \"loop\" has no column");
  using Names = std::vector<std::string>;
  for (const Names& names : {Names{"a,b"}, Names{""}, Names{"a", "b", "a"}, Names{"a\n"}}) {
    EXPECT_THROW(TimingsWriter(file("other.csv"), names), std::invalid_argument);
  }
  EXPECT_FALSE(fs::exists(file("other.csv")));
}

TEST_F(RunFolderTest, KeyPointRowsByHand) {
  KeyPoints points;
  points.push_back(12.5f, 7.25f, 1.5f);
  points.push_back(600.0f, 3.0f, 0.0f);
  points.push_back(1.0f, 2.0f, kNaN);
  const std::vector<float> distances{0.25f, -kNaN, 3.0f};
  const std::vector<int> clusters{-1, 2, 0};
  const std::vector<PointLabel> labels{PointLabel::kStatic, PointLabel::kUnmatched,
                                       PointLabel::kDynamic};
  const std::vector<float> weights{1.0f, 0.125f, 0.0f};
  KeyPointsWriter writer(file("keypoints.csv"));
  const std::vector<float> sizes{31.0f, 37.2f, 111.1f};
  writer.write(10.0, {points.view(), distances, clusters, labels, weights, sizes});
  EXPECT_EQ(linesOf(file("keypoints.csv")),
            (std::vector<std::string>{"timestamp,u,v,depth,distance,cluster,label,weight,size",
                                      "10.000000,12.500,7.250,1.5000,0.2500,-1,static,1.0000,31.0",
                                      "10.000000,600.000,3.000,0.0000,nan,2,unmatched,0.1250,37.2",
                                      "10.000000,1.000,2.000,nan,3.0000,0,dynamic,0.0000,111.1"}));
}

TEST_F(RunFolderTest, KeyPointArraysOfUnequalSizeAreRefused) {
  KeyPoints points;
  points.push_back(1.0f, 2.0f, 3.0f);
  const std::vector<float> one{1.0f};
  const std::vector<int> none;
  const std::vector<PointLabel> label{PointLabel::kStatic};
  KeyPointsWriter writer(file("keypoints.csv"));
  EXPECT_EQ(messageOf<std::invalid_argument>([&] {
              writer.write(1.0, {points.view(), one, none, label, one, one});
            }),
            "key points: 1 points, 1 distances, 0 clusters, 1 labels, 1 weights, 1 sizes; "
            "expected equal sizes");
  points.depth.clear();
  EXPECT_THROW(writer.write(1.0, {points.view(), one, none, label, one, one}),
               std::invalid_argument);
}

TEST_F(RunFolderTest, AFullDiskIsNamed) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  TrajectoryWriter writer("/dev/full");
  const std::string message =
      messageOf<std::runtime_error>([&] { writer.write(1.0, Eigen::Isometry3d::Identity()); });
  EXPECT_NE(message.find("/dev/full"), std::string::npos) << message;
  EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
  EXPECT_THROW(KeyPointsWriter("/dev/full"), std::runtime_error);
  EXPECT_THROW(TimingsWriter("/dev/full", {"track"}), std::runtime_error);
}

TEST_F(RunFolderTest, WhatWasWrittenBeforeTheDiskFilledStaysWhole) {
  // A limit on the file size fails a write in the middle, as a full disk does. In a child, since
  // the limit is the process's.
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{250, 250};
    setrlimit(RLIMIT_FSIZE, &limit);
    TrajectoryWriter writer(file("trajectory.txt"));
    try {
      for (int i = 0; i < 100; ++i) {
        writer.write(i, Eigen::Isometry3d::Identity());
      }
    } catch (const std::runtime_error&) {
      _exit(42);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 42);
  const std::string content = contentOf(file("trajectory.txt"));
  const std::vector<std::string> lines = linesOf(file("trajectory.txt"));
  ASSERT_GE(lines.size(), 2U);
  EXPECT_EQ(content.back(), '\n');
  for (const std::string& line : lines) {
    std::istringstream numbers(line);
    int count = 0;
    for (double value = 0.0; numbers >> value; ++count) {
    }
    EXPECT_EQ(count, 8) << line;
  }
}

TEST_F(RunFolderTest, SummaryIsReplacedInOneStep) {
  const RunFolder run(file("out"));
  run.writeSummary({{"frames", 49}, {"ate", std::numeric_limits<double>::quiet_NaN()}});
  nlohmann::json summary = nlohmann::json::parse(contentOf(file("out/summary.json")));
  EXPECT_EQ(summary["frames"], 49);
  EXPECT_TRUE(summary["ate"].is_null()) << "JSON has no NaN";
  run.writeSummary({{"frames", 50}});
  summary = nlohmann::json::parse(contentOf(file("out/summary.json")));
  EXPECT_EQ(summary["frames"], 50);
  EXPECT_FALSE(fs::exists(file("out/summary.json.tmp")));
}

TEST_F(RunFolderTest, ASummaryThatCannotBeWrittenLeavesTheOldOne) {
  const RunFolder run(file("out"));
  run.writeSummary({{"frames", 1}});
  fs::create_directory(file("out/summary.json.tmp"));  // in the way
  const std::string message = messageOf<std::runtime_error>([&] {
    run.writeSummary({{"frames", 2}});
  });
  EXPECT_NE(message.find("summary.json"), std::string::npos) << message;
  EXPECT_EQ(nlohmann::json::parse(contentOf(file("out/summary.json")))["frames"], 1);
}

TEST_F(RunFolderTest, SummaryTakesNamesThatAreNoUtf8) {
  const RunFolder run(file("out"));
  run.writeSummary({{"dataset", "caf\xe9"}});
  EXPECT_TRUE(nlohmann::json::accept(contentOf(file("out/summary.json"))));
}

TEST_F(RunFolderTest, AMissingFolderNamesTheFile) {
  const std::string message =
      messageOf<std::runtime_error>([&] { TrajectoryWriter(file("none/trajectory.txt")); });
  EXPECT_NE(message.find("none/trajectory.txt"), std::string::npos) << message;
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

}  // namespace
}  // namespace hmcdyn::slam
