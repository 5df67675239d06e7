// SPDX-License-Identifier: BSD-3-Clause
// examples/04_front_end.cpp as a user runs it: two men get up and walk, the camera moves.
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "evaluate/temporary_folder.hpp"
#include "shared_data.hpp"

namespace hmcdyn {
namespace {

constexpr const char* kClip = "data/fr3_walking_halfsphere_first50";
constexpr const char* kModel = "models/yolo-fastest-1.1/yolo-fastest-1.1.cfg";
constexpr const char* kWeights = "models/yolo-fastest-1.1/yolo-fastest-1.1.weights";

class FrontEnd : public evaluate::test::TemporaryFolder {
 protected:
  /// The program's exit code; its output is in the file `out`.
  int run(const std::string& arguments) const {
    const std::string command =
        HMCDYN_FRONT_END " " + arguments + " > '" + path("out").string() + "' 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

struct Line {
  double ate = 0.0;
  unsigned tracked = 0;
  unsigned frames = 0;
};

/// "with    the filter: ATE 0.0123 m, 49 of 49 frames tracked".
Line lineOf(const std::string& text, const char* start) {
  Line line;
  const std::size_t at = text.find(start);
  if (at != std::string::npos) {
    std::sscanf(text.c_str() + at, "%*s the filter: ATE %lf m, %u of %u", &line.ate, &line.tracked,
                &line.frames);
  }
  return line;
}

TEST_F(FrontEnd, WithTheFilterTheErrorIsHalvedAtLeastAndNoFrameIsLost) {
  HMCDYN_SKIP_WITHOUT_SHARED(kClip);
  HMCDYN_SKIP_WITHOUT_SHARED(kWeights);
  const int code =
      run("'" + test::sharedPath(kClip).string() + "' tum3 '" + test::sharedPath(kModel).string() +
          "' '" + test::sharedPath(kWeights).string() + "'");
  const std::string text = read(path("out"));
  ASSERT_EQ(code, 0) << text;
  const Line without = lineOf(text, "without ");
  const Line with = lineOf(text, "with  ");
  EXPECT_EQ(with.frames, 49U) << text;
  EXPECT_EQ(with.tracked, 49U) << text;
  EXPECT_GT(with.ate, 0.0) << text;
  EXPECT_LT(with.ate, 0.5 * without.ate) << text;
}

TEST_F(FrontEnd, SaysHowItIsUsedAndWhatIsMissing) {
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run("nowhere tum3 boxes.txt"), 1);
}

}  // namespace
}  // namespace hmcdyn
