"""The linear equations on what closures leave free, in coordinates that are orthonormal in the mass matrix.

    dq = T x,   du = T z + S x                  T' M T = 1;  S: what the closures ask of rates where they move
    x' = A11 x + z,   z' = A21 x + A22 z        at rest A11 = 0, A21 = -K, A22 = -C of  x'' + C x' + K x = 0
A body on a ball is seen from a frame that turns with what it hangs on, at its angular velocity W there: small turns
about axes of that frame change by du + (w - W) x turn, and rates by da - W x du. With drives that turn steadily the
equations so keep constant coefficients: T' M of the kernel's derivatives are stiffness, damping and gyroscopic terms.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import hat


@record
class ReducedEquations:
    """The equations of f free motions, and T (n, f) that leads back to the freedoms of the tree."""

    tangent: Array
    drift: Array  # S (n, f)
    mass: Array  # (n, n) of the tree
    A11: Array
    A21: Array
    A22: Array
    pushed: Array  # (f,) accelerations left at the state itself
    loads: float  # of what size the parts are whose sum that is
    terms: float  # and those whose sum the stiffness is

    @property
    def count(self) -> int:
        """How many motions are free."""
        return int(self.tangent.shape[1])

    @property
    def stiffness(self) -> Array:
        """K: what a displacement that stays asks for, per unit mass; A22 A11 where closures move."""
        return np.asarray(self.A22 @ self.A11 - self.A21)


def reduced(scene: PreparedScene, found: Linearised, at: Recovered) -> ReducedEquations:
    """The equations on what is free and has inertia; scene: whose bodies' spins may be idle; at: the loads there."""
    idle = idle_spins(scene, found)
    kept = complement(np.array([spin.along for spin in idle]), found.tangent.shape[1])
    T = found.tangent @ kept
    try:
        back = np.linalg.inv(np.linalg.cholesky(T.T @ found.mass @ T)).T
    except np.linalg.LinAlgError:
        message = "the inertias of some motions are so small beside those of others that rounding hides them"
        hint = "look at the largest and the smallest masses and lengths; leave out, or weld, what hardly matters"
        raise SolveError(Problem("mass-ratios", message, hint=hint)) from None
    T, S = T @ back, found.drift @ kept @ back
    for spin in idle:
        S = S - np.outer(found.tangent @ spin.along, spin.gained(found, T))
    return on_basis(scene.layout, found, at, T, S)


def on_basis(layout: Layout, found: Linearised, at: Recovered, T: Array, S: Array) -> ReducedEquations:
    """The equations on displacements T that are orthonormal in the mass matrix, and the rates S that these need."""
    spin, frame = frames(layout, found)
    P = T.T @ found.mass
    slow = found.by_rate - frame
    A11 = P @ (S + (spin - frame) @ T)
    loads, terms = sizes(layout, found, at, T)
    return ReducedEquations(
        tangent=T,
        drift=S,
        mass=found.mass,
        A11=A11,
        A21=P @ (found.by_place @ T + slow @ S) - P @ S @ A11,
        A22=P @ slow @ T - P @ S,
        pushed=P @ (found.accelerations - frame @ rates_of_balls(layout, found)),
        loads=loads,
        terms=terms,
    )


def sizes(layout: Layout, found: Linearised, at: Recovered, T: Array) -> tuple[float, float]:
    """Of what size the parts are whose sums are the loads along the motions, and their stiffness.

    What stands on a body and in its joint, F and M, acts along a motion x by F |shift| + M |turn|, and changes, as the
    body turns with it, by F |turn| |shift| + M |turn|^2; spins W ask for W^2. Inertia loads of what goes on count as
    loads: they cancel in a steady motion, of free bodies with nothing else.
    """
    twists = found.twists @ T
    turn, shift = (np.sqrt(np.sum(part**2, axis=1)) for part in (twists[:, :3], twists[:, 3:]))
    shift = shift + turn * found.arms[:, None]
    force, moment = (np.sqrt(np.sum(at.bodies[name][0] ** 2, axis=1)) for name in ("joint_force", "joint_moment"))
    force = force + layout.bodies["mass"] * float(np.sqrt(np.sum(layout.mechanism.gravity**2)))
    applied, turning = (np.sqrt(np.sum(at.loads[name][0] ** 2, axis=1)).sum() for name in ("force", "moment"))
    force, moment = force + applied, moment + turning
    inertia_force, inertia_moment = inertia_loads(layout, found)
    along = float(np.max((force + inertia_force) @ shift + (moment + inertia_moment) @ turn, initial=0.0))
    spins = float(np.sum(found.omega**2, axis=1).max(initial=0.0))
    return along, float(np.max(force @ (turn * shift) + moment @ turn**2, initial=0.0)) + spins


def inertia_loads(layout: Layout, found: Linearised) -> tuple[Array, Array]:
    """Bounds of the inertia loads that the rates alone ask for, tree order: forces (n_b,) [N], moments (n_b,) [N m].

    A centre is accelerated by at most W |v| + W^2 arm, W the fastest turn of what carries the body.
    """
    bodies = layout.mechanism.bodies
    mass = np.array([bodies[hang.body].mass for hang in layout.spanning.hangs])
    inertia = np.array([np.abs(bodies[hang.body].inertia).sum() for hang in layout.spanning.hangs])
    spin = np.sqrt(np.sum(found.omega**2, axis=1))
    speed = np.sqrt(np.sum(found.velocities**2, axis=1))
    carrying = np.zeros(len(spin))
    for k, parent in enumerate(layout.bodies["parent"].tolist()):  # a parent stands before what it carries
        if parent >= 0:
            carrying[k] = max(carrying[parent], spin[parent])
    return mass * (carrying * speed + spin**2 * found.arms), inertia * spin**2


def frames(layout: Layout, found: Linearised) -> tuple[Array, Array]:
    """w x and W x of the turns of balls, (n, n): of the bodies themselves, and of what they hang on."""
    spin, frame = np.zeros(found.mass.shape), np.zeros(found.mass.shape)
    for first, own, carrier in balls(layout, found):
        turns = slice(first, first + 3)
        spin[turns, turns], frame[turns, turns] = hat(own), hat(carrier)
    return spin, frame


def rates_of_balls(layout: Layout, found: Linearised) -> Array:
    """The angular velocities of bodies on balls, each where its turns stand, (n,)."""
    rates = np.zeros(len(found.accelerations))
    for first, own, _ in balls(layout, found):
        rates[first : first + 3] = own
    return rates


def balls(layout: Layout, found: Linearised) -> list[tuple[int, Array, Array]]:
    """Of each body on a ball its first turn, and the angular velocities of it and of what it hangs on."""
    place = places_of_rates(layout)
    order = {at: k for k, at in enumerate(place[place >= 0].tolist())}
    still = np.zeros(3)
    return [
        (order[int(body["rate_at"])], found.omega[k], found.omega[body["parent"]] if body["parent"] >= 0 else still)
        for k, body in enumerate(layout.bodies)
        if body["ball"]
    ]


@record
class Idle:
    """The spin of a body about an axis n (3,) without inertia: along (f,) the tangent, which moves nothing else.

    It is no part of the motion, its frequency would be without bound. The inertia that the kernel lends it has no spin,
    and keeps none: the rate w . n stays as it is, also where n is tilted.
    """

    body: int
    axis: Array
    along: Array

    def gained(self, found: Linearised, T: Array) -> Array:
        """What displacements T would make of the rate if w stayed: w . (turn x n), (f,)."""
        turn = found.twists[self.body, :3] @ T
        return np.asarray(np.cross(self.axis, found.omega[self.body]) @ turn)


def idle_spins(scene: PreparedScene, found: Linearised) -> list[Idle]:
    """The spins that no inertia resists and nothing turns."""
    f = found.tangent.shape[1]
    if not (f and scene.idle):
        return []
    twists = (found.twists @ found.tangent).reshape(-1, f)
    idle = []
    for spin in scene.idle:
        k = scene.layout.place[spin.body]
        for axis in spin.axes:
            alone = np.zeros(found.twists.shape[:2])
            alone[k, :3] = found.attitudes[k] @ axis
            along: Array = np.linalg.lstsq(twists, alone.ravel(), rcond=None)[0].astype(float)
            if np.abs(twists @ along - alone.ravel()).max() <= tolerances.RANK:  # else a closure holds it
                idle.append(Idle(k, alone[k, :3], along))
    return idle


def complement(rows: Array, f: int) -> Array:
    """An orthonormal basis of what is left beside some rows (k, f), (f, f - rank)."""
    if not len(rows):
        return np.eye(f)
    _, s, V = np.linalg.svd(rows / np.sqrt(np.sum(rows**2, axis=1, keepdims=True)), full_matrices=True)
    return np.asarray(V[int(np.sum(s > tolerances.RANK)) :].T)
