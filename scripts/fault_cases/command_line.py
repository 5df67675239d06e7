# SPDX-License-Identifier: BSD-3-Clause
"""Cases of options."""
from __future__ import annotations

import functools

from fault_cases.case import Case, options
from fault_cases.outcome import refused


def option_cases() -> list[Case]:
    """Options that cannot be are refused by name."""
    usage = functools.partial(refused, code=2)
    return [
        *(Case("25", f"--max-depth {value}", options(f"--max-depth={value}"), usage("--max-depth", value))
          for value in ("nan", "0", "-1")),
        Case("25", "--baselines nan", options("--baselines", "nan"), usage("--baselines", "nan")),
        Case("own", "--baselines 0,inf", options("--baselines", "0,inf"), usage("--baselines", "inf")),
        Case("own", "--score-threshold 25 (per cent)", options("--score-threshold", "25"), usage("--score-threshold")),
    ]
