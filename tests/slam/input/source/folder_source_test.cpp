// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/folder_source.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;

/// A toy sequence whose frame 2 can be damaged: 320x240 px, stamps 1000 s and on at 30 Hz.
class FolderSource : public testing::Test {
 protected:
  TumFolderSource open() {
    return {folder_.path(),
            {},
            loadCamera((folder_.path() / "calibration.yaml").string()),
            [this](const std::string& line) { reports_.push_back(line); }};
  }
  static std::vector<std::size_t> indices(TumFolderSource& source) {
    std::vector<std::size_t> all;
    while (const auto frame = source.next()) {
      all.push_back(frame->index);
    }
    return all;
  }

  hmcdyn::test::TemporaryFolder folder_;
  std::vector<std::string> reports_;
};

slam::test::ToySequence toyOf(int frames) {
  slam::test::ToySequence toy;
  toy.frames = frames;
  return toy;
}

TEST_F(FolderSource, GivesEveryFrameInOrder) {
  slam::test::writeToySequence(folder_.path(), toyOf(4));
  TumFolderSource source = open();
  EXPECT_EQ(source.expectedFrames(), 4u);
  EXPECT_EQ(source.name(), "folder " + folder_.path().filename().string());
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_FALSE(source.next().has_value());
  EXPECT_EQ(source.counts().taken_up, 4u);
  EXPECT_EQ(source.counts().unreadable, 0u);
  EXPECT_EQ(source.counts().without_depth, 0u);
  EXPECT_TRUE(reports_.empty());
  EXPECT_EQ(source.failure(), "");
}

TEST_F(FolderSource, ReportsCountsAndSkipsAFrameThatCannotBeRead) {
  slam::test::writeToySequence(folder_.path(), toyOf(4));
  fs::resize_file(folder_.path() / "rgb" / "1000.066667.png", 100);
  TumFolderSource source = open();
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(source.counts().taken_up, 4u);
  EXPECT_EQ(source.counts().unreadable, 1u);
  ASSERT_EQ(reports_.size(), 1u);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"frame 2", "left out", "1000.066667.png"}));
}

TEST_F(FolderSource, CountsFramesWithoutDepth) {
  slam::test::ToySequence toy = toyOf(2);
  toy.with_depth = false;
  slam::test::writeToySequence(folder_.path(), toy);
  TumFolderSource source = open();
  EXPECT_EQ(indices(source).size(), 2u);
  EXPECT_EQ(source.counts().without_depth, 2u);
}

TEST_F(FolderSource, EndsAtItsLimit) {
  slam::test::writeToySequence(folder_.path(), toyOf(4));
  TumFolderSource source = open();
  source.limit(0);  // all
  EXPECT_EQ(source.expectedFrames(), 4u);
  source.limit(9);
  EXPECT_EQ(source.expectedFrames(), 4u);
  source.limit(2);
  EXPECT_EQ(source.expectedFrames(), 2u);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1}));
}

TEST_F(FolderSource, SkipsWithoutLoading) {
  slam::test::writeToySequence(folder_.path(), toyOf(3));
  fs::resize_file(folder_.path() / "rgb" / "1000.033333.png", 100);
  TumFolderSource source = open();
  EXPECT_EQ(source.next()->index, 0u);
  EXPECT_DOUBLE_EQ(source.upcomingTimestamp(0).value(), 1000.033333);
  EXPECT_DOUBLE_EQ(source.upcomingTimestamp(1).value(), 1000.066667);
  EXPECT_FALSE(source.upcomingTimestamp(2).has_value());
  source.skip();  // damaged, which nobody finds out
  EXPECT_FALSE(source.upcomingTimestamp(1).has_value());
  EXPECT_EQ(source.next()->index, 2u);
  EXPECT_FALSE(source.upcomingTimestamp(0).has_value());
  source.skip();  // nothing left
  EXPECT_EQ(source.counts().taken_up, 3u);
  EXPECT_EQ(source.counts().dropped, 1u);
  EXPECT_EQ(source.counts().unreadable, 0u);
  EXPECT_TRUE(reports_.empty());
}

TEST_F(FolderSource, OfAMissingFolderNamesIt) {
  const CameraCalibration calibration = loadCamera("tum3");
  const std::string message = hmcdyn::test::messageOf<std::runtime_error>([&] {
    TumFolderSource(folder_.path() / "nowhere", {}, calibration, [](const std::string&) {});
  });
  EXPECT_TRUE(hmcdyn::test::mentions(message, {"nowhere", "no such folder"}));
}

}  // namespace
}  // namespace hmcdyn::slam
