#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the boxes that two detectors found: python3 compare_boxes.py A/boxes.txt B/boxes.txt

The files are those of hmcdyn_slam --write-boxes. Boxes of an image are matched by their overlap (intersection over
union, at least 0.5), the largest first.
"""
import pathlib
import sys


def read(file):
    """(x_min, y_min, x_max, y_max) of each box, by time stamp and class."""
    boxes = {}
    for line in pathlib.Path(file).read_text().splitlines():
        if line and not line.startswith("#"):
            time, name, *numbers = line.split()
            boxes.setdefault((time, name), []).append(tuple(map(float, numbers[:4])))
    return boxes


def overlap(a, b):
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0
    area = sum((box[2] - box[0]) * (box[3] - box[1]) for box in (a, b))
    return width * height / (area - width * height)


def compare(first, second):
    """(overlap, largest difference of a corner (px)) of each pair."""
    pairs = []
    for key in first.keys() & second.keys():
        left_a, left_b = list(first[key]), list(second[key])
        for share, a, b in sorted(((overlap(a, b), a, b) for a in left_a for b in left_b), reverse=True):
            if share >= 0.5 and a in left_a and b in left_b:
                left_a.remove(a)
                left_b.remove(b)
                pairs.append((share, max(abs(x - y) for x, y in zip(a, b))))
    return pairs


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    files = [read(file) for file in sys.argv[1:]]
    found = compare(*files)
    count = [sum(map(len, file.values())) for file in files]
    print(f"boxes: {count[0]} and {count[1]}, {len(found)} of them pairs")
    if found:
        print(f"smallest overlap {min(pair[0] for pair in found):.4f}, "
              f"largest difference of a corner {max(pair[1] for pair in found):.4f} px")
