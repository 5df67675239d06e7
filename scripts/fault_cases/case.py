# SPDX-License-Identifier: BSD-3-Clause
"""A case, and the commands that most of them run."""
from __future__ import annotations

import dataclasses
import pathlib
from decimal import Decimal
from typing import Any, Callable, Optional

from fault_cases.data import Box, Text, save
from fault_cases.lab import FRAMES, Lab
from fault_cases.outcome import Expect, Outcome

Run = Callable[[Lab], Outcome]


@dataclasses.dataclass(frozen=True)
class Case:
    """An input, the command on it and what a user needs to come of it."""
    number: str  # in faults.md; or "other", "good", "own"
    what: str
    run: Run
    expect: Expect


def lists(*extra: str, frames: int = FRAMES, **changes: Any) -> Run:
    """S on the clip with changed lists."""
    def run(lab: Lab) -> Outcome:
        outcome = lab.slam(lab.copy(**changes), *extra, frames=frames)
        outcome.twin = lab.untouched(frames)
        return outcome
    return run


def stamps(stamp: Callable[[Decimal, int], str], *extra: str, **changes: Any) -> Run:
    return lists(*extra, stamp=stamp, **changes)


def named_truth(change: Callable[[str], Text]) -> Run:
    """S with --groundtruth."""
    return lambda lab: lab.slam(lab.copy(), "--groundtruth", lab.write("GT.txt", change(lab.clip.truth)))


def found_truth(change: Callable[[str], Text]) -> Run:
    """S where the data set has a ground truth of its own."""
    return lambda lab: lab.slam(lab.copy(truth=change(lab.clip.truth)))


def boxes(line: Optional[Callable[[Box], str]] = None, *extra: str, text: Callable[[str], Text] = str,
          **changes: Any) -> Run:
    """S with boxes from a file: each box as another line, and that text changed."""
    def run(lab: Lab) -> Outcome:
        content = "".join((line or Box.line)(box) + "\n" for box in lab.boxes)
        outcome = lab.slam(lab.copy(**changes), *lab.box_options(text(content)), *extra)
        outcome.twin = lab.untouched(FRAMES, True)
        return outcome
    return run


def camera(text: Text, name: str = "settings.yaml", dataset: Callable[[Lab], pathlib.Path] = Lab.copy) -> Run:
    """S --camera FILE."""
    def run(lab: Lab) -> Outcome:
        outcome = lab.slam(dataset(lab), camera=lab.write(name, text))
        outcome.twin = lab.untouched()
        return outcome
    return run


def images(kind: str, change: Callable[[Any, int], Any], suffix: str = ".png") -> Run:
    def run(lab: Lab) -> Outcome:
        outcome = lab.slam(lab.with_images(kind, change, suffix))
        outcome.twin = lab.untouched()
        return outcome
    return run


def trajectory(estimate: Callable[[str], Text] = str, truth: Callable[[str], Text] = str) -> Run:
    """E on changed files."""
    def run(lab: Lab) -> Outcome:
        outcome = lab.evaluate(truth(lab.clip.truth), estimate(lab.estimate))
        outcome.twin = lab.untouched_error
        return outcome
    return run


def long_trajectory(estimate: Callable[[str], str]) -> Run:
    """E on a ground truth of 30 s and a changed copy of it."""
    def run(lab: Lab) -> Outcome:
        truth = lab.need(lab.shared / "eval" / "groundtruth" / "fr3_walk_halfsphere.txt").read_text()
        return lab.evaluate(truth, estimate(truth))
    return run


def options(*words: str) -> Run:
    return lambda lab: lab.slam(lab.copy(), *words)


def masks(make: Callable[[], Any], first: Optional[Callable[[], Any]] = None) -> Run:
    """S with the same label image for every frame. @param first another one for the first."""
    def run(lab: Lab) -> Outcome:
        for i, (stamp, _) in enumerate(lab.clip.rgb[:FRAMES + 2]):
            save(lab.folder / "masks" / f"{stamp}.png", (first if first and i == 0 else make)())
        return lab.slam(lab.copy(), "--detector", "masks", "--masks", lab.folder / "masks")
    return run
