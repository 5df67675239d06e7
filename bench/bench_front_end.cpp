// SPDX-License-Identifier: BSD-3-Clause
// Optical flow, fundamental matrix and features on real frames (a folder in TUM's format, by
// default the clip beside the project): time and, where the truth is known, error. Flow: into the
// same frame as another camera pose would show it, with noise. Fundamental matrix: matches made
// from the frame's depth and a known motion, 0.1 px of noise, 40 % of them wrong.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/steps/fundamental.hpp>
#include <hmcdyn/steps/optical_flow.hpp>

#include "slam/features/orb_extractor.hpp"

namespace hmcdyn::bench {
namespace {

constexpr int kPoints = 1000;
constexpr std::size_t kMostFrames = 24;
const cv::Matx33d kCamera(535.4, 0.0, 320.1, 0.0, 539.2, 247.6, 0.0, 0.0, 1.0);  // TUM's freiburg3

struct RealFrame {
  cv::Mat gray;
  cv::Mat warped;                    ///< The same from a turned and rolled camera, with noise.
  cv::Matx33d homography;            ///< Pixels of gray to pixels of warped.
  std::vector<cv::Point2f> corners;  ///< Of `warped`: where flow starts from.
  std::vector<cv::Point2f> earlier;  ///< Matches by depth and a known motion, 40 % wrong ...
  std::vector<cv::Point2f> current;  ///< ... and noisy.
  std::vector<cv::Vec4d> exact;      ///< Pairs without noise, to measure by.
};

/// K R K^-1 of some degrees about all axes, and a zoom of 1 %: about 8 px in the image.
cv::Matx33d smallWarp(cv::RNG& random) {
  const auto radians = [&random] { return random.uniform(-0.012, 0.012); };
  cv::Matx33d rotation;
  cv::Rodrigues(cv::Vec3d(radians(), radians(), radians()), rotation);
  const double zoom = 1.0 + random.uniform(-0.01, 0.01);
  return kCamera * rotation * cv::Matx33d(zoom, 0, 0, 0, zoom, 0, 0, 0, 1) * kCamera.inv();
}

void addWarp(RealFrame& frame, cv::RNG& random) {
  frame.homography = smallWarp(random);
  cv::warpPerspective(frame.gray, frame.warped, frame.homography, frame.gray.size(),
                      cv::INTER_CUBIC, cv::BORDER_REFLECT);
  cv::Mat noise(frame.gray.size(), CV_16S);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::add(frame.warped, noise, frame.warped, cv::noArray(), CV_8U);
  cv::Mat inside = cv::Mat::zeros(frame.gray.size(), CV_8U);
  constexpr int kMargin = 30;
  inside(cv::Rect(kMargin, kMargin, inside.cols - 2 * kMargin, inside.rows - 2 * kMargin)) = 255;
  slam::OrbExtractor extractor;
  for (const cv::KeyPoint& point : extractor.extract(frame.warped, inside).key_points) {
    frame.corners.push_back(point.pt);
  }
}

void addMatches(RealFrame& frame, const cv::Mat& depth, cv::RNG& random) {
  cv::Matx33d rotation;
  cv::Rodrigues(cv::Vec3d(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), 0.005),
                rotation);
  const cv::Vec3d translation(random.uniform(-0.03, 0.03), random.uniform(-0.02, 0.02),
                              random.uniform(-0.03, 0.03));
  for (const cv::Point2f& corner : frame.corners) {
    const double z = depth.at<std::uint16_t>(cv::Point(corner)) / 5000.0;
    if (z <= 0.0) {
      continue;
    }
    const cv::Vec3d q =
        kCamera * (rotation * (kCamera.inv() * cv::Vec3d(corner.x, corner.y, 1) * z) + translation);
    const cv::Point2d moved(q[0] / q[2], q[1] / q[2]);
    frame.exact.emplace_back(corner.x, corner.y, moved.x, moved.y);
    const bool wrong = random.uniform(0.0, 1.0) < 0.4;
    const double spread = wrong ? 15.0 : 0.1;  // px
    frame.earlier.push_back(corner);
    frame.current.emplace_back(static_cast<float>(moved.x + random.gaussian(spread)),
                               static_cast<float>(moved.y + random.gaussian(spread)));
  }
}

std::filesystem::path datasetFolder() {
  const char* const named = std::getenv("HMCDYN_BENCH_FRAMES");
  return named != nullptr ? named : HMCDYN_BENCH_FRAMES;
}

std::vector<std::filesystem::path> imagesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Every second frame with the depth image that is nearest in the order of time; none where the
/// folder is missing.
const std::vector<RealFrame>& frames() {
  static const std::vector<RealFrame> loaded = [] {
    std::vector<RealFrame> result;
    const std::vector<std::filesystem::path> colour = imagesIn(datasetFolder() / "rgb");
    const std::vector<std::filesystem::path> depth = imagesIn(datasetFolder() / "depth");
    cv::RNG random(7);
    for (std::size_t i = 0; i < std::min(colour.size(), depth.size()); i += 2) {
      RealFrame frame;
      frame.gray = cv::imread(colour[i].string(), cv::IMREAD_GRAYSCALE);
      const cv::Mat metres = cv::imread(depth[i].string(), cv::IMREAD_UNCHANGED);
      if (frame.gray.empty() || metres.type() != CV_16U || result.size() >= kMostFrames) {
        continue;
      }
      addWarp(frame, random);
      addMatches(frame, metres, random);
      result.push_back(std::move(frame));
    }
    return result;
  }();
  return loaded;
}

bool isReady(benchmark::State& state) {
  if (frames().empty()) {
    state.SkipWithError(("no frames in " + datasetFolder().string() +
                         "; HMCDYN_BENCH_FRAMES names a folder in TUM's format")
                            .c_str());
    return false;
  }
  return true;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// --- optical flow
// -----------------------------------------------------------------------------------

/// From the corners of `warped` into `gray`; NaN = lost.
using Flow = std::function<std::vector<cv::Point2f>(const RealFrame&)>;

void measureFlow(benchmark::State& state, const Flow& flow) {
  if (!isReady(state)) {
    return;
  }
  std::vector<double> errors;
  double points = 0.0;
  double good = 0.0;
  for (const RealFrame& frame : frames()) {
    const std::vector<cv::Point2f> found = flow(frame);
    std::vector<cv::Point2f> truth;
    cv::perspectiveTransform(frame.corners, truth, frame.homography.inv());
    for (std::size_t i = 0; i < found.size(); ++i) {
      points += 1.0;
      if (!std::isnan(found[i].x)) {
        errors.push_back(cv::norm(found[i] - truth[i]));
        good += errors.back() < 1.0 ? 1.0 : 0.0;
      }
    }
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(flow(frames()[k++ % frames().size()]));
  }
  state.counters["median_px"] = median(errors);
  state.counters["found_percent"] = 100.0 * static_cast<double>(errors.size()) / points;
  state.counters["good_percent"] = 100.0 * good / points;
}

Flow lucasKanade(int window, int level, int iterations) {
  return [=](const RealFrame& frame) {
    std::vector<cv::Point2f> found;
    std::vector<std::uint8_t> status;
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, iterations, 0.01);
    cv::calcOpticalFlowPyrLK(frame.warped, frame.gray, frame.corners, found, status, cv::noArray(),
                             {window, window}, level, stop);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (status[i] == 0) {
        found[i] = {kNaN, kNaN};
      }
    }
    return found;
  };
}

std::vector<cv::Point2f> ourFlow(const RealFrame& frame) {
  const OpticalFlowOptions options;
  KeyPoints points;
  for (const cv::Point2f& corner : frame.corners) {
    points.u.push_back(corner.x);
    points.v.push_back(corner.y);
    points.depth.push_back(0.0f);
  }
  const FlowMatches matches =
      trackIntoEarlierFrame(buildFlowPyramid(frame.warped, options),
                            buildFlowPyramid(frame.gray, options), points.view(), options);
  std::vector<cv::Point2f> found;
  for (std::size_t i = 0; i < matches.u.size(); ++i) {
    found.emplace_back(matches.u[i], matches.v[i]);
  }
  return found;
}

// --- fundamental matrix
// -----------------------------------------------------------------------------

/// F with current^T F earlier = 0; empty = none.
using Fundamental = std::function<cv::Mat(const RealFrame&)>;

void measureFundamental(benchmark::State& state, const Fundamental& estimate) {
  if (!isReady(state)) {
    return;
  }
  std::vector<double> errors;
  double failed = 0.0;
  for (const RealFrame& frame : frames()) {
    const cv::Mat found = estimate(frame);
    if (found.rows != 3) {
      failed += 1.0;
      continue;
    }
    const cv::Matx33d f = found;
    for (const cv::Vec4d& pair : frame.exact) {
      const cv::Vec3d line = f * cv::Vec3d(pair[0], pair[1], 1.0);
      errors.push_back(std::abs(line.dot(cv::Vec3d(pair[2], pair[3], 1.0))) /
                       std::hypot(line[0], line[1]));
    }
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(estimate(frames()[k++ % frames().size()]));
  }
  state.counters["median_px"] = median(errors);
  state.counters["failed"] = failed;
}

Fundamental byOpenCv(int method, bool refit) {
  return [=](const RealFrame& frame) {
    cv::setRNGSeed(1);
    cv::Mat mask;
    constexpr double kThreshold = 1.0;  // px
    cv::Mat f =
        cv::findFundamentalMat(frame.earlier, frame.current, method, kThreshold, 0.99, 1000, mask);
    if (!refit || f.rows != 3) {
      return f;
    }
    std::vector<cv::Point2f> earlier;
    std::vector<cv::Point2f> current;
    for (int i = 0; i < mask.rows; ++i) {
      if (mask.at<std::uint8_t>(i) != 0) {
        earlier.push_back(frame.earlier[static_cast<std::size_t>(i)]);
        current.push_back(frame.current[static_cast<std::size_t>(i)]);
      }
    }
    return cv::findFundamentalMat(earlier, current, cv::FM_8POINT);
  };
}

cv::Mat ourFundamental(const RealFrame& frame) {
  std::vector<float> earlier_u, earlier_v, u, v;
  for (std::size_t i = 0; i < frame.earlier.size(); ++i) {
    earlier_u.push_back(frame.earlier[i].x);
    earlier_v.push_back(frame.earlier[i].y);
    u.push_back(frame.current[i].x);
    v.push_back(frame.current[i].y);
  }
  const TwoViewEstimate estimate = estimateTwoViewModel({earlier_u, earlier_v, u, v}, {});
  cv::Mat f;
  if (estimate.model.kind == TwoViewModelKind::kFundamental) {
    f.create(3, 3, CV_64F);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        f.at<double>(row, column) = estimate.model.matrix(row, column);
      }
    }
  }
  return f;
}

// --- features
// ---------------------------------------------------------------------------------------

using Extract = std::function<std::vector<cv::KeyPoint>(const cv::Mat&)>;

void measureFeatures(benchmark::State& state, const Extract& extract) {
  if (!isReady(state)) {
    return;
  }
  constexpr int kCell = 40;  // px
  double cells = 0.0;
  double points = 0.0;
  for (const RealFrame& frame : frames()) {
    std::set<std::pair<int, int>> taken;
    const std::vector<cv::KeyPoint> found = extract(frame.gray);
    for (const cv::KeyPoint& point : found) {
      taken.emplace(static_cast<int>(point.pt.x) / kCell, static_cast<int>(point.pt.y) / kCell);
    }
    cells += static_cast<double>(taken.size());
    points += static_cast<double>(found.size());
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(extract(frames()[k++ % frames().size()].gray));
  }
  state.counters["points"] = points / static_cast<double>(frames().size());
  state.counters["cells_percent"] =
      100.0 * cells / static_cast<double>(frames().size()) / (640.0 / kCell * 480.0 / kCell);
}

std::vector<cv::KeyPoint> openCvFeatures(const cv::Mat& gray) {
  static const cv::Ptr<cv::ORB> orb = cv::ORB::create(kPoints);
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  orb->detectAndCompute(gray, cv::noArray(), points, descriptors);
  benchmark::DoNotOptimize(descriptors.data);
  return points;
}

std::vector<cv::KeyPoint> ourFeatures(const cv::Mat& gray) {
  static slam::OrbExtractor extractor;
  return extractor.extract(gray).key_points;
}

void registerAll() {
  const std::string n = "/" + std::to_string(kPoints) + "/";
  const auto flow = [&n](const std::string& name, Flow run) {
    benchmark::RegisterBenchmark(("optical_flow" + n + name).c_str(), measureFlow, std::move(run));
  };
  flow("hmcdyn", ourFlow);
  flow("lk_21_level3_30", lucasKanade(21, 3, 30));
  flow("lk_21_level2_30", lucasKanade(21, 2, 30));
  flow("lk_15_level2_10", lucasKanade(15, 2, 10));
  flow("lk_11_level2_10", lucasKanade(11, 2, 10));
  flow("lk_9_level2_10", lucasKanade(9, 2, 10));
  const auto fundamental = [&n](const std::string& name, Fundamental run) {
    benchmark::RegisterBenchmark(("fundamental" + n + name).c_str(), measureFundamental,
                                 std::move(run));
  };
  fundamental("hmcdyn", ourFundamental);
  fundamental("fm_ransac", byOpenCv(cv::FM_RANSAC, false));
  fundamental("fm_lmeds", byOpenCv(cv::FM_LMEDS, false));
  fundamental("usac_8pts", byOpenCv(cv::USAC_FM_8PTS, false));
  fundamental("usac_8pts_refit", byOpenCv(cv::USAC_FM_8PTS, true));
  fundamental("usac_magsac_refit", byOpenCv(cv::USAC_MAGSAC, true));
  benchmark::RegisterBenchmark(("features" + n + "hmcdyn").c_str(), measureFeatures, ourFeatures);
  benchmark::RegisterBenchmark(("features" + n + "cv_orb").c_str(), measureFeatures,
                               openCvFeatures);
}

}  // namespace
}  // namespace hmcdyn::bench

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  hmcdyn::bench::registerAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
