#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes every input that people are known to have and that was once handled wrongly, and shows what comes of it.

Runs the programs as a user does, on the real clip with its lists, calibration, boxes, images or ground truth
changed, and prints a Markdown table: case, input, command, message, exit code, time, and whether that is what a
user needs. Exits with 1 where one is not.

  fault_table.py --bin build/release/bin --shared ../shared --output fault_table.md
  fault_table.py --only calibration     # one kind, or cases whose number or text has this in it

Numbers are those of faults.md in the shared folder; "other" and "good" are its last paragraphs, "own" are ours.
In commands, S is `hmcdyn_slam --camera tum3 --max-frames 15` with that input as --dataset, E is
`hmcdyn_evaluate ate -g GT -e EST`. (S has --quiet, --no-report and --no-dense-map as well, to save time; they
change no message.) Needs python3-numpy and python3-opencv for cases with images.
"""
from __future__ import annotations

import argparse
import dataclasses
import pathlib
import re
import shutil
import sys
import tempfile
from typing import Sequence

try:
    from fault_cases import KINDS
except ImportError as error:
    sys.exit(f"fault_table.py: {error}; on Debian: apt-get install python3-opencv, and /usr/bin/python3 to run it")
from fault_cases.case import Case
from fault_cases.lab import PROJECT, Lab
from fault_cases.outcome import Outcome, Skipped

WORTH_TELLING = 5.0  # s; shorter times are not in the table
MESSAGE_WIDTH = 160  # characters


@dataclasses.dataclass
class Row:
    """A line of the table."""
    case: Case
    verdict: str  # "ok", "NOT" or "skipped"
    outcome: Outcome
    complaint: str = ""


def run_case(lab: Lab, case: Case) -> Row:
    lab.new_case()
    try:
        outcome = case.run(lab)
    except Skipped as reason:
        return Row(case, "skipped", Outcome("", 0, f"skipped: {reason}", 0.0))
    complaint = case.expect.complaint(outcome)
    return Row(case, "NOT" if complaint else "ok", outcome, complaint)


def plain(text: str, folder: pathlib.Path) -> str:
    """Without what differs from run to run: colours, the time of a log line, the temporary folder."""
    text = re.sub(r"\x1b\[[0-9;]*m", "", text)
    return re.sub(rf"{re.escape(str(folder))}/(\d+/)?", "", text)


def decisive(row: Row, folder: pathlib.Path) -> str:
    """The lines that say what was asked for, else those that complain, else the last."""
    told = [line.strip() for line in plain(row.outcome.text, folder).splitlines()
            if line.strip() and not line.startswith("results in")]
    patterns = row.case.expect.patterns()
    asked = [line for line in told if any(re.search(p, line, re.I) for p in patterns)]
    complaints = [line for line in told if re.match(r"error|warning|hmcdyn_|\S+: (fatal )?error", line, re.I)]
    chosen = [line for line in complaints if line in asked] or complaints or asked or told[-1:]
    if row.outcome.code == 0 and told and told[-1] not in chosen:
        chosen = chosen[:1] + told[-1:]
    return " ⏎ ".join(shortened(line, patterns) for line in chosen[:2])


def shortened(line: str, patterns: Sequence[str]) -> str:
    """Some 160 characters of a line, around what was asked for where that is far behind."""
    if len(line) <= MESSAGE_WIDTH:
        return line
    found = [m.end() for m in (re.search(p, line, re.I) for p in patterns) if m]
    begin = max(0, min(max(found, default=0) - MESSAGE_WIDTH + 20, len(line) - MESSAGE_WIDTH))
    end = begin + MESSAGE_WIDTH
    return ("…" if begin else "") + line[begin:end] + ("…" if end < len(line) else "")


def cell(text: str) -> str:
    return text.replace("|", "\\|")


def table_line(row: Row, folder: pathlib.Path) -> str:
    seconds = f"{row.outcome.seconds:.1f}" if row.outcome.seconds > WORTH_TELLING else ""
    message = decisive(row, folder) + (f" **({row.complaint})**" if row.complaint else "")
    code = "" if row.verdict == "skipped" else str(row.outcome.code)
    command = f"`{cell(plain(row.outcome.command, folder))}`" if row.outcome.command else ""
    cells = (row.case.number, cell(row.case.what), command, cell(message), code, seconds, row.verdict)
    return f"| {' | '.join(cells)} |"


def table(rows: "dict[str, list[Row]]", folder: pathlib.Path) -> str:
    parts = ["S = `hmcdyn_slam --camera tum3 --max-frames 15 --dataset D --output OUT`, E = `hmcdyn_evaluate ate -g GT "
             "-e EST`; D, GT and EST have the fault. Numbers are of faults.md.\n"]
    for kind, of_kind in rows.items():
        parts.append(f"\n## {kind.capitalize()}\n\n| case | input | command | message | exit | s | |\n"
                     "|---|---|---|---|---|---|---|\n")
        parts += [table_line(row, folder) + "\n" for row in of_kind]
    verdicts = [row.verdict for of_kind in rows.values() for row in of_kind]
    parts.append(f"\n{len(verdicts)} cases: " + ", ".join(f"{verdicts.count(v)} {v}" for v in ("ok", "NOT", "skipped"))
                 + "\n")
    return "".join(parts)


def chosen_cases(only: str) -> "dict[str, list[Case]]":
    """@param only in a kind's name, or in a case's "number input"."""
    found = {kind: [c for c in make() if only.lower() in kind or only.lower() in f"{c.number} {c.what}".lower()]
             for kind, make in KINDS.items()}
    return {kind: cases for kind, cases in found.items() if cases}


def run_all(lab: Lab, kinds: "dict[str, list[Case]]") -> "dict[str, list[Row]]":
    total, done = sum(map(len, kinds.values())), 0
    rows: dict[str, list[Row]] = {}
    for kind, cases in kinds.items():
        for case in cases:
            done += 1
            row = run_case(lab, case)
            rows.setdefault(kind, []).append(row)
            print(f"[{done}/{total}] {row.verdict:7} {case.number:5} {case.what}", file=sys.stderr)
    return rows


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=PROJECT / "build" / "release" / "bin",
                        help="folder of the programs (%(default)s)")
    parser.add_argument("--shared", type=pathlib.Path, default=PROJECT.parent / "shared",
                        help="folder with data/, eval/ and models/ (%(default)s)")
    parser.add_argument("--rendered", type=pathlib.Path, default=PROJECT.parent / "rendered",
                        help="where the rendered sequence is, or is made (%(default)s)")
    parser.add_argument("--only", default="", metavar="SUBSTRING", help="of a kind, a number or an input")
    parser.add_argument("--keep", action="store_true", help="keep the temporary folder, and name it")
    parser.add_argument("--output", type=pathlib.Path, metavar="FILE.md", help="default: standard output")
    return parser.parse_args()


def main() -> int:
    options_ = arguments()
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="fault_table_"))
    try:
        lab = Lab(options_.bin.resolve(), options_.shared.resolve(), options_.rendered.resolve(), scratch)
        rows = run_all(lab, chosen_cases(options_.only))
        text = table(rows, scratch)
    finally:
        if options_.keep:
            print(f"kept {scratch}", file=sys.stderr)
        else:
            shutil.rmtree(scratch, ignore_errors=True)
    if options_.output:
        options_.output.write_text(text)
    else:
        print(text, end="")
    return 1 if any(row.verdict == "NOT" for of_kind in rows.values() for row in of_kind) else 0


if __name__ == "__main__":
    sys.exit(main())
