"""A scene whose numbers are all moved by rounding, each for itself: what two of them differ in is not known.

Masses, springs, lengths, directions and the constants of expressions are known no better than they are typed and were
computed with. What cancels between them, inside a law or between laws, shows in such scenes by its terms.
"""

from __future__ import annotations

from array import array

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.motion.linearisation.displacements import displaced
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array

# Of each number of a table by what it is moved: by its own size, of a vector the largest ...
OWN = {
    "bodies": ("mass", "inertia"), "loads": ("vector", "stiffness", "length", "factor", "offset"),
    "closures": ("length",), "freedoms": (),
}  # fmt: skip
# ... by the scene's size: places in bodies ...
PLACES = {"bodies": ("joint_in_parent",), "loads": ("p", "q"), "closures": ("p", "q"), "freedoms": ()}
# ... or by 1: directions
DIRECTIONS = {
    "bodies": ("frame",),
    "loads": ("axis", "across", "mark"),
    "closures": ("e", "g"),
    "freedoms": ("direction",),
}


class Rounding:
    """A source of roundings, the same for the same number."""

    def __init__(self, number: int) -> None:
        self.rng = np.random.default_rng(number)

    def of(self, count: int) -> Array:
        """Some numbers of the size of rounding, none of them near zero, (count,)."""
        x = self.rng.uniform(-1.0, 1.0, count)
        return np.asarray(tolerances.START_ROUNDING * 0.5 * (x + np.sign(x)))


def rounded_scene(layout: Layout, number: int) -> Layout:
    """A scene like this one but for rounding; number: which."""
    source = Rounding(number)
    tables = {name: table.copy() for name, table in layout.tables.items()}
    for name, table in tables.items():
        if name in OWN and len(table):
            move(table, name, layout, source)
    gravity = layout.mechanism.gravity
    by = source.of(3) * np.abs(gravity).max()
    if layout.flat:
        by[2] = 0.0
    constants = np.array(layout.pack.constants)
    pack = layout.pack.with_constants(array("d", constants * (1.0 + source.of(len(constants)))))
    return replace(layout, tables=tables, pack=pack, mechanism=replace(layout.mechanism, gravity=gravity + by))


def move(table: Table, name: str, layout: Layout, source: Rounding) -> None:
    """Move the numbers of a table, in place."""
    for field in OWN[name]:
        add(table, field, largest(table, field), layout.flat, source)
    for field in PLACES[name]:
        add(table, field, np.full(len(table), layout.size), layout.flat, source)
    for field in DIRECTIONS[name]:
        if not (layout.flat and field == "frame"):
            add(table, field, largest(table, field), layout.flat, source)
    if name == "bodies":
        add(table, "first_moment", table["mass"] * layout.size, layout.flat, source)


def largest(table: Table, field: str) -> Array:
    """The size of the numbers of a field, (rows,)."""
    column = table[field]
    parts = [column[part] for part in column.dtype.names] if column.dtype.names else [column]
    return np.asarray(np.abs(np.array(parts)).max(axis=0))


def add(table: Table, field: str, sizes: Array, flat: bool, source: Rounding) -> None:
    """Move a field's numbers by rounding of a size each, in place; of vectors in a flat scene x and y."""
    column = table[field]
    if not column.dtype.names:
        column += sizes * source.of(len(table))
        return
    across = flat and "z" in column.dtype.names and len(column.dtype.names) == 3
    upright = (
        (column["x"] == 0.0) & (column["y"] == 0.0) & (column["z"] != 0.0) if across else np.zeros(len(table), bool)
    )
    for part in column.dtype.names:
        if across and part == "z":
            continue
        column[part] += np.where(upright, 0.0, sizes * source.of(len(table)))


def rounded_state(layout: Layout, state: Array, number: int) -> Array:
    """A state displaced by the rounding of its coordinates, (n_state,)."""
    place = places_of_rates(layout)
    weights = layout.weights[place[place >= 0]]
    large = np.ones(len(weights))
    order = {at: k for k, at in enumerate(place[place >= 0].tolist())}
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            k = order[int(freedom["u_at"])]
            large[k] = max(1.0, abs(state[freedom["q_at"]]) * weights[k])
    by = Rounding(number).of(len(weights)) * large / weights
    return displaced(layout, state, by)
