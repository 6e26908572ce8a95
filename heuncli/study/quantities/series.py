"""Walk over the results: every number that changes over the instants, with its path, components and unit.

The paths are those of manual/results.md, "Paths": `joints.elbow.force.z` is kind `joints`, name `elbow`, quantity
`force`, component `z`; in a run of cuts the component begins with the number of the cut, `3.z`. Units and shapes come
from the schema: a new quantity of the results needs a row there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import CUT, REPORT_OF, SHARES, TREE, Node, Quantity, Shape, find_child, is_share
from heuncli.results.stored_arrays import StoredArray
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units

SIDES = {None: np.nan, "before": -1.0, "beyond": 1.0}  # as numbers, in CSV


class Series(NamedTuple):
    """One quantity over the instants: `values` is (n_t, n_components), or (1, n_components) if it is static.

    cause: the load whose share it is; empty for the whole quantity
    has_cuts: whether components begin with the number of a cut

    If results are written in parts, the values may be in a file.
    """

    kind: str
    name: str
    quantity: str
    unit: str
    components: tuple[str, ...]
    values: Array
    is_static: bool = False
    cause: str = ""
    has_cuts: bool = False

    @property
    def path(self) -> str:
        """The quantity's path in the JSON, without component."""
        share = f"{SHARES}.{self.cause}" if self.cause else ""
        return ".".join(part for part in (self.kind, self.name, share, self.quantity) if part)


def iter_series(results: Results, labels: Labels) -> Iterator[Series]:
    """Yield every quantity of the results that changes over the instants, in the order of the JSON."""
    for kind in REPORT_OF:
        yield from _Walk(kind, labels).iter_block((), _find_node(TREE, kind), getattr(results, kind))


def convert_units(series: Iterable[Series], units: Units) -> list[Series]:
    """Convert the series to the display units of tables."""
    converted = [(item, *units.find(item.unit)) for item in series]
    return [
        item._replace(unit=unit, values=size * item.values) if unit != item.unit else item
        for item, unit, size in converted
    ]


def iter_impulse_series(impulse: Block, labels: Labels) -> Iterator[Series]:
    """Yield every quantity of one block of `impulses`, as at one instant; its forces are impulses."""
    node = _find_node(_find_node(TREE, "impulses"), "0")
    for kind, part in impulse.items():
        if isinstance(part, dict):
            yield from _Walk(kind, labels, is_impulse=True).iter_block((), _find_node(node, kind), part)
        elif kind not in ("time", "names", "certain_sums"):
            yield from _Walk("", labels, is_impulse=True).iter_block((), node, {kind: part})


@cache
def make_component_names(axes: Shape, sizes: tuple[int, ...]) -> tuple[str, ...]:
    """Make the names of the components of an array with these axes: `x`, `3.z`; one empty name for a single number."""
    names: tuple[str, ...] = ("",)
    for axis, size in zip(axes, sizes, strict=True):
        names = tuple(f"{outer}.{inner}" if outer else inner for outer in names for inner in axis.make_labels(size))
    return names


class _Walk(NamedTuple):
    """The walk over the blocks of one kind; of an impulse they have no axis of instants."""

    kind: str
    labels: Labels
    is_impulse: bool = False

    def iter_block(self, keys: tuple[str, ...], node: Node, block: Block, is_run: bool = False) -> Iterator[Series]:
        """Yield the quantities of a block and of its sub-blocks; is_run: whether it belongs to a run of cuts."""
        is_run = is_run or (self.kind == "sections" and len(keys) == 1 and "s" in block)
        for key, value in block.items():
            if isinstance(value, dict):
                yield from self.iter_block((*keys, key), _find_node(node, key), value, is_run)
                continue
            row = find_child(node, key)
            assert isinstance(row, Quantity), f"{self.kind}.{'.'.join((*keys, key))} has no row in the schema"
            if row.is_timed:
                yield self.make_timed_series(keys, key, row, value, is_run)
            elif row.shape == (CUT,) and np.ndim(value) == 1:  # in a search nodes may move with a load
                yield self.make_cut_series(keys, key, row.select_unit(), np.asarray(value, dtype=np.float64))
            elif key == "side" and any(value):
                yield self.make_cut_series(keys, key, "1", np.array([SIDES[side] for side in value]))

    def make_timed_series(self, keys: tuple[str, ...], key: str, row: Quantity, value: Any, is_run: bool) -> Series:
        """Make the series of a quantity that changes over the instants."""
        values: Any = value if isinstance(value, StoredArray) else np.asarray(value, dtype=np.float64)
        if self.is_impulse:
            values = values[None]
        cause = keys[-1] if is_share(row) else ""
        name = ".".join(keys[:-2] if cause else keys)
        unit = row.select_unit(len(row.units) > 1 and self.labels.is_rotational(self.kind, name))
        axes = row.instant_axes(is_run)
        components, columns = make_component_names(axes, values.shape[1:]), values.reshape(len(values), -1)
        return Series(self.kind, name, key, unit, components, columns, cause=cause, has_cuts=CUT in axes)

    def make_cut_series(self, keys: tuple[str, ...], key: str, unit: str, values: Array) -> Series:
        """Make the series of one number per cut that is the same at all instants."""
        components = make_component_names((CUT,), values.shape)
        return Series(self.kind, ".".join(keys), key, unit, components, values[None, :], is_static=True, has_cuts=True)


def _find_node(node: Node, key: str) -> Node:
    child = find_child(node, key)
    assert isinstance(child, dict), f"{key} has no rows in the schema"
    return child
