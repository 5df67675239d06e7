// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "slam/run/command_line.hpp"
#include "slam/run/run.hpp"
#include "slam/run/stop_request.hpp"
#include "slam/run/summary.hpp"
#include "support/command_line.hpp"

namespace {

constexpr int kBadData = 1;

void printSummary(const nlohmann::json& summary, const std::filesystem::path& output) {
  const nlohmann::json& counts = summary.at("counts");
  std::cout << "tracked " << counts.at("frames_tracked") << " of " << counts.at("frames_in")
            << " frames";
  if (counts.at("color_images_without_depth_image") > 0) {
    std::cout << " (" << counts.at("color_images_without_depth_image")
              << " more colour images have no depth image)";
  }
  if (counts.at("frames_dropped") > 0) {
    std::cout << " (" << counts.at("frames_dropped") << " dropped as late)";
  }
  if (counts.at("stopped_by_signal")) {
    std::cout << ", stopped by a signal at frame " << counts.at("frames_in");
    if (counts.at("frames_expected") > 0) {
      std::cout << " of " << counts.at("frames_expected");
    }
  }
  if (summary.contains("evaluation") && summary.at("evaluation").contains("ate_m")) {
    std::cout << ", ATE RMSE " << summary.at("evaluation").at("ate_m").at("rmse").get<double>()
              << " m over " << summary.at("evaluation").at("ate_m").at("pairs") << " poses";
  }
  std::cout << "\nresults in " << output.string() << '\n';
  for (const nlohmann::json& error : summary.at("errors")) {
    spdlog::error("{} failed in this run; see summary.json", error.at("part").get<std::string>());
  }
}

int run(int argc, char** argv) {
  hmcdyn::slam::SlamOptions options;
  CLI::App app("", "hmcdyn_slam");
  hmcdyn::slam::declareOptions(app, options);
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  try {
    const hmcdyn::slam::StopRequest stop;             // Ctrl-C finishes what there is
    options.loops.closer.bundle.stop = &stop.flag();  // but for minutes of global adjustment
    const nlohmann::json summary = hmcdyn::slam::runSlam(options, [&] { return stop.requested(); });
    printSummary(summary, options.output);
    return hmcdyn::slam::exitCodeOf(summary);
  } catch (const std::invalid_argument& error) {
    spdlog::error("{}", error.what());
    return hmcdyn::support::kBadUsage;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    // Logs go to standard error; standard output is the result.
    spdlog::set_default_logger(spdlog::stderr_color_mt("hmcdyn_slam"));
    spdlog::set_pattern("%^%l%$: %v");
    cv::setNumThreads(1);  // no hidden threads; one seed, one result
    return run(argc, argv);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kBadData;
  }
}
