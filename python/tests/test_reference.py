# SPDX-License-Identifier: BSD-3-Clause
"""Bit for bit what the library says in C++ (reference.cpp), on made-up arrays and on the real clip."""
import os
import pathlib
import subprocess
import sys

import hmcdyn
import numpy
import pytest

cv2 = pytest.importorskip("cv2")
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "examples/python"))
import track_folder  # noqa: E402


def reference(kind, folder, parts):
    """The raw results of the C++ program for raw input."""
    program = os.environ.get("HMCDYN_PYTHON_REFERENCE")
    if not program:
        pytest.skip("HMCDYN_PYTHON_REFERENCE, the C++ program, is not given")
    (folder / "in").write_bytes(b"".join(parts))
    subprocess.run([program, kind, folder / "in", folder / "out"], check=True)
    return (folder / "out").read_bytes()


def raw(values, dtype):
    return numpy.ascontiguousarray(values, dtype).tobytes()


def raw_boxes(boxes):
    return raw(len(boxes), "i4") + raw([box[:4] for box in boxes], "f4")


def test_arrays(tmp_path):
    random = numpy.random.default_rng(5)
    n = 2000
    arrays = [random.uniform(0, 640, n), random.uniform(0, 480, n), random.uniform(-0.5, 5, n),
              random.exponential(1, n)]
    arrays[3][::7] = numpy.nan
    arrays = [values.astype(numpy.float32) for values in arrays]
    boxes = [[50, 50, 300, 400], [200, 100, 500, 460], [600, 0, 700, 500]]
    expected = reference("stage", tmp_path, [raw(n, "i4"), *(raw(values, "f4") for values in arrays), raw_boxes(boxes)])
    result = hmcdyn.filter_key_points(*arrays, boxes)
    assert result.label.tobytes() + result.weight.tobytes() + result.cluster.tobytes() == expected
    assert (result.label == hmcdyn.PointLabel.DYNAMIC).any()


def test_the_real_clip(tmp_path, clip):
    boxes = [[60, 210, 240, 479], [340, 300, 590, 479]]
    parts, results = [], []
    filters = hmcdyn.FrameFilter()
    frames = [frame for _, frame in zip(range(6), track_folder.frames_of(clip))]
    parts.append(raw([len(frames), *frames[0][1].shape], "i4"))
    for time, gray, depth in frames:
        points = cv2.KeyPoint_convert(cv2.ORB_create(500).detect(gray))
        parts += [raw(time, "f8"), raw(gray, "u1"), raw(depth, "f4"), raw(len(points), "i4"), raw(points, "f4"),
                  raw_boxes(boxes)]
        result = filters.filter(time, gray, points, boxes, depth=depth)
        results += [result.keep, result.weight, result.lambda_, result.label]
    expected = reference("frames", tmp_path, parts)
    assert b"".join(values.tobytes() for values in results) == expected
    assert not result.keep.all()
