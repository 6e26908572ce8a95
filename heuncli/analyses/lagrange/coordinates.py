"""Choose Lagrange's coordinates, and relate their rates to the rates of the tree's freedoms.
    q̇ = C u,   u = T z,   u = S q̇,   S = T (C T)⁻¹
C: rows of the chosen coordinates on the n rates u of the tree. T: the motions that the closed chains admit. Rotations
of balls, and the six rates of a free body, are quasi-velocities: components of angular velocity and of velocity along
the world's axes, which are not rates of any coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinate_rates import RODRIGUES_NAMES, make_rodrigues_rows
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS, is_length
from heuncli.base.records import record
from heuncli.base.spelling import suggest
from heuncli.motion.linearisation.linearise import LinearisedEquations, make_coordinate_rows, point_twist
from heuncli.motion.linearisation.reduced_equations import find_massless_spins, find_orthogonal_complement
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

OPTION_WORD = "rodrigues"  # value of --coordinates that selects them
PROBLEM_CODE = "no-coordinate"
NOTHING_FREE_HINT = "free a joint, or drive one: drives are released here"
PIVOT_RATIO = 0.1  # of the largest remaining pivot: the first in the file that reaches this is taken
TRUE_COORDINATES = ("angle", "travel", "length", *RODRIGUES_NAMES)  # coordinates; all others are quasi-velocities


@record
class CoordinateChoice:
    """The chosen coordinates.

    names: joint.quantity of each; is_driven: whether a drive moves it
    rows (f, n), S (n, f): C and S, see above
    left_out: bodies whose spin has no inertia and is left out of the motion
    bodies: all bodies, by name
    """

    names: tuple[str, ...]
    is_driven: tuple[bool, ...]
    rows: Array
    S: Array
    left_out: tuple[str, ...]
    bodies: tuple[str, ...]

    @property
    def is_quasi_velocity(self) -> tuple[bool, ...]:
        """Whether each is a quasi-velocity, that is, has no coordinate."""
        return tuple(
            split_quantity(name) not in TRUE_COORDINATES
            and not (name.rpartition(".")[0] in self.bodies and name[-2] == "d")
            for name in self.names
        )


def split_quantity(name: str) -> str:
    """Return the quantity of joint.quantity."""
    return name.rpartition(".")[2]


def choose_coordinates(
    scene: PreparedScene,
    linear_equations: LinearisedEquations,
    driven: Mapping[str, str],
    requested: Sequence[str] = (),
) -> CoordinateChoice:
    """Choose as many coordinates as there are free motions: the requested ones; else driven ones, those that
    expressions use, then others.

    driven: coordinates that drives moved before the scene was freed

    Raises SolveError [no-coordinate].
    """
    layout = scene.layout
    by_rodrigues = tuple(requested) == (OPTION_WORD,)
    requested = () if by_rodrigues else requested
    rows = (make_rodrigues_rows(layout, linear_equations) if by_rodrigues else {}) | make_candidate_rows(
        layout, linear_equations
    )
    T, left_out = compute_admitted_motions(scene, linear_equations)
    if not T.shape[1]:
        raise SolveError(
            Problem(PROBLEM_CODE, "nothing is free to move: there are no coordinates", hint=NOTHING_FREE_HINT)
        )
    require_known(requested, rows)
    factors = {name: 1.0 / layout.size if is_length(name) else 1.0 for name in rows}
    scaled = {name: factors[name] * row @ T for name, row in rows.items()}
    names = list(requested) or select_independent(scaled, group_coordinates(layout, rows, driven), T.shape[1])
    bodies = tuple(body.name for body in layout.mechanism.bodies)
    C = np.array([rows[name] for name in names]).reshape(len(names), -1)
    require_independent(names, np.array([scaled[name] for name in names]), T.shape[1], scaled)
    return CoordinateChoice(
        names=tuple(names),
        is_driven=tuple(name in driven for name in names),
        rows=C,
        S=T @ np.linalg.inv(C @ T),
        left_out=left_out,
        bodies=bodies,
    )


def compute_admitted_motions(
    scene: PreparedScene, linear_equations: LinearisedEquations
) -> tuple[Array, tuple[str, ...]]:
    """Return the motions that the closed chains admit, (n, f), without massless spins, and the bodies that have these.

    Such a spin w . n stays as it is, whatever else moves.
    """
    massless_spins = find_massless_spins(scene, linear_equations)
    T = linear_equations.tangent @ find_orthogonal_complement(
        np.array([spin.tangent for spin in massless_spins]), linear_equations.tangent.shape[1]
    )
    for spin in massless_spins:
        T = T - np.outer(
            linear_equations.tangent @ spin.tangent, spin.axis @ linear_equations.twists[spin.body, :3] @ T
        )
    order = [link.body for link in scene.layout.spanning.links]
    names = dict.fromkeys(scene.mechanism.bodies[order[spin.body]].name for spin in massless_spins)
    return T, tuple(names)


def make_candidate_rows(layout: Layout, linear_equations: LinearisedEquations) -> dict[str, Array]:
    """Return the rows of all coordinates on the rates of the tree, (n,) each; for released rods also that of their
    length.
    """
    rows = make_coordinate_rows(layout, linear_equations)
    for joint in layout.mechanism.joints:
        if JOINTS[joint.kind].keeps_distance and joint.tension_only:
            rows[f"{joint.name}.length"] = make_length_row(layout, linear_equations, joint)
    return rows


def make_length_row(layout: Layout, linear_equations: LinearisedEquations, joint: Joint) -> Array:
    """Return the row of the distance of two points: their relative velocity along the line between them."""
    twist_b, Q = point_twist(layout, linear_equations, joint.b, joint.q, None)
    twist_a, P = point_twist(layout, linear_equations, joint.a, joint.p, None)
    return np.asarray((Q - P) / np.sqrt((Q - P) @ (Q - P)) @ (twist_b[3:] - twist_a[3:]))


def group_coordinates(layout: Layout, rows: Mapping[str, Array], driven: Mapping[str, str]) -> list[list[str]]:
    """Return the coordinates in groups by preference: driven ones, those named in expressions, then in file order."""
    variables = [use for use in layout.pack.variables if not isinstance(use, str)]
    base = {"rate": "angle", "speed": "travel"}
    named = [f"{name}.{base.get(quantity, quantity)}" for name, quantity in variables]
    return [
        [name for name in rows if name in driven],
        [name for name in rows if name in named],
        [name for name in rows if split_quantity(name) in RODRIGUES_NAMES],
        [name for name in rows if split_quantity(name) in TRUE_COORDINATES],
        list(rows),
    ]


def select_independent(scaled_rows: Mapping[str, Array], groups: Sequence[Sequence[str]], count: int) -> list[str]:
    """Select coordinates that describe all motions, group by group.

    From a group, the first in the file is taken whose part independent of those already taken is not small relative to
    the largest.
    """
    taken: list[str] = []
    basis = np.zeros((0, count))
    largest = max(float(np.sqrt(row @ row)) for row in scaled_rows.values())
    for group in groups:
        while len(taken) < count:
            remainders = {
                name: scaled_rows[name] - basis.T @ (basis @ scaled_rows[name]) for name in group if name not in taken
            }
            size = {name: float(np.sqrt(row @ row)) for name, row in remainders.items()}
            largest_remainder = max(size.values(), default=0.0)
            if largest_remainder <= tolerances.RANK * largest:
                break
            name = next(name for name in size if size[name] >= PIVOT_RATIO * largest_remainder)
            taken.append(name)
            row = remainders[name] / size[name]
            basis = np.vstack([basis, row - basis.T @ (basis @ row)])
    return [name for name in scaled_rows if name in taken]


def require_known(requested: Sequence[str], rows: Mapping[str, Array]) -> None:
    """Raise SolveError [no-coordinate] for names that no coordinate has."""
    wrong = [name for name in requested if name not in rows]
    if wrong:
        raise SolveError(
            *(
                Problem(
                    PROBLEM_CODE, f"there is no coordinate {name}", hint=suggest(name, list(rows), "coordinates") or ""
                )
                for name in wrong
            )
        )


def require_independent(names: Sequence[str], rates: Array, count: int, scaled_rows: Mapping[str, Array]) -> None:
    """Raise SolveError [no-coordinate] if there are too many or too few coordinates, or if one is stationary while the
    scene moves.

    rates (names, count): their rates for the free motions
    """
    if len(names) != count or len(set(names)) != len(names):
        phrase = "degree of freedom" if count == 1 else "degrees of freedom"
        message = f"{count} {phrase}, but {len(names)} coordinate{'s' if len(names) != 1 else ''} named"
        raise SolveError(Problem(PROBLEM_CODE, message, hint=f"name {count} of {', '.join(list(scaled_rows)[:8])}"))
    U, s, V = np.linalg.svd(rates)
    if s[-1] * tolerances.COORDINATE_RATIO < max(s[0], find_largest_rate(scaled_rows)):
        along = {name: abs(float(row @ V[-1])) for name, row in scaled_rows.items()}
        moving = max(along, key=lambda name: along[name])
        stationary = names[int(np.argmax(np.abs(U[:, -1])))]
        message = f"{stationary} cannot describe the motion here: it stops while {moving} moves (dead centre)"
        raise SolveError(Problem(PROBLEM_CODE, message, hint=f"use another coordinate: --coordinates {moving}"))


def find_largest_rate(scaled_rows: Mapping[str, Array]) -> float:
    """Return the largest rate of any coordinate for the free motions."""
    return max(float(np.sqrt(row @ row)) for row in scaled_rows.values())
