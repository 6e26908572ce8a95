"""The numbers of the tables over the instants: a column for each, by its path.

Of a run of cuts: the highest and lowest value of its cuts at each instant, with the extremes of the whole length.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.golden_file import (
    BEYOND,
    OPEN,
    UNKNOWN,
    Value,
)
from heuncli.output.tables.cut_runs import CutRun, RunQuantity, collect_runs
from heuncli.output.tables.table_blocks import POSITIONS
from heuncli.output.tables.table_plans import AXIS, IMPULSES, MASS_EFFECT, PLANS, TablePlan
from heuncli.results.results import Array, CutPosition, Results
from heuncli.results.results_schema import MAGNITUDES, REPORT_OF, XYZ
from heuncli.study.quantities.digits import StatedErrors, find_error_kind
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, iter_series


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


SHOWN, SHOWN_AT_A_BLOW = _collect_shown(PLANS), _collect_shown(IMPULSES)
FOUNDATION_PARTS = frozenset({MASS_EFFECT.only, AXIS.only})  # parts of the foundation besides its total load


class SnapshotColumn(NamedTuple):
    """One number over the instants: its path, unit, kind of error, whether it is a magnitude, and its values (n_t,)."""

    path: str
    unit: str
    kind: str
    is_magnitude: bool
    values: Array


class ResultView(NamedTuple):
    """The results over a range of instants, and the accuracy of their numbers."""

    results: Results
    labels: Labels
    certain: StatedErrors

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

    def collect_runs(self, results: Results) -> list[CutRun]:
        """Collect the runs of cuts, if sections are requested."""
        return collect_runs(results, self.labels) if "sections" in self.reports else []


def collect_columns(results: Results, scope: SnapshotScope) -> list[SnapshotColumn]:
    """Collect the columns of the tables except those of runs of cuts; of a vector its components and its magnitude."""
    runs = {name for name, section in results.sections.items() if "s" in section}
    columns: list[SnapshotColumn] = []
    for series in iter_series(results, scope.labels):
        is_of_run = series.kind == "sections" and series.name.split(".")[0] in runs
        if REPORT_OF[series.kind] in scope.reports and not is_of_run and is_shown(series, SHOWN):
            columns += iter_series_columns(series)
    return columns


def is_shown(series: Series, shown_quantities: frozenset[ShownQuantity]) -> bool:
    """Return whether a series is among the quantities that tables show."""
    if series.cause or series.is_static:
        return False
    only = series.name if series.kind == "foundation" and series.name in FOUNDATION_PARTS else None
    return ShownQuantity(series.kind, only, series.quantity) in shown_quantities


def iter_series_columns(series: Series) -> Iterator[SnapshotColumn]:
    """Yield the columns of one quantity."""
    kind, is_scalar = find_error_kind(series), len(series.components) == 1
    for component, values in zip(series.components, series.values.T, strict=True):
        path = series.path if is_scalar else f"{series.path}.{component}"
        yield SnapshotColumn(path, series.unit, kind, is_scalar and series.quantity in MAGNITUDES, values)
    if series.components == XYZ and series.quantity not in POSITIONS:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        yield SnapshotColumn(series.path, series.unit, kind, True, np.sqrt(squares))


def iter_run_columns(run: CutRun) -> Iterator[SnapshotColumn]:
    """Yield the lowest and highest value of a run's cuts, for each quantity; open if one of the cuts is open."""
    for quantity, values in zip(run.quantities, run.values, strict=True):
        path = make_run_path(run, quantity)
        for word, extreme in (("lowest", values.min(axis=1)), ("highest", values.max(axis=1))):
            yield SnapshotColumn(f"{path}.{word}", quantity.unit, "sections", quantity.is_magnitude, extreme)


def make_run_path(run: CutRun, quantity: RunQuantity) -> str:
    """Return the path of a quantity of a run of cuts, as `--measure` takes it."""
    part = "stress." if quantity in run.stresses else ""
    return f"sections.{run.name}.{part}{quantity.name}"


def collect_all_columns(results: Results, scope: SnapshotScope) -> dict[str, SnapshotColumn]:
    """Collect all columns by their paths."""
    columns = collect_columns(results, scope)
    columns += [column for run in scope.collect_runs(results) for column in iter_run_columns(run)]
    return {column.path: column for column in columns}


def collect_values(results: Results, scope: SnapshotScope) -> dict[str, Array]:
    """Collect the values of all columns by their paths."""
    return {path: column.values for path, column in collect_all_columns(results, scope).items()}


def format_place(place: CutPosition) -> str:
    """Format a place along a run of cuts: its distance [m], and the side of the load that acts there."""
    return " ".join([f"{place.s:.6g} m", *([place.side] if place.side else [])])
