// SPDX-License-Identifier: BSD-3-Clause

#include <limits>
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
using test::invalidArgumentOf;
using test::withoutNaN;
using testing::HasSubstr;

void expectSame(const FrameFilterResult& actual, const FrameFilterResult& expected) {
  EXPECT_EQ(actual.keep, expected.keep);
  EXPECT_EQ(actual.weight, expected.weight);
  EXPECT_EQ(actual.details.stage.label, expected.details.stage.label);
  EXPECT_EQ(withoutNaN(actual.details.belief.belief), withoutNaN(expected.details.belief.belief));
}

TEST(FrameFilter, DropsWhatMovesAndKeepsTheWalls) {
  // Given
  const FilmedScene film;
  FrameFilter filter;
  // When
  const FrameFilterResult result = filterFilm(filter, film, film.boxes);
  // Then: of the thing hardly a point, of the walls hardly one less
  int thing = 0;
  int kept_of_thing = 0;
  int walls = 0;
  int kept_of_walls = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    (film.isThing(i) ? thing : walls) += 1;
    (film.isThing(i) ? kept_of_thing : kept_of_walls) += result.keep[i];
    EXPECT_EQ(result.keep[i] != 0, result.weight[i] > 0.0f);
  }
  ASSERT_GT(thing, 50);
  ASSERT_GT(walls, 300);
  EXPECT_LE(kept_of_thing, thing / 20);
  EXPECT_GE(kept_of_walls, walls * 19 / 20);
}

TEST(FrameFilter, IsTheLibrarysCallWithTheRightFramesAndMemory) {
  // Given every frame's pyramid and beliefs, kept by hand
  const FilmedScene film;
  const DynamicFeatureFilterOptions options;
  std::vector<FlowPyramid> pyramids;
  std::vector<MotionBelief> beliefs;
  std::vector<KeyPoints> points;
  DynamicFeatureFilterWorkspace workspace;
  FrameFilter filter;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    const FrameInput input = film.input(frame);
    pyramids.push_back(buildFlowPyramid(input.gray, options.flow));
    points.push_back(film.points);
    for (std::size_t i = 0; i < film.points.size(); ++i) {
      points.back().depth[i] = input.depth.at<float>(static_cast<int>(film.points.v[i]),
                                                     static_cast<int>(film.points.u[i]));
    }
    // the neighbour, and the frame 0.1 s ago: that is three before
    std::vector<EarlierFrame> earlier;
    for (const int ago : {1, 3}) {
      if (frame >= ago) {
        earlier.emplace_back();
        earlier.back().pyramid = &pyramids[static_cast<std::size_t>(frame - ago)];
        earlier.back().age = input.timestamp - film.input(frame - ago).timestamp;
      }
    }
    DynamicFeatureFilterInput by_hand;
    by_hand.pyramid = &pyramids.back();
    by_hand.points = points.back().view();
    by_hand.regions = film.boxes;
    by_hand.earlier = earlier;
    by_hand.depth = {input.depth.ptr<float>(), input.depth.cols, input.depth.rows,
                     input.depth.step1()};
    by_hand.memory = beliefs.empty() ? nullptr : &beliefs.back();
    const DynamicFeatureFilterResult expected = filterDynamicFeatures(by_hand, options, workspace);
    // When
    const FrameFilterResult result = filter.filter(input, film.boxes);
    // Then
    EXPECT_EQ(result.details.stage.label, expected.stage.label) << "frame " << frame;
    EXPECT_EQ(result.details.stage.weight, expected.stage.weight) << "frame " << frame;
    EXPECT_EQ(withoutNaN(result.details.belief.belief), withoutNaN(expected.belief.belief))
        << "frame " << frame;
    EXPECT_EQ(withoutNaN(result.details.distance), withoutNaN(expected.distance))
        << "frame " << frame;
    beliefs.push_back(expected.belief);
  }
}

TEST(FrameFilter, InTheFirstFrameWhatLiesInBoxesIsDropped) {
  const FilmedScene film;
  FrameFilter filter;
  const FrameFilterResult result = filter.filter(film.input(0), film.boxes);
  EXPECT_EQ(result.status, FrameFilterStatus::kNoHistory);
  EXPECT_TRUE(result.details.earlier.empty());
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    const bool in_box = film.boxes[0].contains(film.points.u[i], film.points.v[i]);
    EXPECT_EQ(result.keep[i], in_box ? 0 : 1) << i;
    EXPECT_EQ(result.weight[i], in_box ? 0.0f : 1.0f) << i;
    EXPECT_EQ(result.lambda[i], in_box ? 0.0f : 1.0f) << i;
    EXPECT_EQ(result.reason[i], in_box ? PointReason::kNoHistory : PointReason::kOutside) << i;
  }
}

TEST(FrameFilter, WithoutThatRuleTheFirstFrameKeepsEverything) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.drop_boxes_without_history = false;
  FrameFilter filter(options);
  const FrameFilterResult result = filter.filter(film.input(0), film.boxes);
  EXPECT_EQ(result.keep, std::vector<std::uint8_t>(film.points.size(), 1));
  EXPECT_EQ(result.weight, std::vector<float>(film.points.size(), 1.0f));
  EXPECT_EQ(result.kept, film.points.size());
}

TEST(FrameFilter, ATimeStampThatDoesNotRiseIsAStatusAndTheFilmGoesOn) {
  const FilmedScene film;
  FrameFilter filter;
  filter.filter(film.input(0), film.boxes);
  for (const double stamp : {0.0, -1.0, static_cast<double>(kNaN)}) {
    FrameInput input = film.input(1);
    input.timestamp = stamp;
    const FrameFilterResult result = filter.filter(input, film.boxes);
    EXPECT_EQ(result.status, FrameFilterStatus::kStampNotRising);
    for (std::size_t i = 0; i < film.points.size(); ++i) {  // as a first frame
      const bool in_box = film.boxes[0].contains(film.points.u[i], film.points.v[i]);
      EXPECT_EQ(result.keep[i], in_box ? 0 : 1) << i;
    }
  }
  FrameFilter untroubled;
  expectSame(filterFilm(filter, film, film.boxes, 1), filterFilm(untroubled, film, film.boxes));
}

TEST(FrameFilter, KeepsACopyOfTheImage) {
  // Given a front end that writes every frame into the same image
  const FilmedScene film;
  FrameFilter filter;
  FrameFilter with_own_images;
  cv::Mat shared_image;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    FrameInput input = film.input(frame);
    const FrameFilterResult expected = with_own_images.filter(input, film.boxes);
    input.gray.copyTo(shared_image);
    input.gray = shared_image;
    // When, then
    expectSame(filter.filter(input, film.boxes), expected);
    shared_image.setTo(0);
  }
}

TEST(FrameFilter, KeepsACopyOfTheDepthImageByWhichBoxesAreCarried) {
  // Given a front end that writes every depth image into the same memory, and a detector that sees
  // the thing in the first frame only
  const FilmedScene film;
  FrameFilter filter;
  FrameFilter with_own_images;
  cv::Mat shared_depth;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    FrameInput input = film.input(frame);
    const auto see = [&](FrameFilter& by) {
      return frame == 0 ? by.filter(input, film.boxes) : by.filter(input);
    };
    const FrameFilterResult expected = see(with_own_images);
    input.depth.copyTo(shared_depth);
    input.depth = shared_depth;
    // When
    const FrameFilterResult result = see(filter);
    // Then
    expectSame(result, expected);
    ASSERT_EQ(result.boxes.size(), 1U);
    EXPECT_EQ(result.boxes[0].x_min, expected.boxes[0].x_min);
    EXPECT_EQ(result.boxes[0].y_min, expected.boxes[0].y_min);
    shared_depth.setTo(0);
  }
}

TEST(FrameFilter, AfterAResetNothingIsKnown) {
  // Given
  const FilmedScene film;
  FrameFilter used;
  filterFilm(used, film, film.boxes);
  // When
  used.reset();
  // Then an earlier time stamp is welcome, and the film gives what it gives a new filter
  FrameFilter fresh;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    expectSame(used.filter(film.input(frame), film.boxes),
               fresh.filter(film.input(frame), film.boxes));
  }
}

TEST(FrameFilter, ReadsDepthsAtTheNearestPixelWhereNoneAreGiven) {
  // Given a key point on the wall in the box, nearest to a pixel with a depth of its own, and two
  // that have no pixel
  FilmedScene film;
  film.key_points.emplace_back(230.5f, 100.6f, 7.0f);
  film.key_points.emplace_back(319.6f, 10.0f, 7.0f);
  film.key_points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 1e20f, 7.0f);
  FrameFilterOptions options;
  options.expert.use_belief = false;
  options.soft_weight_gate = 0.0;  // eq. 7's weights, which depend on the depth
  const auto filmed = [&](bool given, float depth) {
    FrameFilter filter(options);
    FrameFilterResult result;
    for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
      FrameInput input = film.input(frame);
      input.depth.at<float>(101, 231) = 2.0f;
      std::vector<float> depths;
      for (std::size_t i = 0; i < film.points.size(); ++i) {  // on whole pixels
        depths.push_back(input.depth.at<float>(static_cast<int>(film.points.v[i]),
                                               static_cast<int>(film.points.u[i])));
      }
      depths.insert(depths.end(), {depth, 0.0f, 0.0f});
      input.point_depth = given ? Span<const float>(depths) : Span<const float>();
      result = filter.filter(input, film.boxes);
    }
    return result;
  };
  // When
  const FrameFilterResult read = filmed(false, 0.0f);
  // Then
  expectSame(read, filmed(true, 2.0f));
  const std::size_t point = film.points.size();
  ASSERT_EQ(read.details.stage.label[point], PointLabel::kSuspect);
  EXPECT_NE(read.weight[point], filmed(true, 3.0f).weight[point]);
}

TEST(FrameFilter, WorksWithoutADepthCamera) {
  const FilmedScene film;
  FrameFilter filter;
  FrameFilterResult result;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    FrameInput input = film.input(frame);
    input.depth = cv::Mat();
    result = filter.filter(input, film.boxes);
  }
  int kept_of_thing = 0;
  int thing = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    kept_of_thing += film.isThing(i) ? result.keep[i] : 0;
    thing += film.isThing(i) ? 1 : 0;
  }
  EXPECT_LE(kept_of_thing, thing / 20);
  EXPECT_EQ(result.details.belief.size(), 0U);
}

TEST(FrameFilter, TheBeliefsOfTheFrameComparedWithAreTheMemory) {
  // Given the baselines in falling order: the neighbour is still the frame with the memory
  const FilmedScene film;
  FrameFilterOptions options;
  options.baselines = {0.06, 0.0};
  FrameFilter falling(options);
  options.baselines = {0.0, 0.06};
  FrameFilter rising(options);
  const FrameFilterResult result = filterFilm(falling, film, film.boxes);
  expectSame(result, filterFilm(rising, film, film.boxes));
  EXPECT_EQ(result.details.earlier.size(), 2U);
  EXPECT_EQ(result.details.belief.size(), film.points.size());
}

TEST(FrameFilter, WithTheRuleNoneAllIsKept) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.rule = FilterRule::kNone;
  FrameFilter filter(options);
  const FrameFilterResult result = filterFilm(filter, film, film.boxes);
  EXPECT_EQ(result.keep, std::vector<std::uint8_t>(film.points.size(), 1));
  EXPECT_TRUE(result.details.earlier.empty());
}

TEST(FrameFilter, AFrameWithoutKeyPointsIsFine) {
  const FilmedScene film;
  FrameFilter filter;
  for (int frame = 0; frame < FilmedScene::kFrames; ++frame) {
    FrameInput input = film.input(frame);
    input.key_points = {};
    EXPECT_TRUE(filter.filter(input, film.boxes).keep.empty());
  }
}

TEST(FrameFilter, RefusesWhatItCannotUseAndForgetsIt) {
  const FilmedScene film;
  FrameFilter filter;
  filter.filter(film.input(0), film.boxes);
  const auto refusal = [&](auto change) {
    FrameInput input = film.input(1);
    change(input);
    return invalidArgumentOf([&] { filter.filter(input, film.boxes); });
  };
  EXPECT_THAT(refusal([](FrameInput& input) { input.depth.convertTo(input.depth, CV_16UC1); }),
              HasSubstr("CV_32FC1"));
  EXPECT_THAT(refusal([](FrameInput& input) { input.depth = cv::Mat::ones(2, 3, CV_32FC1); }),
              HasSubstr("depth is 3 x 2 px"));
  EXPECT_NE(refusal([](FrameInput& input) { input.gray = cv::Mat(); }), "nothing thrown");
  EXPECT_NE(refusal([](FrameInput& input) {
              input.gray = cv::Mat::zeros(120, 160, CV_8UC1);
              input.depth = cv::Mat();
            }),
            "nothing thrown");
  const std::vector<float> one_depth = {1.0f};
  EXPECT_THAT(refusal([&](FrameInput& input) { input.point_depth = one_depth; }),
              HasSubstr("1 depths"));
  EXPECT_THAT(invalidArgumentOf([] {
                FrameFilterOptions options;
                options.baselines = {0.0, -0.1};
                const FrameFilter bad(options);
              }),
              HasSubstr("baselines holds -0.1"));
  EXPECT_THAT(invalidArgumentOf([] {
                FrameFilterOptions options;
                options.max_followed = 23;
                const FrameFilter bad(options);
              }),
              HasSubstr("max_followed is 23.000000; expected 0 (all), or 24 points or more"));
  // Then the film goes on as if nothing had been
  FrameFilter untroubled;
  expectSame(filterFilm(filter, film, film.boxes, 1), filterFilm(untroubled, film, film.boxes));
}

}  // namespace
}  // namespace hmcdyn
