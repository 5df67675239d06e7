# SPDX-License-Identifier: BSD-3-Clause
"""Cases of images."""
from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from fault_cases.case import Case, Run, images, trajectory
from fault_cases.change import columns
from fault_cases.data import body
from fault_cases.lab import Lab
from fault_cases.outcome import ANY, FAILS, READ, Expect, Outcome, said_once


def eight_bit(depth: Any, _i: int) -> Any:
    return (depth // 256).astype(np.uint8)


def three_channels(depth: Any, _i: int) -> Any:
    return cv2.merge([depth, depth, depth])


def in_metres(depth: Any, _i: int) -> Any:
    return (depth / 5000.0).astype(np.float32)


def millimetres(depth: Any, _i: int) -> Any:
    return (depth // 5).astype(np.uint16)


def shrunk(image: Any, _i: int) -> Any:
    return cv2.resize(image, (320, 240), interpolation=cv2.INTER_NEAREST)


def truncated(image: Any, i: int) -> Any:
    """The fourth image is half of a file."""
    encoded = cv2.imencode(".png", image)[1].tobytes()
    return encoded[:len(encoded) // 2] if i == 3 else encoded


def lfs_pointer(_image: Any, _i: int) -> bytes:
    return (b"version https://git-lfs.github.com/spec/v1\n"
            b"oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n")


def rgba(image: Any, _i: int) -> Any:
    return cv2.cvtColor(image, cv2.COLOR_BGR2BGRA)


def gray(image: Any, _i: int) -> Any:
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def dark_start(image: Any, i: int) -> Any:
    return image * 0 if i < 3 else image


def in_folder(name: str) -> Run:
    """S on the clip in a folder of that name."""
    def run(lab: Lab) -> Outcome:
        outcome = lab.slam(lab.copy(name=name))
        outcome.twin = lab.untouched()
        return outcome
    return run


def image_cases() -> list[Case]:
    """With too little to go on, one line says what was missing."""
    once = Expect(FAILS, (r"1[57] (frames|images)",), checks=(said_once("16.bit|single channel|channels|unsigned"),))
    return [
        Case("20", "8-bit depth", images("depth", eight_bit), once),
        Case("20", "three-channel depth", images("depth", three_channels), once),
        Case("20", "float depth (TIFF)", images("depth", in_metres, ".tiff"), once),
        Case("23", "no depth at all", images("depth", lambda image, _: image * 0), Expect(3, ("no depth",))),
        Case("good", "RGBA colour", images("rgb", rgba), READ),
        Case("good", "gray images", images("rgb", gray), Expect(0, ("tracked 15 of 15",))),
        Case("good", "JPEG colour", images("rgb", lambda image, _: image, ".jpg"), Expect(0, ("tracked 15 of 15",))),
        Case("good", "a truncated image", images("rgb", truncated), Expect(0, ("left out|cannot be read|corrupt",))),
        Case("good", "LFS pointers", images("depth", lfs_pointer), Expect(FAILS, ("LFS|git",))),
        Case("good", "the first three images dark", images("rgb", dark_start), Expect(ANY, ("tracked",))),
        Case("good", "blanks and umlauts in the path", in_folder("Meine Küche 1"), READ),
        Case("good", "motionless estimate", trajectory(columns(lambda f: f[:1] + "1 1 1 0 0 0 1".split())),
             Expect(ANY, ("rmse|no unique|same|motion",))),
        Case("good", "collinear estimate",
             trajectory(lambda t: "".join(f"{l.split()[0]} {i / 10} 0 0 0 0 0 1\n" for i, l in enumerate(body(t)))),
             Expect(ANY, ("rmse|line|collinear",))),
        Case("own", "depth all 65535 (another kind of none)", images("depth", lambda d, _: d * 0 + 65535),
             Expect(FAILS, ("depth",))),
    ]
