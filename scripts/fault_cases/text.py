# SPDX-License-Identifier: BSD-3-Clause
"""Cases of tables as other programs and systems write them."""
from __future__ import annotations

import dataclasses
from typing import Callable

from fault_cases.case import Case, Run, lists, long_trajectory, stamps, trajectory
from fault_cases.change import (bom, columns, comma_decimals, comma_decimals_of_stamps, lines, plus_signs, utf16,
                                with_line)
from fault_cases.data import body, write
from fault_cases.lab import Lab
from fault_cases.outcome import ANY, FAILS, READ, SAME, Expect, Outcome, read_and_said, read_or, refused, same_error


def associations(make: Callable[[list[str]], str]) -> Run:
    """S with an associations.txt of those lines; make gets its four fields."""
    def run(lab: Lab) -> Outcome:
        folder = lab.copy()
        original = (lab.clip.folder / "associations.txt").read_text()
        write(folder / "associations.txt", lines(lambda line: make(line.split()))(original))
        outcome = lab.slam(folder)
        outcome.twin = lab.untouched()
        return outcome
    return run


def dialect_cases() -> list[Case]:
    """Tables as other programs and systems write them."""
    return [
        Case("16", "lists with a BOM", lists(text=bom), READ),
        Case("16", "estimate with a BOM", trajectory(bom), SAME),
        Case("16", "ground truth with a BOM", trajectory(truth=bom), SAME),
        Case("17", "estimate with decimal commas", trajectory(comma_decimals),
             Expect(0, ("decimal comma",), (), (same_error,))),
        Case("17", "decimal commas, commas between fields",
             trajectory(lambda t: lines(lambda l: l.replace(" ", ","))(comma_decimals(t))),
             refused("EST.txt:1", "decimal comma")),
        Case("17", "lists with decimal commas", lists(rgb=comma_decimals_of_stamps, depth=comma_decimals_of_stamps),
             read_and_said("decimal comma")),
        Case("18", "one NaN line", trajectory(with_line(7, "{t} nan nan nan nan nan nan nan")),
             Expect(0, (r"1 of \d+ lines",), (), (same_error,))),
        Case("18", "one line with a zero quaternion", trajectory(with_line(7, "{t} 1 2 3 0 0 0 0")),
             Expect(0, (r"1 of \d+ lines",), (), (same_error,))),
        Case("18", "both in the ground truth",
             trajectory(truth=lambda t: with_line(9, "{t} 1 2 3 0 0 0 0")(
                 with_line(7, "{t} nan nan nan nan nan nan nan")(t))),
             Expect(0, (r"2 of \d+ lines",), (), (same_error,))),
        Case("19", "estimate's stamps rounded to seconds",
             trajectory(columns(lambda f: [f"{float(f[0]):.0f}"] + f[1:])), Expect(ANY, ("repeat", "rounded"))),
        Case("26", "lists with +1.5", stamps(lambda t, _: f"+{t}"), READ),
        Case("26", "trajectory with +1.5", trajectory(columns(plus_signs)), SAME),
        Case("good", "CRLF", lists(text=lambda t: t.replace("\n", "\r\n")), READ),
        Case("good", "tabs", lists(text=lambda t: t.replace(" ", "\t")), READ),
        Case("good", "commas between fields", lists(text=lambda t: t.replace(" ", ",")), READ),
        Case("own", "UTF-16 (Notepad, PowerShell's >)", lists(text=utf16), READ),
        Case("own", "a comma behind each field", trajectory(columns(lambda f: [x + "," for x in f])), SAME),
        Case("own", "poses in brackets", trajectory(lines(lambda l: "[" + ", ".join(l.split()) + "]")),
             dataclasses.replace(refused("EST.txt:1", r"\[1341846434"), instead=SAME)),
        Case("own", "Fortran's exponents (1.5D+00)",
             trajectory(columns(lambda f: f[:1] + [f"{float(x):.9e}".replace("e", "D") for x in f[1:]])),
             dataclasses.replace(refused("EST.txt:1", "D[+-]0"), instead=SAME)),
        Case("own", "a comment behind each row", trajectory(lines(lambda l: l + "  # key frame")),
             dataclasses.replace(refused("EST.txt:1", "#"), instead=SAME)),
        Case("own", "a frame number before the stamp",
             trajectory(lambda t: "".join(f"{i} {l}\n" for i, l in enumerate(body(t)))),
             refused("EST.txt:1: 9 fields", "number|index")),
        Case("own", "w first, in a recording of 30 s", long_trajectory(columns(lambda f: f[:4] + [f[7]] + f[4:7])),
             Expect(0, ("w came first",))),
        Case("own", "positions in millimetres",
             long_trajectory(columns(lambda f: f[:1] + [str(1000 * float(x)) for x in f[1:4]] + f[4:])),
             Expect(0, ("millimetres",))),
        Case("own", "3x4 matrices with a stamp (13 fields)",
             trajectory(columns(lambda f: f[:1] + "1 0 0 0 0 1 0 0 0 0 1 0".split())), refused("EST.txt:1: 13 fields")),
        Case("own", "the estimate is summary.json", trajectory(lambda _: '{\n  "counts": {}\n}\n'),
             refused("EST.txt:1", "JSON")),
        Case("own", "a gzipped list", lists(rgb=lambda rows: b"\x1f\x8b\x08\x00" + bytes(range(256))),
             refused("rgb.txt", "binary|gzip|compress")),
        Case("own", "file names without the folder", lists(rgb=lambda r: [(t, n.split("/")[1]) for t, n in r],
                                                          depth=lambda r: [(t, n.split("/")[1]) for t, n in r]),
             read_or("both its files|no such file", "rgb/")),
        Case("own", "backslashes in file names", lists(text=lambda t: t.replace("/", "\\")), READ),
        Case("own", "another computer's absolute paths",
             lists(rgb=lambda r: [(t, "/home/me/data/" + n) for t, n in r]),
             read_or("/home/me/data/rgb/", "both its files|no such file")),
        Case("own", "file names only (ls > rgb.txt)",
             lists(rgb=lambda r: "".join(n + "\n" for _, n in r), depth=lambda r: "".join(n + "\n" for _, n in r)),
             read_or("rgb.txt:1", "time stamp|stamp")),
        Case("own", "associations: file before stamp", associations(lambda f: f"{f[1]} {f[0]} {f[3]} {f[2]}"),
             read_or("associations.txt:1", "time stamp", "first")),
        Case("own", "associations: depth before colour", associations(lambda f: f"{f[2]} {f[3]} {f[0]} {f[1]}"),
             Expect(FAILS, ("swapped",), instead=READ)),
        Case("own", "associations of images only: rgb depth", associations(lambda f: f"{f[1]} {f[3]}"),
             read_or("associations.txt:1: 2 fields", "4|stamp")),
        Case("own", "a Latin-1 comment", lists(text=lambda t: "# Büro\n".encode("latin-1") + t.encode()), READ),
    ]
