# SPDX-License-Identifier: BSD-3-Clause
"""Tracks a folder in TUM format by OpenCV's ORB and PnP, without the filter and with it, and prints the error.

    python3 track_folder.py FOLDER BOXES.txt [FX FY CX CY]

BOXES.txt as hmcdyn_slam --write-boxes writes it. The camera is TUM's fr3 where it is not given. The same front end
in C++: examples/04_front_end.cpp.
"""
import pathlib
import sys

import cv2
import numpy

import hmcdyn


def read_list(file):
    """(time stamp, name) of each line."""
    lines = [line.split() for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return [(float(line[0]), line[1]) for line in lines]


def frames_of(folder):
    """(time stamp, gray image, depth (m)) of each colour image with a depth image within 20 ms."""
    depths = read_list(folder / "depth.txt")
    times = numpy.array([time for time, _ in depths])
    for time, name in read_list(folder / "rgb.txt"):
        nearest = int(numpy.argmin(abs(times - time)))
        if abs(times[nearest] - time) < 0.02:
            raw = cv2.imread(str(folder / depths[nearest][1]), cv2.IMREAD_UNCHANGED)
            gray = cv2.cvtColor(cv2.imread(str(folder / name)), cv2.COLOR_BGR2GRAY)
            yield time, gray, (raw / 5000).astype(numpy.float32)


def read_boxes(file):
    """People's boxes by time stamp (s)."""
    boxes = {}
    for line in pathlib.Path(file).read_text().splitlines():
        if line and not line.startswith("#"):
            time, name, *numbers = line.split()
            if name in ("0", "person"):
                boxes.setdefault(round(float(time), 4), []).append([float(number) for number in numbers])
    return boxes


class FrontEnd:
    """Matches each frame with the points of the last key frame, which have a place in the world."""

    LEAST_INLIERS = 15  # fewer, and the camera is lost

    def __init__(self, camera, rule):
        self.camera = camera
        self.filter = hmcdyn.FrameFilter(camera=camera, rule=rule)
        self.matrix = numpy.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
        self.pose = numpy.eye(4)  # camera from world, of the last tracked frame
        self.points, self.descriptors = numpy.empty((0, 3), numpy.float32), None

    def track(self, time, gray, depth, boxes):
        """The camera from the world in this frame, or None where it is lost."""
        height, width = gray.shape
        orb = cv2.ORB_create(round(1000 * hmcdyn.feature_factor(boxes, width, height)))
        key_points, descriptors = orb.detectAndCompute(gray, None)
        pixels = cv2.KeyPoint_convert(key_points)
        result = self.filter.filter(time, gray, pixels, boxes, depth=depth)
        pixels, descriptors = pixels[result.keep], descriptors[result.keep]
        inliers = 0
        if len(self.points) > 0:
            inliers = self.locate(pixels, descriptors, result.weight[result.keep])
            if inliers < self.LEAST_INLIERS:
                return None
        self.filter.set_pose(time, self.pose)
        if 2 * inliers < len(self.points) or inliers < 4 * self.LEAST_INLIERS:
            self.make_key_frame(depth, pixels, descriptors, result.lambda_[result.keep])
        return self.pose

    def locate(self, pixels, descriptors, weight):
        """How many points agree with the pose that was found; 0 where none was."""
        matches = [match for match in cv2.BFMatcher(cv2.NORM_HAMMING, True).match(descriptors, self.descriptors)
                   if match.distance <= 64]  # of 256 bits: more, and it is not the same point
        if len(matches) < self.LEAST_INLIERS:
            return 0
        now = [match.queryIdx for match in matches]
        world = self.points[[match.trainIdx for match in matches]]
        found, rotation, shift, _ = cv2.solvePnPRansac(world, pixels[now], self.matrix, None, iterationsCount=1000,
                                                       reprojectionError=3.0, confidence=0.999, flags=cv2.SOLVEPNP_AP3P)
        if not found:
            return 0
        pose = numpy.eye(4)
        pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(rotation)[0], shift[:, 0]
        refined = hmcdyn.refine_pose(*world.T, *pixels[now].T, self.camera, pose, weight=weight[now])
        if not refined.succeeded or refined.inliers < self.LEAST_INLIERS:
            return 0
        self.pose = refined.camera_from_world
        return refined.inliers

    def make_key_frame(self, depth, pixels, descriptors, trust):
        """A point that is not trusted to stand still is no landmark."""
        u, v = pixels.T
        z = depth[numpy.rint(v).astype(int), numpy.rint(u).astype(int)]
        good = (z > 0) & (trust > 0.5)
        if good.sum() > len(self.points) / 4:
            camera = self.camera
            seen = numpy.stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z])
            rotation, shift = self.pose[:3, :3], self.pose[:3, 3:]
            self.points = (rotation.T @ (seen - shift)).T[good].astype(numpy.float32)
            self.descriptors = descriptors[good]


def tum_row(time, camera_from_world):
    """timestamp tx ty tz qx qy qz qw."""
    pose = numpy.linalg.inv(camera_from_world)
    turn = cv2.Rodrigues(pose[:3, :3])[0][:, 0]
    angle = numpy.linalg.norm(turn)
    axis = turn / angle if angle > 0 else turn
    return [time, *pose[:3, 3], *(numpy.sin(angle / 2) * axis), numpy.cos(angle / 2)]


def main(folder, boxes_file, fx=535.4, fy=539.2, cx=320.1, cy=247.6):
    folder, boxes = pathlib.Path(folder), read_boxes(boxes_file)
    camera = hmcdyn.PinholeCamera(float(fx), float(fy), float(cx), float(cy))
    for rule in ("none", "hmc"):
        front_end, rows, frames = FrontEnd(camera, rule), [], 0
        for time, gray, depth in frames_of(folder):
            frames += 1
            pose = front_end.track(time, gray, depth, boxes.get(round(time, 4), []))
            if pose is not None:
                rows.append(tum_row(time, pose))
        error = hmcdyn.ate(folder / "groundtruth.txt", numpy.array(rows)).error
        print(f"{'with   ' if rule == 'hmc' else 'without'} the filter: ATE {error.rmse:.4f} m, "
              f"{len(rows)} of {frames} frames tracked")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 7):
        sys.exit(__doc__)
    main(*sys.argv[1:])
