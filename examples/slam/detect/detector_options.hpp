// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/input/dataset/recording.hpp"

namespace hmcdyn::slam {

/// A program of the user's that finds boxes or masks.
struct CommandOptions {
  std::string line;             ///< For the shell.
  double timeout = 10.0;        ///< Longest time to an answer (s), > 0.
  double start_timeout = 60.0;  ///< Longest time to its first line (s), > 0: it loads its model.
  int restarts = 3;             ///< So often it is started again after it failed, >= 0.
};

/// Which detector, and what it reports.
struct DetectorOptions {
  /// "darknet" (YOLO as .cfg and .weights), "yolo" (YOLOv5 or YOLOv8 as ONNX), "file" (boxes read
  /// from a text file), "hog" (OpenCV's people detector, needs no model), "masks" (label images in
  /// place of boxes, by MaskFolder), "command" (a program of the user's) or "none".
  std::string type = "none";
  std::filesystem::path model;    ///< darknet: the .cfg; yolo: the .onnx. Trained on COCO.
  std::filesystem::path weights;  ///< darknet: the .weights that belong to the .cfg.
  std::filesystem::path boxes;    ///< file: lines as readBoxFile() describes them.
  std::filesystem::path masks;    ///< masks: a folder as MaskFolder describes it.
  int mask_margin = 4;            ///< Regions are that much larger than their masks (px), >= 0.
  CommandOptions command;         ///< command: the program.
  /// Boxes with a lower score are left out, whatever the detector. 0..1.
  float score_threshold = 0.25f;
  /// Of two boxes of one class whose intersection over union is larger, the stronger stays. 0..1.
  /// Not for "file" and "command", whose boxes are taken as they are, nor for "hog", which merges
  /// windows.
  float nms_threshold = 0.45f;
  std::vector<int> classes;  ///< COCO classes to report; empty = all.
  /// Side of the network's square input (px), a multiple of 32; 0 = the model's own, which is
  /// that of the .cfg, and 640 for ONNX. An ONNX export runs with its own size only.
  int input_size = 0;
  /// file, masks: largest difference between the time stamps of an image and its boxes (s).
  double time_tolerance = 0.02;
  FramesOfBoxes frames;  ///< file: what reviewBoxes() checks the boxes against.
};

}  // namespace hmcdyn::slam
