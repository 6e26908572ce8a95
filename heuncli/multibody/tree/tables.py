"""The kernel's structs as NumPy types: tables whose rows are its memory, and the parts of its flat answers.

The types follow from the fields of kernel/scene.py; the order of an answer's parts is that in which
kernel/answers.py writes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import numpy as np

from heuncli.kernel.choose import scene, structs
from heuncli.results.results import Array

Table = np.ndarray[Any, np.dtype[np.void]]

NUMBERS = {"int": np.dtype(np.intc), "float": np.dtype(np.float64)}


@cache
def type_of(struct: type[structs.Struct]) -> np.dtype[np.void]:
    """The NumPy type of a struct of numbers and of structs that `kernel/scene.py` knows."""
    known = vars(scene)
    fields = [(name, NUMBERS[k] if k in NUMBERS else type_of(known[k])) for name, k in struct.__annotations__.items()]
    return np.dtype(fields, align=True)


def table(record: type[structs.Record], rows: list[dict[str, Any]]) -> Table:
    """Rows given by field; what a row does not give is zero, or the kernel's own."""
    found: Table = np.zeros(len(rows), type_of(record))
    for name in dict.fromkeys(name for row in rows for name in row):
        which = [i for i, row in enumerate(rows) if name in row]
        column = found[name].view(flat(found.dtype[name]))
        column[which if len(which) < len(rows) else slice(None)] = [rows[i][name] for i in which]
    return found


@cache
def flat(kind: np.dtype[Any]) -> np.dtype[Any]:
    """The type of a struct as a row of the numbers that it is made of, all of one type; of a number its own."""
    if not kind.names:
        return kind
    parts = [flat(kind[name]) for name in kind.names]
    (number,) = {part.base for part in parts}
    return np.dtype((number, (sum(part.itemsize for part in parts) // number.itemsize,)))


def symmetric(J: Array) -> tuple[float, ...]:
    """A symmetric matrix as Sym3."""
    return J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2]


def vectors(column: Table) -> Array:
    """A column of Vec3 as an array (n, 3)."""
    return np.stack([column["x"], column["y"], column["z"]], axis=-1)


def _answer(vectors: str, numbers: str = "") -> np.dtype[np.void]:
    parts: list[tuple[str, Any, Any]] = [(v, np.float64, (3, 3) if v == "R" else (3,)) for v in vectors.split()]
    return np.dtype([*parts, *((n, np.float64, ()) for n in numbers.split())])


# World axes; r, v, a (less g), joint_moment: of and about the body's joint point; joint loads ON the body.
BODY_ANSWER = _answer("R r omega v alpha a joint_moment joint_force")
FREEDOM_ANSWER = _answer("", "q u udot drive")
# force, moment: ON b, at the point `at` of b; `from_at`: its counterpart on a; strain: of a bushing, in its axes.
LOAD_ANSWER = _answer("force moment at from_at strain", "value span rate power potential")
# f, m: ON b for a multiplier of 1, about the `to` point; closed: whether it takes part, as contacts do that are not
# open; rate, acceleration: of its gap; terms: the size of those that its acceleration is the sum of.
CLOSURE_ANSWER = _answer("f m", "multiplier doubt gap chosen closed rate acceleration terms")
# f, m: ON b for the row's multiplier of 1, about Q; on_a, on_b: where they enter the bodies.
PART_ANSWER = _answer("f m Q on_a on_b", "gap")
STATE_ANSWER = _answer("", "gap idle pivot residual")
# Of one column: of loads, of a cause, or of a blow (jumps of velocities, impulses of the joints).
COLUMN_BODY = _answer("alpha a joint_moment joint_force")
COLUMN_FREEDOM = _answer("", "udot drive")


def parts(flat: Array, sizes: Iterable[tuple[np.dtype[np.void], int]]) -> list[Table]:
    """Rows of numbers (n_t, width) as tables (n_t, n), one after the other; joined without copying where possible."""
    found, at = [], 0
    for kind, count in sizes:
        end = at + count * (kind.itemsize // 8)
        block = np.ascontiguousarray(flat[:, at:end])
        found.append(block.view(kind) if count else np.zeros((len(flat), 0), kind))
        at = end
    return found


def limits(values: Mapping[str, float]) -> Table:
    """The kernel's thresholds as its table of one row, which all scenes share: it cannot be written to."""
    return _limits(tuple(values.items()))


@cache
def _limits(values: tuple[tuple[str, float], ...]) -> Table:
    made = table(scene.Limits, [dict(values)])
    made.flags.writeable = False
    return made
