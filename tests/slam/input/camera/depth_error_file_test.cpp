// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/depth_error_file.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "slam/input/camera/calibration_file.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

constexpr const char* kPlainCamera =
    "# a camera\nfx: 500\nfy: 501\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n"
    "depth_factor: 1000\n";

constexpr const char* kOrbSlamCamera =
    "%YAML:1.0\n---\nCamera.type: \"PinHole\"\nCamera.fx: 500.0\nCamera.fy: 501.0\n"
    "Camera.cx: 320.0\nCamera.cy: 240.0\nCamera.width: 640\nCamera.height: 480\n"
    "DepthMapFactor: 5000.0\nViewer.PointSize:2\n";  // as the stock files end

DepthSettings calibratedStereo() {
  DepthSettings settings;
  settings.sensor = DepthSensor::kActiveStereo;
  settings.error = {0.002f, 0.003f, 0.004f, 0.005f};
  settings.correction.scale = 1.0125;
  settings.correction.rows = 2;
  settings.correction.columns = 3;
  settings.correction.growth = {0.001, -0.002, 0.003, -0.004, 0.005, -0.006};
  return settings;
}

TEST(DepthErrorFile, WithoutAWordOfDepthACameraIsStructuredLight) {
  const TemporaryFolder folder;
  const CameraCalibration camera = readCalibrationFile(folder.write("camera.yaml", kPlainCamera));
  EXPECT_EQ(camera.depth_error.noise_quadratic, DepthErrorModel{}.noise_quadratic);
  EXPECT_EQ(camera.depth_error.systematic_quadratic, DepthErrorModel{}.systematic_quadratic);
  EXPECT_TRUE(isIdentity(camera.depth_correction));
}

TEST(DepthErrorFile, SensorBringsItsPublishedFigures) {
  const TemporaryFolder folder;
  const auto modelOf = [&folder](const std::string& sensor) {
    return readCalibrationFile(
               folder.write("camera.yaml", kPlainCamera + ("sensor: " + sensor + "\n")))
        .depth_error;
  };
  // Azure Kinect: 17 mm at 3.5 m; its offset of 11 mm at 2 m.
  const DepthErrorModel time_of_flight = modelOf("time_of_flight");
  EXPECT_NEAR(depthNoise(3.5f, time_of_flight), 0.017f, 5e-4f);
  EXPECT_NEAR(systematicDepthError(2.0f, time_of_flight), 0.011f, 1e-4f);
  // D435: z^2 * 0.08 px / (424 px * 0.05 m), and 1 % at 2 m.
  const DepthErrorModel stereo = modelOf("active_stereo");
  EXPECT_NEAR(stereo.noise_quadratic, 0.08f / (424.0f * 0.05f), 5e-5f);
  EXPECT_NEAR(systematicDepthError(2.0f, stereo), 0.02f, 1e-4f);
}

TEST(DepthErrorFile, OneFieldAloneReplacesTheSensors) {
  const TemporaryFolder folder;
  const auto file = folder.write("camera.yaml", std::string(kPlainCamera) +
                                                    "sensor: active_stereo\n"
                                                    "depth_error: {noise_floor: 0.02}\n");
  const DepthErrorModel model = readCalibrationFile(file).depth_error;
  EXPECT_EQ(model.noise_floor, 0.02f);
  EXPECT_EQ(model.noise_quadratic, defaultDepthError(DepthSensor::kActiveStereo).noise_quadratic);
}

TEST(DepthErrorFile, WhatIsWrittenIsReadAgainInBothSpellings) {
  const DepthSettings settings = calibratedStereo();
  const TemporaryFolder folder;
  for (const char* camera : {kPlainCamera, kOrbSlamCamera}) {
    const std::string text = withDepthSettings(camera, settings, {"measured by a test"});
    EXPECT_EQ(text.rfind(camera, 0), 0U) << "what the file said must stay";
    const auto file = folder.write("camera.yaml", text);
    EXPECT_EQ(readDepthSettings(SettingsFile(file)).sensor, DepthSensor::kActiveStereo);
    const CameraCalibration read = readCalibrationFile(file);
    EXPECT_EQ(read.pinhole.fx, 500.0);
    EXPECT_EQ(read.depth_error.noise_floor, 0.002f);
    EXPECT_EQ(read.depth_error.noise_quadratic, 0.003f);
    EXPECT_EQ(read.depth_error.systematic_linear, 0.004f);
    EXPECT_EQ(read.depth_error.systematic_quadratic, 0.005f);
    EXPECT_EQ(read.depth_correction.scale, 1.0125);
    EXPECT_EQ(read.depth_correction.rows, 2);
    EXPECT_EQ(read.depth_correction.columns, 3);
    EXPECT_EQ(read.depth_correction.growth, settings.correction.growth);
  }
}

TEST(DepthErrorFile, NewSettingsReplaceOldOnesAndNothingElse) {
  DepthSettings settings = calibratedStereo();
  const std::string first = withDepthSettings(kPlainCamera, settings, {"first"});
  settings.correction = {};
  const std::string second = withDepthSettings(first + "frame_rate: 15\n", settings, {"second"});
  EXPECT_EQ(second.find("first"), std::string::npos);
  EXPECT_EQ(second.find("depth_correction"), std::string::npos);
  EXPECT_EQ(second.rfind(std::string(kPlainCamera) + "frame_rate: 15\n", 0), 0U);
  EXPECT_EQ(second.find("depth_error:"), second.rfind("depth_error:"));
}

TEST(DepthErrorFile, BadSettingsAreErrorsThatNameFileLineAndKey) {
  const TemporaryFolder folder;
  const auto messageFor = [&folder](const std::string& lines) {
    const auto file = folder.write("camera.yaml", kPlainCamera + lines);
    return messageOf<std::runtime_error>([&file] { readCalibrationFile(file); });
  };
  EXPECT_TRUE(mentions(messageFor("sensor: sonar\n"),
                       {"camera.yaml:9", "sensor", "sonar", "time_of_flight"}));
  EXPECT_TRUE(mentions(messageFor("depth_error:\n  noise_flor: 0.1\n"),
                       {"camera.yaml:10", "depth_error", "noise_flor", "noise_floor"}));
  EXPECT_TRUE(mentions(messageFor("depth_error:\n  noise_floor: -1\n"),
                       {"camera.yaml", "depth_error", "noise_floor", "-1"}));
  EXPECT_TRUE(mentions(messageFor("depth_error:\n  noise_floor: deep\n"),
                       {"camera.yaml:10", "noise_floor"}));
  EXPECT_TRUE(mentions(messageFor("depth_error: 3\n"), {"camera.yaml:9", "depth_error"}));
  EXPECT_TRUE(mentions(messageFor("depth_correction:\n  rows: 2\n  columns: 2\n  growth: [0, 1]\n"),
                       {"camera.yaml", "depth_correction", "growth", "4"}));
  EXPECT_TRUE(mentions(messageFor("depth_correction:\n  rows: 2\n"),
                       {"camera.yaml", "depth_correction", "columns"}));
}

}  // namespace
}  // namespace hmcdyn::slam
