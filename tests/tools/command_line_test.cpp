// SPDX-License-Identifier: BSD-3-Clause
// What all programs do with a command line that they do not understand.
#include "support/command_line.hpp"

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::support {
namespace {

const std::vector<std::string> kOptions = {"--filter", "--features",        "--output",
                                           "--seed",   "--cluster-epsilon", "--cluster-min-points"};

TEST(Nearest, FindsALetterTooFewTooManyWrongOrSwapped) {
  EXPECT_EQ(nearest("--filtr", kOptions), "--filter");
  EXPECT_EQ(nearest("--fillter", kOptions), "--filter");
  EXPECT_EQ(nearest("--output5", kOptions), "--output");
  EXPECT_EQ(nearest("--sead", kOptions), "--seed");
  EXPECT_EQ(nearest("--otuput", kOptions), "--output");
}

TEST(Nearest, FindsWhatTheWordBegins) {
  EXPECT_EQ(nearest("--cluster-min", kOptions), "--cluster-min-points");
  EXPECT_EQ(nearest("--cluster", kOptions), "--cluster-epsilon");  // the first of two
}

TEST(Nearest, TakesTheOneThatDiffersLeast) {
  EXPECT_EQ(nearest("--abcdxy", {"--abcdef", "--abcdxz"}), "--abcdxz");
}

TEST(Nearest, FindsNothingWhereTooMuchDiffers) {
  EXPECT_EQ(nearest("--zzz", kOptions), std::nullopt);
  EXPECT_EQ(nearest("--send", {"--sxyd"}), std::nullopt);  // two of four letters
  EXPECT_EQ(nearest("-g", {"-h"}), std::nullopt);
  EXPECT_EQ(nearest("--", kOptions), std::nullopt);
  EXPECT_EQ(nearest("", kOptions), std::nullopt);
  EXPECT_EQ(nearest("--filter", {}), std::nullopt);
}

/// A program with a required option, a number and a command.
struct Program {
  Program() {
    app.add_option("--output", output)->required();
    app.add_option("--speed", speed);
  }
  std::string unknownOf(const std::vector<const char*>& arguments) {
    std::vector<const char*> argv = {"program"};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    try {
      app.parse(static_cast<int>(argv.size()), argv.data());
    } catch (const CLI::ParseError&) {
    }
    return describeUnknown(app);
  }

  CLI::App app{"", "program"};
  std::string output;
  double speed = 1.0;
};

TEST(DescribeUnknown, NamesTheMisspelledOptionWhereAnotherIsMissing) {
  EXPECT_EQ(Program().unknownOf({"--ouput", "folder"}),
            "unknown option --ouput; did you mean --output?\n");
}

TEST(DescribeUnknown, NamesEveryUnknownOptionWithoutItsValue) {
  EXPECT_EQ(Program().unknownOf({"--output", "folder", "--sped=2", "--colour", "blue"}),
            "unknown option --sped; did you mean --speed?\nunknown option --colour\n");
}

TEST(DescribeUnknown, SaysNothingOfNumbersAndOfWhatIsKnown) {
  EXPECT_EQ(Program().unknownOf({"--output", "folder", "--speed", "-2"}), "");
  EXPECT_EQ(Program().unknownOf({"--output", "folder", "-5"}), "");
  EXPECT_EQ(Program().unknownOf({"--speed", "fast"}), "");
}

TEST(DescribeUnknown, SuggestsACommand) {
  Program program;
  program.app.add_subcommand("summary");
  EXPECT_EQ(program.unknownOf({"sumary", "-g", "x"}),
            "unknown command sumary; did you mean summary?\n");
}

TEST(DescribeUnknown, KnowsTheOptionsOfTheCommand) {
  Program program;
  program.app.add_subcommand("rpe")->add_flag("--delta");
  EXPECT_EQ(program.unknownOf({"--output", "folder", "rpe", "--detla"}),
            "unknown option --detla; did you mean --delta?\n");
}

TEST(ParseCommandLine, GoesOnWhereAllIsKnown) {
  Program program;
  const char* const argv[] = {"program", "--output", "folder"};
  EXPECT_EQ(parseCommandLine(program.app, 3, argv), std::nullopt);
  EXPECT_EQ(program.output, "folder");
}

TEST(ParseCommandLine, EndsWithBadUsageAfterACheckThatFails) {
  Program program;
  const char* const argv[] = {"program", "--output", "folder"};
  EXPECT_EQ(parseCommandLine(program.app, 3, argv,
                             [] { throw CLI::ValidationError("--speed", "is too high"); }),
            kBadUsage);
}

TEST(ParseCommandLine, LeavesTwoBlanksBetweenAnOptionAndItsText) {
  // Given names that end two columns before the text, one column before it, and beyond it
  CLI::App app("", "program");
  bool flag = true;
  app.get_formatter()->column_width(12);
  app.add_flag("--six234", "Text");
  app.add_flag("--seven23", "Text");
  app.add_flag("--longer-than-that", "Text");
  app.add_flag("!--no", flag, "Text");
  const char* const argv[] = {"program"};
  ASSERT_EQ(parseCommandLine(app, 1, argv), std::nullopt);
  // When
  const std::string help = app.help();
  // Then
  for (const char* const expected :
       {"\n  --six234  Text\n", "\n  --seven23\n            Text\n",
        "\n  --longer-than-that\n            Text\n", "\n  --no      Text\n"}) {
    EXPECT_NE(help.find(expected), std::string::npos) << expected << help;
  }
}

}  // namespace
}  // namespace hmcdyn::support
