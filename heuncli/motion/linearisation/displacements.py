"""Displace states and perturb scenes: by finite amounts along freedoms, and by rounding.

The displacements of the linear equations are tangent to the finite ones. The difference of two scenes, all numbers of
which are perturbed by rounding independently, is the rounding error: masses, springs, lengths, directions and the
constants of expressions are known no better than typed and computed. What cancels between them, inside a law or between
laws, shows in such scenes by its terms.
"""

from __future__ import annotations

from array import array

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_from_vector, quaternion_product, vector_from_quaternion

# Displacements


def displace(layout: Layout, states: Array, displacement: Array, rates: Array | None = None) -> Array:
    """Displace the undriven freedoms of states (..., n_state) by (..., n), and change their rates by `rates`.

    The order is that of the layout's results. A ball joint is turned by its rotation vector about the world's axes.
    Closures are ignored.
    """
    place = rate_indices(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)  # of each freedom, by where its rate stands
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    undriven = freedoms[freedoms["driven"] == 0]
    displaced_states = np.array(states, dtype=float)
    displaced_states[..., undriven["q_at"]] += displacement[..., number[undriven["u_at"]]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude_index, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        turn = quaternion_from_vector(displacement[..., first : first + 3])
        displaced_states[..., attitude_index : attitude_index + 4] = quaternion_product(
            turn, displaced_states[..., attitude_index : attitude_index + 4]
        )
    if rates is not None:
        displaced_states[..., place] += rates
    return displaced_states


def find_displacement(layout: Layout, state: Array, other: Array) -> Array:
    """Return the displacement (n,) that turns one state (n_state,) into another one; the inverse of displace()."""
    place = rate_indices(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    undriven = freedoms[freedoms["driven"] == 0]
    result = np.zeros(len(place))
    result[number[undriven["u_at"]]] = other[undriven["q_at"]] - state[undriven["q_at"]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude_index, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        conjugate = state[attitude_index : attitude_index + 4] * np.array([1.0, -1.0, -1.0, -1.0])
        result[first : first + 3] = vector_from_quaternion(
            quaternion_product(other[attitude_index : attitude_index + 4], conjugate)
        )
    return result


# Rounded scenes

# The scale of the perturbation of each number of a table: its own size, for a vector the largest component ...
BY_OWN_SIZE = {
    "bodies": ("mass", "inertia"), "loads": ("vector", "stiffness", "length", "factor", "offset"),
    "closures": ("length",), "freedoms": (),
}  # fmt: skip
# ... the scene's size, for positions in bodies ...
BY_SCENE_SIZE = {"bodies": ("joint_in_parent",), "loads": ("p", "q"), "closures": ("p", "q"), "freedoms": ()}
# ... or 1, for directions
BY_ONE = {
    "bodies": ("frame",),
    "loads": ("axis", "mark_a", "mark_b"),
    "closures": ("e", "g"),
    "freedoms": ("direction",),
}


class RoundingSource:
    """A reproducible source of rounding errors: the same seed number gives the same errors."""

    def __init__(self, number: int) -> None:
        self.rng = np.random.default_rng(number)

    def draw(self, count: int) -> Array:
        """Draw numbers of the size of rounding, none of them near zero, (count,)."""
        x = self.rng.uniform(-1.0, 1.0, count)
        return np.asarray(tolerances.START_ROUNDING * 0.5 * (x + np.sign(x)))


def make_rounded_scene(layout: Layout, number: int) -> Layout:
    """Make a scene that differs from this one by rounding; number: which of several."""
    source = RoundingSource(number)
    tables = {name: table.copy() for name, table in layout.tables.items()}
    for name, table in tables.items():
        if name in BY_OWN_SIZE and len(table):
            perturb_table(table, name, layout, source)
    gravity = layout.mechanism.gravity
    gravity_change = source.draw(3) * np.abs(gravity).max()
    if layout.flat:
        gravity_change[2] = 0.0
    constants = np.array(layout.pack.constants)
    pack = layout.pack.with_constants(array("d", constants * (1.0 + source.draw(len(constants)))))
    return replace(
        layout, tables=tables, pack=pack, mechanism=replace(layout.mechanism, gravity=gravity + gravity_change)
    )


def perturb_table(table: Table, name: str, layout: Layout, source: RoundingSource) -> None:
    """Perturb the numbers of a table in place."""
    for field in BY_OWN_SIZE[name]:
        perturb_field(table, field, find_field_magnitude(table, field), layout.flat, source)
    for field in BY_SCENE_SIZE[name]:
        perturb_field(table, field, np.full(len(table), layout.size), layout.flat, source)
    for field in BY_ONE[name]:
        if not (layout.flat and field == "frame"):
            perturb_field(table, field, find_field_magnitude(table, field), layout.flat, source)
    if name == "bodies":
        perturb_field(table, "first_moment", table["mass"] * layout.size, layout.flat, source)


def find_field_magnitude(table: Table, field: str) -> Array:
    """Return the magnitude of the numbers of a field, (rows,)."""
    column = table[field]
    parts = [column[part] for part in column.dtype.names] if column.dtype.names else [column]
    return np.asarray(np.abs(np.array(parts)).max(axis=0))


def perturb_field(table: Table, field: str, sizes: Array, flat: bool, source: RoundingSource) -> None:
    """Perturb a field's numbers in place by rounding of a size each; of vectors in a flat scene only x and y."""
    column = table[field]
    if not column.dtype.names:
        column += sizes * source.draw(len(table))
        return
    keeps_z = flat and "z" in column.dtype.names and len(column.dtype.names) == 3
    is_upright = (
        (column["x"] == 0.0) & (column["y"] == 0.0) & (column["z"] != 0.0) if keeps_z else np.zeros(len(table), bool)
    )
    for part in column.dtype.names:
        if keeps_z and part == "z":
            continue
        column[part] += np.where(is_upright, 0.0, sizes * source.draw(len(table)))


def make_rounded_state(layout: Layout, state: Array, number: int) -> Array:
    """Displace a state by the rounding of its coordinates, (n_state,)."""
    place = rate_indices(layout)
    weights = layout.weights[place[place >= 0]]
    scale = np.ones(len(weights))
    order = {index: k for k, index in enumerate(place[place >= 0].tolist())}
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            k = order[int(freedom["u_at"])]
            scale[k] = max(1.0, abs(state[freedom["q_at"]]) * weights[k])
    displacement = RoundingSource(number).draw(len(weights)) * scale / weights
    return displace(layout, state, displacement)
