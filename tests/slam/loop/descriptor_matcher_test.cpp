// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/descriptor_matcher.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "invalid_argument.hpp"
#include "random.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using hmcdyn::test::Random;

/// A descriptor with the bits from `first` on set, `count` of them, and no other: the distance of
/// two such is the number of bits that one has and the other has not.
cv::Mat bits(int first, int count) {
  cv::Mat row(1, 32, CV_8U, cv::Scalar(0));
  for (int bit = first; bit < first + count; ++bit) {
    std::uint8_t& byte = row.at<std::uint8_t>(0, bit / 8);
    byte = static_cast<std::uint8_t>(byte | (1U << (bit % 8)));
  }
  return row;
}

cv::Mat stacked(std::initializer_list<cv::Mat> rows) {
  cv::Mat all;
  for (const cv::Mat& row : rows) {
    all.push_back(row);
  }
  return all;
}

void expectMatches(const std::vector<DescriptorMatch>& found,
                   const std::vector<DescriptorMatch>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(found[k].from, expected[k].from);
    EXPECT_EQ(found[k].to, expected[k].to);
    EXPECT_EQ(found[k].distance, expected[k].distance);
  }
}

// Three patterns of 80 bits without a common bit, 160 from each other.
TEST(DescriptorMatcher, PairsNearestNeighboursInTheOrderOfTheFirst) {
  const cv::Mat from = stacked({bits(0, 80), bits(80, 80), bits(160, 80)});
  const cv::Mat to = stacked({bits(160, 77), bits(0, 75), bits(80, 80)});
  expectMatches(matchDescriptors(from, to), {{0, 1, 5}, {1, 2, 0}, {2, 0, 3}});
}

// Both of `from` are nearest to the one of `to`; only the nearer one is nearest the other way.
TEST(DescriptorMatcher, APairMustBeNearestBothWays) {
  const cv::Mat from = stacked({bits(0, 90), bits(0, 98)});
  const cv::Mat to = stacked({bits(0, 100)});
  expectMatches(matchDescriptors(from, to), {{1, 0, 2}});
}

// Distances 17 and 20 of `from` to the two of `to`: 17 = 0.85 * 20 is just clear enough, 18 is not.
TEST(DescriptorMatcher, TheSecondNearestMustBeClearlyFarther) {
  const cv::Mat from = bits(20, 100);
  expectMatches(matchDescriptors(from, stacked({bits(20, 117), bits(0, 120)})), {{0, 0, 17}});
  expectMatches(matchDescriptors(from, stacked({bits(20, 118), bits(0, 120)})), {});
}

// The rule of the ratio holds seen from `to` as well.
TEST(DescriptorMatcher, TheSecondNearestCountsFromBothSides) {
  const cv::Mat to = bits(20, 100);
  expectMatches(matchDescriptors(stacked({bits(20, 117), bits(0, 120)}), to), {{0, 0, 17}});
  expectMatches(matchDescriptors(stacked({bits(20, 118), bits(0, 120)}), to), {});
}

TEST(DescriptorMatcher, OfEquallyNearOnesNoneMatches) {
  DescriptorMatcherOptions any;
  any.max_ratio = 1.0f;
  const cv::Mat from = bits(0, 100);
  const cv::Mat twins = stacked({bits(0, 100), bits(0, 100)});
  expectMatches(matchDescriptors(from, twins, any), {});
  expectMatches(matchDescriptors(twins, from, any), {});
  // At a distance above 0, too.
  expectMatches(matchDescriptors(from, stacked({bits(0, 97), bits(0, 103)}), any), {});
}

// A single candidate has no second: only the distance counts, up to 64 bits.
TEST(DescriptorMatcher, ALonelyPairMatchesUpToTheLargestDistance) {
  expectMatches(matchDescriptors(bits(0, 100), bits(0, 164)), {{0, 0, 64}});
  expectMatches(matchDescriptors(bits(0, 100), bits(0, 165)), {});
  DescriptorMatcherOptions strict;
  strict.max_distance = 10;
  expectMatches(matchDescriptors(bits(0, 100), bits(0, 110), strict), {{0, 0, 10}});
  expectMatches(matchDescriptors(bits(0, 100), bits(0, 111), strict), {});
}

TEST(DescriptorMatcher, OppositeDescriptorsDoNotMatchHoweverLonely) {
  DescriptorMatcherOptions any;
  any.max_distance = 256;
  any.max_ratio = 1.0f;
  expectMatches(matchDescriptors(bits(0, 0), bits(0, 256)), {});
  // All 256 bits apart, and asked for: a pair all the same.
  expectMatches(matchDescriptors(bits(0, 0), bits(0, 256), any), {{0, 0, 256}});
}

TEST(DescriptorMatcher, NothingMatchesNothing) {
  const cv::Mat some = bits(0, 100);
  EXPECT_TRUE(matchDescriptors(cv::Mat(), cv::Mat()).empty());
  EXPECT_TRUE(matchDescriptors(some, cv::Mat()).empty());
  EXPECT_TRUE(matchDescriptors(cv::Mat(), some).empty());
  EXPECT_TRUE(matchDescriptors(some, cv::Mat(0, 32, CV_8U)).empty());
}

// Against a second implementation: sorted distances of each row, by the definition.
TEST(DescriptorMatcher, AgreesWithSortedDistancesOnRandomDescriptors) {
  Random random(11);
  // Few bits, so that ties and near ties are frequent.
  const auto draw = [&](int rows) {
    cv::Mat all(rows, 32, CV_8U, cv::Scalar(0));
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < 3; ++j) {
        all.at<std::uint8_t>(i, j) = static_cast<std::uint8_t>(random.integer(0, 255));
      }
    }
    return all;
  };
  const cv::Mat from = draw(60);
  const cv::Mat to = draw(45);
  const auto partnerOf = [](const cv::Mat& row, const cv::Mat& others) {
    std::vector<std::pair<int, int>> sorted;
    sorted.reserve(static_cast<std::size_t>(others.rows));
    for (int j = 0; j < others.rows; ++j) {
      sorted.emplace_back(static_cast<int>(cv::norm(row, others.row(j), cv::NORM_HAMMING)), j);
    }
    std::sort(sorted.begin(), sorted.end());
    const bool clear =
        sorted[0].first < sorted[1].first &&
        static_cast<float>(sorted[0].first) <= 0.85f * static_cast<float>(sorted[1].first);
    return clear ? sorted[0].second : -1;
  };
  std::vector<DescriptorMatch> expected;
  for (int i = 0; i < from.rows; ++i) {
    const int j = partnerOf(from.row(i), to);
    if (j >= 0 && partnerOf(to.row(j), from) == i) {
      expected.push_back(
          {i, j, static_cast<int>(cv::norm(from.row(i), to.row(j), cv::NORM_HAMMING))});
    }
  }
  ASSERT_GT(expected.size(), 5U);
  expectMatches(matchDescriptors(from, to), expected);
}

TEST(DescriptorMatcher, MistakesAreNamed) {
  const cv::Mat good = bits(0, 1);
  EXPECT_EQ(invalidArgumentOf([&] { matchDescriptors(cv::Mat(2, 32, CV_32F), good); }),
            "from has type 5 and 32 columns, expected CV_8U (0) and 32");
  EXPECT_EQ(invalidArgumentOf([&] { matchDescriptors(good, cv::Mat(2, 16, CV_8U)); }),
            "to has type 0 and 16 columns, expected CV_8U (0) and 32");
}

}  // namespace
}  // namespace hmcdyn::slam
