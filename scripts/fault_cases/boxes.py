# SPDX-License-Identifier: BSD-3-Clause
"""Cases of boxes in a file."""
from __future__ import annotations

import dataclasses
import json
import pathlib
import re
from decimal import Decimal

import numpy as np

from fault_cases.case import Case, Run, boxes, masks
from fault_cases.change import bom, comma_decimals, lines, plus_signs, unit
from fault_cases.data import rows_of
from fault_cases.lab import ALL, Lab
from fault_cases.outcome import (ANY, Check, Expect, Outcome, Skipped, as_untouched, counted, read_and_said, read_or,
                                 refused)

RENDER_TIMEOUT = 900.0  # s


def rendered(lab: Lab) -> pathlib.Path:
    """walking_xyz along the recorded path; it stays, as it takes a while."""
    folder = lab.rendered / "walking_xyz_150"
    if not (folder / "boxes.txt").is_file():
        path = lab.need(lab.shared / "eval" / "groundtruth" / "fr3_walk_xyz.txt")
        made = lab.run([lab.program("hmcdyn_synthesize"), "--scene", "walking_xyz", "--trajectory", path, "--frames",
                        "150", "--output", folder, "--quiet"], timeout=RENDER_TIMEOUT)
        if made.code != 0:
            raise Skipped(f"hmcdyn_synthesize: {made.text.strip()[-200:]}")
    return folder


def sparse_boxes(n: int) -> Run:
    """True boxes in every n-th frame."""
    def run(lab: Lab) -> Outcome:
        folder = rendered(lab)
        stamps_with = {stamp for stamp, _ in rows_of((folder / "rgb.txt").read_text())[::n]}
        text = lines(str)((folder / "boxes.txt").read_text())
        kept = "".join(line + "\n" for line in text.splitlines() if line.split()[0] in stamps_with)
        outcome = lab.slam(folder, *lab.box_options(kept), camera=folder / "calibration.yaml", frames=ALL)
        counts = outcome.summary().get("counts", {})
        outcome.text += (f"boxes_bridged {counts.get('boxes_bridged')}, "
                         f"dynamic labels {counts.get('labels', {}).get('dynamic')}\n")
        return outcome
    return run


def error_below(metres: float) -> Check:
    def check(outcome: Outcome) -> str:
        found = re.search(r"ATE RMSE ([\d.]+)", outcome.text)
        return "" if found and float(found[1]) < metres else f"ATE not below {metres} m"
    return check


def box_cases() -> list[Case]:
    """Boxes that cannot be boxes are refused, or counted by rule, with a guess."""
    kept = Expect(checks=(as_untouched,))
    return [
        Case("4", "x_max below x_min", boxes(lambda b: b.line(x0=b.x1, x1=b.x0)),
             dataclasses.replace(refused("boxes.txt", "x_max y_min x_min|swapped|exchanged|order"),
                                 unsaid=("another size",))),
        Case("4", "x y width height", boxes(lambda b: b.line(x1=b.x1 - b.x0, y1=b.y1 - b.y0)),
             refused("x y width height")),
        Case("4", "corners as shares 0..1",
             boxes(lambda b: f"{b.stamp} 0 {b.x0 / 640:.5f} {b.y0 / 480:.5f} {b.x1 / 640:.5f} {b.y1 / 480:.5f} 1"),
             refused("shares")),
        Case("21", "box stamps of another clock", boxes(lambda b: b.line(stamp=str(Decimal(b.stamp) - 1341846000))),
             refused("no box is at a frame's time", "differ by|clock")),
        Case("21", "class 1 (bicycle) everywhere", boxes(lambda b: b.line(kind="1")),
             Expect(0, (r"\d+ of \d+ boxes", "of classes", "bicycle"), checks=(counted("box_file", "other_class"),))),
        Case("21", "scores of 0.2", boxes(lambda b: b.line(score=0.2)),
             Expect(0, (r"\d+ of \d+ boxes", "score below"), checks=(counted("box_file", "low_score"),))),
        Case("other", "YOLO text: x y w h prob, no class",
             boxes(lambda b: f"{(b.x0 + b.x1) / 1280:.4f} {(b.y0 + b.y1) / 960:.4f} {(b.x1 - b.x0) / 640:.4f} "
                             f"{(b.y1 - b.y0) / 480:.4f} {b.score:.3f}"), refused("boxes.txt:1", "YOLO")),
        Case("16", "boxes with a BOM", boxes(text=bom), kept),
        Case("17", "boxes with decimal commas", boxes(text=comma_decimals), read_and_said("decimal commas")),
        Case("26", "boxes with +1.5", boxes(lambda b: " ".join(plus_signs(b.line().split()))), kept),
        Case("good", "a box over everything in each frame", boxes(lambda b: f"{b.stamp} 0 0 0 639 479 1"),
             Expect(ANY, ("tracked",))),
        Case("good", "a mask over everything in each frame", masks(lambda: np.full((480, 640), 255, np.uint8)),
             Expect(ANY, ("tracked",))),
        Case("own", "detector's CSV: frame,x1,y1,x2,y2,confidence,class,name",
             boxes(lambda b: f"0,{b.x0},{b.y0},{b.x1},{b.y1},{b.score},0,person",
                   text=lambda t: "frame,xmin,ymin,xmax,ymax,confidence,class,name\n" + t),
             refused("boxes.txt:[12]", "8 fields", "timestamp class x_min")),
        Case("own", "score before the corners", boxes(lambda b: f"{b.stamp} 0 {b.score} {b.x0} {b.y0} {b.x1} {b.y1}"),
             refused("boxes.txt:1", "score", "order|behind|before|first|third")),
        Case("own", "COCO results as JSON",
             boxes(lambda b: json.dumps({"image_id": b.stamp, "category_id": 1, "score": b.score,
                                         "bbox": [b.x0, b.y0, b.x1 - b.x0, b.y1 - b.y0]}) + ",",
                   text=lambda t: f"[\n{t[:-2]}\n]\n"), refused("boxes.txt:1", "JSON")),
        Case("own", "KITTI labels: Pedestrian 0 0 ...",
             boxes(lambda b: f"Pedestrian 0.00 0 -0.20 {b.x0} {b.y0} {b.x1} {b.y1} 1.8 0.5 1.2 1.8 1.4 8.4 0.01"),
             refused("boxes.txt:1", "Pedestrian")),
        Case("own", "a class's name of two words: traffic light",
             boxes(lambda b: b.line(kind="traffic light")), Expect(0, (r"\(traffic light\)",))),
        Case("own", "class 'people', which COCO has not", boxes(lambda b: b.line(kind="people")),
             refused("boxes.txt:1", "people", "COCO")),
        Case("own", "NaN as a corner in one line", boxes(text=lambda t: t.replace(t.split()[2], "nan", 1)),
             read_or("boxes.txt:1", "nan")),
        Case("own", "boxes of images of 1280 x 960",
             boxes(lambda b: b.line(x0=2 * b.x0, y0=2 * b.y0, x1=2 * b.x1, y1=2 * b.y1)),
             Expect(ANY, (r"another size|larger image|twice",))),
        Case("own", "boxes with integer nanoseconds, lists in seconds",
             boxes(lambda b: b.line(stamp=unit(9)(Decimal(b.stamp), 0))), read_and_said("nanoseconds|1e-09 s")),
        Case("own", "comments only", boxes(text=lambda _: "# nothing\n"), Expect(0, ("no box",))),
        Case("8", "true boxes in every frame", sparse_boxes(1),
             Expect(0, ("ATE RMSE",), checks=(error_below(0.0021),))),
        *(Case("8", f"true boxes in every {n}. frame",
               sparse_boxes(n), Expect(0, ("ATE RMSE",), checks=(counted("boxes_bridged"), error_below(limit))))
          for n, limit in ((2, 0.0021), (3, 0.0021), (5, 0.0033))),
    ]
