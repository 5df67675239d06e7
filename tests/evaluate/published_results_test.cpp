// SPDX-License-Identifier: BSD-3-Clause
// Estimates that another group published, with what TUM's own tools printed for them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/relative_pose_error.hpp"
#include "shared_data.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

/// What a TUM tool printed: lines `name value unit`.
using Printed = std::map<std::string, double>;

Printed readPrinted(const std::filesystem::path& file) {
  Printed printed;
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::string name;
    double value = 0.0;
    if (fields >> name >> value) {
      printed[name] = value;
    }
  }
  return printed;
}

void expectPrinted(const Statistics& statistics, const Printed& printed, const std::string& name,
                   double tolerance) {
  EXPECT_EQ(static_cast<double>(statistics.count), printed.at("compared_pose_pairs"));
  EXPECT_NEAR(statistics.rmse, printed.at(name + ".rmse"), tolerance);
  EXPECT_NEAR(statistics.mean, printed.at(name + ".mean"), tolerance);
  EXPECT_NEAR(statistics.std, printed.at(name + ".std"), tolerance);
  EXPECT_NEAR(statistics.min, printed.at(name + ".min"), tolerance);
  EXPECT_NEAR(statistics.max, printed.at(name + ".max"), tolerance);
}

class PublishedResults : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    HMCDYN_SKIP_WITHOUT_SHARED("eval/published/" + GetParam());
    const std::filesystem::path folder = hmcdyn::test::sharedPath("eval/published/" + GetParam());
    groundtruth_ =
        readTrajectory(hmcdyn::test::sharedPath("eval/groundtruth/" + GetParam() + ".txt"));
    estimate_ = readTrajectory(folder / "estimate.txt");
    ate_ = readPrinted(folder / "ate.txt");
    rpe_ = readPrinted(folder / "rpe.txt");
  }

  Trajectory groundtruth_;
  Trajectory estimate_;
  Printed ate_;
  Printed rpe_;
};

TEST_P(PublishedResults, AgreeOnTheAbsoluteTrajectoryError) {
  const AteResult result = absoluteTrajectoryError(groundtruth_, estimate_);
  expectPrinted(result.error, ate_, "absolute_translational_error", 1e-6);
  EXPECT_NEAR(result.error.median, ate_.at("absolute_translational_error.median"), 1e-4);
}

TEST_P(PublishedResults, AgreeOnTheRelativePoseError) {
  const RpeResult result = relativePoseError(groundtruth_, estimate_);
  expectPrinted(result.translation, rpe_, "translational_error", 1e-6);
  EXPECT_NEAR(result.translation.median, rpe_.at("translational_error.median"), 1e-4);
  expectPrinted(result.rotation, rpe_, "rotational_error", 1e-5);
  // The tool prints this one in radians, though it says degrees: six decimals are 6e-5 degrees.
  EXPECT_NEAR(result.rotation.median, rpe_.at("rotational_error.median") * kDegreesPerRadian, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Sequences, PublishedResults,
                         testing::Values("fr3_sitting_static", "fr3_walk_halfsphere",
                                         "fr3_walk_xyz"),
                         [](const auto& sequence) { return sequence.param; });

}  // namespace
}  // namespace hmcdyn::evaluate
