// SPDX-License-Identifier: BSD-3-Clause
// scripts/download_datasets.sh against archives of our own, by file:// URLs.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kTum = "rgbd_dataset_freiburg3_walking_xyz";
const std::string kBonn = "rgbd_bonn_crowd";

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct ProcessResult {
  int exit_code = -1;
  std::string text;  ///< Both streams.
};

class DownloadDatasets : public evaluate::test::TemporaryFolder {
 protected:
  void SetUp() override {
    for (const char* tool : {"curl", "unzip", "tar", "sha256sum", "python3"}) {
      if (shell("command -v " + std::string(tool) + " > /dev/null") != 0) {
        GTEST_SKIP() << tool << " is not installed";
      }
    }
    std::filesystem::create_directories(path("site"));
    makeArchive(kTum, "tgz", "first");
    makeArchive(kBonn, "zip", "first");
  }

  /// An archive that holds `name`/rgb.txt and a file with some thousand bytes that do not compress.
  void makeArchive(const std::string& name, const std::string& kind,
                   const std::string& content) const {
    std::filesystem::create_directories(path("made/" + name));
    write("made/" + name + "/rgb.txt", content);
    std::string noise;
    for (unsigned value = 1; noise.size() < 20000; value = value * 1664525U + 1013904223U) {
      noise += static_cast<char>(value >> 24U);
    }
    write("made/" + name + "/image", noise);
    const std::string file = path("site/" + name + "." + kind).string();
    const std::string command = kind == "tgz" ? "tar -czf '" + file + "' " + name
                                              : "python3 -m zipfile -c '" + file + "' " + name;
    ASSERT_EQ(shell("cd '" + path("made").string() + "' && " + command), 0);
  }

  ProcessResult download(const std::string& arguments) const {
    const std::string site = "file://" + path("site").string();
    const int code = shell(HMCDYN_SCRIPTS "/download_datasets.sh --output '" +
                           path("data").string() + "' --tum '" + site + "' --bonn '" + site + "' " +
                           arguments + " > '" + path("log").string() + "' 2>&1");
    return {code, read(path("log"))};
  }
  std::string unpacked(const std::string& name) const {
    return read(path("data/" + name + "/rgb.txt"));
  }
};

TEST_F(DownloadDatasets, UnpacksBothKinds) {
  const ProcessResult result = download(kTum + " " + kBonn);
  ASSERT_EQ(result.exit_code, 0) << result.text;
  EXPECT_EQ(unpacked(kTum), "first");
  EXPECT_EQ(unpacked(kBonn), "first");
  const std::string sums = read(path("data/archives/SHA256SUMS"));
  EXPECT_THAT(sums, HasSubstr(kTum + ".tgz"));
  EXPECT_THAT(sums, HasSubstr(kBonn + ".zip"));
  // A second call has nothing to do.
  const ProcessResult again = download(kTum + " " + kBonn);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.text, HasSubstr(kTum + ": there already"));
}

TEST_F(DownloadDatasets, GoesOnWhereItWasStopped) {
  // Given the first half of the archive, then all of it under the unfinished name
  const std::string whole = read(path("site/" + kTum + ".tgz"));
  for (const std::size_t length : {whole.size() / 2, whole.size()}) {
    std::filesystem::remove_all(path("data"));
    std::filesystem::create_directories(path("data/archives"));
    write("data/archives/" + kTum + ".tgz.part", whole.substr(0, length));
    const ProcessResult result = download(kTum);
    EXPECT_EQ(result.exit_code, 0) << result.text;
    EXPECT_EQ(unpacked(kTum), "first");
    EXPECT_EQ(read(path("data/archives/" + kTum + ".tgz")), whole);
  }
  // ... and a half of something else
  std::filesystem::remove_all(path("data"));
  std::filesystem::create_directories(path("data/archives"));
  write("data/archives/" + kTum + ".tgz.part", std::string(500, 'x'));
  EXPECT_EQ(download(kTum).exit_code, 1);
  EXPECT_EQ(download(kTum).exit_code, 0);  // it was deleted
  EXPECT_EQ(unpacked(kTum), "first");
}

TEST_F(DownloadDatasets, WhatIsNoArchiveIsNotUnpacked) {
  write("site/" + kTum + ".tgz", "<html>We have moved</html>");
  const ProcessResult result = download(kTum + " " + kBonn);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.text, HasSubstr("no whole archive"));
  EXPECT_THAT(result.text, HasSubstr("1 of 2 sequences are missing: " + kTum));
  EXPECT_FALSE(std::filesystem::exists(path("data/" + kTum)));
  EXPECT_EQ(unpacked(kBonn), "first");  // the others are fetched all the same
}

TEST_F(DownloadDatasets, AnArchiveThatChangedIsRefused) {
  ASSERT_EQ(download(kTum).exit_code, 0);
  std::filesystem::remove_all(path("data/" + kTum));
  std::filesystem::remove(path("data/archives/" + kTum + ".tgz"));
  makeArchive(kTum, "tgz", "second");
  const ProcessResult result = download(kTum);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.text, HasSubstr("differs from its checksum"));
  EXPECT_FALSE(std::filesystem::exists(path("data/" + kTum)));
}

TEST_F(DownloadDatasets, GivenChecksumsDecide) {
  ASSERT_EQ(download(kTum).exit_code, 0);
  std::filesystem::copy(path("data/archives/SHA256SUMS"), path("sums"));
  const std::string option = "--checksums '" + path("sums").string() + "' ";
  std::filesystem::remove_all(path("data"));
  EXPECT_EQ(download(option + kTum).exit_code, 0);

  const ProcessResult unnamed = download(option + kBonn);
  EXPECT_EQ(unnamed.exit_code, 1);
  EXPECT_THAT(unnamed.text, HasSubstr(kBonn + ".zip is not in"));

  std::filesystem::remove_all(path("data"));
  write("sums", std::string(64, '0') + "  " + kTum + ".tgz\n");
  const ProcessResult wrong = download(option + kTum);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.text, HasSubstr("differs from its checksum"));
}

TEST_F(DownloadDatasets, WithoutAConnectionItSaysSo) {
  // Port 1 of this machine, where nobody listens
  const ProcessResult result = download("--tum http://127.0.0.1:1 " + kTum);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.text, HasSubstr("no connection"));
  EXPECT_THAT(result.text, HasSubstr("The same call goes on"));
}

TEST_F(DownloadDatasets, WhatIsNotThereIsNamed) {
  std::filesystem::remove(path("site/" + kTum + ".tgz"));
  const ProcessResult result = download(kTum);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.text, HasSubstr("not there"));
}

TEST_F(DownloadDatasets, ArchivesCanBeRemoved) {
  ASSERT_EQ(download("--remove-archives " + kTum).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("data/archives/" + kTum + ".tgz")));
  EXPECT_EQ(unpacked(kTum), "first");
}

TEST_F(DownloadDatasets, WrongUsageIsExitCodeTwo) {
  EXPECT_EQ(download("rgbd_dataset_unknown").exit_code, 2);
  EXPECT_EQ(download("--bogus").exit_code, 2);
  EXPECT_EQ(download("--checksums").exit_code, 2);
  EXPECT_EQ(download("--checksums /nonexistent " + kTum).exit_code, 2);
  EXPECT_EQ(shell(HMCDYN_SCRIPTS "/download_datasets.sh > /dev/null 2>&1"), 2);
  const ProcessResult list = download("--list");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.text, HasSubstr("rgbd_bonn_synchronous2\n"));
  EXPECT_THAT(list.text, Not(HasSubstr("==")));
}

}  // namespace
}  // namespace hmcdyn
