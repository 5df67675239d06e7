// SPDX-License-Identifier: BSD-3-Clause
// What the calibration finds in a rendered recording whose depth is wrong by a known amount. The
// truth is the renderer's own depth image, not a model of the error.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "calibrate/error_statistics.hpp"
#include "calibrate/run.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "synthesize/sequence.hpp"

namespace hmcdyn::calibrate {
namespace {

constexpr int kFrames = 8;

/// z times this is measured where z is true: up to `share` wrong, the more so to the right and far
/// away.
double factorOf(double z, int u, double share) {
  return 1.0 + share * (0.4 + 0.4 * u / 640.0 + 0.05 * z);
}

/// 36 cm to the side and 6 cm up and forward in front of the office's walls.
std::filesystem::path written(const std::filesystem::path& file) {
  std::ofstream stream(file);
  for (int i = 0; i <= kFrames; ++i) {
    const double part = static_cast<double>(i) / kFrames;
    stream << fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} 0 0 0 1\n", i / synthesize::kFrameRate,
                          0.36 * part, 0.06 * std::sin(9.0 * part), 0.06 * part * part);
  }
  return file;
}

std::vector<std::filesystem::path> depthFiles(const std::filesystem::path& sequence) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(sequence / "depth")) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());  // folders have no order of their own
  return files;
}

/// RMS over ranges of half a metre and thirds of the image of their median relative errors.
double rmsBias(const std::map<std::array<int, 3>, std::vector<double>>& cells) {
  double sum = 0.0;
  double count = 0.0;
  for (const auto& cell : cells) {
    const double bias = percentile(cell.second, 0.5);
    sum += bias * bias * static_cast<double>(cell.second.size());
    count += static_cast<double>(cell.second.size());
  }
  return std::sqrt(sum / count);
}

class RenderedCalibration : public testing::Test {
 protected:
  RenderedCalibration() : sequence_(folder_.path() / "room") {
    synthesize::SequenceOptions options;
    options.scene = "empty";
    options.frames = kFrames;
    options.noise = synthesize::NoiseModel::kNone;
    options.trajectory = written(folder_.path() / "path.txt");
    options.output = sequence_;
    synthesize::writeSequence(options);
    for (const auto& file : depthFiles(sequence_)) {
      exact_.push_back(cv::imread(file.string(), cv::IMREAD_UNCHANGED));
    }
  }

  Calibration calibrateWrongBy(double share) const {
    const auto files = depthFiles(sequence_);
    for (std::size_t i = 0; i < files.size(); ++i) {
      cv::Mat wrong = exact_[i].clone();
      for (int v = 0; v < wrong.rows; ++v) {
        for (int u = 0; u < wrong.cols; ++u) {
          auto& value = wrong.at<std::uint16_t>(v, u);
          value = cv::saturate_cast<std::uint16_t>(
              value * factorOf(value / synthesize::kDepthFactor, u, share));
        }
      }
      cv::imwrite(files[i].string(), wrong);
    }
    CalibrationOptions options;
    options.dataset = sequence_;
    options.camera = (sequence_ / "calibration.yaml").string();
    options.trajectory = sequence_ / "groundtruth.txt";
    options.scale_known = true;
    return calibrateDepth(options);
  }

  /// Bias of all pixels of the recording before and after a correction.
  std::pair<double, double> biases(const slam::DepthCorrection& correction, double share) const {
    std::map<std::array<int, 3>, std::vector<double>> before;
    std::map<std::array<int, 3>, std::vector<double>> after;
    for (const cv::Mat& exact : exact_) {
      for (int v = 3; v < exact.rows; v += 6) {
        for (int u = 3; u < exact.cols; u += 6) {
          const double z = exact.at<std::uint16_t>(v, u) / synthesize::kDepthFactor;
          if (z > 0.0 && z < 6.0) {
            const double measured = z * factorOf(z, u, share);
            const std::array<int, 3> cell{static_cast<int>(2.0 * z), 3 * v / exact.rows,
                                          3 * u / exact.cols};
            before[cell].push_back(measured / z - 1.0);
            after[cell].push_back(corrected(correction, measured, u, v, exact.size()) / z - 1.0);
          }
        }
      }
    }
    return {rmsBias(before), rmsBias(after)};
  }

 private:
  hmcdyn::test::TemporaryFolder folder_;
  std::filesystem::path sequence_;
  std::vector<cv::Mat> exact_;
};

TEST_F(RenderedCalibration, ABiasOfSomePerCentIsRecoveredToAFifth) {
  constexpr double kShare = -0.04;
  const Calibration found = calibrateWrongBy(kShare);
  EXPECT_TRUE(found.corrects);
  const auto [before, after] = biases(found.fit.correction, kShare);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(after, 0.2 * before) << 100.0 * before << " % before";
}

}  // namespace
}  // namespace hmcdyn::calibrate
