"""A run as it is kept, from the course of its numbers: with the errors it states of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import WRITTEN
from heuncli.output.snapshots.columns import (
    SHOWN_AT_A_BLOW,
    KeptColumn,
    KeptScope,
    Told,
    along,
    columns_of_series,
    is_shown,
)
from heuncli.output.snapshots.course_sums import CourseSums
from heuncli.output.snapshots.kept import (
    UNKNOWN,
    KeptBlow,
    KeptEvent,
    KeptNumber,
    KeptRun,
    KeptSum,
    Value,
)
from heuncli.output.tables.cut_runs import runs_of
from heuncli.output.tables.impulse_tables import MOST_LISTED, at_one_instant
from heuncli.output.tables.page import Page
from heuncli.results.results import Array, Block, CertainSum, Results
from heuncli.results.results_schema import AT_A_BLOW, BLOWS, EVENTS
from heuncli.study.quantities.digits import largest
from heuncli.study.quantities.series import walk_impulse


class KeptCourse(NamedTuple):
    """The columns of a run at its samples and at the even instants, and the extremes of some of them by their paths.

    sums: what tells of the whole course of each column, where it was looked at.
    """

    told: Told
    own: Mapping[str, KeptColumn]
    even: Mapping[str, Array]
    even_at: Array
    bounds: Mapping[str, KeptBounds]
    drift: Mapping[str, float]
    sums: Mapping[str, CourseSums] = MappingProxyType({})

    def number(self, path: str) -> KeptNumber:
        """One quantity as it is kept."""
        column, told = self.own[path], self.told
        times = told.results.time
        error = told.certain.error(column.kind, column.unit)
        ends = [told.value(column.values[i], float(times[i])) for i in (0, -1)]
        even = [told.value(x, t) for x, t in zip(self.even[path], self.even_at.tolist(), strict=True)]
        extremes = self.bounds[path].kept(told)
        same = {*ends, *even, *(extremes.get(word, ends[0]) for word in ("least", "greatest"))}
        if len(same) == 1:
            return KeptNumber(unit=column.unit, error=error, constant=ends[0])
        drift, sums = self.drift.get(path), self.sums.get(path)
        return KeptNumber(
            unit=column.unit, error=error, first=ends[0], last=ends[1], even=even, drift=drift, **extremes,
            **(sums._asdict() if sums is not None else {}),
        )  # fmt: skip


class KeptBounds(NamedTuple):
    """The lowest and highest of a quantity over a run, with instants and places; None: not searched.

    low_spread, high_spread [s]: how far the instants may lie elsewhere, where that is known.
    """

    low: tuple[float, float, str | None] | None
    high: tuple[float, float, str | None] | None
    low_spread: float | None = None
    high_spread: float | None = None

    def kept(self, told: Told) -> dict[str, Any]:
        """As fields of what is kept."""
        fields: dict[str, Any] = {}
        both = (("least", self.low, self.low_spread), ("greatest", self.high, self.high_spread))
        for word, bound, spread in both:
            if bound is None:
                continue
            value, at, place = bound
            fields[word] = told.value(value)
            if np.isfinite(value):
                fields |= {f"{word}_at": at, f"{word}_at_error": spread, f"{word}_place": place}
        return fields


def record_of(course: KeptCourse, page: Page, scope: KeptScope) -> KeptRun:
    """The numbers of a run from its course; page: of what is not beyond its horizon."""
    told, results = course.told, course.told.results
    struck = results.impulses if BLOWS in scope.wanted else []
    events = results.events if EVENTS in scope.wanted else {}
    span = {"first": float(results.time[0]), "last": float(results.time[-1])}
    ending = ending_error(results)
    return KeptRun(
        status=results.status["code"],
        model={key: count for key, count in results.model.items() if type(count) is int},
        time=span | ({"last_error": ending} if ending is not None else {}),
        even_at=course.even_at.tolist(),
        horizon=results.horizon,
        open=sorted(_open(results, scope.wanted)),
        numbers={path: course.number(path) for path in course.own},
        certain_sums=_sums(told, page),
        events={name: _event(event) for name, event in events.items()},
        blows=len(struck),
        impulses=[_blow(impulse, told, scope) for impulse in struck[:MOST_LISTED]],
    )


def ending_error(results: Results) -> float | None:
    """The error of the last instant [s], where an event ends the run."""
    last = float(results.time[-1])
    errors = [
        float(error)
        for event in results.events.values()
        for t, error in zip(event["time"], event["error"], strict=True)
        if float(t) == last and np.isfinite(error)
    ]
    return max(errors, default=None)


def _open(results: Results, wanted: frozenset[str]) -> Iterator[str]:
    """The components that are open at some instant, by their paths."""
    blocks = {"joints": results.joints, "sections": results.sections}
    blocks["foundation.supports"] = results.foundation.get("supports", {})
    for kind, block in blocks.items():
        for name, part in block.items():
            yield from (f"{kind}.{name}.{component}" for component in part.get("open", ()))


def _sums(told: Told, page: Page) -> dict[str, KeptSum]:
    """The certain sums by their terms, before the horizon."""
    kept: dict[str, KeptSum] = {}
    motion = told.results.accuracy.get("estimate", {}).get("motion", 0.0)
    for block in page.results.certain_sums:
        name = " + ".join(sorted(block["terms"]))
        while name in kept:
            name += "'"
        factors = {path: float(np.ravel(factor)[0]) for path, factor in block["terms"].items()}
        kept[name] = KeptSum(factors=factors, error=max(motion, WRITTEN) * largest(np.array([*factors.values()])),
                             value=_sum(block, told, page.results.time))  # fmt: skip
    return kept


def _sum(block: CertainSum, told: Told, times: Array) -> KeptNumber:
    """The value of a certain sum in the samples."""
    unit = "N·m" if not any(".force." in term for term in block["terms"]) else "N"
    values = np.broadcast_to(np.asarray(block["value"], dtype=np.float64), times.shape)
    error = told.certain.error("reactions", unit)
    ends = [told.value(values[i], float(times[i])) for i in (0, -1)]
    if not np.isfinite(values).any() or np.ptp(values) == 0.0:
        return KeptNumber(unit=unit, error=error, constant=ends[0])
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return KeptNumber(
        unit=unit, error=error, first=ends[0], last=ends[1],
        least=float(values[low]), least_at=float(times[low]),
        greatest=float(values[high]), greatest_at=float(times[high]),
    )  # fmt: skip


def _event(event: Block) -> KeptEvent:
    errors: list[Value] = [float(error) if np.isfinite(error) else UNKNOWN for error in event["error"]]
    times = [float(t) for t in event["time"]]
    to = [bool(x) for x in event["to"]]
    return KeptEvent(condition=event["condition"], begins=bool(event["begins"]), time=times, error=errors, to=to)


def _blow(impulse: Block, told: Told, scope: KeptScope) -> KeptBlow:
    """One blow, its numbers as at one instant."""
    view = Told(at_one_instant(told.results, impulse), told.labels, told.certain)
    columns = [
        column
        for series in walk_impulse(impulse, told.labels)
        if not series.of_cuts and is_shown(series, SHOWN_AT_A_BLOW)
        for column in columns_of_series(series)
    ]
    runs = runs_of(view.results, scope.labels, AT_A_BLOW)
    columns += [column for run in runs for column in along(run)]
    at = float(impulse["time"])
    numbers = {
        column.path: KeptNumber(
            unit=column.unit,
            error=told.certain.error(column.kind, column.unit),
            constant=view.value(column.values[0], at),
        )
        for column in columns
    }
    return KeptBlow(time=at, time_error=blow_error(impulse, told), names=list(impulse["names"]), numbers=numbers)


def blow_error(impulse: Block, told: Told) -> float:
    """How far the instant of a blow may be off [s]: the error of places over the speed at which they meet.

    That speed is not known; the largest jump of a centre's velocity is at most twice it where nothing gains energy.
    """
    jumps = [largest(np.asarray(body["center_velocity_jump"])) for body in impulse.get("bodies", {}).values()]
    fastest = max(jumps, default=0.0)
    span = float(np.ptp(told.results.time))
    found = 2.0 * told.certain.error("motion", "m") / fastest if fastest > 0.0 else 0.0
    return min(found, span) + WRITTEN * span
