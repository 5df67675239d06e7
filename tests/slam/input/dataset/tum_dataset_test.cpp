// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/tum_dataset.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

// A folder whose images are there, empty: listing does not open them.
class TumDataset : public testing::Test {
 protected:
  void addImages(std::initializer_list<std::string> files) const {
    for (const std::string& file : files) {
      folder.write(file, "");
    }
  }
  std::string listError(const DatasetOptions& options = {}) const {
    return messageOf<std::runtime_error>([&] { listFrames(folder.path(), options); });
  }

  TemporaryFolder folder;
};

TEST_F(TumDataset, ListsArePairedByTimeStamp) {
  addImages({"rgb/a.png", "rgb/b.png", "depth/a.png", "depth/b.png"});
  folder.write("rgb.txt", "# colour\n\n10.000000 rgb/a.png\n  # more\n10.100000 rgb/b.png\r\n");
  folder.write("depth.txt", "# depth\n10.109000 depth/b.png\n9.990000 depth/a.png\n");

  const std::vector<FrameEntry> frames = listFrames(folder.path());

  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].index, 0U);
  EXPECT_EQ(frames[0].timestamp, 10.0);
  EXPECT_EQ(frames[0].rgb, folder.path() / "rgb/a.png");
  EXPECT_EQ(frames[0].depth, folder.path() / "depth/a.png");
  EXPECT_EQ(frames[1].index, 1U);
  EXPECT_EQ(frames[1].timestamp, 10.1);
  EXPECT_EQ(frames[1].depth, folder.path() / "depth/b.png");
}

TEST_F(TumDataset, UnequalCountsLeaveTheSurplusOut) {
  addImages({"a", "b", "c", "x"});
  folder.write("rgb.txt", "1.0 a\n2.0 b\n3.0 c\n");
  folder.write("depth.txt", "2.001 x\n");
  const std::vector<FrameEntry> frames = listFrames(folder.path());
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].timestamp, 2.0);
}

TEST_F(TumDataset, AssociationsWinOverTheLists) {
  addImages({"a", "b", "x", "y"});
  folder.write("rgb.txt", "1.0 a\n2.0 b\n");
  folder.write("depth.txt", "1.0 x\n2.0 y\n");
  folder.write("associations.txt", "# rgb depth\n2.0 b 5.0 y\n1.0 a 4.0 y\n");
  const std::vector<FrameEntry> frames = listFrames(folder.path());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].timestamp, 1.0);  // in the order of time
  EXPECT_EQ(frames[0].depth, folder.path() / "y");
  EXPECT_EQ(frames[1].rgb, folder.path() / "b");
}

TEST_F(TumDataset, AGivenAssociationFileWinsOverTheFolders) {
  const TemporaryFolder elsewhere;
  addImages({"a", "x"});
  folder.write("associations.txt", "1.0 a 1.0 x\n");
  DatasetOptions options;
  options.associations = elsewhere.write("mine.txt", "7.0 a 7.0 x\n");
  const std::vector<FrameEntry> frames = listFrames(folder.path(), options);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].timestamp, 7.0);
  EXPECT_EQ(frames[0].rgb, folder.path() / "a");  // names are relative to the data set
}

TEST_F(TumDataset, ARepeatedLineCountsOnce) {
  addImages({"a", "x"});
  folder.write("rgb.txt", "1.0 a\n1.0 a\n");
  folder.write("depth.txt", "1.0 x\n1.000 x\n");
  EXPECT_EQ(listFrames(folder.path()).size(), 1U);
}

TEST_F(TumDataset, ATimeStampWithTwoFilesIsAnErrorThatNamesBothLines) {
  addImages({"a", "b", "x"});
  folder.write("rgb.txt", "# colour\n1.0 a\n1.0 b\n");
  folder.write("depth.txt", "1.0 x\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:3:", "1.000000", "line 2"}));
}

TEST_F(TumDataset, AnEntryMayNameAMissingFileButNotAll) {
  addImages({"b", "y"});
  folder.write("associations.txt", "1.0 a 1.0 x\n2.0 b 2.0 y\n");
  EXPECT_EQ(listFrames(folder.path()).size(), 2U);

  folder.write("associations.txt", "1.0 a 1.0 x\n2.0 b 2.0 z\n");
  EXPECT_TRUE(mentions(listError(), {"none of the 2 listed frames", (folder.path() / "a").string(),
                                     (folder.path() / "x").string()}));
}

TEST_F(TumDataset, AMissingFolderOrListIsNamed) {
  const std::filesystem::path nowhere = folder.path() / "nowhere";
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { listFrames(nowhere); }),
                       {nowhere.string(), "no such folder"}));

  const std::filesystem::path file = folder.write("file", "");
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { listFrames(file); }),
                       {file.string(), "is not a folder"}));

  EXPECT_TRUE(mentions(listError(), {"rgb.txt: no such file"}));

  folder.write("rgb.txt", "1.0 a\n");
  EXPECT_TRUE(mentions(listError(), {"depth.txt: no such file"}));

  DatasetOptions options;
  options.associations = folder.path() / "other.txt";
  EXPECT_TRUE(mentions(listError(options), {"other.txt: no such file"}));

  options.associations = folder.path();
  EXPECT_TRUE(
      mentions(listError(options), {folder.path().string(), "is a folder; expected a file"}));
}

TEST_F(TumDataset, AnEmptyListIsNamed) {
  folder.write("depth.txt", "1.0 x\n");
  folder.write("rgb.txt", "");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt: lists no image"}));
  folder.write("rgb.txt", "# nothing but\n# comments\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt: lists no image"}));
}

TEST_F(TumDataset, AMalformedLineIsNamedWithItsNumber) {
  folder.write("depth.txt", "1.0 x\n");
  folder.write("rgb.txt", "# colour\n1.0 a\n2.0\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:3:", "1 fields", "time file"}));
  folder.write("rgb.txt", "1.0 a b\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:1:", "3 fields"}));
  folder.write("rgb.txt", "1.0 a\nsoon b\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:2:", "time stamp is 'soon'"}));
  folder.write("rgb.txt", "1.0x a\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:1:", "time stamp is '1.0x'"}));
  folder.write("rgb.txt", "nan a\n");
  EXPECT_TRUE(mentions(listError(), {"rgb.txt:1:", "time stamp is 'nan'"}));

  folder.write("associations.txt", "1.0 a 1.0 x\n2.0 a\n");
  EXPECT_TRUE(mentions(listError(), {"associations.txt:2:", "2 fields", "time rgb time depth"}));
  folder.write("associations.txt", "1.0 a x 1.0\n");
  EXPECT_TRUE(mentions(listError(), {"associations.txt:1:", "time stamp is 'x'"}));
}

TEST_F(TumDataset, NoPairWithinTheToleranceTellsTheSmallestDifference) {
  folder.write("rgb.txt", "1.0 a\n2.0 b\n");
  folder.write("depth.txt", "1.5 x\n2.03125 y\n");
  EXPECT_TRUE(mentions(listError(), {folder.path().string(), "within 0.02 s", "0.031250 s"}));

  DatasetOptions wider;
  wider.time_tolerance = 0.04;
  addImages({"b", "y"});
  EXPECT_EQ(listFrames(folder.path(), wider).size(), 1U);
}

TEST_F(TumDataset, ANegativeToleranceIsTheCallersMistake) {
  DatasetOptions options;
  options.time_tolerance = -1.0;
  EXPECT_TRUE(
      mentions(messageOf<std::invalid_argument>([&] { listFrames(folder.path(), options); }),
               {"time_tolerance", "-1"}));
}

TEST(Timestamp, SixDecimalsComeBackDigitByDigit) {
  // Microseconds over 25 ms at the time of the recordings, where a double resolves 0.24 us.
  for (int microseconds = 700000; microseconds < 725000; ++microseconds) {
    const std::string text = "1341846434." + std::to_string(microseconds);
    ASSERT_EQ(formatTimestamp(std::stod(text)), text);
  }
  EXPECT_EQ(formatTimestamp(0.5), "0.500000");
}

TEST(RealClip, HasItsFortyNinePairs) {
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50");
  const std::filesystem::path folder = test::sharedPath("data/fr3_walking_halfsphere_first50");
  const std::vector<FrameEntry> frames = listFrames(folder);
  ASSERT_EQ(frames.size(), 49U);
  EXPECT_EQ(formatTimestamp(frames.front().timestamp), "1341846434.710184");
  EXPECT_EQ(frames.front().depth, folder / "depth/1341846434.710197.png");
}

}  // namespace
}  // namespace hmcdyn::slam
