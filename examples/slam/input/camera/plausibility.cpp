// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

// Bounds of what lenses and sensors are, not of any data set: horizontal fields of view from 3 to
// 157 degrees.
constexpr double kLeastFocal = 0.1;     // image widths
constexpr double kLargestFocal = 20.0;  // image widths
constexpr double kLargestAspect = 2.0;  // of fx and fy

std::string written(const PinholeCamera& camera) {
  return fmt::format("fx {:g}, fy {:g}, cx {:g}, cy {:g}", camera.fx, camera.fy, camera.cx,
                     camera.cy);
}

// Of an image that is `scale` times as large; the centre of the first pixel is 0.
PinholeCamera scaled(const PinholeCamera& camera, double scale) {
  return {camera.fx * scale, camera.fy * scale, (camera.cx + 0.5) * scale - 0.5,
          (camera.cy + 0.5) * scale - 0.5};
}

std::string whatIsWrongWithFocal(const CameraCalibration& calibration) {
  const PinholeCamera& camera = calibration.pinhole;
  constexpr double kLargestShare = 10.0;
  const bool is_small = camera.fx < kLargestShare && camera.fy < kLargestShare;
  if (is_small && camera.cx > kLargestShare && camera.cy > kLargestShare) {
    return fmt::format(
        "fx {:g} and fy {:g} look like millimetres, as cx {:g} and cy {:g} are pixels; expected "
        "pixels: the focal length times the image's columns over the sensor's width",
        camera.fx, camera.fy, camera.cx, camera.cy);
  }
  if (is_small) {
    return fmt::format(
        "fx {:g} and fy {:g} look like shares of the image's sides; expected pixels{}", camera.fx,
        camera.fy,
        calibration.width > 0
            ? fmt::format(": {}?",
                          written({camera.fx * calibration.width, camera.fy * calibration.height,
                                   camera.cx * calibration.width, camera.cy * calibration.height}))
            : "");
  }
  if (camera.fx > kLargestAspect * camera.fy || camera.fy > kLargestAspect * camera.fx) {
    return fmt::format(
        "fx {:g} and fy {:g} differ by more than a factor of 2; expected nearly "
        "square pixels",
        camera.fx, camera.fy);
  }
  if (calibration.width > 0 && (camera.fx < kLeastFocal * calibration.width ||
                                camera.fx > kLargestFocal * calibration.width)) {
    return fmt::format("fx {:g} is no lens's for images of {} columns; expected {:g} to {:g}",
                       camera.fx, calibration.width, kLeastFocal * calibration.width,
                       kLargestFocal * calibration.width);
  }
  return {};
}

// A principal point is near the image's centre; where both its coordinates are by one factor too
// far from the corner, the intrinsics are of another resolution.
std::string whatIsWrongWithCentre(const CameraCalibration& calibration) {
  const PinholeCamera& camera = calibration.pinhole;
  const double across = (camera.cx + 0.5) / (0.5 * calibration.width);
  const double down = (camera.cy + 0.5) / (0.5 * calibration.height);
  const double factor = 0.5 * (across + down);
  constexpr double kAgreement = 0.15;  // a principal point lies within some per cent of the centre
  constexpr double kOther = 1.45;      // resolutions differ by a factor of 1.5 and more
  const bool other = across > 0.0 && down > 0.0 && std::abs(across - down) < kAgreement * factor &&
                     (factor > kOther || factor < 1.0 / kOther);
  if (other) {
    constexpr std::array<double, 8> kFactors{1.5, 2.0, 3.0, 4.0, 2.0 / 3, 0.5, 1.0 / 3, 0.25};
    const double nearest =
        *std::min_element(kFactors.begin(), kFactors.end(), [&](double a, double b) {
          return std::abs(std::log(factor / a)) < std::abs(std::log(factor / b));
        });
    return fmt::format(
        "cx {:g} and cy {:g} are the centre of images of about {:.0f} x {:.0f}, not of {} x {}; "
        "{}: {}?",
        camera.cx, camera.cy, nearest * calibration.width, nearest * calibration.height,
        calibration.width, calibration.height,
        nearest == 2.0 ? "halve them" : fmt::format("are they to be times {:g}", 1.0 / nearest),
        written(scaled(camera, 1.0 / nearest)));
  }
  if (!(camera.cx >= 0.0 && camera.cx < calibration.width && camera.cy >= 0.0 &&
        camera.cy < calibration.height)) {
    return fmt::format(
        "the principal point ({:g}, {:g}) is outside the image of {} x {}; expected it near ({:g}, "
        "{:g}){}",
        camera.cx, camera.cy, calibration.width, calibration.height, 0.5 * calibration.width - 0.5,
        0.5 * calibration.height - 0.5,
        across > 0.0 && down > 0.0
            ? fmt::format(" (it is the centre of an image of about {:.0f} x {:.0f})",
                          across * calibration.width, down * calibration.height)
            : "");
  }
  return {};
}

// Where k1, k2, p1, p2 and k3 move what is as far to the right of the centre as the nearest border
// of an image of this size, as a multiple of its distance (Brown's model, as OpenCV writes it).
double stretchAtBorder(const CameraCalibration& calibration) {
  const double radius = std::min(0.5 * calibration.width / calibration.pinhole.fx,
                                 0.5 * calibration.height / calibration.pinhole.fy);
  const double square = radius * radius;
  const auto& [k1, k2, p1, p2, k3] = calibration.distortion;
  const double along = 1.0 + square * (k1 + square * (k2 + square * k3)) + 3.0 * p2 * radius;
  const double across = p1 * radius;
  return along < 0.0 ? along : std::hypot(along, across);
}

// A lens is one to one up to its border: with k1 alone the model folds over where it squeezes to
// two thirds, so a third is no lens's, nor is, stretched, twice: pincushions are of some per cent.
std::string whatIsWrongWithDistortion(const CameraCalibration& calibration) {
  constexpr double kLeast = 1.0 / 3.0;
  constexpr double kAtMost = 2.0;
  const double stretch = stretchAtBorder(calibration);
  if (stretch >= kLeast && stretch <= kAtMost) {
    return {};
  }
  const auto& [k1, k2, p1, p2, k3] = calibration.distortion;
  return fmt::format(
      "the distortion k1 {:g}, k2 {:g}, p1 {:g}, p2 {:g}, k3 {:g} is no lens's: it would put the "
      "border of an image of {} x {} at {:.3g} times its distance from the centre; expected a "
      "third to twice (k1 is seldom above 1; are these values of other keys?)",
      k1, k2, p1, p2, k3, calibration.width, calibration.height, stretch);
}

float quantile(std::vector<float>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string length(double metres) {
  return metres >= 1000.0 ? fmt::format("{:.3g} km", metres / 1000.0)
         : metres >= 0.1  ? fmt::format("{:.3g} m", metres)
                          : fmt::format("{:.2g} cm", 100.0 * metres);
}

/// The depth factor that the steps between the depths around their median tell, if they are those
/// of structured light, which measures disparities of 1/8 px with a focal length of 580 px and a
/// baseline of 7.5 cm: z^2 / 348 m. 0 where they are finer than a few units.
double factorByStepsOfStructuredLight(const std::vector<float>& depths, double median,
                                      double depth_factor) {
  constexpr double kAround = 0.05;        // of the median
  constexpr double kInverseStep = 348.0;  // 1 / m
  constexpr double kLeastStep = 3.0;      // units; below, it is the file's resolution
  std::vector<double> levels;
  for (const float depth : depths) {
    if (std::abs(depth - median) < kAround * median) {
      levels.push_back(std::round(static_cast<double>(depth) * depth_factor));
    }
  }
  const std::size_t around = levels.size();
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  constexpr std::size_t kFew = 6;    // levels
  constexpr std::size_t kOften = 5;  // depths a level; else the gaps are those of the sample
  if (levels.size() < kFew || around < kOften * levels.size()) {
    return 0.0;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    steps.push_back(levels[i] - levels[i - 1]);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double value = median * depth_factor;
  return *middle < kLeastStep ? 0.0 : value * value / (kInverseStep * *middle);
}

}  // namespace

bool isBaseline(double baseline_fx, double fx) {
  const double metres = baseline_fx / fx;
  return metres >= 0.005 && metres <= 5.0;
}

std::string whatIsImplausible(const CameraCalibration& calibration) {
  std::string wrong = whatIsWrongWithFocal(calibration);
  if (wrong.empty() && calibration.width > 0) {
    wrong = whatIsWrongWithCentre(calibration);
  }
  if (wrong.empty() && calibration.width > 0) {
    wrong = whatIsWrongWithDistortion(calibration);
  }
  if (!wrong.empty()) {
    return wrong;
  }
  if (calibration.depth_factor < 1.0 || calibration.depth_factor > 1e6) {
    return fmt::format(
        "the depth factor {:g} is implausible; expected the depth images' value of one metre, such "
        "as 5000, or 1000 for millimetres{}",
        calibration.depth_factor,
        calibration.depth_factor < 1.0
            ? fmt::format(": is it metres a step, {:g} a metre?", 1.0 / calibration.depth_factor)
            : "");
  }
  if (calibration.baseline_fx && !isBaseline(*calibration.baseline_fx, calibration.pinhole.fx)) {
    return fmt::format(
        "baseline_fx {:g} is a baseline of {}; expected baseline times fx (m px), for 8 cm {:g}",
        *calibration.baseline_fx, length(*calibration.baseline_fx / calibration.pinhole.fx),
        0.08 * calibration.pinhole.fx);
  }
  return {};
}

CameraCalibration fittedTo(CameraCalibration calibration, cv::Size image, const std::string& name) {
  const bool has_size = calibration.width > 0 && calibration.height > 0;
  if (has_size && cv::Size(calibration.width, calibration.height) != image) {
    const double across = static_cast<double>(image.width) / calibration.width;
    const double down = static_cast<double>(image.height) / calibration.height;
    throw std::runtime_error(
        fmt::format("camera {}: is for images of {} x {}, but the images are {} x {}{}", name,
                    calibration.width, calibration.height, image.width, image.height,
                    std::abs(across - down) < 0.01 * across
                        ? fmt::format("; if they were only scaled: {}?",
                                      written(scaled(calibration.pinhole, across)))
                        : "; they were cut, or are another camera's: calibrate for them"));
  }
  calibration.width = image.width;
  calibration.height = image.height;
  const std::string wrong = whatIsImplausible(calibration);
  if (!wrong.empty()) {
    throw std::runtime_error(fmt::format("camera {}: {}", name, wrong));
  }
  return calibration;
}

std::vector<std::string> whatIsUnusual(const CameraCalibration& calibration) {
  std::vector<std::string> unusual;
  const PinholeCamera& camera = calibration.pinhole;
  constexpr double kSquare = 1.15;  // sides of a pixel; today's are square within 1 %
  if (camera.fx > kSquare * camera.fy || camera.fy > kSquare * camera.fx) {
    unusual.push_back(fmt::format(
        "fx {:g} and fy {:g} differ by {:.0f} %, pixels of cameras are square; were the images "
        "scaled in one direction, or is one of them another's?",
        camera.fx, camera.fy,
        100.0 * (std::max(camera.fx, camera.fy) / std::min(camera.fx, camera.fy) - 1.0)));
  }
  if (calibration.width <= 0 || calibration.height <= 0) {
    return unusual;
  }
  const auto off = [](double coordinate, int side) {
    return std::abs(coordinate + 0.5 - 0.5 * side) / side;
  };
  constexpr double kCentred = 0.1;  // image sides; lenses sit within some per cent of the centre
  const double across = off(camera.cx, calibration.width);
  const double down = off(camera.cy, calibration.height);
  if (across <= kCentred && down <= kCentred) {
    return unusual;
  }
  const bool is_swapped = across > kCentred && down > kCentred &&
                          off(camera.cy, calibration.width) < 0.5 * kCentred &&
                          off(camera.cx, calibration.height) < 0.5 * kCentred;
  unusual.push_back(fmt::format(
      "the principal point ({:g}, {:g}) is far from the centre of images of {} x {}; {}", camera.cx,
      camera.cy, calibration.width, calibration.height,
      is_swapped ? "are cx and cy swapped?"
                 : "is it of an image that was cut or has another size?"));
  return unusual;
}

std::string whatIsOddAbout(std::vector<float> depths, double depth_factor) {
  if (depths.empty()) {
    return {};
  }
  const double median = quantile(depths, 0.5);
  const double near = quantile(depths, 0.05);
  const double far = quantile(depths, 0.95);
  constexpr double kFarthest = 20.0;   // m, of a median
  constexpr double kNearest = 0.05;    // m, of a median
  constexpr double kUsualNear = 0.28;  // m: Kinect, Xtion and RealSense see nothing nearer
  constexpr double kUsualFar = 2.2;    // m: what a factor of 5000 makes of 11 m in millimetres
  constexpr double kReach = 10.0;      // m: what these cameras reach at most
  constexpr double kTums = 5000.0;
  const bool is_fine = depth_factor >= 2000.0;  // finer than millimetres
  std::string odd;
  if (near == far) {
    return fmt::format("depths are {} nearly everywhere; are these depth images?", length(median));
  }
  if (median > kFarthest || median < kNearest) {
    odd = fmt::format("depths have a median of {}", length(median));
  } else if (is_fine && near < kUsualNear && far < kUsualFar && median < 1.0) {
    odd = fmt::format("depths are small for a depth camera (5 % below {}, 95 % below {})",
                      length(near), length(far));
  } else if (!is_fine && median > kReach) {
    odd = fmt::format("depths are large for a depth camera (median {})", length(median));
  } else {
    // Fives, between millimetres and TUM's factor, cannot be taken for a camera's other baseline.
    const double by_steps = factorByStepsOfStructuredLight(depths, median, depth_factor);
    constexpr double kNearly = 1.35;
    const double times = by_steps > 0.0 ? depth_factor / by_steps : 1.0;
    const bool is_five = (times > 5.0 / kNearly && times < 5.0 * kNearly) ||
                         (times < kNearly / 5.0 && times > 1.0 / (5.0 * kNearly));
    if (!is_five) {
      return {};
    }
    odd = fmt::format("the steps between depths near {} are {} those of structured light",
                      length(median), times > 1.0 ? "some five times" : "a fifth of");
  }
  for (const double factor : {1000.0, kTums}) {
    const double fitting = median * depth_factor / factor;
    if (factor != depth_factor && fitting > 0.3 && fitting < 8.0) {
      return fmt::format("{} with the depth factor {:g}; with {:g} it would be {}{}", odd,
                         depth_factor, factor, length(fitting),
                         factor == 1000.0 ? " (millimetres)" : "");
    }
  }
  return fmt::format("{} with the depth factor {:g}", odd, depth_factor);
}

}  // namespace hmcdyn::slam
