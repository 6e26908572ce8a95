"""The numbers of the tables over the instants: a channel for each, by its path.

Of a series of cuts: the highest and lowest value of its cuts at each instant, with the extremes of the whole length.
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
from heuncli.output.tables.table_plans import AXIS, IMPULSES, MASS_EFFECT, PLANS, TablePlan
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import REPORT_OF
from heuncli.study.quantities.channels import Channel, iter_channels
from heuncli.study.quantities.cut_runs import CutRun, collect_runs
from heuncli.study.quantities.digits import StatedErrors
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


SHOWN, SHOWN_AT_A_BLOW = _collect_shown(PLANS), _collect_shown(IMPULSES)
FOUNDATION_PARTS = frozenset({MASS_EFFECT.only, AXIS.only})  # parts of the foundation besides its total load


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
        """Collect the series of cuts, if sections are requested."""
        return collect_runs(results, self.labels) if "sections" in self.reports else []


def collect_columns(results: Results, scope: SnapshotScope) -> list[Channel]:
    """Collect the numbers of the tables except those of series of cuts; of a vector components and magnitude."""
    runs = {name for name, section in results.sections.items() if "s" in section}
    columns: list[Channel] = []
    for channel in iter_channels(results, scope.labels):
        is_of_run = channel.kind == "sections" and channel.name.split(".")[0] in runs
        if REPORT_OF[channel.kind] in scope.reports and not is_of_run and is_shown(channel, SHOWN):
            columns += channel.numbers
    return columns


def is_shown(channel: Channel, shown_quantities: frozenset[ShownQuantity]) -> bool:
    """Return whether a channel is among the quantities that tables show."""
    if channel.cause or channel.is_static:
        return False
    only = channel.name if channel.kind == "foundation" and channel.name in FOUNDATION_PARTS else None
    return ShownQuantity(channel.kind, only, channel.quantity) in shown_quantities


def iter_run_columns(run: CutRun) -> Iterator[Channel]:
    """Yield the lowest and highest value of a run's cuts, for each quantity; open if one of the cuts is open."""
    for channel in run.channels:
        for word, extreme in (("lowest", channel.values.min(axis=1)), ("highest", channel.values.max(axis=1))):
            yield channel._replace(component=word, values=extreme, axes=())


def collect_all_columns(results: Results, scope: SnapshotScope) -> dict[str, Channel]:
    """Collect all columns by their paths."""
    columns = collect_columns(results, scope)
    columns += [column for run in scope.collect_runs(results) for column in iter_run_columns(run)]
    return {column.path: column for column in columns}


def collect_values(results: Results, scope: SnapshotScope) -> dict[str, Array]:
    """Collect the values of all columns by their paths."""
    return {path: column.values for path, column in collect_all_columns(results, scope).items()}
