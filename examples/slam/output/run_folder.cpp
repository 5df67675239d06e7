// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/run_folder.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hmcdyn::slam {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file) {
  const std::string reason = errno != 0 ? std::strerror(errno) : "unknown error";
  throw std::runtime_error(file.string() + ": cannot be written: " + reason);
}

}  // namespace

LineFile::LineFile(std::filesystem::path file) : file_(std::move(file)) {
  errno = 0;
  stream_.open(file_, std::ios::trunc);
  if (!stream_) {
    fail(file_);
  }
}

void LineFile::append(const std::string& lines) {
  errno = 0;
  stream_ << lines << std::flush;
  if (!stream_) {
    fail(file_);
  }
}

void makeRunFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": cannot be made a folder: " +
                             (error ? error.message() : "there is a file of that name"));
  }
  const std::filesystem::path probe = folder / ".write_test";
  LineFile(probe).append("\n");
  std::filesystem::remove(probe);
}

std::string trajectoryLine(double timestamp, const Eigen::Isometry3d& camera_from_world) {
  const Eigen::Isometry3d pose = camera_from_world.inverse();
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
  const Eigen::Vector3d t = pose.translation();
  return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", timestamp, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string timingsHeader(const StageTimes& frame) {
  std::string header = "timestamp";
  for (const StageTime& time : frame.stages()) {
    header += "," + time.stage + "_ms";
  }
  for (const StageTime& time : frame.stages()) {
    header += "," + time.stage + "_cpu_ms";
  }
  return header + "\n";
}

std::string timingsRow(double timestamp, const StageTimes& frame) {
  std::string row = fmt::format("{:.6f}", timestamp);
  for (const StageTime& time : frame.stages()) {
    row += fmt::format(",{:.3f}", time.wall_ms);
  }
  for (const StageTime& time : frame.stages()) {
    row += fmt::format(",{:.3f}", time.cpu_ms);
  }
  return row + "\n";
}

std::string keyPointsHeader() { return "timestamp,u,v,depth,distance,cluster,label,weight\n"; }

std::string keyPointRows(double timestamp, const KeyPointsView& points, Span<const float> distance,
                         Span<const int> cluster, Span<const PointLabel> label,
                         Span<const float> weight) {
  checkKeyPoints(points);
  const std::size_t n = points.size();
  if (distance.size() != n || cluster.size() != n || label.size() != n || weight.size() != n) {
    throw std::invalid_argument(
        fmt::format("keyPointRows: {} points, {} distances, {} clusters, {} labels, {} weights; "
                    "expected equal sizes",
                    n, distance.size(), cluster.size(), label.size(), weight.size()));
  }
  std::string rows;
  for (std::size_t i = 0; i < n; ++i) {
    rows += fmt::format("{:.6f},{:.3f},{:.3f},{:.4f},{:.4f},{},{},{:.4f}\n", timestamp, points.u[i],
                        points.v[i], hasDepth(points.depth[i]) ? points.depth[i] : 0.0f,
                        distance[i], cluster[i], toString(label[i]), weight[i]);
  }
  return rows;
}

void writeJson(const std::filesystem::path& file, const nlohmann::json& content) {
  const std::filesystem::path unfinished = file.string() + ".part";
  LineFile(unfinished).append(content.dump(2) + "\n");
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) {
    throw std::runtime_error(file.string() + ": cannot be written: " + error.message());
  }
}

}  // namespace hmcdyn::slam
