"""What the tables tell as numbers over the instants: a column each, by its path.

Of a run of cuts the highest and the lowest of its cuts, with the extremes of the whole stretch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.kept import (
    BEYOND,
    OPEN,
    UNKNOWN,
    Value,
)
from heuncli.output.tables.cut_runs import CutRun, RunQuantity, runs_of
from heuncli.output.tables.table_blocks import POSITIONS
from heuncli.output.tables.table_plans import AXIS, IMPULSES, MASS_EFFECT, PLANS, TablePlan
from heuncli.results.results import Array, Place, Results
from heuncli.results.results_schema import MAGNITUDES, REPORT_OF, XYZ
from heuncli.study.quantities.digits import Certainty, kind_of
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, walk


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


class KeptColumn(NamedTuple):
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
        horizon = self.results.horizon
        if at is not None and horizon is not None and at >= horizon:
            return BEYOND
        if np.isfinite(number):
            return float(number) + 0.0
        return UNKNOWN if at in self.unknown else OPEN


class KeptScope(NamedTuple):
    """Of which reports numbers are kept, and how those of the scene are labelled."""

    wanted: frozenset[str]
    labels: Labels

    def runs(self, results: Results) -> list[CutRun]:
        """The runs of cuts, where sections are wanted."""
        return runs_of(results, self.labels) if "sections" in self.wanted else []


def columns_of(results: Results, scope: KeptScope) -> list[KeptColumn]:
    """What the tables tell over the instants, but for runs of cuts; of a vector its components and its magnitude."""
    runs = {name for name, section in results.sections.items() if "s" in section}
    columns: list[KeptColumn] = []
    for series in walk(results, scope.labels):
        in_a_run = series.kind == "sections" and series.name.split(".")[0] in runs
        if REPORT_OF[series.kind] in scope.wanted and not in_a_run and is_shown(series, SHOWN):
            columns += columns_of_series(series)
    return columns


def is_shown(series: Series, shown: frozenset[Shown]) -> bool:
    if series.cause or series.static:
        return False
    only = series.name if series.kind == "foundation" and series.name in PARTS else None
    return Shown(series.kind, only, series.quantity) in shown


def columns_of_series(series: Series) -> Iterator[KeptColumn]:
    """The numbers of one quantity."""
    kind, single = kind_of(series), len(series.components) == 1
    for component, values in zip(series.components, series.values.T, strict=True):
        path = series.path if single else f"{series.path}.{component}"
        yield KeptColumn(path, series.unit, kind, single and series.quantity in MAGNITUDES, values)
    if series.components == XYZ and series.quantity not in POSITIONS:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        yield KeptColumn(series.path, series.unit, kind, True, np.sqrt(squares))


def along(run: CutRun) -> Iterator[KeptColumn]:
    """The lowest and the highest of a run's cuts, of each quantity; open where one of them is."""
    for quantity, values in zip(run.quantities, run.values, strict=True):
        path = run_path(run, quantity)
        for word, of in (("lowest", values.min(axis=1)), ("highest", values.max(axis=1))):
            yield KeptColumn(f"{path}.{word}", quantity.unit, "sections", quantity.even, of)


def run_path(run: CutRun, quantity: RunQuantity) -> str:
    """The path of a quantity of a run of cuts, as `--measure` takes it."""
    part = "stress." if quantity in run.stresses else ""
    return f"sections.{run.name}.{part}{quantity.name}"


def all_columns(results: Results, scope: KeptScope) -> dict[str, KeptColumn]:
    """All columns by their paths."""
    own = columns_of(results, scope)
    own += [column for run in scope.runs(results) for column in along(run)]
    return {column.path: column for column in own}


def values_of(results: Results, scope: KeptScope) -> dict[str, Array]:
    return {path: column.values for path, column in all_columns(results, scope).items()}


def position(place: Place) -> str:
    """A place along a run of cuts: its distance [m], and the side of what acts there."""
    return " ".join([f"{place.s:.6g} m", *([place.side] if place.side else [])])
