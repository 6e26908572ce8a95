"""The kernel's structs as NumPy types: tables whose rows are its memory, and the parts of its flat solutions.

The types follow from the fields of kernel/scene.py. A solution's parts stand in the order in which kernel/solutions.py
writes them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from heuncli.kernel.choose import scene, structs
from heuncli.kernel.choose import scene as kernel
from heuncli.results.results import Array

# Tables

Table = np.ndarray[Any, np.dtype[np.void]]

NUMBERS = {"int": np.dtype(np.intc), "float": np.dtype(np.float64)}
Program = tuple[int, int]  # the program of a value in time: its start in the pack, its length
NO_PROGRAM: Program = (0, 0)
ZERO = (0.0, 0.0, 0.0)
Vector = Array | Sequence[float]
FieldValue = int | float | Program | Vector


@cache
def struct_dtype(struct: type[structs.Struct]) -> np.dtype[np.void]:
    """Return the NumPy type of a struct of numbers and of structs that `kernel/scene.py` defines."""
    known = vars(scene)
    fields = [
        (name, NUMBERS[k] if k in NUMBERS else struct_dtype(known[k])) for name, k in struct.__annotations__.items()
    ]
    return np.dtype(fields, align=True)


def make_table(record: type[structs.Record], rows: Sequence[structs.Record]) -> Table:
    """Make a table of rows; fields that a row does not give are zero, or set by the kernel."""
    made_table: Table = np.zeros(len(rows), struct_dtype(record))
    given_fields = [row.collect_fields() for row in rows]
    for name in dict.fromkeys(name for given in given_fields for name in given):
        which = [i for i, given in enumerate(given_fields) if name in given]
        column = made_table[name].view(flat_dtype(made_table.dtype[name]))
        column[which if len(which) < len(rows) else slice(None)] = [given_fields[i][name] for i in which]
    return made_table


@cache
def flat_dtype(kind: np.dtype[Any]) -> np.dtype[Any]:
    """Return the type of a struct as a row of the numbers in it, all of one type; a number keeps its type."""
    if not kind.names:
        return kind
    parts = [flat_dtype(kind[name]) for name in kind.names]
    (number,) = {part.base for part in parts}
    return np.dtype((number, (sum(part.itemsize for part in parts) // number.itemsize,)))


def to_sym3(J: Array) -> tuple[float, ...]:
    """Return a symmetric matrix as Sym3."""
    return J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2]


def vector_array(column: Table) -> Array:
    """Return a column of Vec3 as an array (n, 3)."""
    return np.stack([column["x"], column["y"], column["z"]], axis=-1)


def _solution_dtype(vectors: str, numbers: str = "") -> np.dtype[np.void]:
    parts: list[tuple[str, Any, Any]] = [(v, np.float64, (3, 3) if v == "R" else (3,)) for v in vectors.split()]
    return np.dtype([*parts, *((n, np.float64, ()) for n in numbers.split())])


# The parts of the solution at a state, in their order.
#
# bodies: world axes; r, v, a (less g), joint_moment: of and about the body's joint point; joint loads ON the body
# loads: force, moment ON b, at the point `at` of b; `from_at`: its counterpart on a; strain: of a bushing, in its axes;
#     reserve: what a friction that sticks could take more
# rows: f, m ON b for a multiplier of 1, about the `to` point; closed: whether it takes part, as contacts do that are
#     not open; rate, acceleration: of its gap; terms: the size of those that its acceleration is the sum of
# parts: f, m ON b for the row's multiplier of 1, about Q; on_a, on_b: where they enter the bodies
SOLUTION_PARTS = {
    "bodies": _solution_dtype("R r omega v alpha a joint_moment joint_force"),
    "freedoms": _solution_dtype("", "q u udot drive"),
    "loads": _solution_dtype(
        "force moment at from_at strain", "value span rate power reserve potential friction_outcome"
    ),
    "rows": _solution_dtype("f m", "multiplier doubt gap chosen closed rate acceleration terms"),
    "parts": _solution_dtype("f m Q on_a on_b", "gap"),
    "whole": _solution_dtype("", "gap idle pivot residual"),
}
# The parts of one column: loads, one cause, or an impact (jumps of velocities, impulses of the joints); multipliers
# follow.
COLUMN_PARTS = {
    "bodies": _solution_dtype("alpha a joint_moment joint_force"),
    "freedoms": _solution_dtype("", "udot drive"),
}


def split_parts(flat: Array, sizes: Iterable[tuple[np.dtype[np.void], int]]) -> list[Table]:
    """Split rows of numbers (n_t, width) into tables (n_t, n), one after the other; joined without copying where
    possible.
    """
    tables, column = [], 0
    for kind, count in sizes:
        end = column + count * (kind.itemsize // 8)
        block = np.ascontiguousarray(flat[:, column:end])
        tables.append(block.view(kind) if count else np.zeros((len(flat), 0), kind))
        column = end
    return tables


def limits_table(values: Mapping[str, float]) -> Table:
    """Return the kernel's thresholds as its table of one row, which all scenes share; it is read-only."""
    return _limits(tuple(values.items()))


@cache
def _limits(values: tuple[tuple[str, float], ...]) -> Table:
    made = make_table(scene.Limits, [scene.Limits(**dict(values))])
    made.flags.writeable = False
    return made


# Flat

TILTS = {"xz": 0.0, "yz": 0.0, "zx": 0.0, "zy": 0.0, "zz": 1.0}  # the entries that all rotation matrices about z share


def moves_in_plane(bodies: Table, freedoms: Table) -> bool:
    """Return whether all bodies only turn about z and shift across it, exactly and at all times.

    Then velocities have three numbers, and components normal to the plane do no work: heights of points, products of
    inertia with z and forces along z load joints and move nothing.
    """
    directions, shifts = freedoms["direction"], freedoms["kind"] == kernel.SHIFT
    upright = all(bool(np.all(bodies["frame"][part] == value)) for part, value in TILTS.items())
    along = np.where(shifts, directions["z"] == 0.0, np.abs(directions["z"]) == 1.0)
    across = shifts | ((directions["x"] == 0.0) & (directions["y"] == 0.0))
    return upright and not bodies["ball"].any() and bool(np.all(along & across))


def remove_tilt(R: Array) -> Array:
    """Remove the tilt of an attitude, which is rounding in a scene declared planar."""
    c, s = float(R[0, 0] + R[1, 1]), float(R[1, 0] - R[0, 1])
    length = math.hypot(c, s)
    c, s = c / length, s / length
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def remove_direction_tilt(kind: int, direction: Array) -> Array:
    """Remove the rounding tilt of a freedom's direction (3,): along z for a rotation, normal to z for a shift."""
    if kind != kernel.SHIFT:
        return np.array([0.0, 0.0, math.copysign(1.0, direction[2])])
    return np.array([direction[0], direction[1], 0.0]) / math.hypot(direction[0], direction[1])
