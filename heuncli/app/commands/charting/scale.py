"""The logarithmic scales of a chart, and what its points are: seconds to the right, errors of the motion upwards.

An error of `LOST` of the scene's size or more tells no more than that all is lost: it stands at the border.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from heuncli.analyses.charting.results import COMPLETED, ChartedRun, ChartResults
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import LOST

PAD = 0.08  # of a decade beside the fastest and the slowest run
MINOR = ((2.5, (2, 5)), (1.0, (2, 3, 5, 7)))  # named between decades where there are no more than so many of these


class Scale(NamedTuple):
    """Decades from `low` to `high`, as logarithms."""

    low: float
    high: float

    def at(self, value: float) -> float:
        """Where a value stands, 0 to 1; what is beyond stands at the border."""
        if not value > 0.0:
            return 0.0
        log = math.log10(value) if math.isfinite(value) else self.high
        return min(max((log - self.low) / (self.high - self.low), 0.0), 1.0)

    @property
    def decades(self) -> list[float]:
        """The powers of ten within."""
        return [float(f"1e{k}") for k in range(math.ceil(self.low), math.floor(self.high) + 1)]

    @property
    def between(self) -> list[float]:
        """Multiples of these, where they are few."""
        among = [multiples for decades, multiples in MINOR if self.high - self.low <= decades]
        if not among:
            return []
        powers = range(math.floor(self.low), math.ceil(self.high) + 1)
        values = (float(f"{m}e{k}") for k in powers for m in among[-1])
        return [v for v in values if self.low <= math.log10(v) <= self.high]


class Point(NamedTuple):
    """A run's place on the chart; bound: its error is not more than that."""

    seconds: float
    error: float
    bound: bool
    front: bool


def points(runs: Iterable[ChartedRun]) -> list[Point]:
    """The runs that came to their end, from the fastest on as they were asked for."""
    found = []
    for run in runs:
        error = run.error["motion"]
        if run.status == COMPLETED and run.seconds is not None and error is not None:
            found.append(Point(run.seconds, min(error, LOST), "motion" in run.bounded, run.front))
    return found


def failures(runs: Iterable[ChartedRun]) -> list[ChartedRun]:
    """The runs that have no place on the chart."""
    return [run for run in runs if run.status != COMPLETED]


def scales(chart: ChartResults) -> tuple[Scale, Scale]:
    """The scales of seconds and of errors: whole decades of these."""
    known = points(chart.runs)
    floor = chart.reference.own["motion"] or 0.0
    times = [math.log10(max(p.seconds, 1e-9)) for p in known] or [-3.0]
    errors = [math.log10(p.error) for p in known] + ([math.log10(floor)] if floor > 0.0 else []) or [-1.0]
    low, high = math.floor(min(errors)), math.ceil(max(errors))
    return Scale(min(times) - PAD, max(max(times), min(times) + 0.3) + PAD), Scale(low, max(high, low + 1))


def seconds(value: float) -> str:
    """A time in the unit that suits it."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= 0.9999 * size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


def power(value: float) -> str:
    """A power of ten, or a multiple: `1e-6`."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e0", "")
