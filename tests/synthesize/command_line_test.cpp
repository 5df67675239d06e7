// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "file_content.hpp"
#include "synthesize/scene_catalog.hpp"
#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

using hmcdyn::test::contentOf;
using test::TemporaryFolder;

struct Outcome {
  int code = -1;
  std::string text;  ///< Of both standard streams.
};

Outcome run(const TemporaryFolder& folder, const std::string& arguments) {
  const std::filesystem::path log = folder / "log.txt";
  const std::string command =
      std::string("'") + HMCDYN_SYNTHESIZE + "' " + arguments + " > '" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): a test of the binary
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contentOf(log)};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(CommandLine, ListsEveryScene) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "--list");
  EXPECT_EQ(outcome.code, 0);
  for (const SceneInfo& info : sceneCatalog()) {
    EXPECT_TRUE(contains(outcome.text, info.name + " ")) << info.name;
  }
}

TEST(CommandLine, HelpShowsOptionsAndExamples) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "--help");
  EXPECT_EQ(outcome.code, 0);
  for (const char* part : {"--scene", "--trajectory", "--noise", "--box-drop", "--size", "out/"}) {
    EXPECT_TRUE(contains(outcome.text, part)) << part;
  }
}

TEST(CommandLine, BadArgumentsGiveAnErrorAndPointToTheHelp) {
  const TemporaryFolder folder;
  const std::string output = "--output '" + (folder / "out").string() + "' ";
  for (const std::string& arguments :
       {std::string(""), output + "--size 640", output + "--size 640x480x3",
        output + "--noise loud", output + "--frames 0", output + "--frames many",
        output + "--box-drop 2", output + "--colour blue",
        output + "--trajectory /nowhere/groundtruth.txt"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_NE(outcome.code, 0) << arguments;
    EXPECT_TRUE(contains(outcome.text, "--help")) << arguments << ": " << outcome.text;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(CommandLine, UnknownSceneNamesTheKnownOnes) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run(folder, "--scene office --output '" + (folder / "out").string() + "'");
  EXPECT_NE(outcome.code, 0);
  EXPECT_TRUE(contains(outcome.text, "walking_xyz"));
}

TEST(CommandLine, RendersWithProgressAndRefusesAFilledFolder) {
  const TemporaryFolder folder;
  const std::string arguments =
      "--scene empty --frames 2 --size 64x48 --output '" + (folder / "out").string() + "'";
  const Outcome first = run(folder, arguments);
  EXPECT_EQ(first.code, 0) << first.text;
  EXPECT_TRUE(contains(first.text, "2/2 frames"));
  const Outcome second = run(folder, arguments);
  EXPECT_NE(second.code, 0);
  EXPECT_TRUE(contains(second.text, "not empty"));
  EXPECT_EQ(run(folder, arguments + " --overwrite --quiet").code, 0);
}

}  // namespace
}  // namespace hmcdyn::synthesize
