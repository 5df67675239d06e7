# SPDX-License-Identifier: BSD-3-Clause
"""Where cases are made and run: programs, data, and folders with a fault in them."""
from __future__ import annotations

import contextlib
import functools
import pathlib
import signal
import subprocess
import time
from decimal import Decimal
from typing import Any, Callable, Optional, Sequence, Union

import cv2

from fault_cases.data import Box, Clip, Text, save, text_of, write
from fault_cases.outcome import Outcome, Skipped

PROJECT = pathlib.Path(__file__).resolve().parent.parent.parent
FRAMES = 15  # of the clip; enough for a baseline of 0.1 s and a key frame or two
ALL = 0  # frames: where the fault is in how many pairs are found
TIMEOUT = 60.0  # s; more than any case may take, compilers included


class Lab:
    """Where cases are made and run: programs, data and a temporary folder."""

    def __init__(self, programs: pathlib.Path, shared: pathlib.Path, rendered: pathlib.Path,
                 scratch: pathlib.Path) -> None:
        self.programs, self.shared, self.rendered, self.scratch = programs, shared, rendered, scratch
        self.cases = 0
        self.folder = scratch

    def new_case(self) -> None:
        self.cases += 1
        self.folder = self.scratch / f"{self.cases:03d}"
        self.folder.mkdir()

    @functools.cached_property
    def clip(self) -> Clip:
        return Clip(self.shared / "data" / "fr3_walking_halfsphere_first50")

    def need(self, path: pathlib.Path) -> pathlib.Path:
        if not path.exists():
            raise Skipped(f"no {path}")
        return path

    def write(self, name: str, content: Text) -> pathlib.Path:
        return write(self.folder / name, content)

    # Programs

    def run(self, words: Sequence[Union[str, pathlib.Path]], short: str = "",
            interrupt_after: Optional[float] = None, cwd: Optional[pathlib.Path] = None,
            timeout: float = TIMEOUT) -> Outcome:
        """@param interrupt_after time (s) until Ctrl-C; the outcome's time then counts from it."""
        began = time.monotonic()
        process = subprocess.Popen([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   stdin=subprocess.DEVNULL, cwd=cwd)
        try:
            if interrupt_after is not None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(interrupt_after)
                began = time.monotonic()
                process.send_signal(signal.SIGINT)
            text = process.communicate(timeout=timeout)[0]
            code = process.returncode
        except subprocess.TimeoutExpired:
            process.kill()
            text, code = process.communicate()[0], 124
        return Outcome(short or self.shortened(words), code, text.decode(errors="replace"),
                       time.monotonic() - began)

    def shortened(self, words: Sequence[Union[str, pathlib.Path]]) -> str:
        return " ".join(pathlib.Path(w).name if "/" in str(w) else str(w) for w in words)

    def program(self, name: str) -> pathlib.Path:
        return self.need(self.programs / name)

    def slam(self, dataset: pathlib.Path, *extra: Union[str, pathlib.Path], camera: Union[str, pathlib.Path] = "tum3",
             frames: int = FRAMES, interrupt_after: Optional[float] = None) -> Outcome:
        output = self.folder / "out"
        words = [self.program("hmcdyn_slam"), "--camera", camera, "--max-frames", str(frames), "--dataset", dataset,
                 "--output", output, "--quiet", "--no-report", "--no-dense-map", *extra]
        outcome = self.run(words, self.slam_short(camera, frames, extra), interrupt_after)
        outcome.output = output
        return outcome

    def slam_short(self, camera: Union[str, pathlib.Path], frames: int,
                   extra: Sequence[Union[str, pathlib.Path]]) -> str:
        words = ["S"] + (["--camera", camera] if camera != "tum3" else [])
        words += ["--max-frames", frames or "0"] if frames != FRAMES else []
        return self.shortened([*map(str, words), *map(str, extra)])

    def evaluate(self, truth: Text, estimate: Text) -> Outcome:
        return self.run([self.program("hmcdyn_evaluate"), "ate", "-g", self.write("GT.txt", truth), "-e",
                         self.write("EST.txt", estimate)], "E")

    # The same without a fault, once a kind of command

    @functools.lru_cache(maxsize=None)
    def untouched(self, frames: int = FRAMES, with_boxes: bool = False) -> Outcome:
        return self.aside(f"untouched_{frames}_{with_boxes}", lambda: self.slam(
            self.copy(), *(self.box_options("".join(b.line() + "\n" for b in self.boxes)) if with_boxes else ()),
            frames=frames))

    @functools.cached_property
    def untouched_error(self) -> Outcome:
        return self.aside("untouched_ate", lambda: self.evaluate(self.clip.truth, self.estimate))

    @functools.cached_property
    def estimate(self) -> str:
        """The trajectory of the whole clip."""
        output = self.untouched(ALL).output
        assert output
        return self.need(output / "trajectory.txt").read_text()

    @functools.cached_property
    def boxes(self) -> list[Box]:
        """What YOLO-fastest finds in the clip."""
        outcome = self.aside("boxes", lambda: self.slam(self.copy(), *self.darknet(), "--write-boxes", frames=ALL))
        assert outcome.output
        lines = [row.split() for row in (outcome.output / "boxes.txt").read_text().splitlines() if row[0] != "#"]
        return [Box(row[0], row[1], *map(float, row[2:])) for row in lines]

    def aside(self, name: str, command: Callable[[], Outcome]) -> Outcome:
        """Runs what several cases need in a folder of its own."""
        folder, self.folder = self.folder, self.scratch / name
        try:
            self.folder.mkdir(exist_ok=True)
            outcome = command()
        finally:
            self.folder = folder
        if outcome.code != 0:
            raise Skipped(f"the clip itself failed: {outcome.text.strip()[-200:]}")
        return outcome

    def darknet(self) -> list[Union[str, pathlib.Path]]:
        model = self.need(self.shared / "models" / "yolo-fastest-1.1")
        return ["--detector", "darknet", "--model", model / "yolo-fastest-1.1.cfg", "--weights",
                model / "yolo-fastest-1.1.weights"]

    def box_options(self, text: Text) -> list[Union[str, pathlib.Path]]:
        return ["--detector", "file", "--boxes", self.write("boxes.txt", text)]

    # A copy of the clip

    def copy(self, *, rgb: Optional[Callable] = None, depth: Optional[Callable] = None,
             stamp: Optional[Callable[[Decimal, int], str]] = None, text: Optional[Callable[[str], Text]] = None,
             truth: Optional[Text] = None, name: str = "clip") -> pathlib.Path:
        """The clip with changed lists.
        @param rgb, depth what becomes of the rows of either list
        @param stamp what becomes of each time stamp in both
        @param text what becomes of either list's text
        """
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        for kind, change in (("rgb", rgb), ("depth", depth)):
            if not (folder / kind).exists():
                (folder / kind).symlink_to(self.clip.folder / kind)
            rows = getattr(self.clip, kind)
            rows = [(stamp(Decimal(t), i), *rest) for i, (t, *rest) in enumerate(rows)] if stamp else rows
            rows = change(rows) if change else rows
            content = rows if isinstance(rows, (str, bytes)) else text_of(rows)
            write(folder / f"{kind}.txt", text(content) if text else content)
        write(folder / "groundtruth.txt", self.clip.truth if truth is None else truth)
        return folder

    def with_images(self, kind: str, change: Callable[[Any, int], Any], suffix: str = ".png") -> pathlib.Path:
        """The clip's first frames with each image of a kind changed: to another image, or to bytes of a file."""
        folder = self.copy(rgb=lambda rows: rows[:FRAMES + 2], depth=lambda rows: rows[:FRAMES + 2])
        (folder / kind).unlink()
        rows = getattr(self.clip, kind)[:FRAMES + 2]
        for i, (_, name) in enumerate(rows):
            image = change(cv2.imread(str(self.clip.folder / name), cv2.IMREAD_UNCHANGED), i)
            save(folder / (name[:-4] + suffix), image)
        write(folder / f"{kind}.txt", text_of([(t, name[:-4] + suffix) for t, name in rows]))
        return folder
