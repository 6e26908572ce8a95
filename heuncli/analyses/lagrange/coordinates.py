"""Lagrange's coordinates: which are chosen, and what their rates make of the rates of the tree's freedoms.

    q' = C u,   u = T z what the closed chains admit,   u = S q',   S = T (C T)^-1
C: the rows of the chosen coordinates on the n rates u of the tree. Turns of balls, and the six rates of a body that no
joint carries, are quasi-velocities: components of angular velocities and of velocities along the world's axes, which
are the rates of no coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.analyses.lagrange import rodrigues
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS, is_length
from heuncli.base.nearest import did_you_mean
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.motion.linearisation.reduced_equations import complement, idle_spins
from heuncli.motion.linearisation.shapes import coordinates as rows_of_scene
from heuncli.motion.linearisation.shapes import twist
from heuncli.multibody.mechanism.model import GROUND, Joint, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows

CODE = "no-coordinate"
IN_FILE_ORDER = 0.1  # of the largest pivot left: the first in the file that has as much is taken
TRUE = ("angle", "travel", "length", *rodrigues.NAMES)  # coordinates; all others are quasi-velocities


@record
class Chosen:
    """The chosen coordinates; names: joint.quantity; driven: of each; rows C (f, n), partials S (n, f)."""

    names: tuple[str, ...]
    driven: tuple[bool, ...]
    rows: Array
    S: Array
    left_out: tuple[str, ...]  # bodies whose spin has no inertia, and is no part of the motion
    bodies: tuple[str, ...]

    @property
    def quasi(self) -> tuple[bool, ...]:
        """Which are quasi-velocities: without a coordinate."""
        return tuple(
            quantity_of(name) not in TRUE and not (name.rpartition(".")[0] in self.bodies and name[-2] == "d")
            for name in self.names
        )


def quantity_of(name: str) -> str:
    """Of joint.quantity."""
    return name.rpartition(".")[2]


def chosen(scene: PreparedScene, found: Linearised, driven: Mapping[str, str], asked: Sequence[str] = ()) -> Chosen:
    """As many coordinates as motions are free: those asked for; else driven ones, those that expressions name, others.

    driven: coordinates that drives had, of the freed scene. Raises SolveError [no-coordinate].
    """
    layout = scene.layout
    by_rodrigues = tuple(asked) == (rodrigues.WORD,)
    asked = () if by_rodrigues else asked
    rows = (rodrigues.rows(layout, found) if by_rodrigues else {}) | candidates(layout, found)
    T, left_out = admitted(scene, found)
    if not T.shape[1]:
        raise SolveError(Problem(CODE, "nothing is free to move: no coordinate tells anything", hint=NOTHING))
    require_known(asked, rows)
    weigh = {name: 1.0 / layout.size if is_length(name) else 1.0 for name in rows}
    scaled = {name: weigh[name] * row @ T for name, row in rows.items()}
    names = list(asked) or picked(scaled, order_of(layout, rows, driven), T.shape[1])
    bodies = tuple(body.name for body in layout.mechanism.bodies)
    C = np.array([rows[name] for name in names]).reshape(len(names), -1)
    require_telling(names, np.array([scaled[name] for name in names]), T.shape[1], scaled)
    return Chosen(tuple(names), tuple(name in driven for name in names), C, T @ np.linalg.inv(C @ T), left_out, bodies)


NOTHING = "leave a joint free, or drive one: drives are freed here"


def admitted(scene: PreparedScene, found: Linearised) -> tuple[Array, tuple[str, ...]]:
    """What the closed chains admit, (n, f), without spins that have no inertia; and the bodies of these.

    Such a spin w . n stays as it is, whatever else moves.
    """
    idle = idle_spins(scene, found)
    T = found.tangent @ complement(np.array([spin.along for spin in idle]), found.tangent.shape[1])
    for spin in idle:
        T = T - np.outer(found.tangent @ spin.along, spin.axis @ found.twists[spin.body, :3] @ T)
    order = [hang.body for hang in scene.layout.spanning.hangs]
    names = dict.fromkeys(scene.mechanism.bodies[order[spin.body]].name for spin in idle)
    return T, tuple(names)


def candidates(layout: Layout, found: Linearised) -> dict[str, Array]:
    """The rows of all coordinates on the rates of the tree, (n,) each; of rods whose length is let go that as well."""
    rows = rows_of_scene(layout, found)
    for joint in layout.mechanism.joints:
        if JOINTS[joint.kind].keeps_distance and joint.tension_only:
            rows[f"{joint.name}.length"] = length_row(layout, found, joint)
    return rows


def length_row(layout: Layout, found: Linearised, joint: Joint) -> Array:
    """What the distance of two points changes by: along the line between them."""
    to, b = twist(layout, found, joint.b, joint.q, None)
    carrier, a = twist(layout, found, joint.a, joint.p, None)
    return np.asarray((b - a) / np.sqrt((b - a) @ (b - a)) @ (to[3:] - carrier[3:]))


def order_of(layout: Layout, rows: Mapping[str, Array], driven: Mapping[str, str]) -> list[list[str]]:
    """The coordinates in groups, those that an engineer would take first: driven, named in expressions, in the file."""
    uses = [use for use in layout.pack.variables if not isinstance(use, str)]
    base = {"rate": "angle", "speed": "travel"}
    named = [f"{name}.{base.get(quantity, quantity)}" for name, quantity in uses]
    return [
        [name for name in rows if name in driven],
        [name for name in rows if name in named],
        [name for name in rows if quantity_of(name) in rodrigues.NAMES],
        [name for name in rows if quantity_of(name) in TRUE],
        list(rows),
    ]


def picked(scaled: Mapping[str, Array], groups: Sequence[Sequence[str]], count: int) -> list[str]:
    """Coordinates that tell all motions, group by group.

    Of a group the first in the file is taken whose part beside what is told already is no small share of the largest.
    """
    taken: list[str] = []
    basis = np.zeros((0, count))
    largest = max(float(np.sqrt(row @ row)) for row in scaled.values())
    for group in groups:
        while len(taken) < count:
            left = {name: scaled[name] - basis.T @ (basis @ scaled[name]) for name in group if name not in taken}
            size = {name: float(np.sqrt(row @ row)) for name, row in left.items()}
            most = max(size.values(), default=0.0)
            if most <= tolerances.RANK * largest:
                break
            name = next(name for name in size if size[name] >= IN_FILE_ORDER * most)
            taken.append(name)
            row = left[name] / size[name]
            basis = np.vstack([basis, row - basis.T @ (basis @ row)])
    return [name for name in scaled if name in taken]


def require_known(asked: Sequence[str], rows: Mapping[str, Array]) -> None:
    """Raise SolveError for names that no coordinate has."""
    wrong = [name for name in asked if name not in rows]
    if wrong:
        raise SolveError(*(
            Problem(CODE, f"no coordinate is called {name}", hint=did_you_mean(name, list(rows), "coordinates") or "")
            for name in wrong
        ))  # fmt: skip


def require_telling(names: Sequence[str], by: Array, count: int, scaled: Mapping[str, Array]) -> None:
    """Raise SolveError where the coordinates are too many, too few, or stand while the scene moves.

    by (names, count): their rates for the motions that are free.
    """
    if len(names) != count or len(set(names)) != len(names):
        few = "motion is" if count == 1 else "motions are"
        message = f"{count} {few} free, and {len(names)} coordinate{'s are' if len(names) != 1 else ' is'} named"
        raise SolveError(Problem(CODE, message, hint=f"name {count} of {', '.join(list(scaled)[:8])}"))
    U, s, V = np.linalg.svd(by)
    if s[-1] * tolerances.TELLING < max(s[0], largest_of(scaled)):
        along = {name: abs(float(row @ V[-1])) for name, row in scaled.items()}
        moves = max(along, key=lambda name: along[name])
        still = names[int(np.argmax(np.abs(U[:, -1])))]
        message = f"{still} cannot tell the motion here: it stands while {moves} moves (dead centre)"
        raise SolveError(Problem(CODE, message, hint=f"take another coordinate: --coordinates {moves}"))


def largest_of(scaled: Mapping[str, Array]) -> float:
    """The largest rate of any coordinate for the motions that are free."""
    return max(float(np.sqrt(row @ row)) for row in scaled.values())


def rates(layout: Layout, names: Sequence[str], states: BodyStates) -> Array:
    """q' of the coordinates, (n_t, f), from the motion of the bodies."""
    return np.stack([_moved(layout, name, states)[0] for name in names], axis=1)


def accelerations(layout: Layout, names: Sequence[str], states: BodyStates) -> Array:
    """q'' of the coordinates, (n_t, f), from the accelerations of the bodies; of quasi-velocities their derivatives."""
    return np.stack([_moved(layout, name, states)[1] for name in names], axis=1)


def _moved(layout: Layout, name: str, states: BodyStates) -> tuple[Array, Array]:
    """Rate and its derivative of one coordinate, (n_t,) each."""
    owner, _, quantity = name.rpartition(".")
    mechanism = layout.mechanism
    joint = next((joint for joint in mechanism.joints if joint.name == owner), None)
    if quantity in rodrigues.NAMES:
        body = next(i for i, own in enumerate(mechanism.bodies) if own.name == owner)
        k = rodrigues.NAMES.index(quantity)
        rate, acceleration = rodrigues.moved(states.R[:, body], states.omega[:, body], states.alpha[:, body], owner)
        return rate[:, k], acceleration[:, k]
    if joint is None:
        return of_body(mechanism, owner, quantity, states)
    if quantity == "length":
        return of_length(joint, states)
    wa, ua = turning(states, joint.a)
    wb, ub = turning(states, joint.b)
    n = states.direction(joint.a, joint.axis)
    if quantity == "angle":
        return dot(n, wb - wa), dot(n, ub - ua)
    if quantity in "xyz":
        k = "xyz".index(quantity)
        return (wb - wa)[:, k], (ub - ua)[:, k]
    Q = states.point_position(joint.b, joint.q)
    v = states.velocity(joint.b, Q) - states.velocity(joint.a, Q)
    a = states.acceleration(joint.b, Q) - states.acceleration(joint.a, Q)
    if quantity == "travel":
        return dot(n, v), dot(n, a - 2.0 * cross_rows(wa, v))
    k = "xyz".index(quantity[1])
    return v[:, k], (a - cross_rows(wa, v))[:, k]  # the place is that of `to`, whose speed past `from` is v


def turning(states: BodyStates, body: int) -> tuple[Array, Array]:
    """Angular velocity and acceleration of a body, or of the ground, (n_t, 3) each."""
    if body == GROUND:
        return np.zeros((len(states.x), 3)), np.zeros((len(states.x), 3))
    return states.omega[:, body], states.alpha[:, body]


def of_body(mechanism: Mechanism, name: str, quantity: str, states: BodyStates) -> tuple[Array, Array]:
    """Of a body that no joint carries: its angular velocity, and the velocity of its centre of mass."""
    body = next(i for i, own in enumerate(mechanism.bodies) if own.name == name)
    k = "xyz".index(quantity[-1])
    if quantity.startswith("d"):
        return states.v_centre[:, body, k], states.a_centre[:, body, k]
    return states.omega[:, body, k], states.alpha[:, body, k]


def length_of(layout: Layout, states: BodyStates, name: str) -> float:
    """The distance of a rod's two points at the first of some instants [m]."""
    joint = next(joint for joint in layout.mechanism.joints if joint.name == name)
    D = states.point_position(joint.b, joint.q)[0] - states.point_position(joint.a, joint.p)[0]
    return float(np.sqrt(D @ D))


def of_length(joint: Joint, states: BodyStates) -> tuple[Array, Array]:
    """Of the distance of two points D: e . v, and e . a + (v^2 - (e . v)^2) / |D|."""
    A, B = states.point_position(joint.a, joint.p), states.point_position(joint.b, joint.q)
    v = states.velocity(joint.b, B) - states.velocity(joint.a, A)
    a = states.acceleration(joint.b, B) - states.acceleration(joint.a, A)
    D = B - A
    length = np.sqrt(dot(D, D))
    e = D / length[:, None]
    return dot(e, v), dot(e, a) + (dot(v, v) - dot(e, v) ** 2) / length


def dot(a: Array, b: Array) -> Array:
    """Of vectors (n_t, 3)."""
    return np.asarray(np.sum(a * b, axis=1))
