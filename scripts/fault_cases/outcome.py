# SPDX-License-Identifier: BSD-3-Clause
"""What came of a command, and what a user needs."""
from __future__ import annotations

import dataclasses
import json
import math
import pathlib
import re
from typing import Any, Callable, Iterator, Optional


class Skipped(Exception):
    """Something that the case needs is not here."""


@dataclasses.dataclass
class Outcome:
    """A command that was run."""
    command: str  # as it stands in the table
    code: int
    text: str
    seconds: float
    output: Optional[pathlib.Path] = None  # where hmcdyn_slam wrote
    twin: Optional["Outcome"] = None  # the same command with nothing wrong in its input

    def summary(self) -> dict[str, Any]:
        path = self.output / "summary.json" if self.output else None
        return json.loads(path.read_text()) if path and path.is_file() else {}

    def count(self, *keys: str) -> int:
        value: Any = self.summary().get("counts", {})
        for key in keys:
            value = value.get(key, {}) if isinstance(value, dict) else {}
        return value if isinstance(value, int) else -1


Check = Callable[[Outcome], str]  # what is wrong, "" where nothing is
FAILS = -1  # an exit code that is any but 0
ANY = -2


@dataclasses.dataclass(frozen=True)
class Expect:
    """The exit code, what has to be said, what must not be, and what has to come out."""
    code: int = 0
    said: tuple[str, ...] = ()
    unsaid: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()
    instead: Optional["Expect"] = None  # as good

    def complaint(self, outcome: Outcome) -> str:
        own = "; ".join(self._complaints(outcome))
        return "" if self.instead and own and not self.instead.complaint(outcome) else own

    def _complaints(self, outcome: Outcome) -> Iterator[str]:
        good = {FAILS: outcome.code not in (0, 124) and outcome.code > 0, ANY: outcome.code >= 0}
        if not good.get(self.code, outcome.code == self.code):
            yield f"exit {outcome.code}"
        yield from (f"does not say /{p}/" for p in self.said if not re.search(p, outcome.text, re.I))
        yield from (f"says /{p}/" for p in self.unsaid if re.search(p, outcome.text, re.I))
        yield from filter(None, (check(outcome) for check in self.checks))

    def patterns(self) -> tuple[str, ...]:
        return self.said + (self.instead.patterns() if self.instead else ())


def refused(*said: str, code: int = FAILS) -> Expect:
    """Ends before the first frame with these words."""
    return Expect(code, said, checks=(nothing_written,))


def nothing_written(outcome: Outcome) -> str:
    return "results were written" if outcome.output and (outcome.output / "trajectory.txt").exists() else ""


def as_untouched(outcome: Outcome) -> str:
    """As many frames are tracked as without the fault, and as much is seen to move, within a tenth."""
    if outcome.twin is None:
        return ""
    for keys, share in ((("frames_tracked",), 0.0), (("labels", "dynamic"), 0.1)):
        now, before = outcome.count(*keys), outcome.twin.count(*keys)
        if abs(now - before) > share * before:
            return f"{' '.join(keys)}: {now}, without the fault {before}"
    return ""


def has_ate(outcome: Outcome) -> str:
    return "" if "ate_m" in outcome.summary().get("evaluation", {}) else "no ATE in summary.json"


def warned_in_summary(outcome: Outcome) -> str:
    return "" if outcome.summary().get("warnings") else "no warning in summary.json"


def same_error(outcome: Outcome) -> str:
    """The evaluator's RMSE is that of the untouched files, to 1 %."""
    now, before = rmse_of(outcome), rmse_of(outcome.twin) if outcome.twin else math.nan
    return "" if abs(now - before) <= 0.01 * before else f"RMSE {now}, without the fault {before}"


def rmse_of(outcome: Outcome) -> float:
    numbers = re.findall(r"\.txt\s+(\d+\.\d+)", outcome.text)
    return float(numbers[-1]) if numbers else math.nan


def said_once(pattern: str, at_most: int = 2) -> Check:
    """A fault of every frame is not said once a frame."""
    def check(outcome: Outcome) -> str:
        lines = sum(bool(re.search(pattern, line, re.I)) for line in outcome.text.splitlines())
        return "" if 1 <= lines <= at_most else f"{lines} lines say /{pattern}/"
    return check


def within(seconds: float) -> Check:
    def check(outcome: Outcome) -> str:
        return "" if outcome.seconds < seconds else f"{outcome.seconds:.1f} s; at most {seconds:g} s"
    return check


def counted(*keys: str) -> Check:
    def check(outcome: Outcome) -> str:
        return "" if outcome.count(*keys) > 0 else f"counts.{'.'.join(keys)} is {outcome.count(*keys)}"
    return check


def results_are_there(outcome: Outcome) -> str:
    assert outcome.output
    missing = [n for n in ("trajectory.txt", "summary.json") if not (outcome.output / n).is_file()]
    return f"no {', '.join(missing)}" if missing else ""


READ = Expect(checks=(as_untouched,))
SAME = Expect(checks=(same_error,))


def read_and_said(*said: str) -> Expect:
    return Expect(0, said, checks=(as_untouched,))


def read_or(*said: str) -> Expect:
    """Read right, or refused with these words: the user has what is needed either way."""
    return dataclasses.replace(refused(*said), instead=READ)
