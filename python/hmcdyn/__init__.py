# SPDX-License-Identifier: BSD-3-Clause
"""Which key points of a frame lie on moving things: a dynamic-feature filter for RGB-D SLAM.

One object and one call a frame, for a front end:

    frames = hmcdyn.FrameFilter(camera=hmcdyn.PinholeCamera(535.4, 539.2, 320.1, 247.6))
    result = frames.filter(timestamp, gray, key_points, boxes, depth=depth)
    kept = key_points[result.keep]

Two images and boxes: filter_dynamic_features. Arrays alone: filter_key_points. A mask a pixel, without a detector:
MotionMaskEstimator. Names, options and results are those of the C++ headers, functions in snake_case.
"""
from ._hmcdyn import *  # noqa: F401,F403
from ._hmcdyn import __version__ as __version__
from .detector import serve_detector as serve_detector

__all__ = [name for name in dir() if not name.startswith("_") and name not in ("detector",)]
