# SPDX-License-Identifier: BSD-3-Clause
"""What becomes of the text of a list or a trajectory."""
from __future__ import annotations

import decimal
import re
from decimal import Decimal
from typing import Callable, Sequence

from fault_cases.data import Rows, body


def unit(power: int) -> Callable[[Decimal, int], str]:
    """Whole numbers of 10^-power s."""
    return lambda t, _: str(int((t * 10 ** power).to_integral_value(decimal.ROUND_HALF_EVEN)))


def utf16(text: str) -> bytes:
    return b"\xff\xfe" + text.encode("utf-16-le")


BOM = "\ufeff"


def bom(text: str) -> str:
    return BOM + text


def comma_decimals(text: str) -> str:
    return re.sub(r"(\d)\.(\d)", r"\1,\2", text)


def comma_decimals_of_stamps(rows: Rows) -> Rows:
    return [(t.replace(".", ","), name) for t, name in rows]


def lines(change: Callable[[str], str]) -> Callable[[str], str]:
    """Every line that is no comment changed."""
    return lambda text: "".join(change(line) + "\n" for line in body(text))


def columns(change: Callable[[list[str]], Sequence[str]]) -> Callable[[str], str]:
    return lines(lambda line: " ".join(change(line.split())))


def plus_signs(fields: list[str]) -> list[str]:
    return [f if f.startswith("-") or not re.fullmatch(r"\d+\.\d+", f) else "+" + f for f in fields]


def kitti(text: str) -> str:
    return "1 0 0 0 0 1 0 0 0 0 1 0\n" * len(body(text))


def with_line(at: int, line: str) -> Callable[[str], str]:
    """@param line which goes in after so many; {t} is the stamp of the one before."""
    def change(text: str) -> str:
        rows = body(text)
        return "\n".join(rows[:at] + [line.format(t=rows[at - 1].split()[0] + "1")] + rows[at:]) + "\n"
    return change
