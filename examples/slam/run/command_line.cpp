// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/command_line.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "slam/input/camera/calibration.hpp"
#include "slam/run/detection_options.hpp"
#include "support/command_line.hpp"
#include "support/time_unit_option.hpp"

namespace hmcdyn::slam {
namespace {

std::string join(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) {
    joined += (joined.empty() ? "" : ", ") + name;
  }
  return joined;
}

/// "hmc" is the paper's method, "robust" ours, and the others replace its judgement alone.
FrameFilterOptions filterOf(const std::string& name) {
  if (name == "hmc") {
    return FrameFilterOptions::paper();
  }
  FrameFilterOptions options = FrameFilterOptions::robust();
  if (name != "robust") {
    options.rule = *filterRuleFromString(name);
  }
  return options;
}

std::vector<std::string> filterNames() {
  std::vector<std::string> names = {"robust"};
  for (const FilterRule rule : kFilterRules) {
    names.emplace_back(toString(rule));
  }
  return names;
}

void declareInput(CLI::App& app, SlamOptions& options) {
  app.add_option("--dataset", options.dataset,
                 "Folder in TUM RGB-D format (BONN's is the same): rgb.txt, depth.txt, perhaps "
                 "associations.txt and groundtruth.txt")
      ->group("Input");
  app.add_option("--source", options.source,
                 "folder (--dataset), or live (a depth camera, in real time)")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, SourceKind>{{"folder", SourceKind::kFolder},
                                                                    {"live", SourceKind::kLive}})
              .description("{folder,live}"))
      ->default_str("folder")
      ->group("Input");
  app.add_option("--live-backend", options.live.backend, "Driver of the live camera")
      ->check(CLI::IsMember(depthCameraBackends()))
      ->capture_default_str()
      ->group("Input");
  app.add_option("--live-index", options.live.index, "Which of the live cameras, from 0")
      ->capture_default_str()
      ->group("Input");
  app.add_option("--mode", options.mode,
                 "offline (every frame waits for its detection; one seed, one result) or realtime "
                 "(frames by their stamps, late ones dropped and counted)")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, RunMode>{{"offline", RunMode::kOffline},
                                                                 {"realtime", RunMode::kRealtime}})
              .description("{offline,realtime}"))
      ->default_str("offline")
      ->group("Input");
  app.add_option("--speed", options.speed, "realtime: so many times as fast as it was recorded")
      ->check(support::aboveZero())
      ->capture_default_str()
      ->group("Input");
  app.add_option("--held-images", options.held_images,
                 "realtime: images that the camera's driver holds while tracking is late; when "
                 "another comes, the oldest is dropped (1: only the newest waits)")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->group("Input");
  app.add_option("--camera", options.camera,
                 "Camera: " + join(cameraPresetNames()) +
                     ", or a calibration YAML (ours, or a settings file of ORB-SLAM2/3 and others)")
      ->capture_default_str()
      ->group("Input");
  app.add_option("--associations", options.association.associations,
                 "Associations file (default: associations.txt of the data set, else rgb.txt and "
                 "depth.txt are paired by time stamp)")
      ->group("Input");
  app.add_option("--time-tolerance", options.association.time_tolerance,
                 "Largest time between a colour image and its depth (s)")
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Input");
  support::addTimeUnit(app, options.association.time_unit,
                       "Of the time stamps in the data set's lists", true)
      ->group("Input");
  app.add_option("--groundtruth", options.groundtruth,
                 "Ground-truth trajectory (default: groundtruth.txt of the data set, if it is "
                 "there); gives ATE and RPE in summary.json")
      ->group("Input");
  app.add_option("--max-frames", options.max_frames, "Stop after so many frames (0 = all)")
      ->capture_default_str()
      ->group("Input");
}

/// First of the options: what comes after it changes single values of what it sets.
void declareMethod(CLI::App& app, SlamOptions& options) {
  app.add_option_function<std::string>(
         "--filter",
         [&options](const std::string& name) {
           options.filter_name = name;
           options.filter = filterOf(name);
           options.bridge = options.filter.bridge;
         },
         "robust (ours), hmc (the paper and nothing else), or another's rule in place of ours: box "
         "(drop whole boxes), dynamic_box (drop those that move), epipolar (one threshold), "
         "two_threshold (SG-SLAM), chi2 (OVD-SLAM), depth_ransac (YOLO-SLAM), none")
      ->check(CLI::IsMember(filterNames()))
      ->default_str("robust")
      ->group("Filter");
  app.add_option(
         "--ablation", options.ablation,
         "robust or hmc without a part of it: rs (every point in a dynamic box is "
         "dropped), df (one threshold in place of clusters; weights 0 and 1), opw (weights 0 "
         "and 1 in the refinement; the map stays as it is)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Ablation>{{"none", Ablation::kNone},
                                                                          {"rs", Ablation::kRs},
                                                                          {"df", Ablation::kDf},
                                                                          {"opw", Ablation::kOpw}})
                      .description("{none,rs,df,opw}"))
      ->default_str("none")
      ->group("Filter");
}

void declareFilter(CLI::App& app, SlamOptions& options) {
  FrameFilterOptions& motion = options.filter;
  FilterStageOptions& stage = motion.expert.stage;
  app.add_flag_callback(
         "--no-soft-weights", [&motion] { motion.soft_weight_gate = 1.0; },
         "Weights 0 and 1 only in the refinement, as --ablation opw")
      ->group("Filter");
  app.add_option("--baselines", motion.baselines,
                 "Ages (s) of the earlier frames that the filter compares with; 0 = the neighbour")
      ->delimiter(',')
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--min-kept", motion.min_kept,
                 "Where fewer key points would be left, the least moving of the others are kept at "
                 "low weight; 0 = never")
      ->check(support::zeroOrMore())
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--cluster-epsilon", stage.clustering.epsilon,
                 "d_eps: neighbourhood radius over (s_z depth, s_d distance)")
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--cluster-min-points", stage.clustering.min_points,
                 "MinPoints of a core point, itself counted")
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--depth-scale", stage.clustering.depth_scale, "s_z (1/m)")
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--distance-scale", stage.clustering.distance_scale, "s_d (1/px)")
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--min-strongest-distance", stage.cluster_filter.min_strongest_distance,
                 "Least mean distance of the strongest dynamic cluster (px); 0 = the paper's rule")
      ->capture_default_str()
      ->group("Filter");
  app.add_option("--screening-floor", stage.cluster_filter.screening_floor,
                 "Least mean distance of a cluster for rough screening (px); 0 = the paper's rule")
      ->capture_default_str()
      ->group("Filter");
}

void declareBelief(CLI::App& app, SlamOptions& options) {
  DynamicFeatureFilterOptions& filter = options.filter.expert;
  MotionBeliefOptions& belief = filter.belief;
  app.add_flag("!--no-belief", filter.use_belief,
               "Without the votes of neighbours and of earlier frames: the paper's filter alone")
      ->group("Belief");
  app.add_option("--vote-sigma", belief.sigma, "Reach of a vote within the frame (px)")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--memory-gain", belief.memory_gain,
                 "Weight of what earlier frames believed against the votes of the frame")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--quiet-weight", belief.quiet_weight,
                 "Weight of a vote for \"at rest\" in a box, 0..1: people pause")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--dynamic-belief", belief.dynamic_belief,
                 "A point believed to move by more than this is dynamic, 0..1")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--certain-weight", belief.certain_weight,
                 "Points in boxes speak for the camera from this weight of a belief on, 0..1")
      ->capture_default_str()
      ->group("Belief");
  OpticalFlowOptions& flow = filter.flow;
  app.add_option("--flow-window", flow.window, "Side of the window of optical flow (px, odd)")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--flow-iterations", flow.max_iterations, "Iterations of optical flow a level")
      ->capture_default_str()
      ->group("Belief");
  app.add_option("--flow-level", flow.max_level, "Coarsest pyramid level of optical flow")
      ->capture_default_str()
      ->group("Belief");
  app.add_flag("--forward-backward", flow.forward_backward,
               "Check matches of optical flow by tracking forth again, for twice the time")
      ->group("Belief");
  app.add_option(
         "--max-followed", options.filter.max_followed,
         "Key points followed by optical flow, most of them in boxes; their neighbours vote "
         "on the others; 0 = all")
      ->capture_default_str()
      ->group("Belief");
}

void declareTracking(CLI::App& app, SlamOptions& options) {
  app.add_option("--features", options.features.features, "ORB key points a frame")
      ->capture_default_str()
      ->group("Tracking");
  app.add_option("--max-feature-factor", options.max_feature_factor,
                 "So many times more key points at most where boxes cover much of the image")
      ->capture_default_str()
      ->group("Tracking");
  app.add_flag("!--no-motion-model", options.tracker.fuse_motion,
               "Poses as measured, not together with what the motion before them tells")
      ->group("Tracking");
  app.add_flag("!--no-mapping", options.mapping.enabled, "Without local bundle adjustment")
      ->group("Tracking");
  app.add_flag("!--no-loops", options.loops.enabled,
               "Without loop closing and relocalisation by place")
      ->group("Tracking");
  app.add_option("--max-depth", options.tracker.map.max_depth,
                 "Farther points (m) do not enter the map")
      ->check(support::aboveZero())
      ->capture_default_str()
      ->group("Tracking");
  app.add_option("--seed", options.seed, "Of every random draw; one seed, one result")
      ->capture_default_str()
      ->group("Tracking");
}

void declareOutput(CLI::App& app, SlamOptions& options) {
  app.add_option("--output", options.output,
                 "Folder for trajectory.txt, timings.csv, summary.json; made if missing")
      ->required()
      ->group("Output");
  app.add_flag("--annotate", options.annotate,
               "A picture a frame in OUTPUT/frames: boxes, labels, clusters")
      ->group("Output");
  app.add_flag("--write-keypoints", options.write_keypoints,
               "keypoints.csv: timestamp,u,v,depth,distance,cluster,label,weight,"
               "size")
      ->group("Output");
  app.add_flag("--write-boxes", options.write_boxes,
               "boxes.txt: what the detector found, for --detector file --boxes")
      ->group("Output");
  app.add_flag("--write-masks", options.write_masks,
               "OUTPUT/masks/STAMP.png, a frame each, 8 bit, named by the colour image: 0 static, "
               "255 moves, 128 stands but may move, 64 unknown (--filter robust)")
      ->group("Output");
  app.add_flag("--write-static-depth", options.write_static_depth,
               "OUTPUT/static_depth/STAMP.png: the depth, scaled as the input's, 0 where something "
               "moves or may move (--filter robust)")
      ->group("Output");
  app.add_flag("!--no-dense-map", options.dense_map, "No map.ply")->group("Output");
  app.add_flag("!--no-report", options.write_report, "No report.html")->group("Output");
  app.add_flag("--quiet", options.quiet, "No progress bar")->group("Output");
}

}  // namespace

void prepareOptions(SlamOptions& options) {
  options.filter = without(options.ablation, options.filter);
  if (options.mode == RunMode::kRealtime || options.source == SourceKind::kLive) {
    options.mode = RunMode::kRealtime;
    options.mapping.delay = 0;
    options.loops.delay = 0;
  }
  options.loops.detector.place.seed = options.seed;
  options.loops.detector.verification.ransac.seed = options.seed;
  options.loops.relocalizer.ransac.seed = options.seed;
  options.filter.seed = options.seed;
}

SlamOptions withDepthError(SlamOptions options, const DepthErrorModel& depth_error) {
  options.tracker.map.depth_error = depth_error;
  options.mapping.adjustment.depth_error = depth_error;
  options.loops.detector.verification.ransac.depth_error = depth_error;
  options.loops.closer.bundle.depth_error = depth_error;
  options.loops.relocalizer.ransac.depth_error = depth_error;
  return options;
}

void declareOptions(CLI::App& app, SlamOptions& options) {
  options.detector.classes = {kPersonClassId};
  app.description(
      "RGB-D SLAM for dynamic scenes: tracks the camera through a folder of colour and depth "
      "images while the filter keeps key points on moving things out of the way.");
  app.footer(
      "Example:\n"
      "  hmcdyn_slam --dataset rgbd_dataset_freiburg3_walking_xyz --camera tum3 \\\n"
      "    --detector darknet --model yolo-fastest-1.1.cfg --weights yolo-fastest-1.1.weights \\\n"
      "    --filter robust --output out\n"
      "Exit codes: 0 done, 1 bad data, a full disk or an error in a part of the system (results "
      "are\n"
      "written all the same), 2 bad usage, 3 fewer than half of the frames have a pose.");
  declareMethod(app, options);
  declareInput(app, options);
  declareDetection(app, options);
  declareFilter(app, options);
  declareBelief(app, options);
  declareTracking(app, options);
  declareOutput(app, options);
}

}  // namespace hmcdyn::slam
