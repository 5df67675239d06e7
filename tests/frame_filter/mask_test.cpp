// SPDX-License-Identifier: BSD-3-Clause
// FrameFilter with masks in place of boxes.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <hmcdyn/frame_filter.hpp>

#include "filmed_scene.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using test::FilmedScene;
using test::filterFilm;
using test::LayeredScene;
using test::withoutNaN;

const std::vector<LabelRegion> kThing = {{7, kPersonClassId, 1.0f}};

FrameFilterOptions withoutBeliefs() {
  FrameFilterOptions options;
  options.expert.use_belief = false;
  return options;
}

TEST(MaskFilter, TheWallBesideTheThingCountsFullyWhereABoxWouldDoubtIt) {
  // Given
  const FilmedScene film;
  FrameFilter by_mask(withoutBeliefs());
  FrameFilter by_box(withoutBeliefs());
  // When
  const FrameFilterResult mask =
      filterFilm(by_mask, film, Regions{FilmedScene::maskOfThing(), kThing});
  const FrameFilterResult box = filterFilm(by_box, film, film.boxes);
  // Then
  int in_box = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    if (film.isThing(i)) {
      EXPECT_EQ(mask.details.stage.label[i], box.details.stage.label[i]) << "point " << i;
      continue;
    }
    EXPECT_EQ(mask.details.stage.label[i], PointLabel::kStatic) << "point " << i;
    EXPECT_EQ(mask.weight[i], 1.0f) << "point " << i;
    in_box += box.details.stage.label[i] != PointLabel::kStatic ? 1 : 0;
  }
  EXPECT_GT(in_box, 20);
}

TEST(MaskFilter, DropsWhatMovesWithBeliefs) {
  const FilmedScene film;
  FrameFilter filter;
  const FrameFilterResult result =
      filterFilm(filter, film, Regions{FilmedScene::maskOfThing(), kThing});
  int thing = 0;
  int kept_of_thing = 0;
  int walls = 0;
  int kept_of_walls = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    (film.isThing(i) ? thing : walls) += 1;
    (film.isThing(i) ? kept_of_thing : kept_of_walls) += result.keep[i];
  }
  EXPECT_LE(kept_of_thing, thing / 20);
  EXPECT_GE(kept_of_walls, walls * 19 / 20);
  EXPECT_EQ(result.details.belief.size(), film.points.size());
}

TEST(MaskFilter, AMaskThatFillsTheBoxGivesTheResultOfTheBox) {
  // Given
  const FilmedScene film;
  const DetectionBox& box = film.boxes.front();
  Regions mask{cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_16UC1), kThing};
  const cv::Point first(static_cast<int>(box.x_min), static_cast<int>(box.y_min));
  const cv::Point last(static_cast<int>(box.x_max), static_cast<int>(box.y_max));
  mask.labels(cv::Rect(first, last + cv::Point(1, 1))).setTo(7);
  for (const bool belief : {false, true}) {
    FrameFilterOptions options;
    options.expert.use_belief = belief;
    FrameFilter by_mask(options);
    FrameFilter by_box(options);
    // When
    const FrameFilterResult expected = filterFilm(by_box, film, film.boxes);
    const FrameFilterResult result = filterFilm(by_mask, film, mask);
    // Then
    EXPECT_EQ(result.keep, expected.keep) << "belief " << belief;
    EXPECT_EQ(result.weight, expected.weight) << "belief " << belief;
    EXPECT_EQ(result.details.stage.label, expected.details.stage.label) << "belief " << belief;
    EXPECT_EQ(withoutNaN(result.details.belief.belief), withoutNaN(expected.details.belief.belief))
        << "belief " << belief;
    EXPECT_GT(expected.details.stage.frame.dynamic, 50U) << "belief " << belief;
  }
}

TEST(MaskFilter, WithoutALimitEveryPointOfARegionIsMeasured) {
  // Given
  const FilmedScene film;
  FrameFilterOptions options;
  options.max_followed = 0;
  FrameFilter filter(options);
  // When
  const FrameFilterResult result =
      filterFilm(filter, film, Regions{FilmedScene::maskOfThing(), kThing});
  // Then
  int thing = 0;
  int measured = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    thing += film.isThing(i) ? 1 : 0;
    measured += film.isThing(i) && !std::isnan(result.details.distance[i]) ? 1 : 0;
  }
  EXPECT_GE(measured, thing * 19 / 20);
}

TEST(MaskFilter, ThePeersRulesFormNoBeliefs) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.rule = FilterRule::kBox;
  FrameFilter filter(options);
  const FrameFilterResult result =
      filterFilm(filter, film, Regions{FilmedScene::maskOfThing(), kThing});
  EXPECT_EQ(result.details.belief.size(), 0U);
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    EXPECT_EQ(result.keep[i], film.isThing(i) ? 0 : 1) << "point " << i;
  }
}

TEST(MaskFilter, AMaskWithoutTheRegionsKeepsEverything) {
  const FilmedScene film;
  FrameFilter filter;
  const Regions mask{cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_8UC1), kThing};
  const FrameFilterResult result = filterFilm(filter, film, mask);
  EXPECT_EQ(result.keep, std::vector<std::uint8_t>(film.points.size(), 1));
}

TEST(MaskFilter, RefusesAMaskOfAnotherSizeOrType) {
  const FilmedScene film;
  FrameFilter filter;
  const auto refusal = [&](const cv::Mat& labels) {
    return test::invalidArgumentOf([&] { filter.filter(film.input(0), Regions{labels, kThing}); });
  };
  EXPECT_THAT(refusal(cv::Mat::zeros(10, 10, CV_8UC1)), testing::HasSubstr("labels is 10 x 10"));
  EXPECT_NE(refusal(cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_32FC1)),
            "nothing thrown");
  EXPECT_NE(refusal(cv::Mat()), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn
