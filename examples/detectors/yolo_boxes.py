#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""People by a YOLOv5 network, with OpenCV's DNN module: the frame of any detector in Python.

    hmcdyn_slam --detector command --command 'python3 yolo_boxes.py yolov5n.onnx' ...
"""
import os
import sys

import cv2
import numpy

import hmcdyn

SIDE = 640
network = cv2.dnn.readNetFromONNX(sys.argv[1])


def find(image):
    """Rows x_min, y_min, x_max, y_max, score, class; the image is blue first."""
    scale = SIDE / max(image.shape[:2])
    width, height = round(image.shape[1] * scale), round(image.shape[0] * scale)
    left, top = (SIDE - width) // 2, (SIDE - height) // 2
    square = numpy.full((SIDE, SIDE, 3), 114, numpy.uint8)
    square[top:top + height, left:left + width] = cv2.resize(image, (width, height))
    network.setInput(cv2.dnn.blobFromImage(square, 1 / 255, swapRB=True))
    rows = network.forward()[0]  # (N, 85): centre, size, objectness, 80 classes
    scores = rows[:, 4] * rows[:, 5]  # people
    centre = (rows[:, :2] - (left, top)) / scale
    half = rows[:, 2:4] / scale / 2
    boxes = numpy.hstack([centre - half, centre + half])
    sizes = numpy.hstack([centre - half, 2 * half])
    kept = cv2.dnn.NMSBoxes(sizes.tolist(), scores.tolist(), 0.25, 0.45)
    return [[*boxes[i], scores[i]] for i in numpy.ravel(kept)]


hmcdyn.serve_detector(find, version=f"{os.path.basename(sys.argv[1])}, OpenCV {cv2.__version__}")
