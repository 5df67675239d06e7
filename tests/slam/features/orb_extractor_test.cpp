// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "features/texture.hpp"
#include "shared_data.hpp"
#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {
namespace {

using Map = std::function<cv::Point2d(cv::Point2f)>;

/// Cells of 32 x 32 px that hold a point.
std::size_t occupiedCells(const std::vector<cv::KeyPoint>& key_points) {
  std::set<std::pair<int, int>> cells;
  for (const cv::KeyPoint& k : key_points) {
    cells.insert({static_cast<int>(k.pt.x) / 32, static_cast<int>(k.pt.y) / 32});
  }
  return cells.size();
}

bool equal(const Features& a, const Features& b) {
  const auto same = [](const cv::KeyPoint& p, const cv::KeyPoint& q) {
    return p.pt == q.pt && p.size == q.size && p.angle == q.angle && p.response == q.response &&
           p.octave == q.octave;
  };
  return a.key_points.size() == b.key_points.size() &&
         std::equal(a.key_points.begin(), a.key_points.end(), b.key_points.begin(), same) &&
         a.descriptors.size() == b.descriptors.size() &&
         (a.descriptors.empty() || cv::norm(a.descriptors, b.descriptors, cv::NORM_L1) == 0.0);
}

/// Matches that are each other's nearest, with the distance from where the map says they belong.
struct Matches {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::vector<double> errors;  // px

  double shareWithin(double tolerance) const {
    return static_cast<double>(std::count_if(errors.begin(), errors.end(),
                                             [&](double e) { return e < tolerance; })) /
           static_cast<double>(errors.size());
  }
};

std::size_t nearest(const Features& from, std::size_t i, const Features& to) {
  std::size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (std::size_t j = 0; j < to.key_points.size(); ++j) {
    const int distance = hammingDistance(from.descriptors.ptr<uchar>(static_cast<int>(i)),
                                         to.descriptors.ptr<uchar>(static_cast<int>(j)));
    if (distance < least) {
      least = distance;
      best = j;
    }
  }
  return best;
}

Matches match(const Features& from, const Features& to, const Map& map) {
  Matches matches;
  for (std::size_t i = 0; i < from.key_points.size(); ++i) {
    const std::size_t j = nearest(from, i, to);
    if (nearest(to, j, from) == i) {
      const cv::Point2d expected = map(from.key_points[i].pt);
      matches.pairs.emplace_back(i, j);
      matches.errors.push_back(cv::norm(expected - cv::Point2d(to.key_points[j].pt)));
    }
  }
  return matches;
}

/// Share of the points whose image under the map lies within 2 px of a point of the other image,
/// among those that land inside it.
double repeatability(const Features& from, const Features& to, const Map& map, cv::Size size) {
  constexpr double kBorder = 70.0;  // where the upper levels have no points
  int landed = 0;
  int found = 0;
  for (const cv::KeyPoint& k : from.key_points) {
    const cv::Point2d p = map(k.pt);
    if (p.x < kBorder || p.y < kBorder || p.x > size.width - kBorder ||
        p.y > size.height - kBorder) {
      continue;
    }
    ++landed;
    found += std::any_of(to.key_points.begin(), to.key_points.end(), [&](const auto& other) {
      return cv::norm(p - cv::Point2d(other.pt)) < 2.0;
    });
  }
  return static_cast<double>(found) / landed;
}

struct Warp {
  cv::Mat image;
  Map map;
};

/// Turned by `degrees` about the centre and scaled.
Warp warped(const cv::Mat& image, double degrees, double scale) {
  const cv::Point2f centre(0.5f * static_cast<float>(image.cols - 1),
                           0.5f * static_cast<float>(image.rows - 1));
  const cv::Matx23d m = cv::Mat(cv::getRotationMatrix2D(centre, degrees, scale));
  Warp warp;
  cv::warpAffine(image, warp.image, m, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  warp.map = [m](cv::Point2f p) {
    return cv::Point2d(m(0, 0) * p.x + m(0, 1) * p.y + m(0, 2),
                       m(1, 0) * p.x + m(1, 1) * p.y + m(1, 2));
  };
  return warp;
}

TEST(OrbExtractor, FindsTheNumberWantedInsideTheImage) {
  const cv::Mat image = test::texture({640, 480}, 1);
  for (const int wanted : {50, 1000, 2500}) {
    OrbOptions options;
    options.features = wanted;
    const Features features = OrbExtractor(options).extract(image);
    EXPECT_EQ(static_cast<int>(features.key_points.size()), wanted);
    EXPECT_EQ(features.descriptors.rows, wanted);
    EXPECT_EQ(features.descriptors.cols, 32);
    EXPECT_EQ(features.descriptors.type(), CV_8UC1);
    for (const cv::KeyPoint& k : features.key_points) {
      EXPECT_TRUE(cv::Rect2f(15.0f, 15.0f, 610.0f, 450.0f).contains(k.pt));
      EXPECT_GE(k.angle, 0.0f);
      EXPECT_LT(k.angle, 360.0f);
      EXPECT_GE(k.octave, 0);
      EXPECT_LT(k.octave, 8);
      EXPECT_NEAR(k.size, 37.0 * std::pow(1.2, k.octave), 1e-3);
    }
  }
}

class OrbExtractorUnderWarp : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(OrbExtractorUnderWarp, PointsAreFoundAndMatchedAgain) {
  const auto [degrees, scale] = GetParam();
  OrbExtractor extractor;
  const auto open_cv = cv::ORB::create(1000);
  double share = 0.0;
  double share_of_open_cv = 0.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const cv::Mat image = test::texture({640, 480}, seed);
    const Warp warp = warped(image, degrees, scale);
    const cv::Mat noisy = test::withNoise(warp.image, 2.0, 3);
    const Features original = extractor.extract(image);
    const Features seen = extractor.extract(noisy);
    EXPECT_GT(repeatability(original, seen, warp.map, image.size()), 0.7) << "texture " << seed;
    const Matches matches = match(original, seen, warp.map);
    EXPECT_GT(matches.pairs.size(), 300U) << "texture " << seed;
    share += matches.shareWithin(4.0) / 3.0;

    Features a;
    Features b;
    open_cv->detectAndCompute(image, {}, a.key_points, a.descriptors);
    open_cv->detectAndCompute(noisy, {}, b.key_points, b.descriptors);
    share_of_open_cv += match(a, b, warp.map).shareWithin(4.0) / 3.0;
  }
  // OpenCV's points crowd at the strongest corners; ours are spread, so some are weaker.
  EXPECT_GT(share, 0.9 * share_of_open_cv);
}

INSTANTIATE_TEST_SUITE_P(Warps, OrbExtractorUnderWarp,
                         testing::Values(std::pair(10.0, 1.0), std::pair(-45.0, 1.0),
                                         std::pair(90.0, 1.0), std::pair(137.0, 1.0),
                                         std::pair(0.0, 0.8), std::pair(20.0, 1.25)));

TEST(OrbExtractor, PlacesPointsBetweenThePixels) {
  const cv::Mat image = test::texture({640, 480}, 4);
  const Warp warp = warped(image, 17.0, 1.0);
  const Features original = OrbExtractor().extract(image);
  const Features seen = OrbExtractor().extract(warp.image);
  auto orb = cv::ORB::create(1000);
  Features whole_a;
  Features whole_b;
  orb->detectAndCompute(image, {}, whole_a.key_points, whole_a.descriptors);
  orb->detectAndCompute(warp.image, {}, whole_b.key_points, whole_b.descriptors);
  const auto median = [](Matches matches) {
    auto& errors = matches.errors;
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    return errors[errors.size() / 2];
  };
  const double ours = median(match(original, seen, warp.map));
  EXPECT_LT(ours, 0.5);
  EXPECT_LT(ours, 0.7 * median(match(whole_a, whole_b, warp.map)));
}

TEST(OrbExtractor, UpperLevelsAreNotShifted) {
  // Half a turn takes (x, y) to (639 - x, 479 - y). A level whose coordinates were scaled without
  // regard to the pixels' centres would be off by (scale - 1) px, 1.5 px at level 5.
  const cv::Mat image = test::texture({640, 480}, 6);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_180);
  const Map map = [](cv::Point2f p) { return cv::Point2d(639.0 - p.x, 479.0 - p.y); };
  const Features original = OrbExtractor().extract(image);
  const Features seen = OrbExtractor().extract(turned);
  cv::Point2d sum;
  int count = 0;
  for (const auto& [i, j] : match(original, seen, map).pairs) {
    const cv::Point2d difference =
        map(original.key_points[i].pt) - cv::Point2d(seen.key_points[j].pt);
    if (original.key_points[i].octave >= 4 && cv::norm(difference) < 5.0) {
      sum += difference;
      ++count;
    }
  }
  ASSERT_GT(count, 50);
  EXPECT_NEAR(sum.x / count, 0.0, 0.15);
  EXPECT_NEAR(sum.y / count, 0.0, 0.15);
}

TEST(OrbExtractor, AnglesTurnWithTheImage) {
  const cv::Mat image = test::texture({480, 480}, 7);
  const Warp warp = warped(image, -30.0, 1.0);  // OpenCV counts anti-clockwise
  const Features original = OrbExtractor().extract(image);
  const Features seen = OrbExtractor().extract(warp.image);
  const Matches matches = match(original, seen, warp.map);
  std::vector<double> turns;
  for (std::size_t m = 0; m < matches.pairs.size(); ++m) {
    const auto& [i, j] = matches.pairs[m];
    if (matches.errors[m] < 2.0) {
      const double turn = seen.key_points[j].angle - original.key_points[i].angle;
      turns.push_back(turn < -180.0 ? turn + 360.0 : turn > 180.0 ? turn - 360.0 : turn);
    }
  }
  ASSERT_GT(turns.size(), 100U);
  std::nth_element(turns.begin(), turns.begin() + turns.size() / 2, turns.end());
  EXPECT_NEAR(turns[turns.size() / 2], 30.0, 1.0);
}

TEST(OrbExtractor, SpreadsPointsWhereOpenCvCrowdsThem) {
  // Strong corners in the left third, weak ones in the rest.
  cv::Mat image = test::texture({640, 480}, 10);
  cv::Mat right = image.colRange(213, 640);
  right.convertTo(right, CV_8U, 0.2, 100.0);
  std::vector<cv::KeyPoint> crowded;
  cv::ORB::create(1000)->detect(image, crowded);
  const Features spread = OrbExtractor().extract(image);
  OrbOptions all;
  all.features = 100000;
  const std::size_t reachable = occupiedCells(OrbExtractor(all).extract(image).key_points);
  EXPECT_EQ(spread.key_points.size(), 1000U);
  EXPECT_GT(occupiedCells(spread.key_points), reachable * 3 / 4);
  EXPECT_GT(occupiedCells(spread.key_points), 2 * occupiedCells(crowded));
}

TEST(OrbExtractor, RepeatsBitForBit) {
  const cv::Mat image = test::texture({640, 480}, 12);
  const Features first = OrbExtractor().extract(image);
  OrbExtractor used;
  used.extract(test::texture({400, 300}, 13));
  used.extract(test::texture({640, 480}, 14));
  EXPECT_TRUE(equal(used.extract(image), first)) << "what came before shows through";
  const int threads = cv::getNumThreads();
  cv::setNumThreads(2);
  const Features several = OrbExtractor().extract(image);
  cv::setNumThreads(1);
  const Features single = OrbExtractor().extract(image);
  cv::setNumThreads(threads);
  EXPECT_TRUE(equal(single, first));
  EXPECT_TRUE(equal(several, first));
}

TEST(OrbExtractor, LeavesItsInputAloneAndTakesPartsOfImages) {
  const cv::Mat whole = test::texture({700, 500}, 15);
  const cv::Mat copy = whole.clone();
  const cv::Mat part = whole(cv::Rect(30, 10, 640, 480));
  EXPECT_TRUE(equal(OrbExtractor().extract(part), OrbExtractor().extract(part.clone())));
  EXPECT_EQ(cv::norm(whole, copy, cv::NORM_L1), 0.0);
}

TEST(OrbExtractor, ResultsDoNotChangeWithTheNextImage) {
  OrbExtractor extractor;
  const Features features = extractor.extract(test::texture({640, 480}, 16));
  const Features copy{features.key_points, features.descriptors.clone()};
  extractor.extract(test::texture({640, 480}, 17));
  EXPECT_TRUE(equal(features, copy));
}

TEST(OrbExtractor, RespectsTheMask) {
  const cv::Mat image = test::texture({640, 480}, 18);
  cv::Mat mask(image.size(), CV_8U, cv::Scalar(1));
  mask(cv::Rect(200, 100, 250, 300)).setTo(0);
  const Features features = OrbExtractor().extract(image, mask);
  EXPECT_EQ(features.key_points.size(), 1000U) << "the rest of the image has enough";
  for (const cv::KeyPoint& k : features.key_points) {
    // The mask is asked at the corner's pixel; half a pixel of the level is the offset's bound.
    const float slack = 0.5f + 0.5f * std::pow(1.2f, static_cast<float>(k.octave));
    EXPECT_FALSE(cv::Rect2f(200.0f + slack, 100.0f + slack, 250.0f - 2.0f * slack - 1.0f,
                            300.0f - 2.0f * slack - 1.0f)
                     .contains(k.pt));
  }
  EXPECT_TRUE(OrbExtractor().extract(image, cv::Mat::zeros(480, 640, CV_8U)).key_points.empty());
}

TEST(OrbExtractor, FeaturelessAndTinyImagesHaveNoFeatures) {
  for (const cv::Mat& image :
       {cv::Mat(480, 640, CV_8U, cv::Scalar(0)), cv::Mat(480, 640, CV_8U, cv::Scalar(200)),
        test::texture({30, 480}, 19), cv::Mat(1, 1, CV_8U, cv::Scalar(5))}) {
    const Features features = OrbExtractor().extract(image);
    EXPECT_TRUE(features.key_points.empty());
    EXPECT_TRUE(features.descriptors.empty());
  }
}

TEST(OrbExtractor, SmallImagesUseTheLevelsTheyHave) {
  const Features features = OrbExtractor().extract(test::texture({64, 48}, 20, 100));
  ASSERT_FALSE(features.key_points.empty());
  for (const cv::KeyPoint& k : features.key_points) {
    EXPECT_LE(k.octave, 1) << "level 2 is 33 px high, less than a patch";
  }
}

TEST(OrbExtractor, LowThresholdServesDimCells) {
  // Contrast 15: nothing exceeds the strong threshold of 20.
  cv::Mat dim;
  test::texture({640, 480}, 21).convertTo(dim, CV_8U, 15.0 / 255.0, 100.0);
  EXPECT_GT(OrbExtractor().extract(dim).key_points.size(), 100U);
  OrbOptions strict;
  strict.min_fast_threshold = 20;
  EXPECT_TRUE(OrbExtractor(strict).extract(dim).key_points.empty());
}

TEST(OrbExtractor, RefusesUnusableImages) {
  OrbExtractor extractor;
  EXPECT_THROW(extractor.extract({}), std::invalid_argument);
  EXPECT_THROW(extractor.extract(cv::Mat(100, 100, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(extractor.extract(cv::Mat(100, 100, CV_16U)), std::invalid_argument);
  const cv::Mat image(100, 100, CV_8U, cv::Scalar(0));
  EXPECT_THROW(extractor.extract(image, cv::Mat(100, 99, CV_8U)), std::invalid_argument);
  EXPECT_THROW(extractor.extract(image, cv::Mat(100, 100, CV_32F)), std::invalid_argument);
}

TEST(OrbExtractor, RefusesOptionsByName) {
  const auto message = [](const std::function<void(OrbOptions&)>& change) {
    OrbOptions options;
    change(options);
    try {
      const OrbExtractor extractor(options);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message([](OrbOptions& o) { o.features = 0; }),
            "ORB options: features is 0; expected > 0");
  EXPECT_NE(message([](OrbOptions& o) { o.scale_factor = 1.0f; }).find("scale_factor"),
            std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.scale_factor = NAN; }).find("scale_factor"),
            std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.levels = 0; }).find("levels"), std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.fast_threshold = 255; }).find("fast_threshold"),
            std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.min_fast_threshold = 21; }).find("min_fast_threshold"),
            std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.cell = 0; }).find("cell"), std::string::npos);
  EXPECT_NE(message([](OrbOptions& o) { o.spread_share = 1.1f; }).find("spread_share"),
            std::string::npos);
}

TEST(OrbExtractor, CoversRealFramesBetterThanOpenCv) {
  HMCDYN_SKIP_WITHOUT_SHARED("data/fr3_walking_halfsphere_first50/rgb");
  std::vector<cv::String> files;
  cv::glob(test::sharedPath("data/fr3_walking_halfsphere_first50/rgb/*.png").string(), files);
  auto orb = cv::ORB::create(1000);
  OrbExtractor extractor;
  for (std::size_t i = 0; i < files.size(); i += 10) {
    const cv::Mat image = cv::imread(files[i], cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(image.empty()) << files[i];
    std::vector<cv::KeyPoint> crowded;
    orb->detect(image, crowded);
    const Features features = extractor.extract(image);
    EXPECT_EQ(features.key_points.size(), 1000U);
    EXPECT_GT(occupiedCells(features.key_points), occupiedCells(crowded) * 3 / 2);
  }
}

}  // namespace
}  // namespace hmcdyn::slam
