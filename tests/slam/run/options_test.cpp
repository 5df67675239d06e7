// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/options.hpp"

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

// A field that is forgotten leaves its part with the error of another camera, and nobody sees it.
TEST(SlamOptions, EveryPartThatWeighsDepthsHasTheCamerasError) {
  DepthErrorModel camera;
  camera.systematic_quadratic = 0.0025f;
  const SlamOptions options = withDepthError({}, camera);
  for (const DepthErrorModel& model :
       {options.tracker.map.depth_error, options.mapping.adjustment.depth_error,
        options.loops.detector.verification.ransac.depth_error,
        options.loops.closer.bundle.depth_error, options.loops.relocalizer.ransac.depth_error}) {
    EXPECT_EQ(model.systematic_quadratic, 0.0025f);
  }
}

}  // namespace
}  // namespace hmcdyn::slam
