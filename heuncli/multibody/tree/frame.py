"""The part of a layout that does not depend on the value of any load: the tree, its rows, the start."""

from __future__ import annotations

from array import array
from functools import cache

import numpy as np

from heuncli.base.records import fields, record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Contact, Freedom, Island, Layout
from heuncli.multibody.tree.rows import VariableRow, make_kernel_table
from heuncli.multibody.tree.spanning import SpanningTree
from heuncli.multibody.tree.starts import JointStart
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Pack


@record
class LayoutFrame:
    """A layout without its mechanism, its programs and its tables of loads, of watched values, and of variables.

    The fields are those of Layout; indices as an array, which can be made read-only.
    """

    spanning: SpanningTree
    place: dict[int, int]
    reference: Array
    freedoms: tuple[Freedom, ...]
    rows: tuple[int, ...]
    starts: tuple[JointStart, ...]
    counters: dict[int, int]
    size: float
    y0: Array
    energy_group: int
    weights: Array
    tables: dict[str, Table]
    indices: Array
    velocity_count: int
    column_count: int
    work_at: int
    islands: tuple[Island, ...]
    contacts: tuple[Contact, ...]
    measure: Array
    flat: bool

    def relative(self, body: int, point: Array) -> Array:
        """Return a body's point relative to its joint point, body axes; a ground point is returned unchanged."""
        return point if body == GROUND else point - self.reference[self.place[body]]

    def in_tree(self, body: int) -> int:
        """Return a body's index in the tree."""
        return body if body == GROUND else self.place[body]


def make_frame(layout: Layout) -> LayoutFrame:
    """Return the part of a layout that does not depend on loads."""
    values = {name: getattr(layout, name) for name in LayoutFrame.__annotations__}
    return LayoutFrame(**values | {"indices": np.array(layout.indices)})


def make_layout(frame: LayoutFrame, mechanism: Mechanism, pack: Pack, loads: dict[str, Table]) -> Layout:
    """Make a layout from a frame; pack: the programs; loads: the tables that a frame does not have."""
    values = fields(frame) | {"indices": array("i", frame.indices.tobytes()), "tables": frame.tables | loads}
    return Layout(mechanism=mechanism, pack=pack, **values)


def remove_loads(layout: Layout) -> Layout:
    """Return a layout with the tables of a scene without loads and watched conditions."""
    return replace(layout, tables=layout.tables | empty_load_tables())


@cache
def empty_load_tables() -> dict[str, Table]:
    """Return the tables that a frame does not have, for a scene without loads: the time is a variable of all of
    them.
    """
    return {
        "loads": make_kernel_table(kernel.Load, []),
        "variables": make_kernel_table(kernel.Variable, [VariableRow()]),
        "watches": make_kernel_table(kernel.Watch, []),
    }
