// SPDX-License-Identifier: BSD-3-Clause
// Kind 6, and the settings files of kind 7: what its own system reads is read; what cannot be right
// is refused with what would fit.
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fault_input.hpp"
#include "slam/input/camera/calibration_file.hpp"
#include "slam/input/camera/plausibility.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;
using slam::CameraCalibration;

/// As ORB-SLAM2 comes with: two values without a blank behind their colons at its end.
constexpr const char* kStock =
    "%YAML:1.0\n\n"
    "# Camera calibration and distortion parameters (OpenCV)\n"
    "Camera.fx: 520.908620\nCamera.fy: 521.007327\nCamera.cx: 325.141442\nCamera.cy: 249.701764\n\n"
    "Camera.k1: 0.231222\nCamera.k2: -0.784899\nCamera.p1: -0.003257\nCamera.p2: -0.000105\n"
    "Camera.k3: 0.917205\n\n"
    "Camera.width: 640\nCamera.height: 480\n\nCamera.fps: 30.0\nCamera.bf: 40.0\nCamera.RGB: 1\n"
    "ThDepth: 40.0\nDepthMapFactor: 5208.0\n\nORBextractor.nFeatures: 1000\n"
    "Viewer.KeyFrameSize: 0.05\nViewer.PointSize:2\nViewer.LineWidth:0.9\nViewer.ViewpointF: 500\n";

constexpr const char* kStella =
    "# a comment\n\nCamera:\n  name: \"TUM RGBD 2\"\n  setup: \"RGBD\"\n  model: "
    "\"perspective\"\n\n"
    "  fx: 520.908620\n  fy: 521.007327\n  cx: 325.141442\n  cy: 249.701764\n\n"
    "  k1: 0.231222\n  k2: -0.784899\n  p1: -0.003257\n  p2: -0.000105\n  k3: 0.917205\n\n"
    "  fps: 30.0\n  cols: 640\n  rows: 480\n  focal_x_baseline: 40.0\n  color_order: \"RGB\"\n\n"
    "Tracking:\n  max_num_keypoints: 1000\n  depthmap_factor: 5208.0\n\nFeature:\n"
    "  scale_factor: 1.2\n";

class Calibration : public testing::Test {
 protected:
  CameraCalibration read(const std::string& text) const {
    return slam::readCalibrationFile(folder_.write("settings.yaml", text));
  }
  std::string refusal(const std::string& text) const {
    return messageOf<std::runtime_error>([&] { read(text); });
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Calibration, SettingsFilesAsOtherSystemsReadThemAreRead) {
  const std::string stock = kStock;
  struct Kind {
    const char* what;
    std::string text;
    int width = 640;
  };
  const std::vector<Kind> kinds{
      {"stock", stock},
      {"no %YAML line", stock.substr(stock.find('#'))},
      {"two %YAML lines and document marks", "%YAML:1.0\n%YAML:1.0\n---\n" + stock + "...\n"},
      {"no blank behind any colon", replaced(stock, ": ", ":")},
      {"tabs", replaced(stock, ": ", ":\t")},
      {"blanks before the colons", replaced(stock, ": ", " : ")},
      {"CRLF", replaced(stock, "\n", "\r\n")},
      {"a BOM", "\xEF\xBB\xBF" + stock},
      {"UTF-16", utf16(stock, false)},
      {"no final newline", stock.substr(0, stock.size() - 1)},
      {"trailing blanks", replaced(stock, "\n", "  \n")},
      {"+1.5", replaced(stock, "Camera.cx: ", "Camera.cx: +")},
      {"keys indented", replaced("\n" + stock.substr(stock.find('#')), "\n", "\n  ")},
      {"what we do not need is broken",
       stock + "Viewer.Path: @root/%x\nother: [1, 2\nViewer.Name: a: b: c\nViewer.PointSize: 3\n"},
      {"one key twice with one value", stock + "Camera.fx: 520.908620\n"},
      {"no size", replaced(replaced(stock, "Camera.width", "#"), "Camera.height", "#"), 0},
      {"no size, but matrices",
       replaced(stock, "Camera.width: 640\nCamera.height: 480\n",
                "T_c1_c2: !!opencv-matrix\n   rows: 4\n   cols: 4\n"
                "   dt: f\n   data: [1.0, 0.0,\n1.0, 0.0]\n"),
       0},
      {"a baseline that is none", replaced(stock, "Camera.bf: 40.0", "Camera.bf: 0.0")},
      {"stella_vslam", kStella},
      {"coefficients that are 0", stock + "Camera.k4: 0.0\nCamera.k5: 0\nCamera.k6: 0\n"}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    const CameraCalibration camera = read(kind.text);
    EXPECT_EQ(camera.pinhole.fx, 520.908620);
    EXPECT_EQ(camera.pinhole.fy, 521.007327);
    EXPECT_EQ(camera.pinhole.cx, 325.141442);
    EXPECT_EQ(camera.pinhole.cy, 249.701764);
    EXPECT_EQ(camera.distortion,
              (std::array<double, 5>{0.231222, -0.784899, -0.003257, -0.000105, 0.917205}));
    EXPECT_EQ(camera.width, kind.width);
    EXPECT_EQ(camera.height, kind.width * 3 / 4);
    EXPECT_EQ(camera.depth_factor, 5208.0);
    EXPECT_EQ(camera.frame_rate, 30.0);
  }
}

TEST_F(Calibration, CameraMatricesAreReadToo) {
  const CameraCalibration ros = read(
      "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: "
      "3\n"
      "  data: [520.5, 0.0, 325.1, 0.0, 521.0, 249.7, 0.0, 0.0, 1.0]\n"
      "distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n"
      "  data: [0.2, -0.7, -0.003, 0.0001, 0.9]\ndepth_factor: 1000\n");
  EXPECT_EQ(ros.pinhole.fx, 520.5);
  EXPECT_EQ(ros.pinhole.cy, 249.7);
  EXPECT_EQ(ros.width, 640);
  EXPECT_EQ(ros.distortion[4], 0.9);
  EXPECT_EQ(ros.depth_factor, 1000.0);
  const CameraCalibration kalibr = read(
      "cam0:\n  camera_model: pinhole\n  intrinsics: [520.5, 521.0, 325.1, 249.7]\n"
      "  distortion_model: radtan\n  distortion_coeffs: [0.2, -0.7, -0.003, 0.0001]\n"
      "  resolution: [640, 480]\ndepth_factor: 1000\n");
  EXPECT_EQ(kalibr.pinhole.fy, 521.0);
  EXPECT_EQ(kalibr.height, 480);
  EXPECT_EQ(kalibr.distortion[3], 0.0001);
}

/// As ROS writes a camera, with a distortion of the given model.
std::string rosCamera(const std::string& model, const std::string& coefficients) {
  return "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
         "  data: [520.5, 0.0, 325.1, 0.0, 521.0, 249.7, 0.0, 0.0, 1.0]\n"
         "distortion_model: " +
         model + "\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [" + coefficients +
         "]\ndepth_factor: 1000\n";
}

TEST_F(Calibration, DistortionIsReadUnderEachOfItsNames) {
  const std::string matrix = "[520.5, 0.0, 325.1, 0.0, 521.0, 249.7, 0.0, 0.0, 1.0]\n";
  const std::string list = "[0.2, -0.7, -0.003, 0.0001]\n";
  const std::string size = "height: 480\nwidth: 640\ndepth_factor: 1000\n";
  const std::string group =
      "  k1: 0.2\n  k2: -0.7\n  p1: -0.003\n  p2: 0.0001\n"
      "projection_parameters:\n  fx: 520.5\n  fy: 521\n  cx: 325.1\n  cy: 249.7\n";
  struct Kind {
    const char* what;
    std::string text;
  };
  for (const Kind& kind : std::vector<Kind>{
           {"ROS 1's topic", size + "distortion_model: plumb_bob\nD: " + list + "K: " + matrix},
           {"ROS 2's topic", size + "distortion_model: plumb_bob\nd: " + list + "k: " + matrix},
           {"EuRoC's",
            "resolution: [640, 480]\ncamera_model: pinhole\n"
            "intrinsics: [520.5, 521, 325.1, 249.7]\n"
            "distortion_model: radial-tangential\ndepth_factor: 1000\n"
            "distortion_coefficients: " +
                list},
           {"VINS-Mono's",
            "model_type: PINHOLE\nimage_width: 640\nimage_height: 480\n"
            "depth_factor: 1000\ndistortion_parameters:\n" +
                group},
           {"nested beside fx",
            "cam:\n  fx: 520.5\n  fy: 521\n  cx: 325.1\n  cy: 249.7\n  distortion: " + list +
                "depth_scale: 1000\n"}}) {
    SCOPED_TRACE(kind.what);
    const CameraCalibration camera = read(kind.text);
    EXPECT_EQ(camera.pinhole.fx, 520.5);
    EXPECT_EQ(camera.distortion, (std::array<double, 5>{0.2, -0.7, -0.003, 0.0001, 0.0}));
  }
  // The second camera's is not ours.
  const std::string stock = kStock;
  EXPECT_EQ(read(replaced(replaced(stock, "Camera.k", "#"), "Camera.p", "#") +
                 "RIGHT.D:\n  rows: 1\n  data: " + list)
                .distortion,
            (std::array<double, 5>{}));
}

TEST_F(Calibration, AnotherModelOfDistortionIsRefusedWhateverTheCameraIsCalled) {
  EXPECT_EQ(read(rosCamera("plumb_bob", "0.2, -0.7, -0.003, 0.0001, 0.9")).distortion[4], 0.9);
  EXPECT_EQ(read(rosCamera("rational_polynomial", "0, 0, 0, 0, 0, 0, 0, 0")).distortion[0], 0.0);
  for (const char* model : {"\"\"", "Plumb Bob", "undistorted", "radial-tangential"}) {
    EXPECT_EQ(read(rosCamera(model, "0, 0, 0, 0, 0")).pinhole.fx, 520.5) << model;
  }
  for (const char* model : {"equidistant", "fisheye", "fov"}) {
    EXPECT_TRUE(mentions(refusal(rosCamera(model, "-0.01, 0.02, -0.02, 0.008")),
                         {"distortion_model is '", model, "rectify"}));
  }
  EXPECT_TRUE(mentions(
      refusal(rosCamera("rational_polynomial", "0.5, -2.6, 0.001, 0.0002, 1.5, 0.4, -2.4, 1.4")),
      {"settings.yaml:", "rational"}));
}

TEST_F(Calibration, FilesWithoutKeysAreNamedForWhatTheyAre) {
  EXPECT_TRUE(mentions(refusal("# Camera list\n1 PINHOLE 640 480 535.4 539.2 320.1 247.6\n"),
                       {"no settings", "COLMAP"}));
  EXPECT_TRUE(mentions(refusal("535.4 0 320.1\n0 539.2 247.6\n0 0 1\n"), {"numbers alone", "fx:"}));
  EXPECT_TRUE(mentions(refusal("[camera]\nfx = 535.4\nfy = 539.2\n"), {"equals signs", "INI"}));
}

TEST_F(Calibration, WhatCamerasSeldomHaveIsSaidButNotRefused) {
  CameraCalibration camera = slam::loadCamera("tum3");
  EXPECT_TRUE(slam::whatIsUnusual(camera).empty());
  camera.pinhole = {535.4, 539.2, 247.6, 320.1};
  EXPECT_EQ(slam::whatIsImplausible(camera), "");
  EXPECT_TRUE(oneMentions(slam::whatIsUnusual(camera), {"(247.6, 320.1)", "swapped"}));
  camera.pinhole = {365.5, 365.5, 254.9, 205.4};  // of 512 x 424
  EXPECT_TRUE(oneMentions(slam::whatIsUnusual(camera), {"640 x 480", "cut"}));
  camera.pinhole = {1070.8, 539.2, 320.1, 247.6};
  EXPECT_TRUE(oneMentions(slam::whatIsUnusual(camera), {"differ by 99 %", "square"}));
}

TEST_F(Calibration, ARateOfZeroDoesNotMatter) {
  EXPECT_EQ(read(replaced(kStock, "Camera.fps: 30.0", "Camera.fps: 0")).frame_rate,
            CameraCalibration{}.frame_rate);
}

TEST_F(Calibration, OtherNamesOfAPinholeAndItsDepthFactorAreRead) {
  const std::string stock = kStock;
  for (const char* model : {"Radtan", "PinHole", "plumb_bob", "pinhole-radtan", "OPENCV"}) {
    EXPECT_EQ(read(stock + "Camera.type: \"" + model + "\"\n").pinhole.fx, 520.908620) << model;
  }
  const std::string plain = "fx: 535.4\nfy: 539.2\ncx: 320.1\ncy: 247.6\n";
  const CameraCalibration flat = read(plain + "H: 480\nW: 640\npng_depth_scale: 5000.0\n");
  EXPECT_EQ(flat.depth_factor, 5000.0);
  EXPECT_EQ(flat.pinhole.cy, 247.6);
  const CameraCalibration nested =
      read("dataset: 'tumrgbd'\nmapping:\n  Training:\n    alpha: 0.8\ncam:\n  H_edge: 8\n  " +
           replaced(plain, "\n", "\n  ") +
           "image_height: 480\n  image_width: 640\n"
           "Calibration:\n  depth_scale: 5000.0\n");
  EXPECT_EQ(nested.pinhole.fy, 539.2);
  EXPECT_EQ(nested.width, 640);
  EXPECT_EQ(nested.depth_factor, 5000.0);
  // Metres a step, as a RealSense says it.
  EXPECT_TRUE(
      mentions(refusal(plain + "H: 480\nW: 640\ndepth_scale: 0.001\n"), {"0.001", "1000 a metre"}));
}

TEST_F(Calibration, WhatCannotBeReadIsNamedWithWhatToDo) {
  const std::string stock = kStock;
  struct Kind {
    const char* what;
    std::string text;
    std::vector<std::string> said;
  };
  const std::vector<Kind> kinds{
      {"KITTI's",
       replaced(stock, "DepthMapFactor", "Other"),
       {"DepthMapFactor is missing", "KITTI", "DepthMapFactor: 5000"}},
      {"a template",
       replaced(stock, "520.908620", "<fx>"),
       {"settings.yaml:4: Camera.fx is '<fx>'", "template"}},
      {"a template in braces",
       replaced(stock, "520.908620", "{camera.K[0]}"),
       {"settings.yaml:4: Camera.fx", "template"}},
      {"an empty value",
       replaced(stock, "520.908620", ""),
       {"settings.yaml:4: Camera.fx has no value", "template"}},
      {"equals signs",
       replaced(stock, "Camera.fx: ", "Camera.fx = "),
       {"settings.yaml:4: 'Camera.fx = 520.908620' has an equals sign", "Camera.fx: value"}},
      {"two lines in one",
       replaced(stock, "520.908620", "520.9 Camera.fy: 521"),
       {"settings.yaml:4: Camera.fx", "520.9 Camera.fy: 521", "two lines in one"}},
      {"a header pasted into a value",
       replaced(stock, "520.908620", "%YAML:1.0 520.9"),
       {"settings.yaml:4: Camera.fx", "%YAML:1.0 520.9", "two lines in one"}},
      {"a decimal comma",
       replaced(stock, "520.908620", "520,908620"),
       {"settings.yaml:4: Camera.fx is '520,908620'", "decimal point"}},
      {"two values",
       stock + "Camera.fx: 535.4\n",
       {"Camera.fx is given twice", "line 4", "'535.4' in line"}},
      {"the rational model",
       stock + "Camera.k4: 0.31\n",
       {"Camera.k4 is 0.31", "rectify the images"}},
      {"a fisheye", replaced(kStella, "perspective", "fisheye"), {"Camera.model is 'fisheye'"}},
      {"ORB-SLAM3's fisheye",
       stock + "Camera.type: \"KannalaBrandt8\"\n",
       {"Camera.type is 'KannalaBrandt8'", "rectify"}},
      {"of no camera",
       "Vocabulary: orb.txt\nThreads: 2\n",
       {"no focal length", "Vocabulary, Threads"}},
      {"XML", "<?xml version=\"1.0\"?>\n<opencv_storage>\n", {"is XML"}},
      {"a negative depth factor",
       replaced(stock, "5208.0", "-5208"),
       {"DepthMapFactor is -5208", "above 0"}}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    const std::string message = refusal(kind.text);
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
}

TEST_F(Calibration, ValuesThatNoCameraHasAreRefusedWithThoseThatFit) {
  const std::string stock = kStock;
  const auto withIntrinsics = [&](const char* fx, const char* fy, const char* cx, const char* cy) {
    return replaced(
        replaced(replaced(replaced(stock, "520.908620", fx), "521.007327", fy), "325.141442", cx),
        "249.701764", cy);
  };
  struct Kind {
    const char* what;
    std::string text;
    std::vector<std::string> said;
  };
  const std::vector<Kind> kinds{
      {"of twice the size",
       withIntrinsics("1041.8", "1042", "650.8", "499.9"),
       {"1280 x 960", "halve them", "fx 520.9"}},
      {"of half the size",
       withIntrinsics("260.4", "260.5", "162.3", "124.6"),
       {"320 x 240", "times 2", "fx 520.8"}},
      {"of 1920 x 1440",
       withIntrinsics("1562", "1563", "976", "749"),
       {"1920 x 1440", "fx 520.667"}},
      {"shares", withIntrinsics("0.8139", "1.0854", "0.508", "0.5202"), {"shares", "fx 520.896"}},
      {"millimetres", withIntrinsics("4.2", "4.2", "325.1", "249.7"), {"millimetres", "pixels"}},
      {"of 1920 x 1080",
       withIntrinsics("1081", "1081", "959.5", "539.5"),
       {"outside", "1920 x 1080"}},
      {"distortion in per cent",
       replaced(replaced(stock, "0.231222", "26.2"), "-0.784899", "-95.3"),
       {"the distortion k1 26.2", "twice"}},
      {"principal point outside",
       withIntrinsics("520", "521", "1320", "249"),
       {"(1320, 249) is outside the image of 640 x 480"}},
      {"negative principal point", withIntrinsics("520", "521", "-3", "249"), {"outside"}},
      {"no lens", withIntrinsics("52", "52.1", "325", "249"), {"no lens's"}},
      {"pixels far from square", withIntrinsics("520", "1521", "325", "249"), {"square pixels"}},
      {"a focal length as distortion",
       replaced(stock, "0.231222", "535.4"),
       {"the distortion k1 535.4", "640 x 480", "other keys"}},
      {"metres a step", replaced(stock, "5208.0", "0.001"), {"0.001", "1000 a metre"}},
      {"absurd", replaced(stock, "5208.0", "1e9"), {"depth factor 1e+09"}}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    const std::string message = refusal(kind.text);
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
  EXPECT_TRUE(mentions(refusal("fx: 520\nfy: 521\ncx: 325\ncy: 249\nwidth: 640\nheight: 480\n"
                               "depth_factor: 5000\nbaseline_fx: 0.08\n"),
                       {"baseline times fx", "41.6"}));
}

TEST_F(Calibration, CamerasThatThereAreArePlausible) {
  struct Kind {
    hmcdyn::PinholeCamera pinhole;
    int width;
    int height;
  };
  for (const Kind& kind :
       std::vector<Kind>{{{517.3, 516.5, 318.6, 255.3}, 640, 480},      // Kinect v1
                         {{365.5, 365.5, 254.9, 205.4}, 512, 424},      // Kinect v2, infrared
                         {{1081.4, 1081.4, 959.5, 539.5}, 1920, 1080},  // Kinect v2, colour
                         {{611.2, 611.5, 312.0, 246.1}, 640, 480},      // RealSense D435
                         {{385.9, 385.9, 323.1, 236.7}, 640, 480},      // RealSense D455
                         {{504.9, 505.0, 332.2, 333.5}, 640, 576},      // Azure Kinect, narrow
                         {{252.3, 252.4, 257.1, 258.3}, 512, 512},      // Azure Kinect, wide
                         {{721.5, 721.5, 609.6, 172.9}, 1242, 375},     // KITTI
                         {{458.7, 457.3, 367.2, 248.4}, 752, 480},      // EuRoC
                         {{190.9, 190.9, 254.9, 256.9}, 512, 512}}) {  // TUM VI, a fisheye's centre
    CameraCalibration camera;
    camera.pinhole = kind.pinhole;
    camera.width = kind.width;
    camera.height = kind.height;
    EXPECT_EQ(slam::whatIsImplausible(camera), "") << kind.pinhole.fx;
    EXPECT_TRUE(slam::whatIsUnusual(camera).empty()) << kind.pinhole.fx;
  }
  for (const std::string& name : slam::cameraPresetNames()) {
    EXPECT_EQ(slam::whatIsImplausible(slam::loadCamera(name)), "") << name;
  }
}

TEST_F(Calibration, TheImagesSayTheSizeAndWhetherItFits) {
  CameraCalibration camera = slam::loadCamera("tum3");
  camera.width = 0;
  camera.height = 0;
  EXPECT_EQ(slam::fittedTo(camera, {640, 480}, "x").height, 480);
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] {
                         slam::fittedTo(camera, {1280, 960}, "x");
                       }),
                       {"camera x", "640 x 480", "times 2", "fx 1070.8"}));
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([] {
                         slam::fittedTo(slam::loadCamera("tum3"), {320, 240}, "tum3");
                       }),
                       {"is for images of 640 x 480, but the images are 320 x 240", "fx 267.7"}));
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([] {
                         slam::fittedTo(slam::loadCamera("tum3"), {848, 480}, "tum3");
                       }),
                       {"848 x 480", "calibrate"}));
}

TEST(CameraName, APathThatLeadsNowhereIsAMissingFile) {
  for (const char* path : {"TUM3.yaml", "settings/tum3", "/nowhere/camera.yml"}) {
    EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { slam::loadCamera(path); }),
                         {path, "no such file"}));
  }
}

}  // namespace
}  // namespace hmcdyn::faults
