# SPDX-License-Identifier: BSD-3-Clause
"""The real clip, its boxes, and how its lists are written."""
from __future__ import annotations

import pathlib
from typing import Any, NamedTuple, Sequence, Union

import cv2

from fault_cases.outcome import Skipped

Text = Union[str, bytes]
Rows = list[tuple[str, str]]  # time stamp and file name


def rows_of(text: str) -> Rows:
    return [tuple(line.split()[:2]) for line in body(text)]  # type: ignore[misc]


def body(text: str) -> list[str]:
    """Lines that are no comment."""
    return [line for line in text.splitlines() if line and line[0] != "#"]


def text_of(rows: "Sequence[Sequence[str]]") -> str:
    return "".join(" ".join(row) + "\n" for row in rows)


def write(path: pathlib.Path, content: Text) -> pathlib.Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def save(path: pathlib.Path, image: Any) -> None:
    if isinstance(image, bytes):
        write(path, image)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), image)


class Clip:
    """The real clip, as it is."""

    def __init__(self, folder: pathlib.Path) -> None:
        if not (folder / "rgb.txt").is_file():
            raise Skipped(f"no {folder}")
        self.folder = folder
        # Only images with a partner: else each case would tell of the one that has none.
        pairs = [line.split() for line in body((folder / "associations.txt").read_text())]
        self.rgb = [(pair[0], pair[1]) for pair in pairs]
        self.depth = [(pair[2], pair[3]) for pair in pairs]
        self.truth = (folder / "groundtruth.txt").read_text()


class Box(NamedTuple):
    """A detector's box as hmcdyn_slam --write-boxes writes it."""
    stamp: str
    kind: str
    x0: float
    y0: float
    x1: float
    y1: float
    score: float

    def line(self, **changed: Any) -> str:
        return "{} {} {:.2f} {:.2f} {:.2f} {:.2f} {:.4f}".format(*self._replace(**changed))
