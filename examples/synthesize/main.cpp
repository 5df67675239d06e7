// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "support/command_line.hpp"
#include "support/progress_bar.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/sequence.hpp"

namespace {

using hmcdyn::synthesize::NoiseModel;
using hmcdyn::synthesize::SequenceOptions;

constexpr const char* kDescription =
    "Renders a dynamic RGB-D sequence in the format of the TUM benchmark, with exact ground "
    "truth.\n"
    "\n"
    "  hmcdyn_synthesize --list\n"
    "  hmcdyn_synthesize --scene walking_xyz --output out/walking_xyz --frames 150\n"
    "  hmcdyn_synthesize --scene crowd --output out/crowd --box-drop 0.1 --box-jitter 4\n"
    "  hmcdyn_synthesize --scene empty --output out/exact --noise none\n"
    "  hmcdyn_synthesize --scene empty --output out/biased --noise kinect_systematic\n"
    "\n"
    "Written: rgb/, depth/ (16-bit, 5000 = 1 m), mask/ (0 static, 128 person at rest, 255 "
    "moving),\n"
    "rgb.txt, depth.txt, associations.txt, groundtruth.txt, boxes.txt, calibration.yaml.\n";

void parseSize(const std::string& text, SequenceOptions& options) {
  char rest = '\0';
  if (std::sscanf(text.c_str(), "%dx%d%c", &options.width, &options.height, &rest) != 2) {
    throw CLI::ValidationError("--size", "'" + text + "' is not WIDTHxHEIGHT, e.g. 640x480");
  }
}

void addOptions(CLI::App& app, SequenceOptions& options, std::string& size, bool& quiet) {
  const std::map<std::string, NoiseModel> models{
      {"kinect", NoiseModel::kKinect},
      {"kinect_systematic", NoiseModel::kKinectSystematic},
      {"none", NoiseModel::kNone}};
  app.add_option("-s,--scene", options.scene, "Scene to render; --list shows them")
      ->capture_default_str();
  app.add_option("-o,--output", options.output,
                 "Folder to write; made if missing; not needed with --list");
  app.add_option("-n,--frames", options.frames, "Number of frames at 30 Hz")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Same seed, same bytes")->capture_default_str();
  app.add_option("--noise", options.noise,
                 "kinect: depth noise and holes, RGB noise, motion blur, exposure; "
                 "kinect_systematic: that with a biased and misplaced depth image, as sensor.yaml "
                 "tells; none: exact")
      ->transform(CLI::CheckedTransformer(models, CLI::ignore_case)
                      .description("{kinect,kinect_systematic,none}"))
      ->default_str("kinect");
  app.add_option("--size", size, "Image size, WIDTHxHEIGHT (px)")->capture_default_str();
  app.add_option("--trajectory", options.trajectory,
                 "TUM trajectory (timestamp tx ty tz qx qy qz qw) to move the camera along; turned "
                 "and shifted as a whole so that its mean pose is the scene's view")
      ->check(CLI::ExistingFile);
  app.add_option("--exposure", options.exposure, "Shutter time of the kinect models (s)")
      ->capture_default_str();
  app.add_option("--moving-speed", options.moving_speed,
                 "Surfaces faster than this are moving in mask/ (m/s)")
      ->capture_default_str();
  app.add_option("--box-drop", options.box_drop, "Probability that a true box is missing, 0..1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--box-jitter", options.box_jitter, "Standard deviation of a box's borders (px)")
      ->check(hmcdyn::support::zeroOrMore())
      ->capture_default_str();
  app.add_option("-j,--threads", options.threads, "Threads; 0 = one a core")
      ->check(hmcdyn::support::zeroOrMore())
      ->capture_default_str();
  app.add_flag("--overwrite", options.overwrite, "Replace the files of a non-empty folder");
  app.add_flag("-q,--quiet", quiet, "No progress bar");
}

int run(int argc, char** argv) {
  SequenceOptions options;
  std::string size = "640x480";
  bool list = false;
  bool quiet = false;
  CLI::App app(kDescription, "hmcdyn_synthesize");
  addOptions(app, options, size, quiet);
  app.add_flag("--list", list, "Print the scenes and end");
  const auto code = hmcdyn::support::parseCommandLine(app, argc, argv, [&] {
    parseSize(size, options);
    if (!list && options.output.empty()) {
      throw CLI::RequiredError("--output");
    }
  });
  if (code) {
    return *code;
  }
  if (list) {
    for (const auto& scene : hmcdyn::synthesize::sceneCatalog()) {
      std::printf("%-20s %s\n", scene.name.c_str(), scene.description.c_str());
    }
    return 0;
  }
  cv::setNumThreads(1);  // frames are the unit of parallel work
  hmcdyn::support::ProgressBar bar("frames", static_cast<std::size_t>(options.frames), !quiet);
  hmcdyn::synthesize::writeSequence(options, [&bar](std::size_t done) { bar.update(done); });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "hmcdyn_synthesize: %s\n", error.what());
    return hmcdyn::support::kBadUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_synthesize: %s\n", error.what());
    return 1;
  }
}
