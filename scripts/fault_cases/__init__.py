# SPDX-License-Identifier: BSD-3-Clause
"""The cases of fault_table.py, a module a kind of fault."""
from __future__ import annotations

from typing import Callable

from fault_cases.boxes import box_cases
from fault_cases.calibration import plausibility_cases, settings_cases
from fault_cases.case import Case
from fault_cases.command_line import option_cases
from fault_cases.cost import cost_cases
from fault_cases.images import image_cases
from fault_cases.networks import head_cases
from fault_cases.programs import dependency_cases
from fault_cases.text import dialect_cases
from fault_cases.time import pair_cases, time_cases
from fault_cases.truth import evaluation_cases

KINDS: dict[str, Callable[[], list[Case]]] = {
    "ground truth": evaluation_cases, "boxes": box_cases, "time": time_cases, "pairs": pair_cases,
    "plausible calibration": plausibility_cases, "settings and calibration": settings_cases,
    "text dialect": dialect_cases, "images": image_cases, "networks": head_cases, "options": option_cases,
    "compilers and dependencies": dependency_cases, "cost": cost_cases,
}
