// SPDX-License-Identifier: BSD-3-Clause
// Inputs that people have and that are not as the documents ask for; made by the tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "file_content.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"
#include "slam/run/options.hpp"

namespace hmcdyn::faults {

/// A text as another program would have written it.
inline std::string replaced(std::string text, const std::string& part, const std::string& with) {
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + with.size())) {
    text.replace(at, part.size(), with);
  }
  return text;
}

/// ASCII in UTF-16 with its mark. @param big_endian the first byte is the upper one.
inline std::string utf16(const std::string& ascii, bool big_endian) {
  std::string bytes = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : ascii) {
    bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  }
  return bytes;
}

/// The lines of a text, without line ends.
inline std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

/// True where one of the sentences has all of the parts.
inline testing::AssertionResult oneMentions(const std::vector<std::string>& sentences,
                                            std::initializer_list<std::string> parts) {
  std::string all;
  for (const std::string& sentence : sentences) {
    if (test::mentions(sentence, parts)) {
      return testing::AssertionSuccess();
    }
    all += "\n  " + sentence;
  }
  return testing::AssertionFailure()
         << "none of" << all << "\nhas \"" << *parts.begin() << "\" ...";
}

/// A test with a toy sequence whose files can be rewritten.
class ToyFolder : public testing::Test {
 protected:
  void SetUp() override { restore(); }

  /// The toy sequence as it was; drawn once, as that takes most of a test's time.
  void restore() const {
    static const hmcdyn::test::TemporaryFolder drawn;
    static const bool is_drawn = [] {
      slam::test::writeToySequence(drawn.path(), {});
      return true;
    }();
    ASSERT_TRUE(is_drawn);
    std::filesystem::copy(drawn.path(), toy(),
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
  }

  std::filesystem::path toy() const { return folder_.path() / "toy"; }

  std::string content(const std::string& name) const {
    return hmcdyn::test::contentOf(toy() / name);
  }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    return folder_.write("toy/" + name, bytes);
  }

  /// Each line of a list with its time stamp changed.
  void restamp(const std::string& name,
               const std::function<std::string(double, std::size_t)>& stamp) const {
    std::string text;
    std::size_t i = 0;
    for (const std::string& line : linesOf(content(name))) {
      const std::size_t blank = line.find(' ');
      text += stamp(std::stod(line.substr(0, blank)), i++) + line.substr(blank) + "\n";
    }
    write(name, text);
  }

  slam::SlamOptions options() const {
    slam::SlamOptions options;
    options.dataset = toy();
    options.camera = (toy() / "calibration.yaml").string();
    options.output = folder_.path() / "out";
    options.features.features = 400;
    options.dense_map = false;
    options.write_report = false;
    options.quiet = true;
    return options;
  }

  hmcdyn::test::TemporaryFolder folder_;
};

}  // namespace hmcdyn::faults
