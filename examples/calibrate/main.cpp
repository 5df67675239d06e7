// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibrate/depth_plot.hpp"
#include "calibrate/run.hpp"
#include "calibrate/true_error.hpp"
#include "support/command_line.hpp"

namespace {

using namespace hmcdyn::calibrate;

struct Arguments {
  CalibrationOptions options;
  hmcdyn::slam::DepthSensor sensor = hmcdyn::slam::DepthSensor::kStructuredLight;
  std::filesystem::path output;
  std::filesystem::path plot;
  std::filesystem::path truth;
  bool measure_only = false;
};

void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

/// Asked before minutes of work.
void requireWritable(const std::filesystem::path& file) {
  const bool existed = std::filesystem::exists(file);
  if (!std::ofstream(file, std::ios::app)) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
  if (!existed) {
    std::filesystem::remove(file);
  }
}

std::vector<std::string> originOf(const Arguments& arguments, const Calibration& calibration) {
  std::vector<std::string> lines{
      fmt::format("measured by hmcdyn_calibrate_depth on {} ({} depths in {} images)",
                  arguments.options.dataset.string(), calibration.samples.size(),
                  calibration.images),
      arguments.options.scale_known
          ? "scale by a trajectory that was not made with this camera's depth"
          : "relative: no scale was known, so none is corrected"};
  if (calibration.corrects) {
    lines.push_back("correction " + describeKnown(calibration.fit));
  }
  return lines;
}

void run(const Arguments& arguments) {
  const CalibrationOptions& options = arguments.options;
  const std::string text = cameraText(options.camera);
  requireWritable(arguments.output);
  const std::optional<TrueError> truth =
      arguments.truth.empty() ? std::nullopt : std::optional(readTrueError(arguments.truth));
  const Calibration calibration = calibrateDepth(options);
  for (const std::string& note : calibration.notes) {
    fmt::print(stderr, "hmcdyn_calibrate_depth: {}\n", note);
  }
  fmt::print("{}", describe(calibration, options));
  if (truth) {
    const Recovery got = recovery(*truth, calibration.samples, calibration.fit, options.scale_known,
                                  calibration.image);
    fmt::print(
        "\nagainst {}: true error {:.3f} % RMS, {:.3f} % after the correction: {:.0f} % left\n"
        "true scale error {:.4f}; true shift {:.2f} px to the right, {:.2f} px down\n",
        arguments.truth.string(), 100.0 * got.before, 100.0 * got.after, 100.0 * got.left(),
        truth->scale, truth->shift.x, truth->shift.y);
  }
  hmcdyn::slam::DepthSettings settings = settingsOf(calibration);
  settings.sensor = arguments.sensor;
  writeText(arguments.output,
            hmcdyn::slam::withDepthSettings(text, settings, originOf(arguments, calibration)));
  if (!arguments.plot.empty() &&
      !cv::imwrite(arguments.plot.string(), drawCalibration(calibration))) {
    throw std::runtime_error(arguments.plot.string() + ": cannot be written");
  }
}

void addOptions(CLI::App& app, Arguments& arguments) {
  CalibrationOptions& options = arguments.options;
  app.add_option("--dataset", options.dataset,
                 "Recording in TUM format; nothing may move in it, the camera should: sideways, "
                 "over\nnear and far texture")
      ->required();
  app.add_option("--camera", options.camera,
                 "tum1, tum2, tum3, bonn, or a calibration file, whose other content is kept")
      ->required();
  app.add_option("--output", arguments.output, "Calibration file to write")->required();
  app.add_option("--trajectory", options.trajectory,
                 "Camera poses (TUM format), refined here; without it from the images");
  app.add_option("--position-sigma", options.position_sigma,
                 "Standard deviation of the trajectory's positions (m)")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_flag("--scale-known", options.scale_known,
               "The trajectory's scale was measured by something else than this camera's depth "
               "(motion\ncapture): the depth's scale is then measured, too");
  app.add_flag("--measure-only", arguments.measure_only,
               "Write the error as measured, and no correction");
  app.add_option("--images", options.images, "Images taken from the recording")
      ->check(CLI::Range(3, 1000))
      ->capture_default_str();
  app.add_option("--plot", arguments.plot, "Picture to draw (.png)");
  app.add_option("--truth", arguments.truth,
                 "sensor.yaml of hmcdyn_synthesize --noise kinect_systematic, to compare with");
  std::map<std::string, hmcdyn::slam::DepthSensor> sensors;
  for (const std::string& name : hmcdyn::slam::depthSensorNames()) {
    sensors[name] = *hmcdyn::slam::findDepthSensor(name);
  }
  app.add_option("--sensor", arguments.sensor, "What the file says of the kind of camera")
      ->transform(CLI::CheckedTransformer(sensors, CLI::ignore_case)
                      .description("{structured_light,time_of_flight,active_stereo}"))
      ->default_str("structured_light");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Measures how wrong a depth camera is: points of a static scene are followed through the "
      "images,\ntriangulated, and compared with their depth. Writes noise, systematic error and a "
      "correction\ninto the camera's file.",
      "hmcdyn_calibrate_depth");
  app.footer(
      "Example: hmcdyn_calibrate_depth --dataset room --camera tum1 --output tum1_depth.yaml "
      "--plot depth.png\n"
      "Exit code: 0 done, 1 the recording does not do or a file is malformed, 2 wrong usage.");
  addOptions(app, arguments);
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  arguments.options.correct = !arguments.measure_only;
  try {
    cv::setNumThreads(1);  // the same result on every machine
    run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_calibrate_depth: %s\n", error.what());
    return 1;
  }
}
