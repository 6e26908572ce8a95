"""The numbers of a solved scene as they are kept: what its tables tell, to full digits, with the errors it states.

Of every quantity: first and last value, the extremes searched between the samples with their instants, and the values
at eleven even instants, so that a course that changes between its extremes is seen. Of a run of cuts the highest and
the lowest of its cuts, with the extremes of the whole stretch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from heuncli.records import replace
from heuncli.report.cut_runs import CutRun, RunQuantity, runs_of
from heuncli.report.digits import Certainty, kind_of, largest
from heuncli.report.impulse_tables import MOST_LISTED, at_one_instant
from heuncli.report.labels import Labels, labels_of
from heuncli.report.page import Page, page_of
from heuncli.report.run_searches import stresses_along
from heuncli.report.series import Series, walk, walk_impulse
from heuncli.report.table_blocks import POSITIONS
from heuncli.report.table_plans import AXIS, IMPULSES, MASS_EFFECT, PLANS, TablePlan
from heuncli.report.table_units import Units
from heuncli.results import Array, Block, CertainSum, Extremes, Place, Results
from heuncli.results_schema import AT_A_BLOW, BLOWS, EVENTS, MAGNITUDES, REPORT_OF, SHARES, XYZ
from heuncli.study.ask.study import Study
from heuncli.study.search.extremes import MOST_COLUMNS, ColumnSearch, no_columns
from heuncli.telling.kept import (
    BEYOND,
    EVEN,
    OPEN,
    UNKNOWN,
    KeptBlow,
    KeptEvent,
    KeptNumber,
    KeptRun,
    KeptSum,
    Value,
)
from heuncli.tolerances import WRITTEN

SI = Units({})
BACK = 1e-5  # of a run, over which the rate at its end is taken where an event ends it
SAME_END = 1e-6  # of a run: ends that differ by no more are those of one run, but for the error of the event there
SECTIONS = frozenset({"sections"})


class Shown(NamedTuple):
    """A quantity that tables show: its kind, the one name of the kind that it is of if so, and what it is called."""

    kind: str
    only: str | None
    quantity: str


def _shown_by(plans: Iterable[TablePlan]) -> frozenset[Shown]:
    lasting = [plan for plan in plans if plan.lasting and not plan.detail]
    return frozenset(Shown(plan.kind, plan.only, quantity) for plan in lasting for quantity in plan.quantities)


SHOWN, SHOWN_AT_A_BLOW = _shown_by(PLANS), _shown_by(IMPULSES)
PARTS = frozenset({MASS_EFFECT.only, AXIS.only})  # of the foundation, beside its wrench


class Column(NamedTuple):
    """One number over the instants: its path, unit, kind of error, whether it is a magnitude; values (n_t,)."""

    path: str
    unit: str
    kind: str
    even: bool
    values: Array


class Told(NamedTuple):
    """The results of one stretch of instants, and how well their numbers are known."""

    results: Results
    labels: Labels
    certain: Certainty

    @property
    def unknown(self) -> frozenset[float]:
        """The instants beside singular poses, at which what is nan is not known."""
        return frozenset(self.results.accuracy.get("unknown", ()))

    def value(self, number: float, at: float | None = None) -> Value:
        """A number as it is kept, or the word in its place; at: its instant."""
        horizon = self.results.accuracy.get("horizon")
        if at is not None and horizon is not None and at >= horizon:
            return BEYOND
        if np.isfinite(number):
            return float(number) + 0.0
        return UNKNOWN if at in self.unknown else OPEN


class Scope(NamedTuple):
    """Of which reports numbers are kept, and how those of the scene are labelled."""

    wanted: frozenset[str]
    labels: Labels

    def runs(self, results: Results) -> list[CutRun]:
        """The runs of cuts, where sections are wanted."""
        return runs_of(results, self.labels) if "sections" in self.wanted else []


def columns_of(results: Results, scope: Scope) -> list[Column]:
    """What the tables tell over the instants, but for runs of cuts; of a vector its components and its magnitude."""
    runs = {name for name, section in results.sections.items() if "s" in section}
    columns: list[Column] = []
    for series in walk(results, scope.labels):
        in_a_run = series.kind == "sections" and series.name.split(".")[0] in runs
        if REPORT_OF[series.kind] in scope.wanted and not in_a_run and _is_shown(series, SHOWN):
            columns += columns_of_series(series)
    return columns


def _is_shown(series: Series, shown: frozenset[Shown]) -> bool:
    if series.cause or series.static:
        return False
    only = series.name if series.name in PARTS else None
    return Shown(series.kind, only, series.quantity) in shown


def columns_of_series(series: Series) -> Iterator[Column]:
    """The numbers of one quantity."""
    kind, single = kind_of(series), len(series.components) == 1
    for component, values in zip(series.components, series.values.T, strict=True):
        path = series.path if single else f"{series.path}.{component}"
        yield Column(path, series.unit, kind, single and series.quantity in MAGNITUDES, values)
    if series.components == XYZ and series.quantity not in POSITIONS:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        yield Column(series.path, series.unit, kind, True, np.sqrt(squares))


def along(run: CutRun) -> Iterator[Column]:
    """The lowest and the highest of a run's cuts, of each quantity; open where one of them is."""
    for quantity, values in zip(run.quantities, run.values, strict=True):
        path = run_path(run, quantity)
        for word, of in (("lowest", values.min(axis=1)), ("highest", values.max(axis=1))):
            yield Column(f"{path}.{word}", quantity.unit, "sections", quantity.even, of)


def run_path(run: CutRun, quantity: RunQuantity) -> str:
    """The path of a quantity of a run of cuts, as `--measure` takes it."""
    part = "stress." if quantity in run.stresses else ""
    return f"sections.{run.name}.{part}{quantity.name}"


class Course(NamedTuple):
    """The columns of a run at its samples and at the even instants, and the extremes of some of them by their paths."""

    told: Told
    own: Mapping[str, Column]
    even: Mapping[str, Array]
    even_at: Array
    bounds: Mapping[str, Bounds]
    drift: Mapping[str, float]

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
        drift = self.drift.get(path)
        return KeptNumber(
            unit=column.unit, error=error, first=ends[0], last=ends[1], even=even, drift=drift, **extremes
        )


class Bounds(NamedTuple):
    """The lowest and highest of a quantity over a run, with instants and places; None: not searched."""

    low: tuple[float, float, str | None] | None
    high: tuple[float, float, str | None] | None

    def kept(self, told: Told) -> dict[str, Any]:
        """As fields of what is kept."""
        fields: dict[str, Any] = {}
        for word, bound in (("least", self.low), ("greatest", self.high)):
            if bound is None:
                continue
            value, at, place = bound
            fields[word] = told.value(value)
            if np.isfinite(value):
                fields |= {f"{word}_at": at, f"{word}_place": place}
        return fields


def keep(study: Study, wanted: frozenset[str], even_at: Sequence[float] = ()) -> KeptRun:
    """The numbers of a study, of the reports that are wanted; even_at: the even instants of the run it is held to."""
    results = study.results
    labels = replace(labels_of(study.spec), units=SI)
    page = page_of(results, labels, study.magnitudes)
    told, scope = Told(results, labels, page.certain), Scope(wanted, labels)
    instants = _even(results, even_at)
    course = _course(study, page, told, instants, scope)
    struck = results.impulses if BLOWS in wanted else []
    events = results.events if EVENTS in wanted else {}
    span = {"first": float(results.time[0]), "last": float(results.time[-1])}
    ending = _ending(results)
    return KeptRun(
        status=results.status["code"],
        model={key: count for key, count in results.model.items() if type(count) is int},
        time=span | ({"last_error": ending} if ending is not None else {}),
        even_at=instants.tolist(),
        horizon=results.accuracy.get("horizon"),
        open=sorted(_open(results, wanted)),
        numbers={path: course.number(path) for path in course.own},
        certain_sums=_sums(told, page),
        events={name: _event(event) for name, event in events.items()},
        blows=len(struck),
        impulses=[_blow(impulse, told, scope) for impulse in struck[:MOST_LISTED]],
    )


def _even(results: Results, given: Sequence[float]) -> Array:
    """Eleven even instants of a run; those given where they are of the same run but for rounding of its end."""
    first, last = float(results.time[0]), float(results.time[-1])
    own = np.linspace(first, last, EVEN) if last > first else np.zeros(0)
    if len(given) == len(own) and np.all(np.abs(own - given) <= SAME_END * (last - first)):
        return np.clip(np.array(given), first, last)
    return own


def _ending(results: Results) -> float | None:
    """The error of the last instant [s], where an event ends the run."""
    last = float(results.time[-1])
    errors = [
        float(error)
        for event in results.events.values()
        for t, error in zip(event["time"], event["error"], strict=True)
        if float(t) == last and np.isfinite(error)
    ]
    return max(errors, default=None)


def _course(study: Study, page: Page, told: Told, instants: Array, scope: Scope) -> Course:
    columns = _all(told.results, scope)
    even = _values(study.resample(instants), scope) if len(instants) else {path: np.zeros(0) for path in columns}
    drift: dict[str, float] = {}
    if _ending(told.results) is not None:
        first, last = float(told.results.time[0]), float(told.results.time[-1])
        back = BACK * (last - first)
        near_end = _values(study.resample(np.array([last - back, last])), scope)
        rates = {path: (x[1] - x[0]) / back for path, x in near_end.items()}
        drift = {path: abs(float(rate)) for path, rate in rates.items() if np.isfinite(rate) and rate}
    return Course(told, columns, even, instants, _bounds(study, page, scope), drift)


def _all(results: Results, scope: Scope) -> dict[str, Column]:
    """All columns by their paths."""
    own = columns_of(results, scope)
    own += [column for run in scope.runs(results) for column in along(run)]
    return {column.path: column for column in own}


def _values(results: Results, scope: Scope) -> dict[str, Array]:
    return {path: column.values for path, column in _all(results, scope).items()}


def _bounds(study: Study, page: Page, scope: Scope) -> dict[str, Bounds]:
    """The extremes of all columns, searched between the samples where there are not too many of them."""
    columns, runs = columns_of(page.results, scope), scope.runs(page.results)
    certain = page.certain
    errors = [certain.error(column.kind, column.unit) for column in columns]
    errors += [certain.error("sections", load.unit) for run in runs for load in run.loads]
    even = np.array([column.even for column in columns] + [False] * (len(errors) - len(columns)), dtype=bool)
    searched = ColumnSearch(
        lambda results: _squared(columns_of(results, scope), len(results.time)), [[i] for i in range(len(columns))],
        np.array(errors), even, page.along if runs else None,
    )  # fmt: skip
    times = None if len(errors) <= MOST_COLUMNS else study.results.time
    found = study.extremes(searched, scope.wanted - {SHARES}, whole=True, times=times)
    low, high = (np.where(even, np.sqrt(np.abs(bound)), bound) for bound in (found.low, found.high))
    bounds = {
        column.path: _bounds_of(low[i], found.low_at[i], high[i], found.high_at[i]) for i, column in enumerate(columns)
    }
    start = len(columns)
    for k, run in enumerate(runs):
        first = start + k * len(run.loads)
        part = found.part(slice(first, first + len(run.loads)))
        bounds |= _along_bounds(run, run.loads, part, found.places[k * len(run.loads) : (k + 1) * len(run.loads)])
        if run.stresses:
            own = stresses_along(run, scope.labels)
            of = ColumnSearch(no_columns, [], own.errors(certain), own.even, own.along, bent=True)
            stresses = own.roots(study.extremes(of, SECTIONS))
            bounds |= _along_bounds(run, run.stresses, stresses, stresses.places)
    return bounds


def _bounds_of(low: float, low_at: float, high: float, high_at: float) -> Bounds:
    return Bounds((float(low), float(low_at), None), (float(high), float(high_at), None))


def _along_bounds(
    run: CutRun, quantities: Sequence[RunQuantity], found: Extremes, places: Sequence[tuple[Place, Place]]
) -> dict[str, Bounds]:
    """The extremes along a run: the lowest belongs to its lowest cuts, the highest to its highest."""
    bounds: dict[str, Bounds] = {}
    for i, quantity in enumerate(quantities):
        path = run_path(run, quantity)
        low = float(found.low[i]), float(found.low_at[i]), position(places[i][0])
        high = float(found.high[i]), float(found.high_at[i]), position(places[i][1])
        bounds |= {f"{path}.lowest": Bounds(low, None), f"{path}.highest": Bounds(None, high)}
    return bounds


def position(place: Place) -> str:
    """A place along a run of cuts: its distance [m], and the side of what acts there."""
    return " ".join([f"{place.s:.6g} m", *([place.side] if place.side else [])])


def _squared(columns: Sequence[Column], n: int) -> Array:
    if not columns:
        return np.zeros((n, 0))
    return np.stack([column.values**2 if column.even else column.values for column in columns], axis=1)


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
    errors = [float(error) if np.isfinite(error) else UNKNOWN for error in event["error"]]
    times = [float(t) for t in event["time"]]
    to = [bool(x) for x in event["to"]]
    return KeptEvent(condition=event["condition"], begins=bool(event["begins"]), time=times, error=errors, to=to)


def _blow(impulse: Block, told: Told, scope: Scope) -> KeptBlow:
    """One blow, its numbers as at one instant."""
    view = Told(at_one_instant(told.results, impulse), told.labels, told.certain)
    columns = [
        column
        for series in walk_impulse(impulse, told.labels)
        if not series.of_cuts and _is_shown(series, SHOWN_AT_A_BLOW)
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
    return KeptBlow(time=at, time_error=_blow_error(impulse, told), names=list(impulse["names"]), numbers=numbers)


def _blow_error(impulse: Block, told: Told) -> float:
    """How far the instant of a blow may be off [s]: the error of places over the speed at which they meet.

    That speed is not known; the largest jump of a centre's velocity is at most twice it where nothing gains energy.
    """
    jumps = [largest(np.asarray(body["center_velocity_jump"])) for body in impulse.get("bodies", {}).values()]
    fastest = max(jumps, default=0.0)
    span = float(np.ptp(told.results.time))
    found = 2.0 * told.certain.error("motion", "m") / fastest if fastest > 0.0 else 0.0
    return min(found, span) + WRITTEN * span
