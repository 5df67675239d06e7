// SPDX-License-Identifier: BSD-3-Clause
// Frames are rendered side by side; nothing of that may be seen.
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "file_content.hpp"
#include "synthesize/sequence.hpp"
#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

namespace fs = std::filesystem;
using hmcdyn::test::contentOf;
using test::shortSequence;
using test::TemporaryFolder;

std::map<std::string, std::string> filesOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      content[fs::relative(entry.path(), folder).string()] = contentOf(entry.path());
    }
  }
  return content;
}

TEST(Sequence, SameSeedGivesTheSameBytesWhateverTheThreads) {
  const TemporaryFolder folder;
  SequenceOptions options = shortSequence(folder / "one");
  options.threads = 1;
  options.box_drop = 0.3;
  options.box_jitter = 2.0;
  writeSequence(options);
  options.output = folder / "three";
  options.threads = 3;
  writeSequence(options);
  const auto one = filesOf(folder / "one");
  const auto three = filesOf(folder / "three");
  ASSERT_EQ(one.size(), 3U * 3U + 6U);
  ASSERT_EQ(one.size(), three.size());
  for (const auto& [name, bytes] : one) {
    EXPECT_TRUE(three.at(name) == bytes) << name << " differs";
  }
}

}  // namespace
}  // namespace hmcdyn::synthesize
