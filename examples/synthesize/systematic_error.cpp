// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/systematic_error.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "synthesize/pi.hpp"
#include "synthesize/random.hpp"

namespace hmcdyn::synthesize {
namespace {

constexpr int kWaves = 3;         // cosines of 0, 1 and 2 half waves in each direction
constexpr int kGridRows = 13;     // of the file: a node every 40 px at 480 rows
constexpr int kGridColumns = 17;  // the same at 640 columns
constexpr std::uint64_t kStream = 79;

void checkOptions(const SystematicErrorOptions& o) {
  const auto require = [](bool good, const char* field, double value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("SystematicErrorOptions: ") + field + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  const auto valid = [](double value) { return std::isfinite(value) && value >= 0.0; };
  require(valid(o.scale), "scale", o.scale, "a share >= 0");
  require(valid(o.quadratic), "quadratic", o.quadratic, "1/m >= 0");
  require(valid(o.shift_least), "shift_least", o.shift_least, "pixels >= 0");
  require(std::isfinite(o.shift_largest) && o.shift_largest >= o.shift_least, "shift_largest",
          o.shift_largest, "pixels >= shift_least");
}

cv::Mat smoothField(cv::Size size, Random& random) {
  std::array<std::array<double, kWaves>, kWaves> amplitude{};
  for (int i = 0; i < kWaves; ++i) {
    for (int j = 0; j < kWaves; ++j) {
      amplitude[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          random.normal() / (1.0 + i * i + j * j);
    }
  }
  const auto wave = [](int half_waves, int pixel, int pixels) {
    return std::cos(kPi * half_waves * (pixel + 0.5) / pixels);
  };
  cv::Mat field(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    std::array<double, kWaves> of_row{};
    for (int i = 0; i < kWaves; ++i) {
      for (int j = 0; j < kWaves; ++j) {
        of_row[static_cast<std::size_t>(i)] +=
            amplitude[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] *
            wave(j, v, size.height);
      }
    }
    for (int u = 0; u < size.width; ++u) {
      double value = 0.0;
      for (int i = 0; i < kWaves; ++i) {
        value += of_row[static_cast<std::size_t>(i)] * wave(i, u, size.width);
      }
      field.at<float>(v, u) = static_cast<float>(value);
    }
  }
  return field;
}

}  // namespace

SystematicError drawSystematicError(const SystematicErrorOptions& options, cv::Size size,
                                    std::uint64_t seed) {
  checkOptions(options);
  Random random(seed, kStream);
  SystematicError error;
  error.scale = options.scale * random.normal();
  const double length = random.uniform(options.shift_least, options.shift_largest);
  const double direction = random.uniform(0.0, 2.0 * kPi);
  error.shift = {length * std::cos(direction), length * std::sin(direction)};
  const cv::Mat field = smoothField(size, random);
  const double rms = cv::norm(field) / std::sqrt(static_cast<double>(field.total()));
  field.convertTo(error.quadratic, CV_32F, options.quadratic / rms);
  return error;
}

void writeSystematicError(const SystematicError& error, const std::filesystem::path& file) {
  std::ofstream stream(file);
  const auto write = [&stream](const char* format, auto... values) {
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    stream << text.data();
  };
  stream
      << "# True systematic error of this rendered camera, in every frame alike:\n"
         "# z_measured = z (1 + scale_error) + quadratic_error(u, v) z^2 (m); a depth pixel shows\n"
         "# what colour shows registration_shift (px) beside it. Nodes: row by row, evenly from\n"
         "# the first pixel's centre to the last one's.\n";
  write("scale_error: %.9g\n", error.scale);
  write("registration_shift: [%.9g, %.9g]\n", error.shift.x, error.shift.y);
  write("quadratic_error:\n  rows: %d\n  columns: %d\n  values: [", kGridRows, kGridColumns);
  for (int row = 0; row < kGridRows; ++row) {
    for (int column = 0; column < kGridColumns; ++column) {
      const auto nearest = [](int node, int nodes, int pixels) {
        return static_cast<int>(
            std::lround(static_cast<double>(node) * (pixels - 1) / (nodes - 1)));
      };
      const double value = error.quadratic.empty()
                               ? 0.0
                               : static_cast<double>(error.quadratic.at<float>(
                                     nearest(row, kGridRows, error.quadratic.rows),
                                     nearest(column, kGridColumns, error.quadratic.cols)));
      write("%s%s%.6g", row + column > 0 ? "," : "", column == 0 ? "\n    " : " ", value);
    }
  }
  stream << "]\n";
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace hmcdyn::synthesize
