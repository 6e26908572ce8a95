"""Reduce the linear equations to what closures leave free, in coordinates that are orthonormal in the mass matrix.

    dq = T x,   du = T z + S x                  T' M T = 1;  S: rates that the closures need where they move
    x' = A11 x + z,   z' = A21 x + A22 z        at rest A11 = 0, A21 = -K, A22 = -C of  x'' + C x' + K x = 0

A body on a ball joint is seen from a frame that turns with its parent, at the parent's angular velocity W: small
rotations about axes of that frame change by du + (w - W) x turn, and rates by da - W x du. So with drives that turn
steadily the equations keep constant coefficients: T' M of the kernel's derivatives are stiffness, damping and
gyroscopic terms.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares, split_null_space
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_matrix


@record
class ReducedEquations:
    """The equations of f free motions, and T (n, f) that maps them to the freedoms of the tree."""

    tangent: Array
    drift: Array  # S (n, f)
    mass: Array  # (n, n) of the tree
    A11: Array
    A21: Array
    A22: Array
    remaining_acceleration: Array  # (f,) accelerations left at the state itself
    load_scale: float  # magnitude of the terms of that sum
    stiffness_scale: float  # magnitude of the terms of the stiffness

    @property
    def count(self) -> int:
        """Number of free motions."""
        return int(self.tangent.shape[1])

    @property
    def stiffness(self) -> Array:
        """K: resistance to a constant displacement, per unit mass; includes A22 A11 where closures move."""
        return np.asarray(self.A22 @ self.A11 - self.A21)


def reduce_equations(scene: PreparedScene, linear: LinearisedEquations, evaluation: Evaluation) -> ReducedEquations:
    """Reduce the equations to what is free and has inertia; scene: bodies may have massless spins; evaluation: loads
    there.
    """
    massless_spins = find_massless_spins(scene, linear)
    massive = find_orthogonal_complement(np.array([spin.tangent for spin in massless_spins]), linear.tangent.shape[1])
    T = linear.tangent @ massive
    try:
        normalisation = np.linalg.inv(np.linalg.cholesky(T.T @ linear.mass @ T)).T
    except np.linalg.LinAlgError:
        message = "the inertias of some motions are so small compared with others that rounding hides them"
        hint = "check the largest and smallest masses and lengths; leave out or weld negligible bodies"
        raise SolveError(Problem("mass-ratios", message, hint=hint)) from None
    T, S = T @ normalisation, linear.drift @ massive @ normalisation
    for spin in massless_spins:
        S = S - np.outer(linear.tangent @ spin.tangent, spin.rate_change(linear, T))
    return project_equations(scene.layout, linear, evaluation, T, S)


def project_equations(
    layout: Layout, linear: LinearisedEquations, evaluation: Evaluation, T: Array, S: Array
) -> ReducedEquations:
    """Return the equations on displacements T that are orthonormal in the mass matrix, and the rates S that these
    need.
    """
    spin, frame = find_ball_rotations(layout, linear)
    P = T.T @ linear.mass
    slow = linear.by_rate - frame
    A11 = P @ (S + (spin - frame) @ T)
    loads, terms = find_scales(layout, linear, evaluation, T)
    return ReducedEquations(
        tangent=T,
        drift=S,
        mass=linear.mass,
        A11=A11,
        A21=P @ (linear.by_place @ T + slow @ S) - P @ S @ A11,
        A22=P @ slow @ T - P @ S,
        remaining_acceleration=P @ (linear.accelerations - frame @ find_ball_rates(layout, linear)),
        load_scale=loads,
        stiffness_scale=terms,
    )


def find_scales(layout: Layout, linear: LinearisedEquations, evaluation: Evaluation, T: Array) -> tuple[float, float]:
    """Return the magnitudes of the terms of the loads along the motions, and of their stiffness.

    The loads on a body and in its joint, F and M, act along a motion x by F |shift| + M |turn|. They change, as the
    body turns with it, by F |turn| |shift| + M |turn|^2; spins W add W^2. Inertia loads of steady motion count as
    loads: they cancel there, for free bodies against nothing else.
    """
    twists = linear.twists @ T
    turn, shift = (np.sqrt(np.sum(part**2, axis=1)) for part in (twists[:, :3], twists[:, 3:]))
    shift = shift + turn * linear.arms[:, None]
    force, moment = (
        np.sqrt(np.sum(evaluation.bodies[name][0] ** 2, axis=1)) for name in ("joint_force", "joint_moment")
    )
    force = force + layout.bodies["mass"] * float(np.sqrt(np.sum(layout.mechanism.gravity**2)))
    applied_force, applied_moment = (
        np.sqrt(np.sum(evaluation.loads[name][0] ** 2, axis=1)).sum() for name in ("force", "moment")
    )
    force, moment = force + applied_force, moment + applied_moment
    inertia_force, inertia_moment = bound_inertia_loads(layout, linear)
    load_scale = float(np.max((force + inertia_force) @ shift + (moment + inertia_moment) @ turn, initial=0.0))
    spins = float(np.sum(linear.omega**2, axis=1).max(initial=0.0))
    return load_scale, float(np.max(force @ (turn * shift) + moment @ turn**2, initial=0.0)) + spins


def bound_inertia_loads(layout: Layout, linear: LinearisedEquations) -> tuple[Array, Array]:
    """Bound the inertia loads from the rates alone, tree order: forces (n_b,) [N], moments (n_b,) [N m].

    The acceleration of a centre is at most W |v| + W^2 arm, W the fastest rotation of the bodies that carry it.
    """
    bodies = layout.mechanism.bodies
    mass = np.array([bodies[link.body].mass for link in layout.spanning.links])
    inertia = np.array([np.abs(bodies[link.body].inertia).sum() for link in layout.spanning.links])
    spin = np.sqrt(np.sum(linear.omega**2, axis=1))
    speed = np.sqrt(np.sum(linear.velocities**2, axis=1))
    parent_spin = np.zeros(len(spin))
    for k, parent in enumerate(layout.bodies["parent"].tolist()):  # a parent comes before its children
        if parent >= 0:
            parent_spin[k] = max(parent_spin[parent], spin[parent])
    return mass * (parent_spin * speed + spin**2 * linear.arms), inertia * spin**2


def find_ball_rotations(layout: Layout, linear: LinearisedEquations) -> tuple[Array, Array]:
    """Return w x and W x for the rotations of ball joints, (n, n): of the bodies themselves, and of their parents."""
    spin, frame = np.zeros(linear.mass.shape), np.zeros(linear.mass.shape)
    for first, body_rate, parent_rate in list_balls(layout, linear):
        turns = slice(first, first + 3)
        spin[turns, turns], frame[turns, turns] = cross_matrix(body_rate), cross_matrix(parent_rate)
    return spin, frame


def find_ball_rates(layout: Layout, linear: LinearisedEquations) -> Array:
    """Return the angular velocities of bodies on ball joints at the places of their rotations, (n,)."""
    rates = np.zeros(len(linear.accelerations))
    for first, body_rate, _ in list_balls(layout, linear):
        rates[first : first + 3] = body_rate
    return rates


def list_balls(layout: Layout, linear: LinearisedEquations) -> list[tuple[int, Array, Array]]:
    """Return for each body on a ball joint its first rotation, and the angular velocities of it and of its parent."""
    place = rate_indices(layout)
    order = {index: k for k, index in enumerate(place[place >= 0].tolist())}
    no_rate = np.zeros(3)
    return [
        (order[int(body["rate_at"])], linear.omega[k], linear.omega[body["parent"]] if body["parent"] >= 0 else no_rate)
        for k, body in enumerate(layout.bodies)
        if body["ball"]
    ]


@record
class MasslessSpin:
    """The spin of a body about an axis n (3,) without inertia.

    tangent (f,): the free motion that moves nothing else

    It is not part of the motion, because its frequency would be unbounded. The artificial inertia has no spin and keeps
    none: the rate w . n stays, also where n is tilted.
    """

    body: int
    axis: Array
    tangent: Array

    def rate_change(self, linear: LinearisedEquations, T: Array) -> Array:
        """Return the change of the rate by displacements T if w stayed: w . (turn x n), (f,)."""
        turn = linear.twists[self.body, :3] @ T
        return np.asarray(np.cross(self.axis, linear.omega[self.body]) @ turn)


def find_massless_spins(scene: PreparedScene, linear: LinearisedEquations) -> list[MasslessSpin]:
    """Return the spins that no inertia resists and nothing turns."""
    f = linear.tangent.shape[1]
    if not (f and scene.idle_spins):
        return []
    twists = (linear.twists @ linear.tangent).reshape(-1, f)
    spins = []
    for spin in scene.idle_spins:
        k = scene.layout.place[spin.body]
        for axis in spin.axes:
            single_spin = np.zeros(linear.twists.shape[:2])
            single_spin[k, :3] = linear.attitudes[k] @ axis
            solution = solve_least_squares(twists, single_spin.ravel())
            if np.abs(twists @ solution - single_spin.ravel()).max() <= tolerances.RANK:  # else a closure holds it
                spins.append(MasslessSpin(k, single_spin[k, :3], solution))
    return spins


def find_orthogonal_complement(rows: Array, f: int) -> Array:
    """Return an orthonormal basis of the complement of some rows (k, f), (f, f - rank)."""
    if not len(rows):
        return np.eye(f)
    return split_null_space(rows / np.sqrt(np.sum(rows**2, axis=1, keepdims=True)), tolerances.RANK)[0]
