# SPDX-License-Identifier: BSD-3-Clause
"""Variants of a sequence of three images of 8 x 6 px. Arguments: the script."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import cv2
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)

SCRIPT = sys.argv.pop(1)
STAMPS = ["10.000000", "10.100000", "10.300000"]


def gray(value):
    image = np.full((6, 8), value, np.uint8)
    image[:, 0] = 255  # the left column
    return image


class VarySequence(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(self.folder.name)
        self.source, self.target = root / "source", root / "target"
        for name in ("rgb", "depth", "mask"):
            (self.source / name).mkdir(parents=True)
        for k, stamp in enumerate(STAMPS):
            for name in ("rgb", "depth", "mask"):
                cv2.imwrite(str(self.source / name / f"{stamp}.png"), gray(k))
        for name in ("rgb", "depth"):
            lines = [f"{stamp} {name}/{stamp}.png\n" for stamp in STAMPS]
            (self.source / f"{name}.txt").write_text("# stamp file\n" + "".join(lines))
        (self.source / "groundtruth.txt").write_text("10.0 1 2 3 0.1 0.2 0.3 0.9\n10.3 4 5 6 0 0 0 1\n")
        (self.source / "boxes.txt").write_text(f"{STAMPS[0]} person 1 2 5 4 0.5\n{STAMPS[1]} person 0 0 7 5 1\n")
        self.calibration("Camera.cx: 3.0\nCamera.fps: 30\nCamera.k1: 0.0\n")

    def tearDown(self):
        self.folder.cleanup()

    def calibration(self, text):
        (self.source / "calibration.yaml").write_text(text)

    def run_script(self, *options):
        return subprocess.run([sys.executable, SCRIPT, self.source, self.target, *options], capture_output=True,
                              text=True, check=False)

    def rows(self, name):
        return [line.split() for line in (self.target / name).read_text().splitlines()]

    def image(self, name):
        return cv2.imread(str(self.target / name), cv2.IMREAD_UNCHANGED)

    def test_backwards_the_last_image_comes_first_at_the_distance_of_the_last_two(self):
        self.assertEqual(self.run_script("--backwards").returncode, 0)
        self.assertEqual([row[0] for row in self.rows("rgb.txt")], ["10.000000", "10.200000", "10.300000"])
        for k, stamp in enumerate(["10.300000", "10.200000", "10.000000"]):
            for name in ("rgb", "depth", "mask"):
                np.testing.assert_array_equal(self.image(f"{name}/{stamp}.png"), gray(k))
        self.assertEqual([row[1] for row in self.rows("groundtruth.txt")], ["4.0", "1.0"])
        self.assertEqual(self.rows("boxes.txt"), [["10.200000", "person", "0", "0", "7", "5", "1"],
                                                  ["10.300000", "person", "1", "2", "5", "4", "0.5"]])

    def test_in_the_mirror_left_is_right(self):
        self.assertEqual(self.run_script("--mirror").returncode, 0)
        np.testing.assert_array_equal(self.image("rgb/10.100000.png"), gray(1)[:, ::-1])
        self.assertEqual(self.rows("groundtruth.txt")[0],
                         ["10.0", "-1.0", "2.0", "3.0", "0.1", "-0.2", "-0.3", "0.9"])
        self.assertEqual(self.rows("boxes.txt")[0], ["10.000000", "person", "2", "2", "6", "4", "0.5"])
        self.assertIn("Camera.cx: 4.000000\n", (self.target / "calibration.yaml").read_text())

    def test_every_second_image_has_half_the_rate(self):
        self.assertEqual(self.run_script("--every", "2").returncode, 0)
        self.assertEqual([row[0] for row in self.rows("depth.txt")], [STAMPS[0], STAMPS[2]])
        self.assertEqual(len(self.rows("boxes.txt")), 1)
        self.assertEqual(len(self.rows("groundtruth.txt")), 2)
        self.assertIn("Camera.fps: 15\n", (self.target / "calibration.yaml").read_text())

    def test_what_cannot_be_varied_is_refused(self):
        self.assertIn("--every is 0", self.run_script("--every", "0").stderr)
        self.calibration("Camera.cx: 3.0\nCamera.k1: 0.26\n")
        refused = self.run_script("--mirror")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("distortion", refused.stderr)
        self.assertFalse(self.target.exists())
        (self.source / "rgb/10.100000.png").write_bytes(b"no image")
        self.assertIn("10.100000.png cannot be read", self.run_script().stderr)
        self.assertIn("exists", self.run_script().stderr)


if __name__ == "__main__":
    unittest.main()
