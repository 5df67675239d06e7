// SPDX-License-Identifier: BSD-3-Clause
// The camera's motion from arbitrary pairs of pixels, and the distances that it gives.
#include <stdexcept>
#include <vector>

#include <hmcdyn/steps/ego_motion.hpp>
#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/steps/fundamental.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloat;
using hmcdyn::fuzz::anyFloats;
using hmcdyn::fuzz::require;
using hmcdyn::fuzz::same;

hmcdyn::TwoViewOptions anyOptions(FuzzedDataProvider& data) {
  hmcdyn::TwoViewOptions options;
  options.max_iterations = 50;  // so that a run is short
  if (data.ConsumeBool()) {
    options.min_matches = data.ConsumeIntegralInRange<int>(7, 20);
    options.min_background_matches = data.ConsumeIntegralInRange<int>(0, 40);
    options.min_background_cells = data.ConsumeIntegralInRange<int>(0, 8);
    options.inlier_threshold = anyFloat(data, 0.1f, 3.0f);
    options.still_share = anyFloat(data, 0.1f, 1.0f);
    options.still_displacement = anyFloat(data, 0.0f, 2.0f);
    options.min_conditioning = anyFloat(data, 1.0f, 5.0f);
    options.min_homography_share = anyFloat(data, 0.0f, 1.0f);
    options.seed = data.ConsumeIntegral<std::uint8_t>();
  }
  return options;
}

struct Pairs {
  std::vector<float> earlier_u, earlier_v, current_u, current_v;

  hmcdyn::PointPairsView view() const { return {earlier_u, earlier_v, current_u, current_v}; }
};

/// Points that move as those before a camera do, but for some: no motion at all, one of the image
/// as a whole, or one that grows with nearness. All from the input.
Pairs anyPairs(FuzzedDataProvider& data) {
  Pairs pairs;
  const int n = data.ConsumeIntegralInRange<int>(0, 120);
  const float shift_u = anyFloat(data, -5.0f, 5.0f);
  const float shift_v = anyFloat(data, -5.0f, 5.0f);
  const float parallax = anyFloat(data, -20.0f, 20.0f);
  for (int i = 0; i < n; ++i) {
    const float u = anyFloat(data, 0.0f, 100.0f);
    const float v = anyFloat(data, 0.0f, 100.0f);
    const float nearness = static_cast<float>(data.ConsumeIntegral<std::uint8_t>()) / 255.0f;
    const bool own_way = data.ConsumeIntegralInRange<int>(0, 7) == 0;
    pairs.current_u.push_back(u);
    pairs.current_v.push_back(v);
    pairs.earlier_u.push_back(own_way ? anyFloat(data, 0.0f, 100.0f)
                                      : u + shift_u + parallax * nearness);
    pairs.earlier_v.push_back(own_way ? anyFloat(data, 0.0f, 100.0f) : v + shift_v);
  }
  return pairs;
}

void checkDistances(const std::vector<float>& distance, std::size_t n) {
  require(distance.size() == n, "a distance a pair");
  for (const float pixels : distance) {
    require(std::isnan(pixels) || (pixels >= 0.0f && std::isfinite(pixels)),
            "a distance is finite and >= 0, or NaN");
  }
}

void measureEgoMotion(FuzzedDataProvider& data, const Pairs& pairs) {
  const std::size_t n = pairs.current_u.size();
  hmcdyn::PinholeCamera camera;
  camera.fx = static_cast<double>(anyFloat(data, 10.0f, 500.0f));
  camera.fy = static_cast<double>(anyFloat(data, 10.0f, 500.0f));
  camera.cx = static_cast<double>(anyFloat(data, 0.0f, 100.0f));
  camera.cy = static_cast<double>(anyFloat(data, 0.0f, 100.0f));
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translation().x() = static_cast<double>(anyFloat(data, -1.0f, 1.0f));
  motion.translation().z() = static_cast<double>(anyFloat(data, -1.0f, 1.0f));
  const std::vector<float> earlier_depth = anyFloats(data, n, 0.0f, 6.0f);
  const std::vector<float> current_depth = anyFloats(data, n, 0.0f, 6.0f);
  checkDistances(egoMotionDistances(camera, motion, pairs.view(), earlier_depth, current_depth), n);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const hmcdyn::TwoViewOptions options = anyOptions(data);
  const std::vector<hmcdyn::DetectionBox> boxes = hmcdyn::fuzz::anyBoxes(data, 3);
  const Pairs pairs = anyPairs(data);
  const std::size_t n = pairs.current_u.size();
  try {
    const hmcdyn::TwoViewEstimate motion = estimateTwoViewModel(pairs.view(), boxes, options);
    require(motion.matches <= n && motion.inliers <= motion.matches, "inliers are matches");
    require(
        !motion.fundamentalDefined() || motion.model.kind == hmcdyn::TwoViewModelKind::kFundamental,
        "where F is defined, it is the model");
    const std::vector<float> distance = modelDistances(motion.model, pairs.view());
    checkDistances(distance, n);
    const hmcdyn::TwoViewEstimate again = estimateTwoViewModel(pairs.view(), boxes, options);
    require(same(modelDistances(again.model, pairs.view()), distance),
            "the same input and seed give the same model");
  } catch (const std::invalid_argument&) {  // as documented
  }
  measureEgoMotion(data, pairs);
  return 0;
}
