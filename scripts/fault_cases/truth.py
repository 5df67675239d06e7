# SPDX-License-Identifier: BSD-3-Clause
"""Cases of ground truth."""
from __future__ import annotations

import dataclasses
from decimal import Decimal

from fault_cases.case import Case, found_truth, named_truth, options
from fault_cases.change import BOM, bom, columns, kitti, lines, unit, with_line
from fault_cases.lab import Lab
from fault_cases.outcome import Expect, Outcome, has_ate, refused, warned_in_summary


def other_time_zone(lab: Lab) -> Outcome:
    return lab.slam(lab.copy(truth=columns(lambda f: [str(Decimal(f[0]) + 7200)] + f[1:])(lab.clip.truth)))


def evaluation_cases() -> list[Case]:
    """A ground truth that cannot be used is never left out in silence."""
    header = "timestamp tx ty tz qx qy qz qw\n"
    ate = Expect(said=("ATE",), checks=(has_ate,))
    counted_out = dataclasses.replace(ate, said=("ATE", r"1 of \d+ lines"))
    return [
        Case("3", "ground truth that is not there", options("--groundtruth", "nosuch.txt"),
             refused("nosuch.txt.*no such file")),
        Case("3", "ground truth with a header line", named_truth(lambda t: header + "".join(t.splitlines(True)[3:])),
             ate),
        Case("3", "ground truth with a BOM", named_truth(bom), ate),
        Case("3", "ground truth with a NaN line", named_truth(with_line(9, "{t} nan nan nan nan nan nan nan")),
             counted_out),
        Case("3", "ground truth in KITTI rows", named_truth(kitti), refused("GT.txt:1: 12 fields", "KITTI")),
        Case("3", "the data set's own in KITTI rows", found_truth(kitti),
             Expect(0, ("no ATE", "groundtruth.txt:1", "KITTI"), checks=(warned_in_summary,))),
        Case("3", "the data set's own with header and BOM", found_truth(lambda t: BOM + header + lines(str)(t)), ate),
        Case("3", "the data set's own is empty", found_truth(lambda _: ""),
             Expect(0, ("no ATE", "no pose"), checks=(warned_in_summary,))),
        Case("own", "ground truth in local time, two hours ahead", other_time_zone,
             Expect(0, ("no ATE", "frames' time"), checks=(warned_in_summary,))),
        Case("own", "ground truth is an EuRoC CSV in nanoseconds",
             named_truth(lines(lambda l: ",".join([unit(9)(Decimal(l.split()[0]), 0), *l.split()[1:4], "1", "0", "0",
                                                   "0"] + ["0.0"] * 9))),
             refused("17 fields", "EuRoC")),
    ]
