// SPDX-License-Identifier: BSD-3-Clause
// Every installed program as a user meets it: help, version, and a misspelled option.
#include <array>
#include <cstdio>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <hmcdyn/version.hpp>

namespace hmcdyn {
namespace {

using testing::HasSubstr;

struct Outcome {
  int exit_code = -1;
  std::string text;  ///< Standard output and error.
};

Outcome run(const std::string& arguments) {
  const std::string command = HMCDYN_BIN "/" + arguments + " 2>&1";
  Outcome outcome;
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return outcome;
  }
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
    outcome.text += buffer.data();
  }
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

struct Misspelled {
  const char* call;
  const char* option;
  const char* meant;
};

const std::vector<std::string> kHelps = {"hmcdyn_slam",
                                         "hmcdyn_evaluate",
                                         "hmcdyn_evaluate ate",
                                         "hmcdyn_evaluate rpe",
                                         "hmcdyn_evaluate summary",
                                         "hmcdyn_synthesize",
                                         "hmcdyn_label_score",
                                         "hmcdyn_map_score",
                                         "hmcdyn_tables",
                                         "hmcdyn_calibrate_depth",
                                         "hmcdyn_mask",
                                         "hmcdyn_mask_score"};

TEST(Tools, SuggestTheNearestOption) {
  const Misspelled cases[] = {{"hmcdyn_slam --filtr hmc", "--filtr", "--filter"},
                              {"hmcdyn_evaluate ate --estimat x", "--estimat", "--estimate"},
                              {"hmcdyn_synthesize --scnee crowd", "--scnee", "--scene"},
                              {"hmcdyn_label_score a:b --margni 2", "--margni", "--margin"},
                              {"hmcdyn_mask --datset d", "--datset", "--dataset"},
                              {"hmcdyn_mask_score a:b --egde 2", "--egde", "--edge"},
                              {"hmcdyn_map_score a b --radus 1", "--radus", "--radius"},
                              {"hmcdyn_tables --rendred", "--rendred", "--rendered"},
                              {"hmcdyn_calibrate_depth --polt x", "--polt", "--plot"}};
  for (const Misspelled& one : cases) {
    const Outcome outcome = run(one.call);
    EXPECT_EQ(outcome.exit_code, 2) << one.call;
    EXPECT_THAT(outcome.text, HasSubstr(std::string("unknown option ") + one.option +
                                        "; did you mean " + one.meant + "?"));
    EXPECT_THAT(outcome.text, HasSubstr("--help"));
  }
}

TEST(Tools, SayTheirVersion) {
  for (const std::string& call : kHelps) {
    if (call.find(' ') == std::string::npos) {
      const Outcome outcome = run(call + " --version");
      EXPECT_EQ(outcome.exit_code, 0) << call;
      EXPECT_EQ(outcome.text, "hmcdyn " HMCDYN_VERSION_STRING "\n") << call;
    }
  }
}

/// The options of a help, each with its text in one line.
std::vector<std::string> optionsIn(const std::string& help) {
  std::vector<std::string> options;
  std::istringstream lines(help);
  bool in_option = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  -", 0) == 0) {
      options.push_back(line);
      in_option = true;
    } else if (in_option && line.rfind("      ", 0) == 0) {
      options.back() += " " + line.substr(line.find_first_not_of(' '));
    } else {
      in_option = false;
    }
  }
  return options;
}

int words(const std::string& text) {
  std::istringstream stream(text);
  int count = 0;
  for (std::string word; stream >> word;) {
    count += word == "REQUIRED" || word == "..." ? 0 : 1;
  }
  return count;
}

TEST(Tools, EveryNumberHasItsDefaultInTheHelpAndEveryOptionAText) {
  // A number is of the type FLOAT, INT or UINT, or, in hmcdyn_evaluate, S, D, N or UNIT.
  const std::regex number("^  \\S+ (FLOAT|INT|UINT|ENUM|S|D|UNIT)\\b.*");
  for (const std::string& call : kHelps) {
    const Outcome help = run(call + " --help");
    EXPECT_EQ(help.exit_code, 0) << call;
    const std::vector<std::string> options = optionsIn(help.text);
    EXPECT_GE(options.size(), 2U) << call;
    for (const std::string& option : options) {
      EXPECT_GE(words(option), 3) << call << ": " << option;  // name, type, and a text
      if (std::regex_match(option, number)) {
        EXPECT_TRUE(option.find('=') != std::string::npos ||
                    option.find("efault") != std::string::npos)
            << call << " has no default: " << option;
      }
    }
  }
}

}  // namespace
}  // namespace hmcdyn
