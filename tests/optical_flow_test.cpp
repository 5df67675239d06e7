// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/steps/optical_flow.hpp>

#include "invalid_argument.hpp"
#include "texture.hpp"

namespace hmcdyn {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

OpticalFlowOptions fixedOptions() {
  OpticalFlowOptions options;
  options.window = 21;
  options.max_level = 2;
  options.max_iterations = 30;
  options.epsilon = 0.01f;
  options.forward_backward = true;
  options.max_forward_backward_error = 0.5f;
  options.max_difference = 255.0f;
  return options;
}

/// The texture moved by (dx, dy).
cv::Mat movedTexture(double dx, double dy, std::uint32_t seed = 1) {
  const test::Texture texture(seed);
  return test::drawImage(kWidth, kHeight,
                         [&](double x, double y) { return texture(x - dx, y - dy); });
}

/// Key points every 8 pixels, `margin` away from the border.
KeyPoints gridPoints(int margin) {
  KeyPoints points;
  for (int v = margin; v < kHeight - margin; v += 8) {
    for (int u = margin; u < kWidth - margin; u += 8) {
      points.push_back(static_cast<float>(u) + 0.3f, static_cast<float>(v) - 0.2f, 1.0f);
    }
  }
  return points;
}

FlowMatches track(const cv::Mat& current, const cv::Mat& earlier, const KeyPoints& points,
                  const OpticalFlowOptions& options = fixedOptions()) {
  return trackIntoEarlierFrame(buildFlowPyramid(current, options),
                               buildFlowPyramid(earlier, options), points.view(), options);
}

TEST(OpticalFlow, FindsKnownShifts) {
  const KeyPoints points = gridPoints(30);
  for (const cv::Point2d shift : {cv::Point2d(0.0, 0.0), cv::Point2d(0.25, -0.6),
                                  cv::Point2d(3.7, 1.4), cv::Point2d(-8.5, 6.25)}) {
    // Given a current image that is the earlier one moved by `shift`
    const FlowMatches matches = track(movedTexture(shift.x, shift.y), movedTexture(0, 0), points);

    // Then each key point came from that far back.
    EXPECT_EQ(matches.found, points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(matches.u[i], points.u[i] - shift.x, 0.05) << "shift " << shift;
      EXPECT_NEAR(matches.v[i], points.v[i] - shift.y, 0.05) << "shift " << shift;
    }
  }
}

TEST(OpticalFlow, PointsOutsideOrNotFiniteAreLost) {
  const float infinity = std::numeric_limits<float>::infinity();
  KeyPoints points;
  points.push_back(-0.5f, 50.0f, 1.0f);
  points.push_back(80.0f, 119.5f, 1.0f);
  points.push_back(1e9f, 50.0f, 1.0f);
  points.push_back(kNaN, 50.0f, 1.0f);
  points.push_back(80.0f, -infinity, 1.0f);
  points.push_back(80.0f, 60.0f, kNaN);  // depth does not matter
  const FlowMatches matches = track(movedTexture(0, 0), movedTexture(0, 0), points);
  ASSERT_EQ(matches.u.size(), 6U);
  EXPECT_EQ(matches.found, 1U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(std::isnan(matches.u[i])) << "point " << i;
    EXPECT_TRUE(std::isnan(matches.v[i])) << "point " << i;
  }
  EXPECT_NEAR(matches.u[5], 80.0, 0.05);
}

TEST(OpticalFlow, PointsThatWereNotInTheEarlierImageAreLost) {
  // Given shifts to the right: what is left of column `shift` now was outside before.
  for (const float shift : {2.0f, 4.0f, 6.0f, 9.0f}) {
    KeyPoints points;
    for (int v = 20; v < 100; v += 4) {
      for (const float share : {0.1f, 0.4f, 0.7f}) {
        points.push_back(share * shift, static_cast<float>(v), 1.0f);
      }
    }
    const FlowMatches matches =
        track(movedTexture(static_cast<double>(shift), 0.0), movedTexture(0.0, 0.0), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_FALSE(matches.u[i] < 0.0f) << "shift " << shift << " point " << points.u[i];
    }
  }
}

TEST(OpticalFlow, APyramidDependsOnItsImageAlone) {
  // Given a part of a larger image, and a copy of that part
  const cv::Mat large = movedTexture(0.0, 0.0);
  const cv::Rect part(30, 30, 100, 60);
  const cv::Mat alone = large(part).clone();
  KeyPoints points;
  for (int u = 2; u < 98; u += 6) {
    points.push_back(static_cast<float>(u), 3.0f, 1.0f);
  }
  const OpticalFlowOptions options = fixedOptions();
  const FlowPyramid earlier = buildFlowPyramid(movedTexture(2.0, 1.0)(part).clone(), options);
  const FlowPyramid of_part = buildFlowPyramid(large(part), options);
  const FlowPyramid of_copy = buildFlowPyramid(alone, options);

  // When the large image is written over
  cv::Mat(large).setTo(cv::Scalar(0));

  // Then both give the same matches.
  const FlowMatches a = trackIntoEarlierFrame(of_part, earlier, points.view(), options);
  const FlowMatches b = trackIntoEarlierFrame(of_copy, earlier, points.view(), options);
  ASSERT_GT(b.found, 0U);
  EXPECT_EQ(a.found, b.found);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(a.u[i] == b.u[i] || (std::isnan(a.u[i]) && std::isnan(b.u[i]))) << "point " << i;
  }
}

TEST(OpticalFlow, WithoutTextureEverythingIsLost) {
  const cv::Mat flat(kHeight, kWidth, CV_8UC1, cv::Scalar(77));
  const FlowMatches matches = track(flat, flat, gridPoints(10));
  EXPECT_EQ(matches.found, 0U);
  for (const float u : matches.u) {
    EXPECT_TRUE(std::isnan(u));
  }
}

TEST(OpticalFlow, UnrelatedImagesFailTheForwardBackwardCheck) {
  const KeyPoints points = gridPoints(20);
  OpticalFlowOptions strict = fixedOptions();
  strict.max_forward_backward_error = 0.1f;
  const FlowMatches matches = track(movedTexture(0, 0, 1), movedTexture(0, 0, 2), points, strict);
  EXPECT_LT(matches.found, points.size() / 2);
}

TEST(OpticalFlow, AMatchWhoseWindowChangedIsDropped) {
  // Given an image of which the right half is 30 gray levels brighter in the earlier frame: a match
  // stays where it is, but its window differs by 30 (clipped at 255, a little less).
  const cv::Mat current = movedTexture(0, 0);
  cv::Mat earlier = current.clone();
  earlier.colRange(kWidth / 2, kWidth) += cv::Scalar(30);
  OpticalFlowOptions options = fixedOptions();
  options.window = 11;
  options.max_level = 0;
  options.forward_backward = false;
  KeyPoints points;
  for (int v = 20; v < 100; v += 8) {
    points.push_back(30.0f, static_cast<float>(v), 1.0f);
    points.push_back(130.0f, static_cast<float>(v), 1.0f);
  }

  // When both are accepted, and when a difference above 12 gray levels is not
  options.max_difference = 255.0f;
  const FlowMatches all = track(current, earlier, points, options);
  options.max_difference = 12.0f;
  const FlowMatches alike = track(current, earlier, points, options);

  // Then the left half's matches are left, exactly as they were.
  std::size_t bright = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.u[i] < kWidth / 2.0f) {
      EXPECT_EQ(alike.u[i], all.u[i]) << "point " << i;
      EXPECT_FALSE(std::isnan(alike.u[i])) << "point " << i;
    } else {
      EXPECT_TRUE(std::isnan(alike.u[i])) << "point " << i;
      bright += std::isnan(all.u[i]) ? 0 : 1;
    }
  }
  EXPECT_GT(bright, 0U);
  EXPECT_EQ(alike.found, points.size() / 2);
}

/// Tracks with guesses at the true place, moved by (du, dv).
FlowMatches trackGuessed(const cv::Point2f& shift, const cv::Point2f& error,
                         const KeyPoints& points, const OpticalFlowOptions& options) {
  FlowMatches guess;
  for (std::size_t i = 0; i < points.size(); ++i) {
    guess.u.push_back(points.u[i] - shift.x + error.x);
    guess.v.push_back(points.v[i] - shift.y + error.y);
  }
  const cv::Mat current = movedTexture(static_cast<double>(shift.x), static_cast<double>(shift.y));
  return trackIntoEarlierFrame(buildFlowPyramid(current, options),
                               buildFlowPyramid(movedTexture(0, 0), options), points.view(),
                               options, guess);
}

std::size_t countRight(const FlowMatches& matches, const KeyPoints& points,
                       const cv::Point2f& shift) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    right += std::hypot(matches.u[i] - points.u[i] + shift.x,
                        matches.v[i] - points.v[i] + shift.y) < 0.2f
                 ? 1
                 : 0;
  }
  return right;
}

TEST(OpticalFlow, AGuessFindsWhatMovedBeyondTheWindow) {
  // Given a motion of 25 px, where a window of 11 px at level 0 and 1 sees 10 or so
  OpticalFlowOptions options = fixedOptions();
  options.window = 11;
  options.max_level = 1;
  options.guess_max_level = 1;
  options.max_difference = 12.0f;
  const cv::Point2f shift(24.0f, -7.0f);
  const KeyPoints points = gridPoints(34);
  const FlowMatches alone =
      track(movedTexture(static_cast<double>(shift.x), static_cast<double>(shift.y)),
            movedTexture(0, 0), points, options);
  EXPECT_LT(countRight(alone, points, shift), points.size() / 10);

  // Then a guess that is 2 px off finds it.
  const FlowMatches guessed = trackGuessed(shift, {1.5f, -1.5f}, points, options);
  EXPECT_EQ(countRight(guessed, points, shift), points.size());
}

TEST(OpticalFlow, AWrongGuessLosesAPointAtWorst) {
  // Given guesses 30 px off for images that did not move
  OpticalFlowOptions options = fixedOptions();
  options.window = 11;
  options.max_difference = 12.0f;
  const KeyPoints points = gridPoints(34);
  const FlowMatches wrong = trackGuessed({0.0f, 0.0f}, {30.0f, 25.0f}, points, options);
  std::size_t elsewhere = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float error = std::hypot(wrong.u[i] - points.u[i], wrong.v[i] - points.v[i]);
    elsewhere += error > 1.0f ? 1 : 0;  // false for the lost ones
  }
  EXPECT_LE(elsewhere, points.size() / 50);
}

TEST(OpticalFlow, WithoutAGuessAPointStartsWhereItIs) {
  // Given guesses that are NaN or outside the image, among good ones
  OpticalFlowOptions options = fixedOptions();
  options.guess_max_level = 1;
  const KeyPoints points = gridPoints(34);
  const cv::Mat current = movedTexture(2.0, 1.0);
  const cv::Mat earlier = movedTexture(0.0, 0.0);
  FlowMatches guess;
  const std::vector<float> none{kNaN, -1.0f, 1e9f, std::numeric_limits<float>::infinity()};
  for (std::size_t i = 0; i < points.size(); ++i) {
    guess.u.push_back(none[i % none.size()]);
    guess.v.push_back(points.v[i]);
  }
  FlowMatches own;
  own.u = points.u;
  own.v = points.v;
  const FlowPyramid from = buildFlowPyramid(current, options);
  const FlowPyramid to = buildFlowPyramid(earlier, options);
  const FlowMatches a = trackIntoEarlierFrame(from, to, points.view(), options, guess);
  const FlowMatches b = trackIntoEarlierFrame(from, to, points.view(), options, own);
  EXPECT_EQ(a.found, points.size());
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.v, b.v);
}

TEST(OpticalFlow, UnequalGuessesAreRefused) {
  const OpticalFlowOptions options = fixedOptions();
  const KeyPoints points = gridPoints(56);
  const FlowPyramid pyramid = buildFlowPyramid(movedTexture(0, 0), options);
  const auto message = [&](std::size_t columns, std::size_t rows) {
    FlowMatches guess;
    guess.u.assign(columns, 60.0f);
    guess.v.assign(rows, 60.0f);
    return test::invalidArgumentOf(
        [&] { trackIntoEarlierFrame(pyramid, pyramid, points.view(), options, guess); });
  };
  const std::string n = std::to_string(points.size());
  EXPECT_EQ(message(3, points.size()), "trackIntoEarlierFrame: " + n +
                                           " key points, but guesses for 3 columns and " + n +
                                           " rows; expected equal sizes, or none");
  EXPECT_EQ(message(points.size(), 0), "trackIntoEarlierFrame: " + n +
                                           " key points, but guesses for " + n +
                                           " columns and 0 rows; expected equal sizes, or none");
  EXPECT_EQ(message(0, 3), "trackIntoEarlierFrame: " + n +
                               " key points, but guesses for 0 columns and 3 rows; expected equal "
                               "sizes, or none");
  EXPECT_EQ(message(points.size(), points.size()), "nothing thrown");
  EXPECT_EQ(message(0, 0), "nothing thrown");
}

TEST(OpticalFlow, FoundCountsWhatIsNotNaN) {
  const KeyPoints points = gridPoints(0);
  const FlowMatches matches = track(movedTexture(5.0, 5.0), movedTexture(0, 0), points);
  std::size_t found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(std::isnan(matches.u[i]), std::isnan(matches.v[i]));
    found += std::isnan(matches.u[i]) ? 0 : 1;
  }
  EXPECT_EQ(matches.found, found);
}

TEST(OpticalFlow, NoPointsAndTinyImagesAreFine) {
  EXPECT_EQ(track(movedTexture(0, 0), movedTexture(0, 0), KeyPoints()).found, 0U);
  const cv::Mat tiny(1, 1, CV_8UC1, cv::Scalar(5));
  KeyPoints points;
  points.push_back(0.0f, 0.0f, 1.0f);
  EXPECT_EQ(track(tiny, tiny, points).found, 0U);
}

TEST(OpticalFlow, RepeatsBitForBit) {
  const KeyPoints points = gridPoints(5);
  const FlowMatches first = track(movedTexture(3.3, -2.1), movedTexture(0, 0), points);
  const FlowMatches second = track(movedTexture(3.3, -2.1), movedTexture(0, 0), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isnan(first.u[i])) {
      EXPECT_EQ(first.u[i], second.u[i]);
      EXPECT_EQ(first.v[i], second.v[i]);
    }
  }
  EXPECT_EQ(first.found, second.found);
}

TEST(OpticalFlow, AReusedPyramidIsAsAFreshOne) {
  // Of the same image size, whose memory serves again, and of another size, window and depth
  const OpticalFlowOptions options = fixedOptions();
  const cv::Mat image = movedTexture(3.3, -2.1);
  const FlowPyramid fresh = buildFlowPyramid(image, options);
  OpticalFlowOptions others = options;
  others.window = 11;
  others.max_level = 1;
  const cv::Mat wide(kHeight, 2 * kWidth, CV_8UC1, cv::Scalar(9));
  FlowPyramid same_size = buildFlowPyramid(movedTexture(0, 0), options);
  const unsigned char* memory = same_size.front().data;
  std::vector<FlowPyramid> reused;
  reused.push_back(buildFlowPyramid(image, options, std::move(same_size)));
  reused.push_back(buildFlowPyramid(image, options, buildFlowPyramid(wide, others)));
  EXPECT_EQ(reused.front().front().data, memory);
  for (const FlowPyramid& pyramid : reused) {
    ASSERT_EQ(pyramid.size(), fresh.size());
    for (std::size_t level = 0; level < fresh.size(); ++level) {
      ASSERT_EQ(pyramid[level].size(), fresh[level].size());
      EXPECT_EQ(cv::norm(pyramid[level], fresh[level], cv::NORM_INF), 0.0) << level;
    }
    const KeyPoints points = gridPoints(30);
    const FlowPyramid earlier = buildFlowPyramid(movedTexture(0, 0), options);
    EXPECT_EQ(trackIntoEarlierFrame(pyramid, earlier, points.view(), options).found,
              trackIntoEarlierFrame(fresh, earlier, points.view(), options).found);
  }
}

TEST(OpticalFlow, OtherImagesAreRefused) {
  const auto message = [](const cv::Mat& image) {
    return test::invalidArgumentOf([&] { buildFlowPyramid(image, fixedOptions()); });
  };
  EXPECT_EQ(message(cv::Mat()), "buildFlowPyramid: image is empty; expected 8-bit gray (CV_8UC1)");
  EXPECT_EQ(message(cv::Mat(9, 9, CV_8UC3, cv::Scalar::all(0))),
            "buildFlowPyramid: image is CV_8UC3; expected 8-bit gray (CV_8UC1)");
  EXPECT_EQ(message(cv::Mat(9, 9, CV_16UC1, cv::Scalar::all(0))),
            "buildFlowPyramid: image is CV_16UC1; expected 8-bit gray (CV_8UC1)");
  EXPECT_EQ(message(cv::Mat(9, 9, CV_32FC1, cv::Scalar::all(0))),
            "buildFlowPyramid: image is CV_32FC1; expected 8-bit gray (CV_8UC1)");
}

TEST(OpticalFlow, OtherPyramidsAreRefused) {
  const OpticalFlowOptions options = fixedOptions();
  const KeyPoints points = gridPoints(30);
  const FlowPyramid good = buildFlowPyramid(movedTexture(0, 0), options);
  const FlowPyramid wide =
      buildFlowPyramid(cv::Mat(kHeight, kWidth + 2, CV_8UC1, cv::Scalar(0)), options);
  const auto message = [&](const FlowPyramid& current, const FlowPyramid& earlier) {
    return test::invalidArgumentOf(
        [&] { trackIntoEarlierFrame(current, earlier, points.view(), options); });
  };
  const std::string expected =
      "trackIntoEarlierFrame: expected two pyramids of one image size, as buildFlowPyramid makes";
  EXPECT_EQ(message({}, good), expected);
  EXPECT_EQ(message(good, {}), expected);
  EXPECT_EQ(message(good, wide), expected);
  EXPECT_EQ(message(good, good), "nothing thrown");
}

TEST(OpticalFlow, PyramidsOfASmallerWindowAreRefused) {
  // Given pyramids whose border is too narrow for the window that is asked for.
  const KeyPoints points = gridPoints(0);
  for (const int max_level : {0, 2}) {
    OpticalFlowOptions narrow = fixedOptions();
    narrow.window = 7;
    narrow.max_level = max_level;
    const FlowPyramid pyramid = buildFlowPyramid(movedTexture(0, 0), narrow);
    OpticalFlowOptions wide = narrow;
    wide.window = 21;
    EXPECT_EQ(
        test::invalidArgumentOf(
            [&] { trackIntoEarlierFrame(pyramid, pyramid, points.view(), wide); }),
        "trackIntoEarlierFrame: window is 21, but a pyramid was built for 7; expected at most "
        "that");
    // A larger border is fine, and so is another number of levels.
    wide.max_level = 1;
    const FlowPyramid wider = buildFlowPyramid(movedTexture(0, 0), wide);
    EXPECT_GT(trackIntoEarlierFrame(wider, wider, points.view(), narrow).found, 0U);
  }
}

TEST(OpticalFlow, UnequalArraysAreRefused) {
  KeyPoints points = gridPoints(30);
  points.v.pop_back();
  EXPECT_NE(test::invalidArgumentOf([&] { track(movedTexture(0, 0), movedTexture(0, 0), points); }),
            "nothing thrown");
}

TEST(OpticalFlow, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    OpticalFlowOptions options = fixedOptions();
    change(options);
    return test::invalidArgumentOf([&] { buildFlowPyramid(movedTexture(0, 0), options); });
  };
  using Options = OpticalFlowOptions;
  EXPECT_EQ(message([](Options& o) { o.window = 20; }),
            "OpticalFlowOptions::window is 20.000000; expected an odd number of pixels >= 3");
  EXPECT_EQ(message([](Options& o) { o.window = 1; }),
            "OpticalFlowOptions::window is 1.000000; expected an odd number of pixels >= 3");
  EXPECT_EQ(message([](Options& o) { o.max_level = -1; }),
            "OpticalFlowOptions::max_level is -1.000000; expected a level >= 0");
  EXPECT_EQ(message([](Options& o) { o.max_iterations = 0; }),
            "OpticalFlowOptions::max_iterations is 0.000000; expected a count >= 1");
  EXPECT_EQ(message([](Options& o) { o.epsilon = 0.0f; }),
            "OpticalFlowOptions::epsilon is 0.000000; expected a value > 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.guess_max_level = -1; }),
            "OpticalFlowOptions::guess_max_level is -1.000000; expected a level >= 0");
  EXPECT_EQ(message([](Options& o) { o.max_difference = 0.0f; }),
            "OpticalFlowOptions::max_difference is 0.000000; expected a value > 0 (gray levels)");
  EXPECT_EQ(message([](Options& o) { o.max_difference = kNaN; }),
            "OpticalFlowOptions::max_difference is nan; expected a value > 0 (gray levels)");
  EXPECT_EQ(message([](Options& o) { o.max_forward_backward_error = kNaN; }),
            "OpticalFlowOptions::max_forward_backward_error is nan; expected a value > 0 (px)");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn
