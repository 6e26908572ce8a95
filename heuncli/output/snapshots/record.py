"""Make the snapshot of a run from the course of its numbers, with their stated errors: a channel for each, by its path.

The numbers are those of the tables. Of a series of cuts they are the highest and lowest value of its cuts at each
instant, with the extremes of the whole length.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import WRITTEN
from heuncli.output.snapshots.course_sums import CourseSums
from heuncli.output.snapshots.golden_file import (
    BEYOND,
    OPEN,
    UNKNOWN,
    EventSnapshot,
    ImpactSnapshot,
    NumberSnapshot,
    RunSnapshot,
    SumSnapshot,
    Value,
)
from heuncli.output.tables.event_tables import MAX_LISTED, make_impact_results
from heuncli.output.tables.page import Page
from heuncli.output.tables.table_plans import AXIS, MASS_EFFECT, PLANS, TablePlan
from heuncli.output.tables.table_plans import IMPULSES as IMPULSE_PLANS
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block, CutPosition, DeterminateSum, Results
from heuncli.results.results_schema import EVENTS, IMPULSES, REPORT_OF
from heuncli.study.quantities.channels import Channel, iter_channels, iter_impulse_channels
from heuncli.study.quantities.cut_series import CutSeries, collect_cut_series
from heuncli.study.quantities.digits import StatedErrors, largest_magnitude
from heuncli.study.quantities.labels import Labels


class ShownQuantity(NamedTuple):
    """A quantity that tables show.

    only: the one name of the kind to which it is limited, if any
    """

    kind: str
    only: str | None
    quantity: str


def _collect_shown(plans: Iterable[TablePlan]) -> frozenset[ShownQuantity]:
    plans_with_extremes = [plan for plan in plans if plan.has_extremes and not plan.is_detail]
    return frozenset(
        ShownQuantity(plan.kind, plan.only, quantity) for plan in plans_with_extremes for quantity in plan.quantities
    )


SHOWN, SHOWN_AT_IMPACT = _collect_shown(PLANS), _collect_shown(IMPULSE_PLANS)
FOUNDATION_PARTS = frozenset({MASS_EFFECT.only, AXIS.only})  # parts of the foundation besides its total load


class ResultView(NamedTuple):
    """The results over a range of instants, and the accuracy of their numbers."""

    results: Results
    labels: Labels
    stated_errors: StatedErrors

    @property
    def unknown(self) -> frozenset[float]:
        """The instants near singular positions, at which a nan means that the number is not known."""
        return frozenset(self.results.accuracy.get("unknown", ()))

    def to_value(self, number: float, time: float | None = None) -> Value:
        """Return a number as it is stored, or the word in its place; time: its instant."""
        horizon = self.results.horizon
        if time is not None and horizon is not None and time >= horizon:
            return BEYOND
        if np.isfinite(number):
            return float(number) + 0.0
        return UNKNOWN if time in self.unknown else OPEN


class SnapshotScope(NamedTuple):
    """Of which reports numbers are stored, and the labels of the scene."""

    reports: frozenset[str]
    labels: Labels

    def collect_cut_series(self, results: Results) -> list[CutSeries]:
        """Collect the series of cuts, if sections are requested."""
        return collect_cut_series(results, self.labels) if "sections" in self.reports else []


def collect_columns(results: Results, scope: SnapshotScope) -> list[Channel]:
    """Collect the numbers of the tables except those of series of cuts; of a vector components and magnitude."""
    cut_series = {name for name, section in results.sections.items() if "s" in section}
    columns: list[Channel] = []
    for channel in iter_channels(results, scope.labels):
        is_of_series = channel.kind == "sections" and channel.name.split(".")[0] in cut_series
        if REPORT_OF[channel.kind] in scope.reports and not is_of_series and is_shown(channel, SHOWN):
            columns += channel.numbers
    return columns


def is_shown(channel: Channel, shown_quantities: frozenset[ShownQuantity]) -> bool:
    """Return whether a channel is among the quantities that tables show."""
    if channel.cause or channel.is_static:
        return False
    only = channel.name if channel.kind == "foundation" and channel.name in FOUNDATION_PARTS else None
    return ShownQuantity(channel.kind, only, channel.quantity) in shown_quantities


def iter_series_columns(series: CutSeries) -> Iterator[Channel]:
    """Yield for each quantity the lowest and highest value of the cuts of a series; open if one of them is open."""
    for channel in series.channels:
        for word, extreme in (("lowest", channel.values.min(axis=1)), ("highest", channel.values.max(axis=1))):
            yield channel._replace(component=word, values=extreme, axes=())


def collect_all_columns(results: Results, scope: SnapshotScope) -> dict[str, Channel]:
    """Collect all columns by their paths."""
    columns = collect_columns(results, scope)
    columns += [column for series in scope.collect_cut_series(results) for column in iter_series_columns(series)]
    return {column.path: column for column in columns}


def collect_values(results: Results, scope: SnapshotScope) -> dict[str, Array]:
    """Collect the values of all columns by their paths."""
    return {path: column.values for path, column in collect_all_columns(results, scope).items()}


class SnapshotCourse(NamedTuple):
    """The columns of a run by their paths, at its samples and at the even instants, with their extremes.

    drift: rates at the last instant, if an event ends the run
    sums: over the whole course of each column, if they were computed
    """

    view: ResultView
    columns: Mapping[str, Channel]
    even: Mapping[str, Array]
    even_at: Array
    bounds: Mapping[str, SnapshotBounds]
    drift: Mapping[str, float]
    sums: Mapping[str, CourseSums] = MappingProxyType({})

    def make_number(self, path: str) -> NumberSnapshot:
        """Make the snapshot of one quantity."""
        column, view = self.columns[path], self.view
        times = view.results.time
        error = view.stated_errors.find_error(column)
        ends = [view.to_value(column.values[i], float(times[i])) for i in (0, -1)]
        even = [view.to_value(x, t) for x, t in zip(self.even[path], self.even_at.tolist(), strict=True)]
        extremes = self.bounds[path].to_fields(view)
        distinct_values = {*ends, *even, *(extremes.get(word, ends[0]) for word in ("least", "greatest"))}
        if len(distinct_values) == 1:
            return NumberSnapshot(unit=column.unit, error=error, constant=ends[0])
        drift, sums = self.drift.get(path), self.sums.get(path)
        return NumberSnapshot(
            unit=column.unit, error=error, first=ends[0], last=ends[1], even=even, drift=drift, **extremes,
            **(sums._asdict() if sums is not None else {}),
        )  # fmt: skip


class SnapshotBounds(NamedTuple):
    """The lowest and highest value of a quantity over a run, with instant and place; None if not searched.

    low_spread, high_spread: how far the instants may lie elsewhere [s], if that is known
    """

    low: tuple[float, float, CutPosition | None] | None
    high: tuple[float, float, CutPosition | None] | None
    low_spread: float | None = None
    high_spread: float | None = None

    def to_fields(self, view: ResultView) -> dict[str, Any]:
        """Return the bounds as fields of a NumberSnapshot."""
        fields: dict[str, Any] = {}
        bounds = (("least", self.low, self.low_spread), ("greatest", self.high, self.high_spread))
        for word, bound, spread in bounds:
            if bound is None:
                continue
            value, time, place = bound
            fields[word] = view.to_value(value)
            if np.isfinite(value):
                fields |= {f"{word}_at": time, f"{word}_at_error": spread, f"{word}_place": place}
        return fields


def make_run_snapshot(course: SnapshotCourse, page: Page, scope: SnapshotScope) -> RunSnapshot:
    """Make the snapshot of a run from its course.

    page: of the run before its horizon
    """
    view, results = course.view, course.view.results
    impulses = results.impulses if IMPULSES in scope.reports else []
    events = results.events if EVENTS in scope.reports else {}
    span = {"first": float(results.time[0]), "last": float(results.time[-1])}
    ending = find_ending_error(results)
    return RunSnapshot(
        status=results.status["code"],
        model={key: count for key, count in results.model.items() if type(count) is int},
        time=span | ({"last_error": ending} if ending is not None else {}),
        even_at=course.even_at.tolist(),
        horizon=results.horizon,
        open=sorted(_find_open_components(results, scope.reports)),
        numbers={path: course.make_number(path) for path in course.columns},
        certain_sums=_make_sums(view, page),
        events={name: _make_event(event) for name, event in events.items()},
        blows=len(impulses),
        impulses=[_make_impact(impulse, view, scope) for impulse in impulses[:MAX_LISTED]],
    )


def find_ending_error(results: Results) -> float | None:
    """Return the error of the last instant [s], if an event ends the run."""
    last = float(results.time[-1])
    errors = [
        float(error)
        for event in results.events.values()
        for t, error in zip(event["time"], event["error"], strict=True)
        if float(t) == last and np.isfinite(error)
    ]
    return max(errors, default=None)


def _find_open_components(results: Results, reports: frozenset[str]) -> Iterator[str]:
    """Yield the paths of the components that are open at some instant."""
    blocks = {"joints": results.joints, "sensors": results.sensors, "sections": results.sections}
    blocks["foundation.supports"] = results.foundation.get("supports", {})
    for kind, block in blocks.items():
        for name, part in block.items():
            yield from (f"{kind}.{name}.{component}" for component in part.get("open", ()))
            for number, bearing in part.get("bearings", {}).items():
                yield from (f"{kind}.{name}.bearings.{number}.{component}" for component in bearing["open"])


def _make_sums(view: ResultView, page: Page) -> dict[str, SumSnapshot]:
    """Make the snapshots of the determinate sums before the horizon, by their terms."""
    snapshots: dict[str, SumSnapshot] = {}
    motion = view.results.accuracy.get("estimate", {}).get("motion", 0.0)
    for block in page.results.certain_sums:
        name = " + ".join(sorted(block["terms"]))
        while name in snapshots:
            name += "'"
        factors = {path: float(np.ravel(factor)[0]) for path, factor in block["terms"].items()}
        snapshots[name] = SumSnapshot(
            factors=factors,
            error=max(motion, WRITTEN) * largest_magnitude(np.array([*factors.values()])),
            value=_make_sum_value(block, view, page.results.time),
        )
    return snapshots


def _make_sum_value(block: DeterminateSum, view: ResultView, times: Array) -> NumberSnapshot:
    """Make the snapshot of a determinate sum's value in the samples."""
    unit = "N·m" if not any(".force." in term for term in block["terms"]) else "N"
    values = np.broadcast_to(np.asarray(block["value"], dtype=np.float64), times.shape)
    error = view.stated_errors.error_of("reactions", unit)
    ends = [view.to_value(values[i], float(times[i])) for i in (0, -1)]
    if not np.isfinite(values).any() or np.ptp(values) == 0.0:
        return NumberSnapshot(unit=unit, error=error, constant=ends[0])
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return NumberSnapshot(
        unit=unit, error=error, first=ends[0], last=ends[1],
        least=float(values[low]), least_at=float(times[low]),
        greatest=float(values[high]), greatest_at=float(times[high]),
    )  # fmt: skip


def _make_event(event: Block) -> EventSnapshot:
    errors: list[Value] = [float(error) if np.isfinite(error) else UNKNOWN for error in event["error"]]
    times = [float(t) for t in event["time"]]
    becomes = [bool(x) for x in event["to"]]
    return EventSnapshot(
        condition=event["condition"], begins=bool(event["begins"]), time=times, error=errors, to=becomes
    )


def _make_impact(impulse: Block, view: ResultView, scope: SnapshotScope) -> ImpactSnapshot:
    """Make the snapshot of one impact, whose numbers are constants."""
    impact_view = ResultView(make_impact_results(view.results, impulse), view.labels, view.stated_errors)
    columns = [
        column
        for channel in iter_impulse_channels(impulse, view.labels)
        if not channel.has_cuts and is_shown(channel, SHOWN_AT_IMPACT)
        for column in channel.numbers
    ]
    all_series = collect_cut_series(impact_view.results, scope.labels, IMPULSE_UNITS)
    columns += [column for series in all_series for column in iter_series_columns(series)]
    time = float(impulse["time"])
    numbers = {
        column.path: NumberSnapshot(
            unit=column.unit,
            error=view.stated_errors.find_error(column),
            constant=impact_view.to_value(column.values[0], time),
        )
        for column in columns
    }
    return ImpactSnapshot(
        time=time, time_error=estimate_impact_error(impulse, view), names=list(impulse["names"]), numbers=numbers
    )


def estimate_impact_error(impulse: Block, view: ResultView) -> float:
    """Estimate the error of the instant of an impact [s]: the error of places over the approach speed.

    That speed is not known; the largest jump of a centre's velocity is at most twice it if nothing gains energy.
    """
    jumps = [largest_magnitude(np.asarray(body["center_velocity_jump"])) for body in impulse.get("bodies", {}).values()]
    fastest = max(jumps, default=0.0)
    span = float(np.ptp(view.results.time))
    error = 2.0 * view.stated_errors.error_of("motion", "m") / fastest if fastest > 0.0 else 0.0
    return min(error, span) + WRITTEN * span
