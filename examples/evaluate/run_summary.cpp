// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hmcdyn::evaluate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

double finiteNumber(const nlohmann::json& value, const char* name) {
  const double number = value.at(name).get<double>();
  if (!std::isfinite(number) || number < 0.0) {
    throw std::invalid_argument(fmt::format("{} is {}; expected a number >= 0", name, number));
  }
  return number;
}

std::optional<ErrorSummary> errorOf(const nlohmann::json& evaluation, const char* name) {
  if (!evaluation.contains(name)) {
    return std::nullopt;
  }
  const nlohmann::json& error = evaluation.at(name);
  return ErrorSummary{finiteNumber(error, "rmse"), finiteNumber(error, "std")};
}

RunSummary parse(const nlohmann::json& summary) {
  const nlohmann::json& counts = summary.at("counts");
  if (counts.at("stopped_by_signal").get<bool>()) {
    throw std::invalid_argument("the run was stopped before its end");
  }
  if (counts.contains("write_failures") && !counts.at("write_failures").empty()) {
    throw std::invalid_argument("the run could not write its results: " +
                                counts.at("write_failures").front().get<std::string>());
  }
  if (summary.contains("errors") && !summary.at("errors").empty()) {
    const nlohmann::json& error = summary.at("errors").front();
    throw std::invalid_argument(fmt::format("{} failed in the run: {}",
                                            error.at("part").get<std::string>(),
                                            error.at("error").get<std::string>()));
  }
  RunSummary run;
  run.frames = counts.at("frames_in").get<std::size_t>();
  run.tracked = counts.at("frames_tracked").get<std::size_t>();
  if (run.frames == 0 || run.tracked > run.frames) {
    throw std::invalid_argument(fmt::format(
        "{} of {} frames tracked; expected at least one frame, and no more tracked than there are",
        run.tracked, run.frames));
  }
  run.tracking_ms = finiteNumber(summary, "tracking_cpu_ms");
  if (summary.contains("evaluation")) {
    const nlohmann::json& evaluation = summary.at("evaluation");
    run.ate = errorOf(evaluation, "ate_m");
    run.translation = errorOf(evaluation, "rpe_translation_m_per_s");
    run.rotation = errorOf(evaluation, "rpe_rotation_deg_per_s");
  }
  return run;
}

std::vector<fs::path> foldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

}  // namespace

RunSummary readRunSummary(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    fail(file, "cannot be read");
  }
  try {
    return parse(nlohmann::json::parse(stream));
  } catch (const nlohmann::json::exception& error) {
    fail(file, std::string("is no complete summary: ") + error.what());
  } catch (const std::invalid_argument& error) {
    fail(file, error.what());
  }
}

RunCollection collectRuns(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    fail(folder, "is no folder");
  }
  RunCollection collection;
  for (const fs::path& sequence : foldersIn(folder)) {
    for (const fs::path& variant : foldersIn(sequence)) {
      for (const fs::path& run_folder : foldersIn(variant)) {
        try {
          RunSummary run = readRunSummary(run_folder / "summary.json");
          run.sequence = sequence.filename().string();
          run.variant = variant.filename().string();
          run.name = run_folder.filename().string();
          collection.runs.push_back(std::move(run));
        } catch (const std::runtime_error& error) {
          collection.unfinished.emplace_back(error.what());
        }
      }
    }
  }
  return collection;
}

}  // namespace hmcdyn::evaluate
