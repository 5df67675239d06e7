// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/folder_source.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dataset/temporary_folder.hpp"
#include "pipeline/toy_sequence.hpp"
#include "slam/camera/calibration_file.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;

class FolderSource : public testing::Test {
 protected:
  TumFolderSource open() {
    return {folder_.path(), {}, loadCamera((folder_.path() / "calibration.yaml").string()),
            [this](const std::string& line) { reports_.push_back(line); }};
  }
  std::vector<std::size_t> indices(TumFolderSource& source) {
    std::vector<std::size_t> all;
    while (const auto frame = source.next()) {
      all.push_back(frame->index);
    }
    return all;
  }

  test::TemporaryFolder folder_;
  std::vector<std::string> reports_;
};

TEST_F(FolderSource, GivesEveryFrameInOrder) {
  slam::test::writeToySequence(folder_.path(), {4});
  TumFolderSource source = open();
  EXPECT_EQ(source.expectedFrames(), 4u);
  EXPECT_EQ(indices(source), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(source.next(), std::nullopt);
  EXPECT_EQ(source.counts().taken_up, 4u);
  EXPECT_EQ(source.counts().unreadable, 0u);
  EXPECT_EQ(source.counts().without_depth, 0u);
  EXPECT_TRUE(reports_.empty());
  EXPECT_EQ(source.failure(), "");
}

}  // namespace
}  // namespace hmcdyn::slam
