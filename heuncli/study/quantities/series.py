"""One walk over the results: every number that runs over the instants, with its path, components and unit.

The paths are those of manual/results.md, "Paths": `joints.elbow.force.z` is kind `joints`, name `elbow`, quantity
`force`, component `z`; in a run of cuts the component begins with the number of the cut, `3.z`. Units and shapes are
those of the schema: what is added to the results later needs a row there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import CUT, REPORT_OF, SHARES, TREE, Node, Quantity, Shape, below, is_share
from heuncli.results.stored_arrays import StoredArray
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units

SIDES = {None: np.nan, "before": -1.0, "beyond": 1.0}  # as numbers, in CSV


class Series(NamedTuple):
    """One quantity over the instants: `values` is (n_t, n_components), or (1, n_components) where `static`.

    cause: of whose share it is, in the quantity of the same name; empty for the whole. of_cuts: whether components
    begin with the number of a cut. Of results that are written piece by piece the values may stand in a file, as there.
    """

    kind: str
    name: str
    quantity: str
    unit: str
    components: tuple[str, ...]
    values: Array
    static: bool = False
    cause: str = ""
    of_cuts: bool = False

    @property
    def path(self) -> str:
        """The quantity's path in the JSON, without component."""
        share = f"{SHARES}.{self.cause}" if self.cause else ""
        return ".".join(part for part in (self.kind, self.name, share, self.quantity) if part)


def walk(results: Results, labels: Labels) -> Iterator[Series]:
    """Every quantity of the results that runs over the instants, in the order of the JSON."""
    for kind in REPORT_OF:
        yield from _Walk(kind, labels).block((), _node(TREE, kind), getattr(results, kind))


def in_units(series: Iterable[Series], units: Units) -> list[Series]:
    """The series in the units that tables show."""
    shown = [(item, *units.of(item.unit)) for item in series]
    return [
        item._replace(unit=unit, values=size * item.values) if unit != item.unit else item for item, unit, size in shown
    ]


def walk_impulse(impulse: Block, labels: Labels) -> Iterator[Series]:
    """Every quantity of one block of `impulses`, as if at one instant; its forces are impulses."""
    node = _node(_node(TREE, "impulses"), "0")
    for kind, part in impulse.items():
        if isinstance(part, dict):
            yield from _Walk(kind, labels, at_a_blow=True).block((), _node(node, kind), part)
        elif kind not in ("time", "names", "certain_sums"):
            yield from _Walk("", labels, at_a_blow=True).block((), node, {kind: part})


@cache
def component_names(axes: Shape, sizes: tuple[int, ...]) -> tuple[str, ...]:
    """Names of the components of an array with these axes: `x`, `3.z`; one empty name for a single number."""
    names: tuple[str, ...] = ("",)
    for axis, size in zip(axes, sizes, strict=True):
        names = tuple(f"{outer}.{inner}" if outer else inner for outer in names for inner in axis.labels(size))
    return names


class _Walk(NamedTuple):
    """The walk over the blocks of one kind, over the instants or `at_a_blow`, which has no axis of instants."""

    kind: str
    labels: Labels
    at_a_blow: bool = False

    def block(self, keys: tuple[str, ...], node: Node, block: Block, run: bool = False) -> Iterator[Series]:
        """The quantities of a block and of those in it; `run`: whether it belongs to a run of cuts."""
        run = run or (self.kind == "sections" and len(keys) == 1 and "s" in block)
        for key, value in block.items():
            if isinstance(value, dict):
                yield from self.block((*keys, key), _node(node, key), value, run)
                continue
            row = below(node, key)
            assert isinstance(row, Quantity), f"{self.kind}.{'.'.join((*keys, key))} has no row in the schema"
            if row.timed:
                yield self.over_instants(keys, key, row, value, run)
            elif row.shape == (CUT,) and np.ndim(value) == 1:  # in a search nodes may move with a load
                yield self.along_cuts(keys, key, row.unit(), np.asarray(value, dtype=np.float64))
            elif key == "side" and any(value):
                yield self.along_cuts(keys, key, "1", np.array([SIDES[side] for side in value]))

    def over_instants(self, keys: tuple[str, ...], key: str, row: Quantity, value: Any, run: bool) -> Series:
        """The series of a quantity that runs over the instants."""
        values: Any = value if isinstance(value, StoredArray) else np.asarray(value, dtype=np.float64)
        if self.at_a_blow:
            values = values[None]
        cause = keys[-1] if is_share(row) else ""
        name = ".".join(keys[:-2] if cause else keys)
        unit = row.unit(len(row.units) > 1 and self.labels.turns(self.kind, name))
        axes = row.axes(run)
        components, flat = component_names(axes, values.shape[1:]), values.reshape(len(values), -1)
        return Series(self.kind, name, key, unit, components, flat, cause=cause, of_cuts=CUT in axes)

    def along_cuts(self, keys: tuple[str, ...], key: str, unit: str, values: Array) -> Series:
        """The series of one number a cut that is the same at all instants."""
        components = component_names((CUT,), values.shape)
        return Series(self.kind, ".".join(keys), key, unit, components, values[None, :], static=True, of_cuts=True)


def _node(node: Node, key: str) -> Node:
    child = below(node, key)
    assert isinstance(child, dict), f"{key} has no rows in the schema"
    return child
