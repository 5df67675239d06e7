# SPDX-License-Identifier: BSD-3-Clause
"""The examples run, and the page's picture is made."""
import pathlib
import re
import subprocess
import sys

import pytest

cv2 = pytest.importorskip("cv2")

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples/python"


def run(script, *arguments):
    outcome = subprocess.run([sys.executable, EXAMPLES / script, *map(str, arguments)], capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stderr
    return outcome.stdout


def test_labels_on_two_images_draws_a_picture(tmp_path):
    pytest.importorskip("matplotlib")
    run("labels_on_two_images.py", tmp_path / "labels.png")
    picture = cv2.imread(str(tmp_path / "labels.png"))
    red = (picture[:, :, 2] > 200) & (picture[:, :, 0] < 60) & (picture[:, :, 1] < 60)
    assert red.mean() > 0.01


def test_a_folder_is_tracked_and_masked(tmp_path, clip):
    # Two men walk in front of the camera: boxes as a person would draw them, for every frame.
    times = [line.split()[0] for line in (clip / "rgb.txt").read_text().splitlines() if not line.startswith("#")]
    boxes = tmp_path / "boxes.txt"
    boxes.write_text("".join(f"{time} person 40 200 250 479 0.9\n{time} person 320 280 600 479 0.9\n"
                             for time in times))
    text = run("track_folder.py", clip, boxes)
    errors = [float(error) for error in re.findall(r"ATE ([0-9.]+) m", text)]
    assert len(errors) == 2 and errors[1] < errors[0], text
    run("masks_for_folder.py", clip, clip / "groundtruth.txt", tmp_path / "masks")
    masks = sorted((tmp_path / "masks").glob("*.png"))
    assert len(masks) > 40
    assert cv2.imread(str(masks[-1]), cv2.IMREAD_UNCHANGED).shape == (480, 640)


def test_boxes_of_two_detectors_are_compared(tmp_path):
    (tmp_path / "a.txt").write_text("# timestamp class x_min y_min x_max y_max score\n"
                                    "1.5 0 0 0 10 10 0.9\n1.5 0 100 0 110 10 0.8\n2.5 0 0 0 10 10 0.9\n")
    # The first box is taller by 0.5 px; the second is of another class, the third overlaps too little.
    (tmp_path / "b.txt").write_text("1.5 0 0 0 10 10.5 0.7\n1.5 56 100 0 110 10 0.8\n2.5 0 6 0 16 10 0.9\n")
    text = run("../detectors/compare_boxes.py", tmp_path / "a.txt", tmp_path / "b.txt")
    assert text == ("boxes: 3 and 3, 1 of them pairs\n"
                    "smallest overlap 0.9524, largest difference of a corner 0.5000 px\n")  # 100 / 105
