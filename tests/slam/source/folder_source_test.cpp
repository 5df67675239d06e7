// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/folder_source.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dataset/temporary_folder.hpp"
#include "pipeline/toy_sequence.hpp"
#include "slam/camera/calibration.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;

class FolderSource : public testing::Test {
 protected:
  /// Three frames, the middle one's time stamp is 1000.033333.
  TumFolderSource open(bool with_depth = true) {
    test::ToySequence toy;
    toy.frames = 3;
    toy.with_depth = with_depth;
    test::writeToySequence(folder_.path(), toy);
    return reopen();
  }
  TumFolderSource reopen() {
    return {folder_.path(),
            {},
            loadCamera((folder_.path() / "calibration.yaml").string()),
            [this](const std::string& line) { reports_.push_back(line); }};
  }
  static std::vector<std::size_t> indices(TumFolderSource& source) {
    std::vector<std::size_t> all;
    while (const std::optional<RgbdFrame> frame = source.next()) {
      all.push_back(frame->index);
    }
    return all;
  }

  hmcdyn::test::TemporaryFolder folder_;
  std::vector<std::string> reports_;
};

TEST_F(FolderSource, GivesEveryFrameInOrder) {
  TumFolderSource source = open();
  EXPECT_EQ(source.expectedFrames(), 3U);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_FALSE(source.next().has_value());
  EXPECT_EQ(source.counts().taken_up, 3U);
  EXPECT_EQ(source.counts().unreadable, 0U);
  EXPECT_EQ(source.counts().without_depth, 0U);
  EXPECT_TRUE(reports_.empty());
  EXPECT_EQ(source.failure(), "");
}

TEST_F(FolderSource, AFrameThatCannotBeReadIsLeftOutAndNamed) {
  open();
  const fs::path broken = folder_.path() / "rgb" / "1000.033333.png";
  fs::resize_file(broken, fs::file_size(broken) / 2);
  TumFolderSource source = reopen();
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(source.counts().taken_up, 3U);
  EXPECT_EQ(source.counts().unreadable, 1U);
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_TRUE(hmcdyn::test::mentions(reports_[0], {"frame 1", "1000.033333.png"}));
}

TEST_F(FolderSource, FramesWithoutDepthAreDeliveredAndCounted) {
  TumFolderSource source = open(false);
  EXPECT_EQ(indices(source).size(), 3U);
  EXPECT_EQ(source.counts().without_depth, 3U);
}

TEST_F(FolderSource, ALimitEndsItEarlyAndZeroIsNone) {
  TumFolderSource source = open();
  source.limit(0);
  source.limit(7);
  EXPECT_EQ(source.expectedFrames(), 3U);
  source.limit(2);
  EXPECT_EQ(source.expectedFrames(), 2U);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1}));
}

TEST_F(FolderSource, ASkippedFrameIsDroppedWithoutBeingLoaded) {
  open();
  fs::remove(folder_.path() / "rgb" / "1000.000000.png");  // loading it would be reported
  TumFolderSource source = reopen();
  ASSERT_TRUE(source.nextTimestamp().has_value());
  EXPECT_DOUBLE_EQ(*source.nextTimestamp(), 1000.0);
  EXPECT_DOUBLE_EQ(source.timestampAfterNext().value(), 1000.033333);
  source.skip();
  EXPECT_DOUBLE_EQ(source.nextTimestamp().value(), 1000.033333);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(source.counts().dropped, 1U);
  EXPECT_EQ(source.counts().taken_up, 3U);
  EXPECT_TRUE(reports_.empty());
  EXPECT_FALSE(source.nextTimestamp().has_value());
  source.skip();  // at the end there is nothing to drop
  EXPECT_EQ(source.counts().dropped, 1U);
}

TEST_F(FolderSource, AMissingFolderIsNamed) {
  const CameraCalibration calibration;
  const std::string message = hmcdyn::test::messageOf<std::runtime_error>([&] {
    TumFolderSource(folder_.path() / "nowhere", {}, calibration, [](const std::string&) {});
  });
  EXPECT_NE(message.find("nowhere"), std::string::npos) << message;
}

}  // namespace
}  // namespace hmcdyn::slam
