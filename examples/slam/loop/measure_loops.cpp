// SPDX-License-Identifier: BSD-3-Clause
// Measures place recognition, loop check and relocalisation on rendered sequences, where true poses
// and depths say which frames see the same. Every STRIDE-th frame is a key frame, without the
// points on people; a frame is compared with all frames of all sequences but those within a second
// of it: with the five that look most alike, and with the three that look most alike and share
// nothing. Usage: measure_loops STRIDE FOLDER... (as hmcdyn_synthesize writes them)

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "evaluate/trajectory.hpp"
#include "slam/features/frame.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/input/camera/calibration_file.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
#include "slam/loop/loop_verification.hpp"
#include "slam/loop/place_index.hpp"
#include "slam/loop/relocalizer.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kSecond = 30;        // frames
constexpr std::size_t kSequence = 100000;  // ids of a sequence start at a multiple of it
constexpr std::size_t kTried = 5;
constexpr int kOthersTried = 3;
constexpr double kSame = 0.4;    // overlap from which two frames see the same place
constexpr double kOther = 0.02;  // and up to which they do not

struct Keyed {
  LoopKeyFrame key_frame;
  cv::Mat depth;
};

double milliseconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

Keyed keyFrameOf(const FrameEntry& entry, const CameraCalibration& calibration,
                 const std::filesystem::path& mask_file, OrbExtractor& extractor, std::size_t id,
                 const Eigen::Isometry3d& world_from_camera) {
  const RgbdFrame image = loadFrame(entry, calibration);
  const cv::Mat people = cv::imread(mask_file.string(), cv::IMREAD_GRAYSCALE);
  const Frame frame =
      makeFrame(entry.index, entry.timestamp,
                extractor.extract(image.gray, people.empty() ? cv::Mat() : people == 0),
                image.depth, extractor.options().scale_factor);
  Keyed keyed;
  keyed.key_frame.id = id;
  keyed.key_frame.timestamp = entry.timestamp;
  keyed.key_frame.camera_from_world = world_from_camera.inverse();
  keyed.key_frame.descriptors = frame.features.descriptors;
  keyed.key_frame.points = frame.points;
  keyed.key_frame.sigma = frame.sigma;
  keyed.key_frame.map_point = frame.map_point;
  keyed.depth = image.depth;
  return keyed;
}

std::vector<Keyed> readSequence(const std::filesystem::path& folder, std::size_t number,
                                std::size_t stride, PinholeCamera& camera) {
  const CameraCalibration calibration = readCalibrationFile(folder / "calibration.yaml");
  camera = calibration.pinhole;
  const evaluate::Trajectory truth = evaluate::readTrajectory(folder / "groundtruth.txt");
  const std::vector<FrameEntry> entries = listFrames(folder);
  OrbExtractor extractor;
  std::vector<Keyed> sequence;
  for (std::size_t i = 0; i < std::min(entries.size(), truth.size()); i += stride) {
    sequence.push_back(keyFrameOf(entries[i], calibration,
                                  folder / "mask" / entries[i].rgb.filename(), extractor,
                                  number * kSequence + i, truth[i].pose));
  }
  return sequence;
}

/// Share of the points of `a` that `b` sees too, by true poses and measured depths.
double overlapOf(const Keyed& a, const Keyed& b, const PinholeCamera& camera) {
  const KeyPoints& points = a.key_frame.points;
  const Eigen::Isometry3d motion =
      b.key_frame.camera_from_world * a.key_frame.camera_from_world.inverse();
  std::size_t seen = 0;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!hasDepth(points.depth[i])) {
      continue;
    }
    ++asked;
    const Eigen::Vector3d p = motion * camera.unproject(points.u[i], points.v[i], points.depth[i]);
    if (!(p.z() > 0.1)) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.project(p);
    if (pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < b.depth.cols - 1 &&
        pixel.y() < b.depth.rows - 1) {
      const double z = b.depth.at<float>(cvRound(pixel.y()), cvRound(pixel.x()));
      seen += std::abs(z - p.z()) < 0.03 * p.z() ? 1 : 0;
    }
  }
  return asked == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(asked);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void printQuantiles(const char* name, const std::vector<double>& values) {
  std::printf("  %-34s n %4zu  min %.4f  5%% %.4f  median %.4f  95%% %.4f  max %.4f\n", name,
              values.size(), quantile(values, 0.0), quantile(values, 0.05), quantile(values, 0.5),
              quantile(values, 0.95), quantile(values, 1.0));
}

struct Measurement {
  std::vector<double> query_ms, verify_ms, relocalize_ms;
  std::vector<double> relative_same, relative_other;  // best score to that of the neighbour
  std::vector<double> support_same, support_other, coverage_same, inliers_other, depth_same,
      depth_other;
  std::vector<double> translation_error, relocalization_error;
  std::map<std::string, int> verdicts_same, verdicts_other;
  int queries = 0, first_right = 0, among_five = 0, relocalized = 0, with_revisit = 0;
};

bool isNear(std::size_t a, std::size_t b) {
  return a / kSequence == b / kSequence && std::max(a, b) - std::min(a, b) < kSecond;
}

double translationError(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

void measureCandidate(const Keyed& query, const Keyed& other, double overlap, double relative,
                      const PinholeCamera& camera, Measurement& m) {
  const double start = milliseconds();
  const LoopVerification found = verifyLoop(other.key_frame, query.key_frame, camera);
  m.verify_ms.push_back(milliseconds() - start);
  if (overlap >= kSame) {
    ++m.verdicts_same[toString(found.verdict)];
    m.relative_same.push_back(relative);
    m.support_same.push_back(found.support);
    m.coverage_same.push_back(found.coverage);
    m.depth_same.push_back(found.depth_agreement);
  } else if (overlap <= kOther) {
    ++m.verdicts_other[toString(found.verdict)];
    m.relative_other.push_back(relative);
    m.inliers_other.push_back(static_cast<double>(found.inliers));
    m.support_other.push_back(found.support);
    m.depth_other.push_back(found.depth_agreement);
  }
  if (found.verdict == LoopVerdict::kAccepted) {
    const Eigen::Isometry3d truth =
        query.key_frame.camera_from_world * other.key_frame.camera_from_world.inverse();
    m.translation_error.push_back(translationError(found.to_from, truth));
  }
}

/// The five best candidates, and the three best of those that share nothing.
void measureCandidates(const std::map<std::size_t, Keyed>& all, const Keyed& query,
                       const std::vector<PlaceCandidate>& places, double reference, bool revisit,
                       const PinholeCamera& camera, Measurement& m) {
  bool right = false;
  int others = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Keyed& other = all.at(places[k].id);
    const double overlap = overlapOf(query, other, camera);
    const bool is_other = overlap <= kOther;
    if (k >= kTried && (!is_other || others == kOthersTried)) {
      continue;
    }
    others += is_other ? 1 : 0;
    right = right || (k < kTried && overlap >= kSame);
    m.first_right += revisit && k == 0 && right ? 1 : 0;
    const double relative = reference > 0.0 ? places[k].score / reference : 0.0;
    measureCandidate(query, other, overlap, relative, camera, m);
  }
  m.among_five += revisit && right ? 1 : 0;
}

void measureQuery(const std::map<std::size_t, Keyed>& all, const PlaceIndex& index,
                  const std::map<std::size_t, LoopKeyFrame>& key_frames, const Keyed& query,
                  const PinholeCamera& camera, Measurement& m) {
  bool revisit = false;
  std::vector<std::size_t> near;
  for (const auto& [id, other] : all) {
    if (isNear(id, query.key_frame.id)) {
      near.push_back(id);
    } else {
      revisit = revisit || overlapOf(query, other, camera) >= kSame;
    }
  }
  ++m.queries;
  double start = milliseconds();
  const auto places = index.query(query.key_frame.descriptors, index.size(), near);
  m.query_ms.push_back(milliseconds() - start);
  double reference = 0.0;
  for (const PlaceCandidate& place : index.query(query.key_frame.descriptors, index.size())) {
    if (place.id != query.key_frame.id && isNear(place.id, query.key_frame.id)) {
      reference = std::max(reference, place.score);
    }
  }
  if (revisit) {
    ++m.with_revisit;
  }
  measureCandidates(all, query, places, reference, revisit, camera, m);
  std::map<std::size_t, LoopKeyFrame> others = key_frames;
  for (const std::size_t id : near) {
    others.erase(id);
  }
  RelocalizerOptions options;
  options.max_candidates = 5 + near.size();  // those near are in the index, but are not tried
  start = milliseconds();
  const RelocalizationResult found = relocalize(query.key_frame, index, others, camera, options);
  m.relocalize_ms.push_back(milliseconds() - start);
  if (found.camera_from_world) {
    ++m.relocalized;
    m.relocalization_error.push_back(
        translationError(*found.camera_from_world, query.key_frame.camera_from_world));
  }
}

void print(const Measurement& m) {
  std::printf("queries %d, with a revisit %d: first right %d, right among five %d\n", m.queries,
              m.with_revisit, m.first_right, m.among_five);
  for (const auto* verdicts : {&m.verdicts_same, &m.verdicts_other}) {
    std::printf("candidates that %s:", verdicts == &m.verdicts_same ? "see the same" : "do not");
    for (const auto& [name, count] : *verdicts) {
      std::printf("  %s %d", name.c_str(), count);
    }
    std::printf("\n");
  }
  printQuantiles("relative score, same", m.relative_same);
  printQuantiles("relative score, other", m.relative_other);
  printQuantiles("support, same", m.support_same);
  printQuantiles("support, other", m.support_other);
  printQuantiles("coverage, same", m.coverage_same);
  printQuantiles("inliers, other", m.inliers_other);
  printQuantiles("depth agreement, same", m.depth_same);
  printQuantiles("depth agreement, other", m.depth_other);
  printQuantiles("accepted: translation error (m)", m.translation_error);
  printQuantiles("relocalised: error (m)", m.relocalization_error);
  printQuantiles("query (ms)", m.query_ms);
  printQuantiles("loop check (ms)", m.verify_ms);
  printQuantiles("relocalisation (ms)", m.relocalize_ms);
}

void measure(std::size_t stride, const std::vector<std::string>& folders) {
  std::map<std::size_t, Keyed> all;
  std::map<std::size_t, LoopKeyFrame> key_frames;
  PlaceIndex index;
  PinholeCamera camera;
  for (std::size_t s = 0; s < folders.size(); ++s) {
    for (const Keyed& keyed : readSequence(folders[s], s, stride, camera)) {
      all[keyed.key_frame.id] = keyed;
      key_frames[keyed.key_frame.id] = keyed.key_frame;
      index.add(keyed.key_frame.id, keyed.key_frame.descriptors);
    }
  }
  Measurement m;
  for (const auto& [id, query] : all) {
    measureQuery(all, index, key_frames, query, camera, m);
  }
  std::printf("key frames %zu\n", all.size());
  print(m);
}

}  // namespace
}  // namespace hmcdyn::slam

int main(int argc, char** argv) {
  const int stride = argc < 3 ? 0 : std::atoi(argv[1]);
  if (stride < 1) {
    std::fputs("usage: measure_loops STRIDE FOLDER...\n", stderr);
    return 2;
  }
  try {
    hmcdyn::slam::measure(static_cast<std::size_t>(stride), {argv + 2, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measure_loops: %s\n", error.what());
    return 1;
  }
  return 0;
}
