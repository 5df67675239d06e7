# SPDX-License-Identifier: BSD-3-Clause
"""Masks of what moves for a folder in TUM format, for NeRF, Gaussian splatting or another SLAM.

    python3 masks_for_folder.py FOLDER TRAJECTORY.txt OUTPUT [FX FY CX CY]

TRAJECTORY.txt: poses of the camera (hmcdyn_slam's trajectory.txt, or your own), TUM format. A PNG a colour image
with a pose within 20 ms, of its name: 255 moves, 128 stands but moved before, 64 unknown, 0 the room.
"""
import pathlib
import sys

import cv2
import numpy

import hmcdyn
from track_folder import frames_of


def pose_of(row):
    """Camera from world of timestamp tx ty tz qx qy qz qw, which is where the camera is in the world."""
    x, y, z, w = row[4:]
    pose = numpy.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = row[1:4]
    return numpy.linalg.inv(pose)


def main(folder, trajectory, output, fx=535.4, fy=539.2, cx=320.1, cy=247.6):
    output = pathlib.Path(output)
    output.mkdir(parents=True, exist_ok=True)
    rows = hmcdyn.read_trajectory(trajectory)
    estimator = hmcdyn.MotionMaskEstimator(hmcdyn.PinholeCamera(float(fx), float(fy), float(cx), float(cy)))
    written = 0
    for time, gray, depth in frames_of(pathlib.Path(folder)):
        nearest = rows[numpy.argmin(abs(rows[:, 0] - time))]
        pose = pose_of(nearest) if abs(nearest[0] - time) < 0.02 else None
        mask = estimator.update(time, depth, pose, gray=gray)
        if pose is not None:
            cv2.imwrite(str(output / f"{time:.6f}.png"), mask.label)
            written += 1
    print(f"{written} masks in {output}")


if __name__ == "__main__":
    if len(sys.argv) not in (4, 8):
        sys.exit(__doc__)
    main(*sys.argv[1:])
