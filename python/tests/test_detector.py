# SPDX-License-Identifier: BSD-3-Clause
"""serve_detector(): the other end of hmcdyn_slam --detector command."""
import json
import subprocess
import sys

import numpy
import pytest

cv2 = pytest.importorskip("cv2")


def start(script):
    return subprocess.Popen([sys.executable, "-c", "import hmcdyn, numpy\n" + script], stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def ask(process, frame, image):
    header = {"frame": frame, "timestamp": 1.5, "width": image.shape[1], "height": image.shape[0],
              "bytes": image.nbytes}
    process.stdin.write(json.dumps(header).encode() + b"\n" + image.tobytes())
    process.stdin.flush()
    return json.loads(process.stdout.readline())


IMAGE = numpy.arange(4 * 6 * 3, dtype=numpy.uint8).reshape(4, 6, 3)


def test_boxes_are_answered_and_prints_do_not_disturb():
    process = start("def find(image):\n  print('hello')\n  return [[1, 2, 3, image[0, 1, 2], 0.5, 'person']]\n"
                    "hmcdyn.serve_detector(find, version='mine 1')")
    with process:
        assert json.loads(process.stdout.readline()) == {"hmcdyn_detector": 1, "version": "mine 1"}
        for frame in (1, 2):
            assert ask(process, frame, IMAGE) == {"frame": frame, "boxes": [[1, 2, 3, 5, 0.5, "person"]]}
        process.stdin.close()
        assert process.wait() == 0
        assert b"hello" in process.stderr.read()


def test_a_mask_is_answered_as_a_png():
    process = start("hmcdyn.serve_detector(lambda image: image[:, :, 0] > 30)")
    with process:
        process.stdout.readline()
        size = ask(process, 7, IMAGE)["mask_bytes"]
        mask = cv2.imdecode(numpy.frombuffer(process.stdout.read(size), numpy.uint8), cv2.IMREAD_UNCHANGED)
        numpy.testing.assert_array_equal(mask, IMAGE[:, :, 0] > 30)
        process.stdin.close()


def test_a_mask_of_another_type_is_refused_by_its_type():
    process = start("hmcdyn.serve_detector(lambda image: image[:, :, 0].astype(numpy.int64))")
    with process:
        process.stdout.readline()
        assert "the mask is an array of int64, shape (4, 6); expected" in ask(process, 1, IMAGE)["error"]
        process.stdin.close()


def test_what_the_function_throws_is_told():
    process = start("def find(image):\n  raise OSError('no GPU')\nhmcdyn.serve_detector(find)")
    with process:
        process.stdout.readline()
        assert ask(process, 1, IMAGE) == {"error": "OSError: no GPU"}
        process.stdin.close()
        assert process.wait() != 0
        assert b"no GPU" in process.stderr.read()
