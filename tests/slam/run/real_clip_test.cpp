// SPDX-License-Identifier: BSD-3-Clause
// The whole pipeline on real frames: two men get up and walk, the camera moves.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"

namespace hmcdyn::slam {
namespace {

constexpr const char* kClip = "data/fr3_walking_halfsphere_first50";
constexpr const char* kModel = "models/yolo-fastest-1.1/yolo-fastest-1.1.cfg";
constexpr const char* kWeights = "models/yolo-fastest-1.1/yolo-fastest-1.1.weights";

nlohmann::json runClip(FilterRule rule, const std::filesystem::path& output) {
  SlamOptions options;
  options.dataset = hmcdyn::test::sharedPath(kClip);
  options.camera = "tum3";
  options.detector.type = "darknet";
  options.detector.model = hmcdyn::test::sharedPath(kModel);
  options.detector.weights = hmcdyn::test::sharedPath(kWeights);
  options.detector.classes = {kPersonClassId};
  options.filter.rule = rule;
  options.output = output;
  options.quiet = true;
  return runSlam(options);
}

double ateOf(const nlohmann::json& summary) {
  return summary.at("evaluation").at("ate_m").at("rmse").get<double>();
}

// One test, so that the filtered run is made once.
TEST(RealClip, TheMenAreFoundNoFrameIsLostAndTheErrorIsHalvedAtLeast) {
  HMCDYN_SKIP_WITHOUT_SHARED(kClip);
  HMCDYN_SKIP_WITHOUT_SHARED(kWeights);
  const hmcdyn::test::TemporaryFolder folder;
  const nlohmann::json with = runClip(FilterRule::kHmc, folder.path() / "hmc");
  const nlohmann::json without = runClip(FilterRule::kNone, folder.path() / "none");

  const nlohmann::json& counts = with.at("counts");
  EXPECT_EQ(counts.at("frames_tracked"), 49);
  EXPECT_LE(ateOf(with), 0.030);
  EXPECT_LT(ateOf(with), 0.5 * ateOf(without));

  EXPECT_EQ(counts.at("frames_with_boxes"), 49);
  EXPECT_GE(counts.at("dynamic_boxes").get<int>(), 80);  // two men in 48 frames, some missed
  const auto share = [&](const char* label) {
    return counts.at("labels").at(label).get<double>() / counts.at("key_points").get<double>();
  };
  EXPECT_GT(share("static"), 0.5);
  EXPECT_GT(share("dynamic"), 0.1);
}

}  // namespace
}  // namespace hmcdyn::slam
