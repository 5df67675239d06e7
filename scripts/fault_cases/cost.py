# SPDX-License-Identifier: BSD-3-Clause
"""Cases of many of the same, which must not take quadratic time."""
from __future__ import annotations

import dataclasses
from typing import Any

import cv2
import numpy as np

from fault_cases.case import Case, boxes, masks
from fault_cases.outcome import ANY, Expect, refused, within
from fault_cases.programs import user_program


EQUAL_POINTS = r"""
#include <chrono>
#include <cstdio>
#include <hmcdyn/steps/clustering.hpp>
int main() {
  double worst = 0.0;
  for (const int dimensions : {2, 3}) {
    for (const float order : {1.0f, 2.0f}) {
      const Eigen::MatrixXf points = Eigen::MatrixXf::Constant(dimensions, 200000, 1.5f);
      hmcdyn::ClusteringOptions options;
      options.order = order;
      const auto begin = std::chrono::steady_clock::now();
      const int clusters = hmcdyn::densityClusters(points, options).clusters;
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
      if (time.count() > worst) worst = time.count();
      std::printf("%dD p=%g: %d clusters, %.3f s; ", dimensions, order, clusters, time.count());
    }
  }
  std::printf("longest %.3f s\n", worst);
  return worst < 5.0 ? 0 : 1;
}
"""


NEAR_POINTS = r"""
#include <cstdio>
#include <hmcdyn/steps/clustering.hpp>
int main() {
  Eigen::MatrixXf points(3, 20000);
  for (int i = 0; i < 20000; ++i) points.col(i).setConstant(1.5f + 5e-7f * i);
  std::printf("%d clusters\n", hmcdyn::densityClusters(points).clusters);
}
"""


MANY_LABELS = r"""
#include <chrono>
#include <cstdio>
#include <opencv2/core.hpp>
#include <hmcdyn/hmcdyn.hpp>
int main() {
  cv::Mat labels(480, 640, CV_32SC1), gray(480, 640, CV_8UC1);
  for (int i = 0; i < 480 * 640; ++i) labels.at<int>(i / 640, i % 640) = 1 + i % 300000;
  cv::RNG(1).fill(gray, cv::RNG::UNIFORM, 0, 255);
  hmcdyn::KeyPoints points;
  for (int i = 0; i < 1000; ++i) points.push_back(30.0f + i % 40 * 14.0f, 30.0f + i / 40 * 16.0f, 2.0f);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<hmcdyn::LabelRegion> regions = hmcdyn::regionsIn(labels);
  const std::vector<hmcdyn::DetectionBox> boxes = hmcdyn::boundingBoxes(labels, regions);
  const auto result = hmcdyn::filterDynamicFeatures(gray, gray, points.view(), labels, regions);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  std::printf("%zu regions, %zu boxes, %zu labels: %.3f s\n", regions.size(), boxes.size(),
              result.stage.label.size(), time.count());
  return time.count() < 5.0 ? 0 : 1;
}
"""


def many_labels() -> Any:
    """As many labels as 16 bits have."""
    return (np.arange(640 * 480) % 65536).astype(np.uint16).reshape(480, 640)


def soft_mask() -> Any:
    """A probability in place of a label: a person whose border fades over 40 px."""
    image = np.zeros((480, 640), np.uint8)
    image[150:420, 120:260] = 255
    return cv2.blur(image, (41, 41))


def cost_cases() -> list[Case]:
    """Many of the same do not take quadratic time."""
    bounded = Expect(ANY, ("tracked",), checks=(within(10.0),))
    return [
        Case("27", "2e5 equal points, 2D and 3D, p = 1 and 2", user_program(EQUAL_POINTS, "-O2"),
             Expect(0, ("longest",), checks=(within(10.0),))),
        Case("own", "2e4 points in 3D, within 1 cm of each other", user_program(NEAR_POINTS, "-O2"),
             Expect(0, ("1 clusters",), checks=(within(5.0),))),
        Case("28", "a label image with 3e5 labels", user_program(MANY_LABELS, "-O2"),
             Expect(0, ("300000 regions",), checks=(within(10.0),))),
        Case("own", "--masks with 65535 labels a frame", masks(many_labels), refused("65535 different labels")),
        Case("own", "the same from the second frame on",
             masks(many_labels, lambda: np.zeros((480, 640), np.uint16)), bounded),
        Case("own", "--masks is the folder of depth images",
             lambda lab: lab.slam(lab.copy(), "--detector", "masks", "--masks", lab.clip.folder / "depth"),
             dataclasses.replace(bounded, said=("labels|regions|depth image",))),
        Case("own", "masks with soft borders (255 levels)", masks(soft_mask), bounded),
        Case("own", "1e5 boxes in a frame",
             boxes(text=lambda t: t.splitlines(True)[9] * 100000),
             dataclasses.replace(bounded, said=("100000 boxes",))),
    ]
