// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/calibration.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "slam/input/camera/calibration_file.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

using Coefficients = std::array<double, 5>;

constexpr const char* kOwn =
    "# a camera\n"
    "fx: 500.5\n"
    "fy: 501\n"
    "cx: 319.5\n"
    "cy: 239.5\n"
    "width: 640\n"
    "height: 480\n"
    "depth_factor: 1000\n";

constexpr const char* kOldOrbSlam =
    "%YAML:1.0\n"
    "\n"
    "#--------------------------------------------------------------------------------\n"
    "Camera.type: \"PinHole\"\n"
    "Camera.fx: 517.306408\n"
    "Camera.fy: 516.469215\n"
    "Camera.cx: 318.643040\n"
    "Camera.cy: 255.313989\n"
    "Camera.k1: 0.262383\n"
    "Camera.k2: -0.953104\n"
    "Camera.p1: -0.005358\n"
    "Camera.p2: 0.002628\n"
    "Camera.k3: 1.163314\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n"
    "Camera.fps: 25.0\n"
    "Camera.bf: 40.0\n"
    "Camera.RGB: 1\n"
    "ThDepth: 40.0\n"
    "DepthMapFactor: 5000.0\n"
    "ORBextractor.nFeatures: 1000\n";

constexpr const char* kNewOrbSlam =
    "%YAML:1.0\n"
    "---\n"
    "File.version: \"1.0\"\n"
    "Camera.type: \"PinHole\"\n"
    "Camera1.fx: 500.0\n"
    "Camera1.fy: 501.0\n"
    "Camera1.cx: 320.0\n"
    "Camera1.cy: 240.0\n"
    "Camera1.k1: 0.1\n"
    "Camera1.k2: -0.2\n"
    "Camera1.p1: 0.003\n"
    "Camera1.p2: -0.004\n"
    "Camera.width: 848\n"
    "Camera.height: 480\n"
    "Camera.fps: 60\n"
    "Stereo.b: 0.08\n"
    "RGBD.DepthMapFactor: 1000.0\n"
    "IMU.T_b_c1: !!opencv-matrix\n"
    "  rows: 2\n"
    "  cols: 2\n"
    "  dt: f\n"
    "  data: [1.0, 0.0,\n"
    "         0.0, 1.0]\n";

// A text with one part replaced.
std::string with(std::string text, const std::string& part, const std::string& replacement) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), replacement);
}

class CalibrationFile : public testing::Test {
 protected:
  CameraCalibration read(const std::string& text) const {
    return readCalibrationFile(folder.write("camera.yaml", text));
  }
  std::string readError(const std::string& text) const {
    return messageOf<std::runtime_error>([&] { read(text); });
  }

  TemporaryFolder folder;
};

TEST(CameraPreset, HaveTheirPublishedFigures) {
  const CameraCalibration tum1 = loadCamera("tum1");
  EXPECT_EQ(tum1.pinhole.fx, 517.306408);
  EXPECT_EQ(tum1.distortion, (Coefficients{0.262383, -0.953104, -0.005358, 0.002628, 1.163314}));
  const CameraCalibration tum2 = loadCamera("tum2");
  EXPECT_EQ(tum2.pinhole.fy, 521.007327);
  EXPECT_EQ(tum2.distortion, (Coefficients{0.231222, -0.784899, -0.003257, -0.000105, 0.917205}));
  const CameraCalibration tum3 = loadCamera("tum3");
  EXPECT_EQ(tum3.pinhole.cx, 320.1);
  EXPECT_FALSE(hasDistortion(tum3));
  const CameraCalibration bonn = loadCamera("bonn");
  EXPECT_EQ(bonn.pinhole.cy, 237.756098);
  EXPECT_TRUE(hasDistortion(bonn));
  for (const std::string& name : cameraPresetNames()) {
    const CameraCalibration calibration = loadCamera(name);
    EXPECT_EQ(calibration.depth_factor, 5000.0);
    EXPECT_EQ(calibration.width, 640);
    EXPECT_EQ(calibration.height, 480);
    EXPECT_EQ(calibration.frame_rate, 30.0);
    EXPECT_FALSE(calibration.baseline_fx.has_value());
  }
}

TEST(CameraPreset, AnUnknownNameListsThemWithTheNearest) {
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] { loadCamera("tmu3"); }),
                       {"'tmu3'", "tum1, tum2, tum3, bonn", "nor a file", "'tum3'"}));
  EXPECT_TRUE(
      mentions(messageOf<std::invalid_argument>([] { loadCamera("Bon"); }), {"mean 'bonn'"}));
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] { loadCamera(""); }), {"''"}));
}

TEST_F(CalibrationFile, OwnSpellingWithDefaults) {
  const CameraCalibration calibration = read(kOwn);
  EXPECT_EQ(calibration.pinhole.fx, 500.5);
  EXPECT_EQ(calibration.pinhole.fy, 501.0);
  EXPECT_EQ(calibration.pinhole.cx, 319.5);
  EXPECT_EQ(calibration.pinhole.cy, 239.5);
  EXPECT_EQ(calibration.width, 640);
  EXPECT_EQ(calibration.height, 480);
  EXPECT_EQ(calibration.depth_factor, 1000.0);
  EXPECT_EQ(calibration.frame_rate, 30.0);
  EXPECT_FALSE(hasDistortion(calibration));
  EXPECT_FALSE(calibration.baseline_fx.has_value());
}

TEST_F(CalibrationFile, OwnSpellingWithEverything) {
  const CameraCalibration calibration =
      read(std::string(kOwn) +
           "distortion: [0.1, -0.2, 0.003, -0.004]\nframe_rate: 25\nbaseline_fx: 40\n");
  EXPECT_EQ(calibration.distortion, (Coefficients{0.1, -0.2, 0.003, -0.004, 0.0}));
  EXPECT_EQ(calibration.frame_rate, 25.0);
  EXPECT_EQ(calibration.baseline_fx, 40.0);

  EXPECT_EQ(read(std::string(kOwn) + "distortion: [0.1, 0.2, 0.03, 0.04, 0.5]\n").distortion,
            (Coefficients{0.1, 0.2, 0.03, 0.04, 0.5}));
  EXPECT_EQ(read(std::string(kOwn) + "k1: 0.5\np2: 0.25\n").distortion,
            (Coefficients{0.5, 0.0, 0.0, 0.25, 0.0}));
}

TEST_F(CalibrationFile, IsFoundByItsPath) {
  const std::filesystem::path file = folder.write("mine.yaml", kOwn);
  EXPECT_EQ(loadCamera(file.string()).pinhole.fx, 500.5);
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { loadCamera(folder.path().string()); }),
                       {folder.path().string(), "is a folder; expected a file"}));
}

TEST_F(CalibrationFile, OrbSlamsOldSpelling) {
  const CameraCalibration calibration = read(kOldOrbSlam);
  const CameraCalibration tum1 = loadCamera("tum1");
  EXPECT_EQ(calibration.pinhole.fx, tum1.pinhole.fx);
  EXPECT_EQ(calibration.pinhole.fy, tum1.pinhole.fy);
  EXPECT_EQ(calibration.pinhole.cx, tum1.pinhole.cx);
  EXPECT_EQ(calibration.pinhole.cy, tum1.pinhole.cy);
  EXPECT_EQ(calibration.distortion, tum1.distortion);
  EXPECT_EQ(calibration.width, 640);
  EXPECT_EQ(calibration.frame_rate, 25.0);
  EXPECT_EQ(calibration.depth_factor, 5000.0);
  EXPECT_EQ(calibration.baseline_fx, 40.0);
}

TEST_F(CalibrationFile, OrbSlamsNewSpelling) {
  const CameraCalibration calibration = read(kNewOrbSlam);
  EXPECT_EQ(calibration.pinhole.fx, 500.0);
  EXPECT_EQ(calibration.pinhole.cy, 240.0);
  EXPECT_EQ(calibration.distortion, (Coefficients{0.1, -0.2, 0.003, -0.004, 0.0}));
  EXPECT_EQ(calibration.width, 848);
  EXPECT_EQ(calibration.height, 480);
  EXPECT_EQ(calibration.frame_rate, 60.0);
  EXPECT_EQ(calibration.depth_factor, 1000.0);
  ASSERT_TRUE(calibration.baseline_fx.has_value());
  EXPECT_DOUBLE_EQ(*calibration.baseline_fx, 0.08 * 500.0);
}

TEST_F(CalibrationFile, AMissingKeyIsNamed) {
  for (const std::string key : {"fx", "fy", "cx", "cy", "width", "height", "depth_factor"}) {
    const std::string text = with(kOwn, "\n" + key + ":", "\n#" + key + ":");
    EXPECT_TRUE(mentions(readError(text), {"camera.yaml: " + key + " is missing"}));
  }
  EXPECT_TRUE(mentions(readError(with(kOldOrbSlam, "DepthMapFactor", "Other")),
                       {"camera.yaml: DepthMapFactor is missing"}));
  EXPECT_TRUE(mentions(readError(with(kNewOrbSlam, "Camera1.fy", "Other")),
                       {"camera.yaml: Camera1.fy is missing"}));
}

TEST_F(CalibrationFile, AWrongValueIsNamedWithItsLine) {
  EXPECT_TRUE(mentions(readError(with(kOwn, "500.5", "wide")),
                       {"camera.yaml:2: fx is 'wide'; expected a number"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "500.5", "[500.5]")),
                       {"camera.yaml:2: fx: expected a number"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "500.5", "0")), {"camera.yaml:2: fx is 0", "above 0"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "501", "-501")), {"camera.yaml:3: fy is -501"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "319.5", ".nan")), {"camera.yaml:4: cx is '.nan'"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "640", "640.5")),
                       {"camera.yaml:6: width is 640.5", "whole number"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "480", "0")), {"camera.yaml:7: height is 0"}));
  EXPECT_TRUE(mentions(readError(with(kOwn, "1000", "-1")), {"camera.yaml:8: depth_factor is -1"}));
  EXPECT_TRUE(mentions(readError(with(kOldOrbSlam, "517.306408", "none")),
                       {"camera.yaml:5: Camera.fx is 'none'"}));
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "frame_rate: 0\n"),
                       {"camera.yaml:9: frame_rate is 0"}));
}

TEST_F(CalibrationFile, AWrongDistortionIsNamed) {
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "distortion: [0.1, 0.2]\n"),
                       {"camera.yaml:9: distortion has 2 numbers"}));
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "distortion: none\n"),
                       {"camera.yaml:9: distortion: expected a list"}));
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "distortion: [a, 0, 0, 0]\n"),
                       {"camera.yaml:9: distortion is 'a'"}));
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "distortion: [0, 0, 0, 0]\nk1: 0.1\n"),
                       {"camera.yaml:10: k1 is given twice"}));
}

TEST_F(CalibrationFile, AMisspeltKeyIsNotTakenForADefault) {
  EXPECT_TRUE(mentions(readError(std::string(kOwn) + "distorsion: [1, 2, 3, 4]\n"),
                       {"camera.yaml:9: distorsion is no key", "distortion"}));
}

TEST_F(CalibrationFile, AnotherCameraModelIsRefused) {
  EXPECT_TRUE(mentions(readError(with(kNewOrbSlam, "PinHole", "KannalaBrandt8")),
                       {"camera.yaml:4: Camera.type is 'KannalaBrandt8'", "PinHole"}));
}

TEST_F(CalibrationFile, WhatIsNoYamlIsNamed) {
  EXPECT_TRUE(mentions(readError("fx: [1, 2\nfy: 3\n"), {"camera.yaml:", "is not YAML"}));
  EXPECT_TRUE(mentions(readError(""), {"camera.yaml", "expected lines"}));
  EXPECT_TRUE(mentions(readError("just words\n"), {"camera.yaml", "expected lines"}));
}

TEST_F(CalibrationFile, KeysInOtherLettersAreNamed) {
  EXPECT_TRUE(
      mentions(readError(with(kOldOrbSlam, "Camera.fx", "CAMERA.FX")),
               {"camera.yaml:5: 'CAMERA.FX' is written in other letters", "expected Camera.fx"}));
}

TEST_F(CalibrationFile, Open3DsMatrixIsNamedWithWhatIsRead) {
  EXPECT_TRUE(mentions(readError("{\"intrinsic_matrix\": [5, 0, 0, 0, 5, 0, 3, 2, 1]}"),
                       {"intrinsic_matrix is not read", "Open3D", "fx, fy, cx, cy"}));
}

}  // namespace
}  // namespace hmcdyn::slam
