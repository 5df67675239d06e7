# SPDX-License-Identifier: BSD-3-Clause
"""Things in front of a wall 3 m away, in three images of 64 x 48 px. Arguments: the script."""
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
STAMPS = ["10.000000", "11.000000", "12.000000"]
WALL = 3.0  # m
FOCAL = 50.0


class InsertThings(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(self.folder.name)
        self.source, self.target = root / "source", root / "target"
        self.source.mkdir()
        self.wall(WALL)
        for name in ("rgb", "depth"):
            (self.source / f"{name}.txt").write_text("".join(f"{stamp} {name}/{stamp}.png\n" for stamp in STAMPS))
        (self.source / "groundtruth.txt").write_text("".join(f"{stamp} 1 2 3 0 0 0 1\n" for stamp in STAMPS))
        self.calibration = f"Camera.fx: {FOCAL}\nCamera.fy: {FOCAL}\nCamera.cx: 32\nCamera.cy: 24\n"
        (self.source / "calibration.yaml").write_text(self.calibration + "RGBD.DepthMapFactor: 1000.0\n")

    def tearDown(self):
        self.folder.cleanup()

    def wall(self, distance):
        for name, image in (("rgb", np.full((48, 64, 3), 200, np.uint8)),
                            ("depth", np.full((48, 64), 1000 * distance, np.uint16))):
            (self.source / name).mkdir(exist_ok=True)
            for stamp in STAMPS:
                cv2.imwrite(str(self.source / name / f"{stamp}.png"), image)

    def run_script(self, *options):
        return subprocess.run([sys.executable, SCRIPT, self.source, self.target, *options], capture_output=True,
                              text=True, check=False)

    def image(self, folder, stamp):
        return cv2.imread(str(self.target / folder / f"{stamp}.png"), cv2.IMREAD_UNCHANGED)

    def test_half_way_the_ball_is_in_the_middle_with_its_front_at_its_distance(self):
        self.assertEqual(self.run_script("--things", "ball").returncode, 0)
        mask, depth = self.image("mask", STAMPS[1]), self.image("depth", STAMPS[1])
        # centre (0, 0.1 sin 4.5 - 0.1, 1.25) m: 1.25 m off, 7.9 px above the middle; radius 0.16 m: 6.4 px
        self.assertEqual(mask[16, 32], 255)
        self.assertEqual(mask[40, 32], 0)
        self.assertAlmostEqual(np.count_nonzero(mask) / (np.pi * 6.4 ** 2), 1.0, delta=0.15)
        self.assertAlmostEqual(depth[16, 33] / 1000, 1.25 - 0.16, delta=0.08)  # a step of disparity is 4 cm here
        self.assertEqual(depth[40, 32], 3000)
        self.assertTrue((self.image("rgb", STAMPS[1])[40, 32] == 200).all())

    def test_the_ball_comes_from_the_left_and_leaves_to_the_right(self):
        self.run_script("--things", "ball")
        # 1.3 m aside at 1.25 m is 52 px from the middle: outside
        self.assertEqual(np.count_nonzero(self.image("mask", STAMPS[0])), 0)
        self.assertEqual(np.count_nonzero(self.image("mask", STAMPS[2])), 0)

    def test_a_box_at_rest_is_seen_but_does_not_move(self):
        self.run_script("--things", "box")
        mask, depth = self.image("mask", STAMPS[0]), self.image("depth", STAMPS[0])
        self.assertEqual(np.count_nonzero(mask), 0)
        # centre (0.45, 0.25, 1.3) m, front at 1.15 m: around column 32 + 50 * 0.45 / 1.15 = 51.6, row 34.9
        self.assertAlmostEqual(depth[35, 52] / 1000, 1.15, delta=0.08)

    def test_what_is_nearer_hides_it(self):
        self.wall(0.8)
        self.run_script("--things", "ball")
        self.assertEqual(np.count_nonzero(self.image("mask", STAMPS[1])), 0)
        self.assertTrue((self.image("depth", STAMPS[1]) == 800).all())

    def test_the_same_seed_gives_the_same_images_and_the_truth_stays(self):
        self.run_script("--seed", "3")
        first = self.image("depth", STAMPS[1])
        self.target = self.target.with_name("again")
        self.run_script("--seed", "3")
        self.assertTrue((first == self.image("depth", STAMPS[1])).all())
        self.assertEqual((self.target / "groundtruth.txt").read_text(), (self.source / "groundtruth.txt").read_text())

    def test_a_calibration_without_a_key_is_named(self):
        (self.source / "calibration.yaml").write_text(self.calibration)
        run = self.run_script()
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("calibration.yaml has no DepthMapFactor", run.stderr)


if __name__ == "__main__":
    unittest.main()
