#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes another sequence of a recorded one, on which nothing was tuned: mirrored, backwards, slower.

A method whose constants were chosen on a few recordings should do as well on their images in a mirror,
played backwards or at a lower rate, where the error of the method is another, and that of the data is not.

  vary_sequence.py kitchen_walk out/kitchen_walk_mirrored --mirror
  vary_sequence.py kitchen_walk out/kitchen_walk_backwards --backwards
  vary_sequence.py kitchen_walk out/kitchen_walk_half --every 2

Reads a folder in TUM format: rgb.txt and depth.txt, and where they are there groundtruth.txt, boxes.txt, mask/
and calibration.yaml (ORB-SLAM keys, without distortion where --mirror is given). Needs python3-numpy and
python3-opencv.
"""
import argparse
import pathlib
import re
import sys

try:
    import cv2
except ImportError as error:
    sys.exit(f"vary_sequence.py: {error}; on Debian: apt-get install python3-opencv, and /usr/bin/python3 to run it")


def read_rows(path):
    """Lines of a list without comments, split at blanks; [] where there is no such file."""
    if not path.exists():
        return []
    lines = (line.split() for line in path.read_text().splitlines())
    return [line for line in lines if line and not line[0].startswith("#")]


def write_rows(path, rows):
    path.write_text("".join(" ".join(row) + "\n" for row in sorted(rows, key=lambda row: float(row[0]))))


class Variation:
    """What happens to times, images, poses, boxes and calibration."""

    def __init__(self, mirror, backwards, every, first, last, width):
        self.mirror, self.backwards, self.every = mirror, backwards, every
        self.first, self.last, self.width = first, last, width

    def stamp(self, text):
        return f"{self.first + self.last - float(text):.6f}" if self.backwards else text

    def image(self, image):
        return image[:, ::-1].copy() if self.mirror else image

    def pose(self, values):
        """The mirror image of a pose: x and the turns about y and z change their sign."""
        signs = (-1, 1, 1, 1, -1, -1, 1) if self.mirror else (1,) * 7
        return [repr(sign * float(value)) for sign, value in zip(signs, values)]

    def box(self, x_min, x_max):
        if not self.mirror:
            return x_min, x_max
        last = self.width - 1
        return f"{last - float(x_max):g}", f"{last - float(x_min):g}"

    def calibration(self, text):
        if self.mirror:
            text = re.sub(r"(\bcx:\s*)([-+.\deE]+)",
                          lambda found: f"{found[1]}{self.width - 1 - float(found[2]):.6f}", text)
        return re.sub(r"(\bfps:\s*)([.\d]+)", lambda found: f"{found[1]}{float(found[2]) / self.every:g}", text)


def copy_images(source, target, rows, folder, variation):
    """Writes the images of a list as PNG, named by their new stamps. Returns the new list."""
    (target / folder).mkdir(parents=True)
    new = []
    for row in rows:
        image = cv2.imread(str(source / row[1]), cv2.IMREAD_UNCHANGED)
        if image is None:
            sys.exit(f"vary_sequence.py: {source / row[1]} cannot be read as an image")
        name = f"{folder}/{variation.stamp(row[0])}.png"
        cv2.imwrite(str(target / name), variation.image(image))
        new.append([variation.stamp(row[0]), name])
    return new


def has_distortion(calibration):
    values = re.findall(r"\b(?:k[1-6]|p[12]):\s*([-+.\deE]+)", calibration)
    return any(float(value) != 0.0 for value in values)


def vary(source, target, mirror, backwards, every):
    colour = read_rows(source / "rgb.txt")
    if not colour:
        sys.exit(f"vary_sequence.py: {source / 'rgb.txt'} names no image; expected a folder in TUM format")
    calibration_file = source / "calibration.yaml"
    calibration = calibration_file.read_text() if calibration_file.exists() else ""
    if mirror and has_distortion(calibration):
        sys.exit(f"vary_sequence.py: {calibration_file} has distortion, which --mirror does not turn round; "
                 "expected an undistorted recording")
    first_image = cv2.imread(str(source / colour[0][1]), cv2.IMREAD_UNCHANGED)
    if first_image is None:
        sys.exit(f"vary_sequence.py: {source / colour[0][1]} cannot be read as an image")
    variation = Variation(mirror, backwards, every, float(colour[0][0]), float(colour[-1][0]), first_image.shape[1])
    colour = colour[::every]
    kept = {row[0] for row in colour}

    target.mkdir(parents=True)
    write_rows(target / "rgb.txt", copy_images(source, target, colour, "rgb", variation))
    depth = read_rows(source / "depth.txt")[::every]
    write_rows(target / "depth.txt", copy_images(source, target, depth, "depth", variation))
    masks = [[row[0], f"mask/{row[0]}.png"] for row in colour if (source / f"mask/{row[0]}.png").exists()]
    if masks:
        copy_images(source, target, masks, "mask", variation)
    write_rows(target / "groundtruth.txt", [[variation.stamp(row[0]), *variation.pose(row[1:8])]
                                            for row in read_rows(source / "groundtruth.txt")])
    boxes = []
    for row in read_rows(source / "boxes.txt"):
        if row[0] in kept:
            x_min, x_max = variation.box(row[2], row[4])
            boxes.append([variation.stamp(row[0]), row[1], x_min, row[3], x_max, *row[5:]])
    write_rows(target / "boxes.txt", boxes)
    if calibration:
        (target / "calibration.yaml").write_text(variation.calibration(calibration))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path, help="folder of the recording")
    parser.add_argument("target", type=pathlib.Path, help="folder to be made; must not exist")
    parser.add_argument("--mirror", action="store_true", help="left is right")
    parser.add_argument("--backwards", action="store_true", help="the last image comes first")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every Nth image only")
    options = parser.parse_args()
    if options.every < 1:
        parser.error(f"--every is {options.every}; expected a number of at least 1")
    if options.target.exists():
        parser.error(f"{options.target} exists; expected a folder to be made")
    vary(options.source, options.target, options.mirror, options.backwards, options.every)


if __name__ == "__main__":
    main()
