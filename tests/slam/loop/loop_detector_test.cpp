// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_detector.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "loop/place_scene.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using namespace hmcdyn::slam::test;  // NOLINT(google-build-using-namespace): the scene's words

constexpr int kVisit = 100000;  // map points of a visit start at a multiple of it

/// A wall 16 m long with things in front of it, and a camera that looks at it from somewhere along
/// it. What it sees on another visit are other map points, as drift makes them.
class Corridor {
 public:
  Corridor() {
    Random random(1);
    landmarks_ = scattered(random, 1800, {-2.0, -1.1, 2.0}, {14.0, 1.1, 3.2});
  }

  static Eigen::Isometry3d pose(double x) {
    return motionOf({0.0, 0.03 * x, 0.0}, {-x, 0.05, 0.0});
  }

  /// The next key frame, `x` metres along; covisible with those that share 15 map points.
  LoopKeyFrame next(double x, int visit = 0) {
    const std::size_t id = seen_.size();
    LoopKeyFrame frame =
        see(landmarks_, id, pose(x), static_cast<std::uint32_t>(id) + 7, {0.7, 1.0, 12});
    for (int& point : frame.map_point) {
      point += visit * kVisit;
    }
    const std::set<int> points(frame.map_point.begin(), frame.map_point.end());
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const auto shared = std::count_if(seen_[k].begin(), seen_[k].end(),
                                        [&](int point) { return points.count(point) != 0; });
      if (shared >= 15) {
        frame.covisible.emplace_back(k, static_cast<int>(shared));
      }
    }
    seen_.push_back(frame.map_point);
    return frame;
  }

 private:
  Landmarks landmarks_;
  std::vector<std::vector<int>> seen_;
};

/// Key frames 0, 1, 2 at the corridor's start, 3 .. 17 at its other end: the start is old then.
std::vector<LoopReport> walkAway(LoopDetector& detector, Corridor& corridor) {
  std::vector<LoopReport> reports;
  reports.reserve(18);
  for (int k = 0; k < 3; ++k) {
    reports.push_back(detector.process(corridor.next(0.3 * k)));
  }
  for (int k = 0; k < 15; ++k) {
    reports.push_back(detector.process(corridor.next(8.0 + 0.3 * k)));
  }
  return reports;
}

LoopVerdict verdictOn(const LoopReport& report, std::size_t id) {
  for (const LoopCandidate& candidate : report.candidates) {
    if (candidate.id == id) {
      return candidate.verification.verdict;
    }
  }
  ADD_FAILURE() << "key frame " << id << " is no candidate";
  return LoopVerdict::kLowScore;
}

TEST(LoopDetector, TheFirstKeyFrameHasNoCandidates) {
  Corridor corridor;
  LoopDetector detector(kLens);
  const LoopReport report = detector.process(corridor.next(0.0));
  EXPECT_EQ(report.id, 0U);
  EXPECT_TRUE(report.candidates.empty());
  EXPECT_FALSE(report.constraint);
  EXPECT_EQ(detector.keyFrames().size(), 1U);
  EXPECT_EQ(detector.index().size(), 1U);
}

TEST(LoopDetector, AWalkThroughNewPlacesFindsNoLoop) {
  Corridor corridor;
  LoopDetector detector(kLens);
  for (int k = 0; k < 40; ++k) {
    const LoopReport report = detector.process(corridor.next(0.3 * k));
    EXPECT_FALSE(report.constraint) << k;
    for (const LoopCandidate& candidate : report.candidates) {
      EXPECT_EQ(candidate.verification.verdict, LoopVerdict::kLowScore) << k;
    }
  }
}

// Everything that a standing camera saw shares points with what it sees.
TEST(LoopDetector, KeyFramesThatShareAPointAreNoCandidates) {
  Corridor corridor;
  LoopDetector detector(kLens);
  for (int k = 0; k < 30; ++k) {
    const LoopReport report = detector.process(corridor.next(1.0 + 0.001 * k));
    EXPECT_TRUE(report.candidates.empty()) << k;
  }
}

// Without any shared points, as after tracking was lost: those of the last ten are too young.
TEST(LoopDetector, LatestKeyFramesAreNoCandidates) {
  Corridor corridor;
  LoopDetectorOptions options;
  options.max_candidates = 100;
  LoopDetector detector(kLens, options);
  for (int k = 0; k < 12; ++k) {
    LoopKeyFrame frame = corridor.next(1.0);
    frame.covisible.clear();
    const LoopReport report = detector.process(std::move(frame));
    EXPECT_EQ(report.candidates.size(), static_cast<std::size_t>(std::max(0, k - 9))) << k;
    for (const LoopCandidate& candidate : report.candidates) {
      EXPECT_LE(candidate.id + 10, static_cast<std::size_t>(k));
    }
  }
}

TEST(LoopDetector, OneHitIsNoLoopAndTwoAreNoneEither) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  for (int k = 0; k < 2; ++k) {
    const LoopReport report = detector.process(corridor.next(0.1 + 0.2 * k, 1));
    EXPECT_FALSE(report.constraint);
    ASSERT_FALSE(report.candidates.empty());
    EXPECT_EQ(report.candidates[0].consistent, k + 1);
    EXPECT_EQ(report.candidates[0].verification.verdict, LoopVerdict::kInconsistent);
    EXPECT_EQ(report.candidates[0].verification.matches, 0U);  // not even looked at
  }
}

TEST(LoopDetector, ThreeHitsInSuccessionAreALoopWithItsMotion) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  detector.process(corridor.next(0.1, 1));
  detector.process(corridor.next(0.3, 1));
  const LoopReport report = detector.process(corridor.next(0.5, 1));
  ASSERT_TRUE(report.constraint);
  const LoopConstraint& loop = *report.constraint;
  EXPECT_LE(loop.from, 2U);
  EXPECT_EQ(loop.to, 20U);
  EXPECT_EQ(verdictOn(report, loop.from), LoopVerdict::kAccepted);
  const Eigen::Isometry3d truth =
      Corridor::pose(0.5) * Corridor::pose(0.3 * static_cast<double>(loop.from)).inverse();
  EXPECT_LT(metresBetween(loop.to_from, truth), 0.01);
  EXPECT_LT(radiansBetween(loop.to_from, truth), 0.003);
  EXPECT_EQ(loop.inliers, loop.key_points.size());
  EXPECT_GE(loop.inliers, 100U);
  // Each pair is one landmark, under the numbers of both visits.
  EXPECT_EQ(loop.map_points.size(), loop.key_points.size());
  for (const auto& [first, second] : loop.map_points) {
    EXPECT_EQ(first + kVisit, second);
  }
}

// Key frames that see the same points are one candidate, and the one that looks most alike stands
// for them.
TEST(LoopDetector, APlaceIsOneCandidate) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  detector.process(corridor.next(0.1, 1));
  detector.process(corridor.next(0.3, 1));
  const LoopReport report = detector.process(corridor.next(0.3, 1));
  ASSERT_TRUE(report.constraint);
  EXPECT_EQ(report.constraint->from, 1U);  // from where all of it is seen
  EXPECT_EQ(verdictOn(report, 1), LoopVerdict::kAccepted);
  const auto good = std::count_if(report.candidates.begin(), report.candidates.end(),
                                  [](const LoopCandidate& candidate) {
                                    return candidate.verification.verdict != LoopVerdict::kLowScore;
                                  });
  EXPECT_EQ(good, 1);
  EXPECT_GT(report.candidates[0].place_score, 1.5 * report.candidates[0].score);
  EXPECT_LT(report.candidates[0].place_score, 3.0 * report.candidates[0].score) << "of three";
}

// A lone key frame looks as much alike as each of three that see the same.
TEST(LoopDetector, APlaceOutweighsAKeyFrameThatIsAlone) {
  for (const bool grouped : {true, false}) {
    LoopDetectorOptions options;
    options.min_relative_place = grouped ? 0.75 : 0.0;
    Corridor corridor;
    LoopDetector detector(kLens, options);
    detector.process(corridor.next(0.3, 7));  // key frame 0, on a visit of its own
    walkAway(detector, corridor);
    const LoopReport report = detector.process(corridor.next(0.3, 1));
    const bool has_lone = std::any_of(report.candidates.begin(), report.candidates.end(),
                                      [](const LoopCandidate& c) { return c.id == 0; });
    ASSERT_FALSE(report.candidates.empty());
    EXPECT_EQ(report.candidates[0].id, 2U);
    EXPECT_EQ(has_lone, !grouped);
  }
}

// Of several places that pass one is the loop, that with the most inliers.
TEST(LoopDetector, TheBestPlaceOutvotesTheOthers) {
  LoopDetectorOptions options;
  options.min_relative_place = 0.0;
  Corridor corridor;
  LoopDetector detector(kLens, options);
  detector.process(corridor.next(0.75, 7));  // key frame 0, alone and farther off
  walkAway(detector, corridor);
  detector.process(corridor.next(0.1, 1));
  detector.process(corridor.next(0.3, 1));
  const LoopReport report = detector.process(corridor.next(0.3, 1));
  ASSERT_TRUE(report.constraint);
  EXPECT_EQ(report.constraint->from, 2U);
  EXPECT_EQ(verdictOn(report, 0), LoopVerdict::kOutvoted);
}

TEST(LoopDetector, HitsThatOtherPlacesInterruptAreNoLoop) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  for (int k = 0; k < 4; ++k) {
    const LoopReport hit = detector.process(corridor.next(0.3, 1));
    EXPECT_FALSE(hit.constraint) << k;
    ASSERT_FALSE(hit.candidates.empty());
    EXPECT_EQ(hit.candidates[0].consistent, k % 2 + 1);
    if (k % 2 == 1) {
      detector.process(corridor.next(4.0 + 0.02 * k, 1));  // never seen before
    }
  }
}

// Three hits, but at two places that share no point: the other end of the corridor, then the start.
TEST(LoopDetector, HitsAtDifferentPlacesAreNoLoop) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  for (int k = 0; k < 12; ++k) {
    detector.process(corridor.next(4.0 + 0.02 * k, 1));
  }
  detector.process(corridor.next(0.2, 2));
  detector.process(corridor.next(10.0, 2));
  const LoopReport report = detector.process(corridor.next(0.3, 2));
  EXPECT_FALSE(report.constraint);
  ASSERT_FALSE(report.candidates.empty());
  EXPECT_EQ(report.candidates[0].consistent, 1);
}

TEST(LoopDetector, AfterALoopItRests) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  for (int k = 0; k < 2; ++k) {
    detector.process(corridor.next(0.3, 1));
  }
  ASSERT_TRUE(detector.process(corridor.next(0.3, 1)).constraint);
  for (std::size_t k = 0; k < LoopDetectorOptions{}.cooldown; ++k) {
    EXPECT_TRUE(detector.process(corridor.next(0.3, 1)).candidates.empty()) << k;
  }
  // And the hits before do not count any more.
  const LoopReport first = detector.process(corridor.next(0.3, 1));
  ASSERT_FALSE(first.candidates.empty());
  EXPECT_EQ(first.candidates[0].consistent, 1);
  detector.process(corridor.next(0.3, 1));
  EXPECT_TRUE(detector.process(corridor.next(0.3, 1)).constraint);
}

TEST(LoopDetector, CulledKeyFramesAreForgotten) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  EXPECT_TRUE(detector.remove(0));
  EXPECT_TRUE(detector.remove(1));
  EXPECT_FALSE(detector.remove(1));
  EXPECT_FALSE(detector.remove(777));
  EXPECT_EQ(detector.keyFrames().size(), 16U);
  EXPECT_EQ(detector.index().size(), 16U);
  detector.process(corridor.next(0.1, 1));
  detector.process(corridor.next(0.3, 1));
  const LoopReport report = detector.process(corridor.next(0.3, 1));
  ASSERT_TRUE(report.constraint);
  EXPECT_EQ(report.constraint->from, 2U);
  EXPECT_TRUE(detector.remove(2));
  for (std::size_t k = 0; k <= LoopDetectorOptions{}.cooldown + 3; ++k) {
    EXPECT_FALSE(detector.process(corridor.next(0.3, 1)).constraint) << k;
  }
}

TEST(LoopDetector, TheSameSequenceGivesTheSameReports) {
  const auto run = [] {
    Corridor corridor;
    LoopDetector detector(kLens);
    std::vector<LoopReport> reports = walkAway(detector, corridor);
    for (int k = 0; k < 4; ++k) {
      reports.push_back(detector.process(corridor.next(0.1 + 0.2 * k, 1)));
    }
    return reports;
  };
  const std::vector<LoopReport> one = run();
  const std::vector<LoopReport> other = run();
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_EQ(one[k].candidates.size(), other[k].candidates.size());
    for (std::size_t c = 0; c < one[k].candidates.size(); ++c) {
      EXPECT_EQ(one[k].candidates[c].id, other[k].candidates[c].id);
      EXPECT_EQ(one[k].candidates[c].score, other[k].candidates[c].score);
      EXPECT_EQ(one[k].candidates[c].verification.to_from.matrix(),
                other[k].candidates[c].verification.to_from.matrix());
    }
    ASSERT_EQ(one[k].constraint.has_value(), other[k].constraint.has_value());
  }
  EXPECT_TRUE(one[20].constraint);
}

// Bad data is no mistake: what sees nothing finds nothing, and is in nobody's way.
TEST(LoopDetector, KeyFramesWithoutKeyPointsFindNothing) {
  Corridor corridor;
  LoopDetector detector(kLens);
  walkAway(detector, corridor);
  LoopKeyFrame blind;
  blind.id = 1000;
  EXPECT_TRUE(detector.process(blind).candidates.empty());
  LoopKeyFrame flat = corridor.next(0.3, 1);
  std::fill(flat.points.depth.begin(), flat.points.depth.end(), 0.0f);
  EXPECT_FALSE(detector.process(flat).constraint);
}

TEST(LoopDetector, MistakesAreNamed) {
  Corridor corridor;
  LoopDetectorOptions options;
  options.min_consistent = 0;
  EXPECT_EQ(invalidArgumentOf([&] { const LoopDetector detector(kLens, options); }),
            "options.min_consistent is 0, expected at least 1");
  options = {};
  options.place_size = 0;
  EXPECT_EQ(invalidArgumentOf([&] { const LoopDetector detector(kLens, options); }),
            "options.place_size is 0, expected at least 1");
  LoopDetector detector(kLens);
  const LoopKeyFrame frame = corridor.next(0.0);
  detector.process(frame);
  EXPECT_EQ(invalidArgumentOf([&] { detector.process(frame); }),
            "key_frame.id is 0, expected one that is not known yet");
  LoopKeyFrame bad = corridor.next(0.1);
  bad.sigma.pop_back();
  EXPECT_NE(invalidArgumentOf([&] { detector.process(bad); }).find("size of key_frame.sigma"),
            std::string::npos);
  // What was refused was not taken in.
  EXPECT_EQ(detector.keyFrames().size(), 1U);
}

}  // namespace
}  // namespace hmcdyn::slam
