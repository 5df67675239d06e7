// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/run.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "evaluate/trajectory.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/file_io.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/input/dataset/recording.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::calibrate {
namespace {

/// A correction is written where it takes this share off the held-out median error: less is what
/// two halves of one recording differ by anyway.
constexpr double kLeastGain = 0.05;

std::vector<CalibrationImage> loadImages(const CalibrationOptions& options,
                                         const std::vector<slam::FrameEntry>& entries,
                                         const slam::CameraCalibration& camera) {
  const std::size_t step =
      std::max<std::size_t>(1, (entries.size() + static_cast<std::size_t>(options.images) - 1) /
                                   static_cast<std::size_t>(options.images));
  const slam::Rectifier rectifier(camera);
  std::vector<CalibrationImage> images;
  for (std::size_t i = 0; i < entries.size(); i += step) {
    const slam::RgbdFrame frame = slam::rectify(slam::loadFrame(entries[i], camera), rectifier);
    images.push_back({frame.timestamp, frame.gray, frame.depth});
  }
  return images;
}

ImagePoses firstPoses(const evaluate::Trajectory& given,
                      const std::vector<CalibrationImage>& images, const std::vector<Track>& tracks,
                      const PinholeCamera& camera) {
  return given.empty() ? posesFromTracks(images, tracks, camera)
                       : posesFromTrajectory(images, given);
}

/// Images and poses of a row, one after the other, that have a pose.
void dropUnknown(std::vector<CalibrationImage>& images, ImagePoses& poses,
                 std::vector<Track>& tracks) {
  std::vector<int> place(images.size(), -1);
  int kept = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (poses[i]) {
      const auto to = static_cast<std::size_t>(kept);
      images[to] = images[i];
      poses[to] = poses[i];
      place[i] = kept++;
    }
  }
  images.resize(static_cast<std::size_t>(kept));
  poses.resize(static_cast<std::size_t>(kept));
  for (Track& track : tracks) {
    Track known;
    for (const TrackPoint& point : track) {
      if (place[static_cast<std::size_t>(point.image)] >= 0) {
        known.push_back({place[static_cast<std::size_t>(point.image)], point.pixel, point.size});
      }
    }
    track = std::move(known);
  }
}

std::vector<double> measuredDepths(const std::vector<DepthSample>& samples) {
  std::vector<double> depths;
  depths.reserve(samples.size());
  for (const DepthSample& sample : samples) {
    depths.push_back(sample.measured);
  }
  return depths;
}

std::string describe(const Estimate& estimate, double factor, const char* unit) {
  return estimate.observable ? fmt::format("{:.2f} {} (+- {:.2f})", factor * estimate.value, unit,
                                           factor * estimate.deviation)
                             : "not observable";
}

std::string describe(const ErrorStatistics& statistics, const DepthErrorModel& model) {
  std::string text = "     range  points   bias (mm)  68 % (mm)  noise (mm)  systematic (mm)\n";
  for (const RangeStatistics& r : statistics.ranges) {
    text += fmt::format("{:3.1f}-{:3.1f} m {:7} {:11.1f} {:10.1f} {:11.1f} {:16.1f}\n", r.nearest,
                        r.farthest, r.count, 1e3 * r.bias, 1e3 * r.total, 1e3 * r.noise,
                        1e3 * r.systematic);
  }
  text += fmt::format("model: noise {:.4f} + {:.5f} z^2, systematic {:.4f} z + {:.5f} z^2 (m)\n",
                      model.noise_floor, model.noise_quadratic, model.systematic_linear,
                      model.systematic_quadratic);
  text += "bias by thirds of the image, away from edges (%):\n";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const auto region = std::find_if(
          statistics.regions.begin(), statistics.regions.end(),
          [&](const RegionStatistics& r) { return r.row == row && r.column == column; });
      text += region == statistics.regions.end() ? "       -"
                                                 : fmt::format(" {:7.2f}", 100.0 * region->bias);
    }
    text += "\n";
  }
  text += fmt::format("68 % of errors within {:.4f} z^2, at depth edges {:.4f} z^2 ({} points)\n",
                      statistics.elsewhere, statistics.at_edges, statistics.edges);
  return text;
}

/// The parts of the image as a picture of signs, where one is not known.
std::string describeSquares(const CorrectionFit& fit) {
  if (std::count(fit.known_squares.begin(), fit.known_squares.end(), 0) == 0) {
    return "\n";
  }
  std::string text = " (x known, . not):\n";
  const auto across = static_cast<std::size_t>(fit.correction.columns - 1);
  for (std::size_t i = 0; i < fit.known_squares.size(); ++i) {
    text += fmt::format("{}{}", fit.known_squares[i] != 0 ? " x" : " .",
                        i % across + 1 == across ? "\n" : "");
  }
  return text;
}

}  // namespace

Calibration calibrateDepth(const CalibrationOptions& options) {
  if (options.images < 3) {
    throw std::invalid_argument(
        fmt::format("CalibrationOptions: images is {}; expected at least 3", options.images));
  }
  if (!(options.position_sigma > 0.0)) {
    throw std::invalid_argument(
        fmt::format("CalibrationOptions: position_sigma is {}; expected metres above 0",
                    options.position_sigma));
  }
  if (options.scale_known && options.trajectory.empty()) {
    throw std::invalid_argument(
        "CalibrationOptions: scale_known without a trajectory; expected one that was not made "
        "with this camera's depth");
  }
  slam::Recording recording = slam::openRecording(options.dataset, options.camera);
  slam::CameraCalibration& camera = recording.calibration;
  camera.depth_correction = {};  // measured anew, from the camera's own depth
  Calibration result;
  result.notes = std::move(recording.list.notes);
  std::vector<CalibrationImage> images = loadImages(options, recording.list.frames, camera);
  result.image = {camera.width, camera.height};
  std::vector<cv::Mat> grays;
  grays.reserve(images.size());
  for (const CalibrationImage& image : images) {
    grays.push_back(image.gray);
  }
  std::vector<Track> tracks = featureTracks(grays);
  evaluate::NotedTrajectory given;
  if (!options.trajectory.empty()) {
    given = evaluate::readTrajectoryFor(options.trajectory, images.front().timestamp,
                                        images.back().timestamp);
    result.notes.insert(result.notes.end(), given.notes.begin(), given.notes.end());
  }
  ImagePoses poses = firstPoses(given.poses, images, tracks, camera.pinhole);
  dropUnknown(images, poses, tracks);
  result.images = images.size();
  TriangulationOptions triangulation_options;
  triangulation_options.position_sigma = options.position_sigma;
  result.triangulation = triangulate(images, tracks, poses, camera.pinhole, triangulation_options);
  result.samples = depthSamples(images, result.triangulation, camera.pinhole);
  CorrectionFitOptions fit_options;
  fit_options.scale_known = options.scale_known;
  result.fit = fitCorrection(result.samples, result.image, fit_options);
  result.corrects = options.correct &&
                    result.fit.held_out_after < (1.0 - kLeastGain) * result.fit.held_out_before;
  result.before = errorStatistics(result.samples, measuredDepths(result.samples),
                                  result.fit.truth_scale, result.image);
  result.after =
      errorStatistics(result.samples, result.fit.held_out, result.fit.truth_scale, result.image);
  result.model_before = fitModel(result.before.ranges);
  result.model_after = fitModel(result.after.ranges);
  result.to_color = depthToColor(images, result.samples, result.fit.correction,
                                 result.fit.truth_scale, 1.4826 * result.fit.held_out_after);
  return result;
}

slam::DepthSettings settingsOf(const Calibration& calibration) {
  slam::DepthSettings settings;
  settings.error = calibration.corrects ? calibration.model_after : calibration.model_before;
  if (calibration.corrects) {
    settings.correction = calibration.fit.correction;
  }
  return settings;
}

std::string cameraText(const std::string& camera) {
  const std::optional<slam::CameraCalibration> preset = slam::findCameraPreset(camera);
  if (!preset) {
    return support::toText(slam::readFile(camera), camera);
  }
  return fmt::format(
      "fx: {}\nfy: {}\ncx: {}\ncy: {}\ndistortion: [{}]\ndepth_factor: {}\nwidth: {}\n"
      "height: {}\nframe_rate: {}\n",
      preset->pinhole.fx, preset->pinhole.fy, preset->pinhole.cx, preset->pinhole.cy,
      fmt::join(preset->distortion, ", "), preset->depth_factor, preset->width, preset->height,
      preset->frame_rate);
}

std::string describeKnown(const CorrectionFit& fit) {
  return fmt::format(
      "known from {:.1f} to {:.1f} m in {} of {} parts of the image; a guess elsewhere",
      fit.known_range[0], fit.known_range[1],
      std::count(fit.known_squares.begin(), fit.known_squares.end(), 1), fit.known_squares.size());
}

std::string describe(const Calibration& c, const CalibrationOptions& options) {
  std::string text = fmt::format(
      "{} images, {} points triangulated (median {:.2f} px; camera positions within {:.1f} mm of "
      "the given ones), {} depths compared\n",
      c.images, c.triangulation.tracks.size(), c.triangulation.pixel_error,
      1e3 * c.triangulation.position_error, c.samples.size());
  text += "\nas measured:\n" + describe(c.before, c.model_before);
  text +=
      "\ncorrected, each point by a fit that has not seen it:\n" + describe(c.after, c.model_after);
  text += fmt::format(
      "\nmedian error {:.2f} % before and {:.2f} % after the correction where no fit looked: {}\n",
      100.0 * c.fit.held_out_before, 100.0 * c.fit.held_out_after,
      c.corrects ? "corrected" : "not worth a correction, or not wanted");
  if (c.corrects) {
    text += describeKnown(c.fit) + describeSquares(c.fit);
  }
  text += fmt::format(
      "scale: {}\n",
      options.scale_known
          ? fmt::format("depth times {:.4f} where it is near 0, see growth", c.fit.correction.scale)
          : "not observable (its trajectory's scale comes from depth); the "
            "correction changes no depth on average");
  text += fmt::format("depth lies beside colour by: {} to the right, {} down ({} points)\n",
                      describe(c.to_color.shift_u, 1.0, "px"),
                      describe(c.to_color.shift_v, 1.0, "px"), c.to_color.samples);
  text +=
      fmt::format("depth was taken after colour by: {}\n", describe(c.to_color.delay, 1e3, "ms"));
  return text;
}

}  // namespace hmcdyn::calibrate
