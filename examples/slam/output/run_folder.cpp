// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/run_folder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "slam/output/tum_line.hpp"

namespace hmcdyn::slam {
namespace {

constexpr const char* kTrajectoryFile = "trajectory.txt";
constexpr const char* kOnlineTrajectoryFile = "trajectory_online.txt";
constexpr const char* kTimingsFile = "timings.csv";
constexpr const char* kKeyPointsFile = "keypoints.csv";
constexpr const char* kSummaryFile = "summary.json";
constexpr const char* kKeyFramesFile = "keyframes.txt";
constexpr const char* kLoopsFile = "loops.csv";
constexpr const char* kMapFile = "map.ply";
constexpr const char* kReportFile = "report.html";
constexpr std::size_t kReserve = std::size_t{1} << 20U;  // bytes

/// Fixed decimals whatever the locale, and NaN without its sign.
std::string number(double value, int decimals) {
  return std::isnan(value) ? "nan" : fmt::format("{:.{}f}", value, decimals);
}

void checkStages(const std::vector<std::string>& stages) {
  for (auto stage = stages.begin(); stage != stages.end(); ++stage) {
    if (stage->empty() || stage->find_first_of(",\"\r\n") != std::string::npos ||
        std::find(stages.begin(), stage, *stage) != stage) {
      throw std::invalid_argument("timings: stage name \"" + *stage +
                                  "\"; expected names without commas, quotes and line breaks, "
                                  "none empty, each once");
    }
  }
}

void checkSizes(const LabelledKeyPoints& frame) {
  checkKeyPoints(frame.points);
  const std::size_t n = frame.points.size();
  if (frame.distances.size() != n || frame.clusters.size() != n || frame.labels.size() != n ||
      frame.weights.size() != n || frame.sizes.size() != n) {
    throw std::invalid_argument(
        fmt::format("key points: {} points, {} distances, {} clusters, {} labels, {} weights, "
                    "{} sizes; expected equal sizes",
                    n, frame.distances.size(), frame.clusters.size(), frame.labels.size(),
                    frame.weights.size(), frame.sizes.size()));
  }
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& file) : file_(file) {}

void TrajectoryWriter::write(double timestamp, const Eigen::Isometry3d& camera_from_world) {
  file_.append(tumLine(timestamp, camera_from_world));
}

void TrajectoryWriter::finish(const std::vector<StampedPose>& poses) {
  std::string lines;
  for (const StampedPose& pose : poses) {
    lines += tumLine(pose.timestamp, pose.camera_from_world);
  }
  const std::filesystem::path online = file_.path().parent_path() / kOnlineTrajectoryFile;
  std::error_code error;
  std::filesystem::copy_file(file_.path(), online,
                             std::filesystem::copy_options::overwrite_existing, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(online, ignored);  // no half copies
    throw std::runtime_error(online.string() + ": cannot be written: " + error.message());
  }
  replaceFile(file_.path(), lines);
}

TimingsWriter::TimingsWriter(const std::filesystem::path& file, std::vector<std::string> stages)
    : stages_((checkStages(stages), std::move(stages))), file_(file) {
  std::string header = "timestamp";
  for (const char* unit : {"wall_ms", "cpu_ms"}) {
    for (const std::string& stage : stages_) {
      header += fmt::format(",{}_{}", stage, unit);
    }
  }
  file_.append(header + "\n");
}

void TimingsWriter::write(double timestamp, const support::StageTimes& times) {
  for (const support::StageTime& time : times.stages()) {
    if (std::find(stages_.begin(), stages_.end(), time.stage) == stages_.end()) {
      throw std::invalid_argument("timings: stage \"" + time.stage + "\" has no column");
    }
  }
  std::string row = fmt::format("{:.6f}", timestamp);
  for (const auto value : {&support::StageTime::wall_ms, &support::StageTime::cpu_ms}) {
    for (const std::string& stage : stages_) {
      const support::StageTime* time = times.find(stage);
      row += "," + (time == nullptr ? "nan" : number(time->*value, 4));
    }
  }
  file_.append(row + "\n");
}

KeyPointsWriter::KeyPointsWriter(const std::filesystem::path& file) : file_(file) {
  file_.append("timestamp,u,v,depth,distance,cluster,label,weight,size\n");
}

void KeyPointsWriter::write(double timestamp, const LabelledKeyPoints& frame) {
  checkSizes(frame);
  std::string rows;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    fmt::format_to(std::back_inserter(rows), "{:.6f},{},{},{},{},{},{},{},{}\n", timestamp,
                   number(frame.points.u[i], 3), number(frame.points.v[i], 3),
                   number(frame.points.depth[i], 4), number(frame.distances[i], 4),
                   frame.clusters[i], toString(frame.labels[i]), number(frame.weights[i], 4),
                   number(frame.sizes[i], 1));
  }
  file_.append(rows);
}

RunFolder::RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  const auto fail = [&](const std::string& reason) {
    throw std::runtime_error("output folder " + folder_.string() + ": " + reason);
  };
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    fail("cannot be created: " + error.message());
  }
  if (!std::filesystem::is_directory(folder_)) {
    fail("is no folder");
  }
  for (const char* name : {kTrajectoryFile, kOnlineTrajectoryFile, kTimingsFile, kKeyPointsFile,
                           kSummaryFile, kKeyFramesFile, kLoopsFile, kMapFile, kReportFile}) {
    std::filesystem::remove(folder_ / name, error);
    if (error) {
      fail(std::string(name) + " of an earlier run cannot be removed: " + error.message());
    }
  }
  try {
    // Permissions alone do not tell: disks fill, mounts are read-only.
    const std::filesystem::path file = folder_ / ".reserve";
    reserve_.emplace(file);
    std::filesystem::remove(file);
    reserve_->append(std::string(kReserve, '\n'));
  } catch (const std::exception& cause) {
    fail(cause.what());
  }
}

TrajectoryWriter RunFolder::trajectory() const {
  return TrajectoryWriter(folder_ / kTrajectoryFile);
}

TimingsWriter RunFolder::timings(std::vector<std::string> stages) const {
  return {folder_ / kTimingsFile, std::move(stages)};
}

KeyPointsWriter RunFolder::keyPoints() const { return KeyPointsWriter(folder_ / kKeyPointsFile); }

KeyFramesWriter RunFolder::keyFrames() const { return KeyFramesWriter(folder_ / kKeyFramesFile); }

LoopsWriter RunFolder::loops() const { return LoopsWriter(folder_ / kLoopsFile); }

std::size_t RunFolder::writeMap(const PointCloud& cloud) const {
  return writePly(folder_ / kMapFile, cloud);
}

void RunFolder::writeReport(const std::string& html) const {
  replaceFile(folder_ / kReportFile, html);
}

void RunFolder::writeSummary(const nlohmann::json& summary) const {
  // Paths among the options may hold bytes that are no UTF-8.
  replaceFile(folder_ / kSummaryFile,
              summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace hmcdyn::slam
