// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/chart_data.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

namespace hmcdyn::slam {
namespace {

using Json = nlohmann::json;

/// Rounded to a number of decimals, so that it is short as text; null where it is not finite.
Json rounded(double value, double decimals_factor) {
  if (!std::isfinite(value) || std::abs(value) > 1e12) {
    return nullptr;
  }
  return std::round(value * decimals_factor) / decimals_factor;
}

constexpr double kTenthMillimetre = 1e4;
constexpr double kMicrosecond = 1e6;  // of seconds
constexpr double kMicrosecondOfMs = 1e3;

template <class Value>
Json column(const std::vector<ReportFrame>& frames, const Value& value) {
  Json values = Json::array();
  for (const ReportFrame& frame : frames) {
    values.push_back(value(frame));
  }
  return values;
}

Json positions(const std::vector<ReportFrame>& frames, Eigen::Vector3d ReportFrame::*position) {
  Json axes = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    axes.push_back(column(frames, [&](const ReportFrame& frame) {
      return (frame.*position).allFinite() ? rounded((frame.*position)[axis], kTenthMillimetre)
                                           : Json(nullptr);
    }));
  }
  return axes;
}

/// Names in the order of their first use, and each frame's index in them.
struct Categories {
  Json names = Json::array();
  Json index = Json::array();
};

Categories categories(const std::vector<ReportFrame>& frames, std::string ReportFrame::*name) {
  Categories result;
  std::map<std::string, int> known;
  for (const ReportFrame& frame : frames) {
    if ((frame.*name).empty()) {
      result.index.push_back(-1);
      continue;
    }
    const auto [place, is_new] = known.try_emplace(frame.*name, static_cast<int>(known.size()));
    if (is_new) {
      result.names.push_back(frame.*name);
    }
    result.index.push_back(place->second);
  }
  return result;
}

bool timeIncreases(const std::vector<ReportFrame>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!std::isfinite(frames[i].timestamp) ||
        (i > 0 && frames[i].timestamp <= frames[i - 1].timestamp)) {
      return false;
    }
  }
  return true;
}

/// The frame of a time stamp, where its position is known.
std::optional<std::size_t> findFrame(const std::vector<ReportFrame>& frames, double timestamp) {
  constexpr double kSameStamp = 1e-5;  // s
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (std::abs(frames[i].timestamp - timestamp) < kSameStamp && frames[i].position.allFinite()) {
      return i;
    }
  }
  return std::nullopt;
}

Json acceptedLoops(const ReportInput& input) {
  Json pairs = Json::array();
  for (const LoopRow& loop : input.loops) {
    const auto current = findFrame(input.frames, loop.timestamp);
    const auto matched = findFrame(input.frames, loop.matched_timestamp);
    if (loop.refusal.empty() && current && matched) {
      pairs.push_back({*current, *matched});
    }
  }
  return pairs;
}

Json stageColumns(const ReportInput& input) {
  Json stages = Json::array();
  for (std::size_t i = 0; i < input.stages.size(); ++i) {
    stages.push_back(
        {{"name", input.stages[i]}, {"ms", column(input.frames, [&](const auto& frame) {
                                       return rounded(frame.stage_ms[i], kMicrosecondOfMs);
                                     })}});
  }
  return stages;
}

}  // namespace

Json chartData(const ReportInput& input) {
  const std::vector<ReportFrame>& frames = input.frames;
  const double start = frames.empty() ? 0.0 : frames.front().timestamp;
  Json data;
  data["x_is_frame"] = !timeIncreases(frames);
  data["t"] =
      column(frames, [&](const auto& f) { return rounded(f.timestamp - start, kMicrosecond); });
  data["p"] = positions(frames, &ReportFrame::position);

  const auto has_truth = [](const ReportFrame& frame) { return frame.truth.allFinite(); };
  const bool truth = std::any_of(frames.begin(), frames.end(), has_truth);
  data["truth"] = truth ? positions(frames, &ReportFrame::truth) : Json(nullptr);
  double max_error = -1.0;
  for (const ReportFrame& frame : frames) {
    max_error = std::isfinite(frame.error) ? std::max(max_error, frame.error) : max_error;
  }
  data["max_error"] = std::max(max_error, 0.0);
  data["error"] = max_error < 0.0 ? Json(nullptr) : column(frames, [](const auto& frame) {
    return rounded(frame.error, 10.0 * kTenthMillimetre);
  });

  data["stages"] = stageColumns(input);
  data["labels"] = {
      {"static", column(frames, [](const auto& frame) { return frame.static_points; })},
      {"suspect", column(frames, [](const auto& frame) { return frame.suspect_points; })},
      {"dynamic", column(frames, [](const auto& frame) { return frame.dynamic_points; })},
      {"unmatched", column(frames, [](const auto& frame) { return frame.unmatched_points; })}};
  data["boxes"] = column(frames, [](const auto& frame) { return frame.boxes; });
  data["dynamic_boxes"] = column(frames, [](const auto& frame) { return frame.dynamic_boxes; });
  const Categories models = categories(frames, &ReportFrame::model);
  const Categories failures = categories(frames, &ReportFrame::failure);
  data["models"] = models.names;
  data["model"] = models.index;
  data["failures"] = failures.names;
  data["failure"] = failures.index;
  data["key"] = column(frames, [](const auto& frame) { return frame.key_frame ? 1 : 0; });
  data["loops"] = acceptedLoops(input);
  return data;
}

}  // namespace hmcdyn::slam
