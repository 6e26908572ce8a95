"""Rules about bushings: tables that cover zero deflection, and matrices that store energy or take it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.scene.expressions.programs import Expression, out_of_range_texts
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import loads
from heuncli.scene.file_format.resolve_loads import is_matrix, make_symmetric_matrix
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

# keys of the blocks of a 6 x 6: displacement, rotation, and force by rotation
STIFFNESS_BLOCKS = "stiffness", "turning", "coupling"
DAMPING_BLOCKS = "damping", "turning_damping", "coupling_damping"
AXES = "xyz"


def iter_bushings(draft: DraftDocument) -> Iterator[tuple[str, fl.BushingEntry]]:
    """Yield the bushings of a document, by name."""
    for name, load in draft.document.forces.items():
        if isinstance(load, fl.BushingEntry):
            yield name, load


def list_tables(laws: object) -> list[Expression]:
    """Return the tables among the values of a stiffness."""
    values = (laws.x, laws.y, laws.z) if isinstance(laws, fl.ShiftLaws | fl.TurnLaws) else laws
    return [law for law in (values if isinstance(values, tuple) else (values,)) if isinstance(law, Expression)]


@rule("bushing-table")
def check_bushing_table(draft: DraftDocument) -> Iterator[Violation]:
    """The tables of a bushing have a value at zero deflection."""
    for name, load in iter_bushings(draft):
        for key in ("stiffness", "turning"):
            for law in list_tables(getattr(load, key)):
                if math.isnan(law.value(0.0, (0.0,))):
                    message, hint = out_of_range_texts(law.tables[0])
                    full_message = f"{key} has no value at zero deflection of the bushing: {message}"
                    yield Violation(("forces", name, key), full_message, hint)


@rule("bushing-matrix")
def check_bushing_matrix(draft: DraftDocument) -> Iterator[Violation]:
    """Matrices of stiffness and damping are symmetric, and each motion costs energy, or none."""
    for name, load in iter_bushings(draft):
        for keys in (STIFFNESS_BLOCKS, DAMPING_BLOCKS):
            given = [key for key in keys if is_matrix(getattr(load, key))]
            if not given:
                continue
            skew = [key for key in given if key not in ("coupling", "coupling_damping")]
            violations = [x for key in skew for x in check_symmetry(("forces", name, key), getattr(load, key))]
            yield from violations or check_energy(name, load, keys)


def check_symmetry(path: tuple[str, ...], matrix: loads.Matrix) -> Iterator[Violation]:
    """Yield the first two elements of a matrix that should be equal and are not."""
    size = max(abs(x) for row in matrix for x in row)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if abs(matrix[i][j] - matrix[j][i]) > tolerances.STIFFNESS_TYPED * size:
            places = f"{AXES[i]}{AXES[j]} and {AXES[j]}{AXES[i]}"
            message = f"{path[-1]} is not symmetric: {places} are {matrix[i][j]:g} and {matrix[j][i]:g}"
            yield Violation((*path, j, i), message, "make them equal: a matrix that is not symmetric has no potential")
            return


def check_energy(name: str, load: fl.BushingEntry, keys: Sequence[str]) -> Iterator[Violation]:
    """Yield the block, of three that are given by `keys`, with which the bushing could drive."""
    shift, turn, coupling = (getattr(load, key) for key in keys)
    for key, block in zip(keys[:2], (shift, turn), strict=True):
        if tables := list_tables(block):
            if coupling is not None:
                message = f"coupling is given, but {key} has the table {tables[0].tables[0].name}"
                yield Violation(("forces", name, keys[2]), message, "coupled directions need numbers")
            return
        if is_matrix(block) and not is_semidefinite(make_symmetric_matrix(block)):
            message = f"{key} is not positive semidefinite: in some direction it would drive"
            hint = "each element off the diagonal is at most the root of the product of its two diagonal elements"
            yield Violation(("forces", name, key), message, hint)
            return
    if coupling is not None and not is_semidefinite(join_blocks(shift, turn, coupling)):
        message = f"with {keys[2]} the matrix of all six directions is not positive semidefinite: it would drive"
        hint = f"give larger {keys[0]} and {keys[1]}, or smaller {keys[2]}: rows for x, y, z of the force, per rotation"
        yield Violation(("forces", name, keys[2]), message, hint)


def join_blocks(shift: object, turn: object, coupling: loads.Matrix) -> list[tuple[float, ...]]:
    """Return the 6 x 6 of displacement and rotation."""
    upper, lower = make_symmetric_matrix(shift), make_symmetric_matrix(turn)
    return [
        *((*own, *by_turn) for own, by_turn in zip(upper, coupling, strict=True)),
        *((*by_shift, *own) for own, by_shift in zip(lower, zip(*coupling, strict=True), strict=True)),
    ]


def is_semidefinite(matrix: Sequence[Sequence[float]]) -> bool:
    """Whether a symmetric matrix has no negative eigenvalue, to STIFFNESS_TYPED: with 1 on its diagonal, and so much
    more, it has a Cholesky factor.
    """
    count = range(len(matrix))
    if any(matrix[i][i] < 0.0 for i in count):
        return False
    if any(matrix[i][i] == 0.0 and any(matrix[i]) for i in count):
        return False
    roots = [math.sqrt(matrix[i][i]) or 1.0 for i in count]
    rest = [[matrix[i][j] / roots[i] / roots[j] for j in count] for i in count]
    for k in count:
        pivot = rest[k][k] + tolerances.STIFFNESS_TYPED
        if pivot <= 0.0:
            return False
        for i in range(k + 1, len(matrix)):
            for j in range(k + 1, len(matrix)):
                rest[i][j] -= rest[i][k] * rest[k][j] / pivot
    return True
