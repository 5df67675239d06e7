// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/detection_options.hpp"

#include <optional>
#include <string>
#include <vector>

#include "slam/detect/coco_classes.hpp"
#include "slam/detect/detector_factory.hpp"
#include "support/command_line.hpp"

namespace hmcdyn::slam {
namespace {

/// "person,chair", "0,56" or "all".
std::vector<int> parseClasses(const std::string& list) {
  std::vector<int> classes;
  if (list == "all") {
    return classes;
  }
  for (const std::string& name : CLI::detail::split(list, ',')) {
    const std::optional<int> id = findCocoClass(name);
    if (!id) {
      throw CLI::ValidationError("--classes", "'" + name +
                                                  "' is no COCO class; expected names such as "
                                                  "person, numbers 0 to 79, or all");
    }
    classes.push_back(*id);
  }
  return classes;
}

CLI::Validator inputSize() {
  return {[](const std::string& text) {
            constexpr int kStride = 32;  // px; of the coarsest of YOLO's layers
            constexpr int kLargest = 4096;
            int size = 0;
            const bool good = CLI::detail::lexical_cast(text, size) && size >= 0 &&
                              size <= kLargest && size % kStride == 0;
            return good ? std::string()
                        : "is " + text + "; expected 0, or a multiple of 32 up to 4096 (px)";
          },
          "PX"};
}

CLI::Validator secondsToWait() {
  return {[](const std::string& text) {
            constexpr double kLongest = 1e6;
            double seconds = 0.0;
            const bool good =
                CLI::detail::lexical_cast(text, seconds) && seconds > 0.0 && seconds <= kLongest;
            return good ? std::string() : "is " + text + "; expected more than 0, up to 1e6 (s)";
          },
          "SECONDS"};
}

void declareCommand(CLI::App& app, CommandOptions& command) {
  app.add_option("--command", command.line,
                 "Program for --detector command, with its arguments: an image a frame comes on "
                 "its standard input, boxes or a mask go back (docs/detectors.md)")
      ->group("Detection");
  app.add_option("--command-timeout", command.timeout,
                 "Longest time (s) to its answer; then it is killed and started again")
      ->check(secondsToWait())
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--command-start-timeout", command.start_timeout,
                 "Longest time (s) to its first line, while it loads its model")
      ->check(secondsToWait())
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--command-restarts", command.restarts,
                 "So often it is started again after it died, hung or answered garbage")
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Detection");
}

}  // namespace

void declareDetection(CLI::App& app, SlamOptions& options) {
  DetectorOptions& detector = options.detector;
  app.add_option("--detector", detector.type,
                 "Where boxes come from: darknet, yolo (ONNX) and hog see people; file reads them "
                 "(--boxes); masks reads label images in place of boxes (--masks); command asks a "
                 "program of yours (--command); none needs no model: --filter robust goes by its "
                 "motion mask alone")
      ->check(CLI::Validator(describeFormerType, ""))
      ->check(CLI::IsMember(detectorTypes()))
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--model", detector.model, "Model: .cfg for darknet, .onnx for yolo (v5 or v8)")
      ->group("Detection");
  app.add_option("--weights", detector.weights, "Weights of a darknet model")->group("Detection");
  app.add_option("--boxes", detector.boxes,
                 "Boxes for --detector file; a line: timestamp class x_min y_min x_max y_max score")
      ->group("Detection");
  app.add_option(
         "--masks", detector.masks,
         "Folder for --detector masks: a PNG a frame, named by the time stamp of its colour "
         "image; 8 or 16 bit, 0 = background, every other value may move")
      ->group("Detection");
  app.add_option("--mask-margin", detector.mask_margin,
                 "Regions are that much larger than their masks (px): what lies at a silhouette "
                 "is on neither side")
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Detection");
  declareCommand(app, detector.command);
  app.add_option(
         "--input-size", detector.input_size,
         "Side of the network's input (px), a multiple of 32: an ONNX model's is fixed by its "
         "export; 0 = 640 for yolo, as in the .cfg for darknet")
      ->check(inputSize())
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--score-threshold", detector.score_threshold, "Lowest score of a box, 0..1")
      ->check(support::zeroToOne())
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--nms-threshold", detector.nms_threshold,
                 "Overlap (intersection over union) above which the weaker box goes, 0..1")
      ->check(support::zeroToOne())
      ->capture_default_str()
      ->group("Detection");
  app.add_option("--bridge", options.bridge,
                 "A box that the detector missed is carried on by optical flow for so long (s); "
                 "0 = never")
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Detection");
  app.add_option_function<std::string>(
         "--classes",
         [&detector](const std::string& list) { detector.classes = parseClasses(list); },
         "COCO classes to report, by name or number, or 'all' (default: person)")
      ->group("Detection");
}

}  // namespace hmcdyn::slam
