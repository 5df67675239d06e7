#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Puts things that move by themselves into a recorded room: a ball that floats by, a box that is pushed.

No detector knows them, so they show what geometry alone finds on real images. They are rendered along scripted
paths in front of the camera, hidden by what is nearer, with the depth of a structured-light sensor: noise and
steps of disparity, no depth at outlines and in the projector's shadow, a silhouette that is off by a pixel.

  insert_things.py kitchen_static out/kitchen_things
  insert_things.py desk_static out/desk_things --scale 0.4

Reads a folder in TUM format of a room where nothing moves: rgb.txt, depth.txt, groundtruth.txt and
calibration.yaml (ORB-SLAM keys, without distortion). Writes the same with mask/ (255 what moves, 0 the room and
what rests); the truth stays that of the room. Needs python3-numpy and python3-opencv.
"""
import argparse
import pathlib
import re
import shutil
import sys

try:
    import cv2
    import numpy as np
except ImportError as error:
    sys.exit(f"insert_things.py: {error}; on Debian: apt-get install python3-opencv, and /usr/bin/python3 to run it")

from vary_sequence import read_rows, write_rows

BASELINE = 0.075  # m, of the depth sensor
DISPARITY_NOISE = 0.07  # px
DISPARITY_STEP = 1 / 8  # px
SPEED_OF_REST = 0.02  # m/s


def read_calibration(path):
    text = path.read_text()
    values = dict(re.findall(r"^(?:Camera\.|RGBD\.)(fx|fy|cx|cy|DepthMapFactor):\s*([-+.\deE]+)", text, re.M))
    missing = {"fx", "fy", "cx", "cy", "DepthMapFactor"} - set(values)
    if missing:
        sys.exit(f"insert_things.py: {path} has no {', '.join(sorted(missing))}; expected ORB-SLAM's keys")
    return {key: float(value) for key, value in values.items()}


def rotation(q):
    x, y, z, w = np.asarray(q) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def ease(share):
    """0..1 with rest at both ends."""
    share = np.clip(share, 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


class Ball:
    """Floats through the whole view, without texture; comes from one side and leaves on the other."""
    colour = np.array([60.0, 90.0, 190.0])

    def __init__(self, scale, _seed):
        self.scale, self.radius = scale, 0.16 * scale

    def centre(self, share):
        """In the frame of the camera half-way (m), at a share of the recording."""
        return self.scale * np.array([-1.3 + 2.6 * share, 0.1 * np.sin(9.0 * share) - 0.1, 1.25])

    def cast(self, origin, rays, centre):
        """Distances along the rays (their z is 1), normals and brightness of the surface."""
        offset = origin - centre
        a, b = (rays ** 2).sum(-1), rays @ offset
        root = b * b - a * (offset @ offset - self.radius ** 2)
        along = np.where(root > 0.0, (-b - np.sqrt(np.maximum(root, 0.0))) / a, np.inf)
        along[along <= 0.0] = np.inf
        normal = (origin + np.where(np.isfinite(along), along, 0.0)[..., None] * rays - centre) / self.radius
        return along, normal, np.ones_like(along)


class Box:
    """Stands in the room, is pushed aside, and stays where it then is; printed on all sides."""
    colour = np.array([110.0, 160.0, 200.0])

    def __init__(self, scale, seed):
        self.scale, self.half = scale, scale * np.array([0.2, 0.15, 0.15])
        draw = np.random.default_rng(seed).uniform(0.45, 1.0, (24, 24)).astype(np.float32)
        self.print = cv2.resize(draw, (240, 240), interpolation=cv2.INTER_CUBIC)

    def centre(self, share):
        return self.scale * np.array([0.45 - 0.75 * ease((share - 0.35) / 0.25), 0.25, 1.3])

    def cast(self, origin, rays, centre):
        offset = origin - centre
        with np.errstate(divide="ignore", invalid="ignore"):
            near, far = (-self.half - offset) / rays, (self.half - offset) / rays
        enter, leave = np.minimum(near, far), np.maximum(near, far)
        along, axis = enter.max(-1), enter.argmax(-1)
        along = np.where((along < leave.min(-1)) & (along > 0.0), along, np.inf)
        at = offset + np.where(np.isfinite(along), along, 0.0)[..., None] * rays
        normal = np.zeros_like(rays)
        np.put_along_axis(normal, axis[..., None], np.sign(np.take_along_axis(at, axis[..., None], -1)), -1)
        column = ((at[..., 0] + at[..., 2]) * 300 / self.scale).astype(int) % 240
        row = ((at[..., 1] + 0.5 * at[..., 2]) * 300 / self.scale).astype(int) % 240
        return along, normal, self.print[row, column]


THINGS = {"ball": Ball, "box": Box}


class Sensor:
    """What the colour and the depth camera make of a thing."""

    def __init__(self, calibration, shape, seed):
        self.focal, self.factor = calibration["fx"], calibration["DepthMapFactor"]
        row, column = np.indices(shape, dtype=np.float64)
        self.rays = np.stack([(column - calibration["cx"]) / calibration["fx"],
                              (row - calibration["cy"]) / calibration["fy"], np.ones(shape)], -1)
        self.draw = np.random.default_rng(seed)

    def depth(self, true_depth):
        disparity = self.focal * BASELINE / true_depth
        noise = cv2.GaussianBlur(self.draw.normal(0.0, 1.0, true_depth.shape), (0, 0), 1.0) * 3.5
        measured = np.round((disparity + DISPARITY_NOISE * noise) / DISPARITY_STEP) * DISPARITY_STEP
        return self.focal * BASELINE / np.maximum(measured, DISPARITY_STEP)

    def shadow(self, seen, thing_depth, room_depth):
        """Room that the projector does not reach, left of what hides it."""
        hidden = np.zeros_like(seen)
        rows, columns = np.nonzero(seen & ~np.roll(seen, 1, axis=1))
        for row, column in zip(rows, columns):
            room = room_depth[row, max(column - 3, 0)]
            if room > thing_depth[row, column]:
                width = int(self.focal * BASELINE * (1.0 / thing_depth[row, column] - 1.0 / room))
                hidden[row, max(column - width, 0):column] = True
        return hidden & ~seen

    def add(self, colour, depth, along, normal, brightness, tint):
        """Draws a thing into both images (m in the depth image). Returns where it is seen."""
        room = np.where(depth > 0.0, depth, np.inf)
        seen = along < room
        if not seen.any():
            return colour, depth, seen
        light = 0.55 + 0.45 * np.clip(-(normal @ np.array([0.3, 0.7, 0.65])), 0.0, 1.0)
        drawn = tint * (light * brightness)[..., None] + self.draw.normal(0.0, 3.0, colour.shape)
        alpha = cv2.GaussianBlur(seen.astype(np.float64), (0, 0), 0.7)[..., None]
        fill = np.where(seen[..., None], drawn, tint * 0.6)
        colour = np.where(alpha > 0.02, alpha * fill + (1.0 - alpha) * colour, colour)
        # Registered to a pixel only; no depth at parts of the outline.
        measured = np.roll(seen, 1, axis=1)
        shallow = np.where(measured, self.depth(np.where(np.isfinite(along), along, 1.0)), depth)
        ring = cv2.dilate(measured.astype(np.uint8), np.ones((5, 5))) - cv2.erode(measured.astype(np.uint8), np.ones((3, 3)))
        patchy = cv2.GaussianBlur(self.draw.normal(0.0, 1.0, depth.shape), (0, 0), 3.0) > 0.0
        lost = ((ring > 0) & patchy) | self.shadow(measured, np.where(np.isfinite(along), along, 9.0), room)
        return colour, np.where(lost, 0.0, shallow), seen


def nearest_pose(stamp, poses):
    row = min(poses, key=lambda pose: abs(pose[0] - stamp))
    if abs(row[0] - stamp) > 0.02:
        return None
    return rotation(row[4:8]), np.array(row[1:4])


def insert(source, target, names, scale, seed):
    colour_rows, depth_rows = read_rows(source / "rgb.txt"), read_rows(source / "depth.txt")
    poses = [[float(value) for value in row] for row in read_rows(source / "groundtruth.txt")]
    if not colour_rows or not depth_rows or not poses:
        sys.exit(f"insert_things.py: {source} needs rgb.txt, depth.txt and groundtruth.txt with lines")
    calibration = read_calibration(source / "calibration.yaml")
    middle = nearest_pose(float(colour_rows[len(colour_rows) // 2][0]), poses)
    if middle is None:
        sys.exit(f"insert_things.py: {source / 'groundtruth.txt'} has no pose half-way through the recording")
    for folder in ("rgb", "depth", "mask"):
        (target / folder).mkdir(parents=True)
    things = [THINGS[name](scale, seed) for name in names]
    first, last = float(colour_rows[0][0]), float(colour_rows[-1][0])
    sensor, new_colour, new_depth = None, [], []
    for stamp, name, *_ in colour_rows:
        time = float(stamp)
        partner = min(depth_rows, key=lambda row: abs(float(row[0]) - time))
        pose = nearest_pose(time, poses)
        colour = cv2.imread(str(source / name))
        depth = cv2.imread(str(source / partner[1]), cv2.IMREAD_UNCHANGED)
        if colour is None or depth is None:
            sys.exit(f"insert_things.py: {source / name} or {source / partner[1]} cannot be read as an image")
        if pose is None or abs(float(partner[0]) - time) > 0.02:
            continue  # no frame that could be used
        sensor = sensor or Sensor(calibration, depth.shape, seed)
        colour, depth = colour.astype(np.float64), depth / sensor.factor
        mask = np.zeros(depth.shape, np.uint8)
        turn = middle[0].T @ pose[0]
        origin = middle[0].T @ (pose[1] - middle[1])
        rays = sensor.rays @ turn.T
        share = (time - first) / (last - first)
        step = 0.025 / (last - first)  # 25 ms to either side show the speed
        for thing in things:
            along, normal, brightness = thing.cast(origin, rays, thing.centre(share))
            colour, depth, seen = sensor.add(colour, depth, along, normal, brightness, thing.colour)
            speed = np.linalg.norm(thing.centre(share + step) - thing.centre(share - step)) / 0.05
            mask[seen] = 255 if speed > SPEED_OF_REST else 0
        cv2.imwrite(str(target / f"rgb/{stamp}.png"), np.clip(colour, 0, 255).astype(np.uint8))
        cv2.imwrite(str(target / f"depth/{partner[0]}.png"), np.round(depth * sensor.factor).astype(np.uint16))
        cv2.imwrite(str(target / f"mask/{stamp}.png"), mask)
        new_colour.append([stamp, f"rgb/{stamp}.png"])
        new_depth.append([partner[0], f"depth/{partner[0]}.png"])
    write_rows(target / "rgb.txt", new_colour)
    write_rows(target / "depth.txt", new_depth)
    shutil.copy(source / "groundtruth.txt", target / "groundtruth.txt")
    shutil.copy(source / "calibration.yaml", target / "calibration.yaml")
    (target / "boxes.txt").write_text("# no detector knows these things\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path, help="folder of the recording")
    parser.add_argument("target", type=pathlib.Path, help="folder to be made; must not exist")
    parser.add_argument("--things", nargs="+", choices=sorted(THINGS), default=["ball", "box"])
    parser.add_argument("--scale", type=float, default=1.0,
                        help="so many times as large and as far as by default, where they pass 1.3 m off")
    parser.add_argument("--seed", type=int, default=1, help="of noise and print")
    options = parser.parse_args()
    if not 0.0 < options.scale < 100.0:
        parser.error(f"--scale is {options.scale}; expected a number above 0")
    if options.target.exists():
        parser.error(f"{options.target} exists; expected a folder to be made")
    insert(options.source, options.target, options.things, options.scale, options.seed)


if __name__ == "__main__":
    main()
