// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "mask/mask_run.hpp"
#include "support/command_line.hpp"
#include "support/progress_bar.hpp"

namespace {

using hmcdyn::masking::MaskRunCounts;
using hmcdyn::masking::MaskRunOptions;

void addOptions(CLI::App& app, MaskRunOptions& options) {
  app.add_option("--dataset", options.dataset,
                 "Folder in TUM format: rgb/, depth/, and associations.txt or rgb.txt, depth.txt")
      ->required();
  app.add_option("--camera", options.camera,
                 "tum1, tum2, tum3, bonn, or a calibration file (YAML, ours or another system's)")
      ->required();
  app.add_option("--output", options.output, "Folder for mask/ and things.csv")->required();
  app.add_option("--trajectory", options.trajectory,
                 "Poses of the camera, 'timestamp tx ty tz qx qy qz qw' "
                 "(default: DATASET/groundtruth.txt)");
  app.add_option("--boxes", options.boxes,
                 "Boxes of things that may move, 'timestamp class x_min y_min x_max y_max score' "
                 "(default: no detector)");
  app.add_option("--max-frames", options.max_frames, "Stop after so many frames; 0 = all")
      ->capture_default_str();
  app.add_option("--max-depth", options.mask.max_depth,
                 "Farther pixels (m) are unknown: depth cameras err by too much")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--max-moving", options.mask.max_moving_share,
                 "A mask over more than this share of the depths is reported")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_flag("--write-static-depth", options.write_static_depth,
               "Also write depth/STAMP.png: the depth, 0 where something moves or may move");
  app.add_flag("--annotate", options.annotate,
               "Also write annotated/STAMP.jpg: red moves, yellow stands, dark is unknown");
}

std::string summary(const MaskRunCounts& counts, const MaskRunOptions& options) {
  return fmt::format(
      "{} frames: {} judged, {} not (no pose, no depth, first frame or a jump), {} cover more than "
      "{:.0f} %\n{:.1f} % of the pixels move; {:.2f} ms of CPU time a mask; masks in {}\n",
      counts.frames, counts.judged, counts.unknown, counts.too_large,
      100.0f * options.mask.max_moving_share, 100.0 * counts.moving_share, counts.milliseconds,
      (options.output / "mask").string());
}

}  // namespace

int main(int argc, char** argv) {
  MaskRunOptions options;
  CLI::App app(
      "Writes a mask for every frame of an RGB-D recording: which pixels move. Needs the camera's\n"
      "poses, no detector; boxes make it better where there are any.",
      "hmcdyn_mask");
  app.footer(
      "OUTPUT/mask/STAMP.png, named by the colour image, 8 bit: 0 static, 255 moves, 128 stands "
      "but may\nmove (it moved before, or a box names it), 64 unknown: no depth, out of range, "
      "nothing to compare\nwith (the first frame), or no pose. OUTPUT/things.csv: number, box, "
      "velocity in the world.\nWith a distorted lens masks belong to the undistorted images.\n"
      "No poses at hand? Any tracker's will do, also hmcdyn_slam's:\n"
      "  hmcdyn_slam --dataset D --camera C --output out\n"
      "  hmcdyn_mask --dataset D --camera C --trajectory out/trajectory.txt --output masks\n"
      "Where the trajectory has no pose within --max-pose-gap the mask is unknown.\n"
      "Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  addOptions(app, options);
  app.add_option("--max-pose-gap", options.max_pose_gap,
                 "Poses at most so far apart (s) are interpolated")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  if (options.trajectory.empty()) {
    options.trajectory = options.dataset / "groundtruth.txt";
  }
  try {
    MaskRunCounts counts;
    {
      std::unique_ptr<hmcdyn::support::ProgressBar> bar;
      counts = writeMasks(
          options,
          [&](std::size_t done, std::size_t total) {
            if (!bar) {
              bar = std::make_unique<hmcdyn::support::ProgressBar>("frames", total);
            }
            bar->update(done);
          },
          [](const std::string& line) { std::fprintf(stderr, "hmcdyn_mask: %s\n", line.c_str()); });
    }
    std::fputs(summary(counts, options).c_str(), stdout);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_mask: %s\n", error.what());
    return 1;
  }
}
