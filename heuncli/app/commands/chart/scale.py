"""The logarithmic scales of a chart and its points: seconds to the right, errors of the motion upwards.

Errors of `LOST` of the scene's size or more are drawn at the border: they only say that the run is useless.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from heuncli.analyses.work_precision.results import COMPLETED, ChartResults, ChartRun
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import LOST

PAD = 0.08  # of a decade, margin at the fastest and at the slowest run
MINOR = ((2.5, (2, 5)), (1.0, (2, 3, 5, 7)))  # (most decades, multiples labelled between them)


class Scale(NamedTuple):
    """A logarithmic scale from the decadic logarithm `low` to `high`."""

    low: float
    high: float

    def locate(self, value: float) -> float:
        """Return the position of a value, 0 to 1; values outside are placed at the border."""
        if not value > 0.0:
            return 0.0
        log = math.log10(value) if math.isfinite(value) else self.high
        return min(max((log - self.low) / (self.high - self.low), 0.0), 1.0)

    @property
    def decades(self) -> list[float]:
        """The powers of ten within the scale."""
        return [float(f"1e{k}") for k in range(math.ceil(self.low), math.floor(self.high) + 1)]

    @property
    def minor_ticks(self) -> list[float]:
        """Multiples of the powers of ten, if there are few decades."""
        multiples_by_range = [multiples for decades, multiples in MINOR if self.high - self.low <= decades]
        if not multiples_by_range:
            return []
        powers = range(math.floor(self.low), math.ceil(self.high) + 1)
        values = (float(f"{m}e{k}") for k in powers for m in multiples_by_range[-1])
        return [v for v in values if self.low <= math.log10(v) <= self.high]


class ChartPoint(NamedTuple):
    """The position of a run on the chart.

    is_bound: whether the error is only an upper bound
    front: whether it is on the front
    """

    seconds: float
    error: float
    is_bound: bool
    front: bool


def list_points(runs: Iterable[ChartRun]) -> list[ChartPoint]:
    """Return the points of the completed runs, in the order of the runs."""
    chart_points = []
    for run in runs:
        error = run.error["motion"]
        if run.status == COMPLETED and run.seconds is not None and error is not None:
            chart_points.append(ChartPoint(run.seconds, min(error, LOST), "motion" in run.upper_bounds, run.front))
    return chart_points


def list_failures(runs: Iterable[ChartRun]) -> list[ChartRun]:
    """Return the runs that did not complete."""
    return [run for run in runs if run.status != COMPLETED]


def choose_scales(chart: ChartResults) -> tuple[Scale, Scale]:
    """Choose the scales of seconds and of errors; the latter in whole decades."""
    chart_points = list_points(chart.runs)
    floor = chart.reference.error["motion"] or 0.0
    times = [math.log10(max(p.seconds, 1e-9)) for p in chart_points] or [-3.0]
    errors = [math.log10(p.error) for p in chart_points] + ([math.log10(floor)] if floor > 0.0 else []) or [-1.0]
    low, high = math.floor(min(errors)), math.ceil(max(errors))
    return Scale(min(times) - PAD, max(max(times), min(times) + 0.3) + PAD), Scale(low, max(high, low + 1))


def format_seconds(value: float) -> str:
    """Format a time in a suitable unit."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= 0.9999 * size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


def format_power(value: float) -> str:
    """Format a power of ten, or a multiple of it: `1e-6`."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e0", "")
