// SPDX-License-Identifier: BSD-3-Clause
// The whole pipeline on rendered sequences, whose truth is exact.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "run/rendered_sequence.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"

namespace hmcdyn::slam {
namespace {

class Rendered : public testing::Test {
 protected:
  /// Tracks a sequence and returns its ATE RMSE (m); every frame must be tracked.
  double track(const std::filesystem::path& sequence, FilterRule rule) const {
    SlamOptions options;
    options.dataset = sequence;
    options.camera = (sequence / "calibration.yaml").string();
    options.detector.type = "file";
    options.detector.boxes = sequence / "boxes.txt";
    options.filter.rule = rule;
    options.output = folder_.path() / "out";
    options.quiet = true;
    const nlohmann::json summary = runSlam(options);
    EXPECT_EQ(summary.at("counts").at("frames_tracked"), summary.at("counts").at("frames_in"));
    return summary.at("evaluation").at("ate_m").at("rmse").get<double>();
  }

  std::filesystem::path render(const std::string& scene, int frames, bool noise) const {
    return hmcdyn::test::renderedSequence(
        folder_.path(), scene, frames,
        noise ? synthesize::NoiseModel::kKinect : synthesize::NoiseModel::kNone);
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Rendered, AnEmptyRoomWithoutNoiseIsTrackedToAMillimetre) {
  EXPECT_LT(track(render("empty", 30, false), FilterRule::kNone), 0.001);
}

TEST_F(Rendered, InACrowdTheFilterTakesAwayMostOfTheError) {
  const std::filesystem::path crowd = render("crowd", 30, true);
  const double without = track(crowd, FilterRule::kNone);
  EXPECT_LT(track(crowd, FilterRule::kHmc), 0.5 * without);
}

}  // namespace
}  // namespace hmcdyn::slam
