# SPDX-License-Identifier: BSD-3-Clause
"""Cases of time stamps, and of images without a partner."""
from __future__ import annotations

import struct
from decimal import Decimal
from typing import Any, Callable, Optional

from fault_cases.case import Case, Run, lists, stamps
from fault_cases.change import unit
from fault_cases.data import Rows, Text, text_of
from fault_cases.lab import ALL, Lab
from fault_cases.outcome import (ANY, FAILS, READ, Expect, Outcome, read_and_said, read_or, refused, results_are_there,
                                 within)


def since(start: str, pattern: str = "{:.6f}", factor: int = 1) -> Callable[[Decimal, int], str]:
    return lambda t, _: pattern.format((t - Decimal(start)) * factor)


def each(n: int) -> Callable[[Any], Any]:
    return lambda rows: rows[::n]


def with_header(text: str) -> Callable[[Any], Text]:
    return lambda rows: text + text_of(rows)


def thrice(rows: Rows) -> Rows:
    return [row for row in rows for _ in range(3)]


def shared_stamps(rows: Rows) -> Rows:
    """Three frames have the stamp of the first of them."""
    return [(rows[i // 3 * 3][0], name) for i, (_, name) in enumerate(rows)]


def duration(_t: Decimal, i: int) -> str:
    """How long a frame lasted; no two neighbours alike."""
    return f"0.03{33 + 2 * (i * 5 % 8)}"


def with_gap(t: Decimal, i: int) -> str:
    return str(t + (3600 if i >= 8 else 0))


def unpadded(t: Decimal, _i: int) -> str:
    seconds = int(t)
    return f"{seconds}.{int((t - seconds) * 10 ** 9)}"


def float32(t: Decimal, _i: int) -> str:
    return f"{struct.unpack('f', struct.pack('f', float(t)))[0]:.6f}"


def long_wait(interrupt_after: Optional[float]) -> Run:
    """In real time, an hour's gap after eight frames, and perhaps Ctrl-C in it."""
    def run(lab: Lab) -> Outcome:
        outcome = lab.slam(lab.copy(stamp=with_gap), "--mode", "realtime", interrupt_after=interrupt_after)
        end = f"{outcome.seconds:.2f} s"
        outcome.command += f"; Ctrl-C after {interrupt_after} s, end {end} later" if interrupt_after else f"; {end}"
        return outcome
    return run


def swapped_lists(lab: Lab) -> Outcome:
    return lab.slam(lab.copy(rgb=lambda _: lab.clip.depth, depth=lambda _: lab.clip.rgb))


def two_clocks(lab: Lab) -> Outcome:
    """Depth in seconds since boot, as some drivers stamp it."""
    def booted(rows: Any) -> Any:
        return [(str(Decimal(t) - Decimal("1341845000.25")), n) for t, n in rows]
    return lab.slam(lab.copy(depth=booted))


def mixed_units(lab: Lab) -> Outcome:
    """Colour in seconds, depth in microseconds of the same clock."""
    outcome = lab.slam(lab.copy(depth=lambda rows: [(unit(6)(Decimal(t), 0), n) for t, n in rows]))
    outcome.twin = lab.untouched()
    return outcome


def time_cases() -> list[Case]:
    """What clock stamps are of is found out and said, or asked."""
    asks = "--time-unit"
    return [
        Case("5", "integer nanoseconds", stamps(unit(9), frames=ALL), read_and_said("nanoseconds")),
        Case("5", "integer milliseconds", stamps(unit(3), frames=ALL), read_and_said("milliseconds")),
        Case("6", "real time, a gap of an hour", long_wait(None),
             Expect(0, ("gap of 36", "tracked 15 of 15"), checks=(within(15.0), results_are_there))),
        Case("6", "Ctrl-C in the gap", long_wait(2.0),
             Expect(0, ("tracked",), checks=(within(2.0), results_are_there))),
        Case("32", "three frames to a time stamp", lists(rgb=shared_stamps, depth=shared_stamps),
             refused("other files than", "different stamps")),
        Case("32", "stamps that are durations", stamps(duration), refused("how long each frame lasted")),
        Case("32", "stamps that are all 0.0333", stamps(lambda *_: "0.0333"), refused("how long each frame lasted")),
        Case("19", "lists with stamps rounded to seconds", stamps(lambda t, _: f"{t:.0f}"),
             refused("rounded to seconds")),
        Case("other", "19 digits, tabs, CRLF, no final newline",
             stamps(unit(9), text=lambda t: t[:-1].replace(" ", "\t").replace("\n", "\r\n")), read_and_said("nanosec")),
        Case("other", "nanoseconds that went through a double",
             stamps(lambda t, _: f"{float(t * 10 ** 9):.0f}"), read_and_said("nanoseconds")),
        Case("other", "colour in Unix time, depth since boot", two_clocks, refused("two clocks", "differ by")),
        Case("other", "each line three times", lists(rgb=thrice, depth=thrice), READ),
        Case("other", "frame numbers, header of the other sensor",
             stamps(lambda _, i: str(i), rgb=with_header("# depth images\n"), depth=with_header("# rgb images\n")),
             refused("frame numbers", asks)),
        Case("other", "the same with --time-unit frame", stamps(lambda _, i: str(i), "--time-unit", "frame"),
             Expect(0, ("tracked 15 of 15",))),
        Case("other", "4 decimals and a trailing tab",
             stamps(lambda t, _: f"{t:.4f}", text=lambda t: t.replace("\n", "\t\n")), READ),
        Case("other", "steps of 1 ms", stamps(lambda t, i: f"{1341846434 + i / 1000:.3f}"),
             Expect(0, ("1000 frames a second",))),
        Case("good", "stamps from 0 on", stamps(since("1341846434.710184")), Expect(0, ("tracked 15 of 15",))),
        Case("good", "lists not sorted", lists(rgb=lambda rows: rows[::-1], depth=lambda rows: rows[5:] + rows[:5]),
             read_and_said("go back")),
        Case("own", "ms since the start, 3 decimals", stamps(since("1341846434.710184", "{:.3f}", 1000)),
             Expect(0, ("milliseconds", "tracked 15 of 15"))),
        Case("own", "colour in seconds, depth in microseconds", mixed_units, read_or("unit", "depth.txt")),
        Case("own", "numpy.savetxt with %.6e", stamps(lambda t, _: f"{float(t):.6e}"),
             refused("other files than", "rounded|precision|digits|32 bits")),
        Case("own", "stamps that went through a float of 32 bits", stamps(float32),
             refused("rounded|precision|32 bits")),
        Case("own", "seconds and nanoseconds in two columns",
             stamps(lambda t, _: f"{int(t)} {int((t % 1) * 10 ** 9)}"), refused("rgb.txt:1", "fields|file")),
        Case("own", "sec.nsec without leading zeros", stamps(unpadded), read_or("leading zeros")),
        Case("own", "the first stamp is 0 (camera not set yet)", stamps(lambda t, i: "0.000000" if i == 0 else str(t)),
             Expect(0, ("gap of|first",))),
        Case("own", "days as Excel counts them", stamps(lambda t, _: f"{t / 86400 + 25569:.10f}"),
             refused(f"{asks}|days")),
        Case("own", "hh:mm:ss.ffffff", stamps(lambda t, _: f"15:07:{14 + (t - Decimal('1341846434')):09.6f}"),
             refused("rgb.txt:1", "time of day|clock time|date")),
        Case("own", "stamps below 0 (from a trigger on)", stamps(since("1341846435.2")),
             Expect(0, ("tracked 15 of 15",))),
        Case("own", "frame numbers with .0", stamps(lambda _, i: f"{i}.0"), refused("frame numbers", asks)),
        Case("own", "1 Hz of real seconds, 5 lines (few to tell by)",
             stamps(lambda _, i: str(i), rgb=lambda r: r[:5], depth=lambda r: r[:5]), refused("frame numbers", asks)),
    ]


def pair_cases() -> list[Case]:
    """Images without a partner are counted and named."""
    return [
        Case("7", "depth at a third of the colour's rate", lists(depth=each(3), frames=ALL),
             Expect(ANY, ("32 of the 49 colour images",))),
        Case("own", "depth 25 ms later than colour (no partner in 20 ms)",
             lists(depth=lambda rows: [(str(Decimal(t) + Decimal("0.016")), n) for t, n in rows]), READ),
        Case("own", "depth an hour ahead (summer time)",
             lists(depth=lambda rows: [(str(Decimal(t) + 3600), n) for t, n in rows]), refused("3600", "two clocks")),
        Case("good", "swapped lists", swapped_lists, Expect(FAILS, ("swapped",))),
    ]
