"""What of a layout hangs on no value of a load: the tree, its rows, the start."""

from __future__ import annotations

from array import array
from functools import cache

import numpy as np

from heuncli.base.records import fields, record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Contact, Freedom, Island, Layout
from heuncli.multibody.tree.rows import VariableRow, table_of
from heuncli.multibody.tree.spanning import Spanning
from heuncli.multibody.tree.starts import JointStart
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Pack


@record
class LayoutFrame:
    """A layout without its mechanism, its programs and its tables of loads, of what is watched, and of variables.

    The fields are those of Layout; indices as an array, which can be locked.
    """

    spanning: Spanning
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
    answer_count: int
    column_count: int
    work_at: int
    islands: tuple[Island, ...]
    contacts: tuple[Contact, ...]
    measure: Array
    flat: bool

    def relative(self, body: int, point: Array) -> Array:
        """A body's point from its joint point, body axes; a ground point as it is."""
        return point if body == GROUND else point - self.reference[self.place[body]]

    def in_tree(self, body: int) -> int:
        """A body's place in the tree."""
        return body if body == GROUND else self.place[body]


def frame_of(layout: Layout) -> LayoutFrame:
    """What stands of a layout without loads."""
    own = {name: getattr(layout, name) for name in LayoutFrame.__annotations__}
    return LayoutFrame(**own | {"indices": np.array(layout.indices)})


def layout_of(frame: LayoutFrame, mechanism: Mechanism, pack: Pack, loads: dict[str, Table]) -> Layout:
    """A layout of a frame; pack: the programs; loads: the tables that a frame is without."""
    own = fields(frame) | {"indices": array("i", frame.indices.tobytes()), "tables": frame.tables | loads}
    return Layout(mechanism=mechanism, pack=pack, **own)


def without_loads(layout: Layout) -> Layout:
    """A layout with the tables of a scene to which no load is applied, and in which no condition is watched."""
    return replace(layout, tables=layout.tables | no_loads())


@cache
def no_loads() -> dict[str, Table]:
    """Tables that a frame is without, of a scene without loads: the time is a variable of all of them."""
    return {
        "loads": table_of(kernel.Load, []),
        "variables": table_of(kernel.Variable, [VariableRow()]),
        "watches": table_of(kernel.Watch, []),
    }
