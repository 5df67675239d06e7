// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/place_index.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "invalid_argument.hpp"
#include "random.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using hmcdyn::test::Random;

cv::Mat randomDescriptors(Random& random, int rows) {
  cv::Mat descriptors(rows, 32, CV_8U);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < 32; ++j) {
      descriptors.at<std::uint8_t>(i, j) = static_cast<std::uint8_t>(random.integer(0, 255));
    }
  }
  return descriptors;
}

/// The same points seen again: `flips` bits of each descriptor differ, and only some are there.
cv::Mat seenAgain(const cv::Mat& descriptors, Random& random, int flips, double share) {
  cv::Mat again;
  for (int i = 0; i < descriptors.rows; ++i) {
    cv::Mat row = descriptors.row(i).clone();
    for (int k = 0; k < flips; ++k) {
      const int bit = random.integer(0, 255);
      row.at<std::uint8_t>(0, bit / 8) =
          static_cast<std::uint8_t>(row.at<std::uint8_t>(0, bit / 8) ^ (1U << (bit % 8)));
    }
    again.push_back(random.chance(share) ? row : randomDescriptors(random, 1));
  }
  return again;
}

void expectEqual(const std::vector<PlaceCandidate>& a, const std::vector<PlaceCandidate>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].score, b[i].score);
  }
}

TEST(PlaceIndex, TheSameFrameScoresOneAndComesFirst) {
  Random random(1);
  PlaceIndex index;
  std::vector<cv::Mat> frames;
  for (std::size_t id = 0; id < 20; ++id) {
    frames.push_back(randomDescriptors(random, 200));
    index.add(100 + id, frames.back());
  }
  const auto found = index.query(frames[7], 3);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].id, 107U);
  EXPECT_NEAR(found[0].score, 1.0, 1e-6);
}

// Half of the points with 20 of 256 bits changed: of 60 places each is found first.
TEST(PlaceIndex, FindsAPlaceWhenHalfOfItIsSeenAgainWithNoise) {
  Random random(2);
  PlaceIndex index;
  std::vector<cv::Mat> frames;
  for (std::size_t id = 0; id < 60; ++id) {
    frames.push_back(randomDescriptors(random, 400));
    index.add(id, frames.back());
  }
  for (std::size_t id = 0; id < 60; ++id) {
    const auto found = index.query(seenAgain(frames[id], random, 20, 0.5), 2);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].id, id);
    EXPECT_GT(found[0].score, 2.0 * found[1].score);
  }
}

// One word a table. Two descriptors a and b of the frame, a alone in key frame 1, twice a and once
// b in key frame 2, c in key frame 3. Of three key frames two hold a, one holds b: rarities
// ln(1 + 3/2), ln(1 + 3). Key frame 1 shares min(1/2, 1) of a; key frame 2 min(1/2, 2/3) of a and
// min(1/2, 1/3) of b. The frame with itself: (rarity of a + rarity of b) / 2.
TEST(PlaceIndex, ScoreByHand) {
  cv::Mat a(1, 32, CV_8U, cv::Scalar(0));
  cv::Mat b(1, 32, CV_8U, cv::Scalar(255));
  cv::Mat c(1, 32, CV_8U, cv::Scalar(0x55));
  PlaceIndexOptions options;
  options.tables = 2;
  PlaceIndex index(options);
  cv::Mat frame;
  cv::vconcat(a, b, frame);
  cv::Mat second;
  cv::vconcat(frame, a, second);
  index.add(1, a);
  index.add(2, second);
  index.add(3, c);
  const auto found = index.query(frame, 10);
  const double rare_a = std::log(2.5);
  const double rare_b = std::log(4.0);
  const double own = 0.5 * rare_a + 0.5 * rare_b;
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].id, 2U);
  EXPECT_NEAR(found[0].score, (0.5 * rare_a + rare_b / 3.0) / own, 1e-6);
  EXPECT_EQ(found[1].id, 1U);
  EXPECT_NEAR(found[1].score, 0.5 * rare_a / own, 1e-6);
}

TEST(PlaceIndex, EqualScoresAreOrderedById) {
  Random random(3);
  const cv::Mat frame = randomDescriptors(random, 50);
  PlaceIndex index;
  for (const std::size_t id : {5U, 3U, 9U, 1U}) {
    index.add(id, frame);
  }
  const auto found = index.query(frame, 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].id, 1U);
  EXPECT_EQ(found[1].id, 3U);
  EXPECT_EQ(found[2].id, 5U);
}

TEST(PlaceIndex, AnswersDependOnTheSetAloneNotOnItsHistory) {
  Random random(4);
  std::vector<cv::Mat> frames;
  for (int k = 0; k < 12; ++k) {
    frames.push_back(randomDescriptors(random, 100));
  }
  const cv::Mat frame = seenAgain(frames[4], random, 10, 0.6);
  PlaceIndex straight;
  for (std::size_t id = 0; id < 10; ++id) {
    straight.add(id, frames[id]);
  }
  PlaceIndex winding;
  winding.add(11, frames[11]);
  for (std::size_t id = 10; id > 0; --id) {
    winding.add(id - 1, frames[id - 1]);
  }
  winding.add(10, frames[10]);
  EXPECT_TRUE(winding.remove(10));
  EXPECT_TRUE(winding.remove(11));
  EXPECT_FALSE(winding.remove(11));
  EXPECT_EQ(winding.size(), 10U);
  expectEqual(winding.query(frame, 10), straight.query(frame, 10));
}

TEST(PlaceIndex, ExcludedAndRemovedKeyFramesAreNotFound) {
  Random random(5);
  const cv::Mat frame = randomDescriptors(random, 50);
  PlaceIndex index;
  for (std::size_t id = 0; id < 4; ++id) {
    index.add(id, frame);
  }
  index.remove(2);
  const auto found = index.query(frame, 10, {3, 0});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, 1U);
}

TEST(PlaceIndex, ARemovedKeyFrameCanComeBack) {
  Random random(6);
  const cv::Mat frame = randomDescriptors(random, 50);
  PlaceIndex index;
  index.add(1, frame);
  index.remove(1);
  EXPECT_TRUE(index.query(frame, 10).empty());
  index.add(1, frame);
  EXPECT_EQ(index.query(frame, 10).size(), 1U);
}

TEST(PlaceIndex, NothingFindsNothing) {
  Random random(7);
  PlaceIndex index;
  EXPECT_TRUE(index.query(randomDescriptors(random, 10), 5).empty());
  index.add(1, cv::Mat());
  index.add(2, randomDescriptors(random, 10));
  EXPECT_TRUE(index.query(cv::Mat(), 5).empty());
  EXPECT_EQ(index.size(), 2U);
}

TEST(PlaceIndex, KeepsDescriptorsAtEvenDistances) {
  Random random(8);
  const cv::Mat all = randomDescriptors(random, 100);
  PlaceIndexOptions options;
  options.max_descriptors = 10;
  PlaceIndex index(options);
  index.add(1, all);
  cv::Mat every_tenth;
  for (int i = 0; i < 100; i += 10) {
    every_tenth.push_back(all.row(i));
  }
  const auto found = index.query(every_tenth, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].score, 1.0, 1e-6);
}

TEST(PlaceIndex, MistakesAreNamed) {
  PlaceIndexOptions options;
  options.bits = 3;
  EXPECT_EQ(invalidArgumentOf([&] { const PlaceIndex index(options); }),
            "options.bits is 3, expected 4..20");
  PlaceIndex index;
  index.add(4, cv::Mat());
  EXPECT_EQ(invalidArgumentOf([&] { index.add(4, cv::Mat()); }),
            "id is 4, expected one that is not in the index");
  EXPECT_EQ(invalidArgumentOf([&] { index.query(cv::Mat(3, 16, CV_8U), 1); }),
            "descriptors has type 0 and 16 columns, expected CV_8U (0) and 32");
}

}  // namespace
}  // namespace hmcdyn::slam
