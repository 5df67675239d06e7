// SPDX-License-Identifier: BSD-3-Clause
// Kind 1: a ground truth that cannot be used is said, never left out in silence.
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fault_input.hpp"
#include "slam/run/input_check.hpp"
#include "slam/run/run.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

class Evaluation : public ToyFolder {
 protected:
  struct Unusable {
    const char* what;
    std::string text;
    std::vector<std::string> said;
  };

  static std::vector<Unusable> unusable() {
    return {
        {"KITTI's rows", "1 0 0 0 0 1 0 0 0 0 1 0\n", {"truth.txt:1: 12 fields", "KITTI"}},
        {"words", "this is no trajectory\n", {"truth.txt"}},
        {"a file of nothing", "# timestamp tx ty tz qx qy qz qw\n", {"holds no pose"}},
        {"NaN alone", "1000.0 nan nan nan nan nan nan nan\n", {"holds no pose", "1 with NaN"}},
        {"another recording",
         "5 0 0 0 0 0 0 1\n6 0 0 0 0 0 0 1\n",
         {"no pose at the frames' time"}},
        {"time that goes back", "1000.2 0 0 0 0 0 0 1\n1000.1 0 0 0 0 0 0 1\n", {"truth.txt:2:"}},
    };
  }
};

TEST_F(Evaluation, AGroundTruthThatTheUserNamedAndIsMissingIsAnErrorBeforeTheRun) {
  slam::SlamOptions options = this->options();
  options.groundtruth = toy() / "nosuch.txt";
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { slam::runSlam(options); }),
                       {"nosuch.txt", "No such file"}));
  EXPECT_FALSE(std::filesystem::exists(options.output));
}

TEST_F(Evaluation, OneThatTheUserNamedAndCannotBeUsedIsAnErrorWithTheReason) {
  for (const Unusable& kind : unusable()) {
    SCOPED_TRACE(kind.what);
    slam::SlamOptions options = this->options();
    options.groundtruth = write("truth.txt", kind.text);
    const std::string message =
        messageOf<std::runtime_error>([&] { slam::checkInput(options, false); });
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
}

TEST_F(Evaluation, TheDataSetsOwnThatCannotBeUsedIsAWarningInTheSummary) {
  write("groundtruth.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const nlohmann::json summary = slam::runSlam(options());
  EXPECT_FALSE(summary.contains("evaluation"));
  EXPECT_TRUE(oneMentions(summary.at("warnings").get<std::vector<std::string>>(),
                          {"no ATE", "groundtruth.txt:1", "KITTI"}));
}

TEST_F(Evaluation, AHeaderAMarkAndAPoseThatIsNoneDoNotMatter) {
  const std::string good = content("groundtruth.txt");
  slam::SlamOptions options = this->options();
  options.groundtruth = write("truth.txt", "\xEF\xBB\xBFtimestamp tx ty tz qx qy qz qw\n" + good +
                                               "1000.9 nan nan nan 0 0 0 0\n");
  const slam::RunInput input = slam::checkInput(options, false);
  EXPECT_EQ(input.groundtruth, options.groundtruth);
  EXPECT_TRUE(oneMentions(input.notes, {"1 of 9 lines are left out", "line 10"}));
}

}  // namespace
}  // namespace hmcdyn::faults
