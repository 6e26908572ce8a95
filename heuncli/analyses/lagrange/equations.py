"""Lagrange's equations at an instant: e q'' + C = k + Q, with what makes each term (no. 18, 19; (29) to (39)).

    x = sum x_i q_i', w = sum w_i q_i'            partials of the velocities, (29), (30)
    e_ij = sum m x_i . x_j + w_i . I w_j          E = q' e q' / 2,   p = e q' (35),   n = e^-1,   F = p n p / 2
    C_i = sum m x_i . x.. + w_i . (I w. + w x I w)    of the accelerations at q'' = 0, e q'' taken off: (37)
    k_i = sum k . x_P,i + M . w_i                 (34), by cause
C is quadratic in the rates: C(q') = G q' with 2 G e_k = C(q' + e_k) - C(q') - C(e_k), and
gamma^(i)_lk = (C_i(e_l + e_k) - C_i(e_l) - C_i(e_k)) / 2, by the same answers of the kernel at other rates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import Chosen, accelerations
from heuncli.analyses.lagrange.freed import FreedScene
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.shares import GRAVITY, MOTION
from heuncli.motion.integration.evaluator import CAUSES, Recovered
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.results.results import Array


@record
class Partials:
    """What the rates of the coordinates make of the bodies' velocities, order of the spec, world axes.

    turn (n, 3, f): of the angular velocities; shift (n, 3, f): of the centres of mass; centres (n, 3) [m].
    """

    turn: Array
    shift: Array
    centres: Array

    def at(self, body: int, position: Array) -> Array:
        """Of the point of a body that is at a world position, (3, f); of the ground 0."""
        if body == GROUND:
            return np.zeros(self.shift.shape[1:])
        arm = position - self.centres[body]
        return np.asarray(self.shift[body] + np.cross(self.turn[body], arm, axis=0))

    def turning(self, body: int) -> Array:
        """Of a body's angular velocity, (3, f); of the ground 0."""
        return np.zeros(self.turn.shape[1:]) if body == GROUND else self.turn[body]

    def work(self, action: Action) -> Array:
        """The generalised force (f,) of an action at the first of its instants."""
        k = np.zeros(self.turn.shape[2])
        for end, force, moment in action.on_bodies():
            k = k + force[0] @ self.at(end.body, end.position[0]) + moment[0] @ self.turning(end.body)
        return k


def partials_of(layout: Layout, found: Linearised, S: Array) -> Partials:
    """The partials of all bodies by the coordinates."""
    order = [layout.place[i] for i in range(len(layout.mechanism.bodies))]
    twists = found.twists[order] @ S
    return Partials(twists[:, :3], twists[:, 3:], found.centres[order])


def reciprocal(names: Sequence[str], epsilon: Array) -> Array:
    """n = e^-1. Raises SolveError [no-inertia] where a motion has no inertia."""
    try:
        L = np.linalg.cholesky(epsilon)
    except np.linalg.LinAlgError:
        _, V = np.linalg.eigh(epsilon)
        name = names[int(np.argmax(np.abs(V[:, 0])))]
        message = f"{name} moves without inertia: no acceleration follows from a force along it"
        raise SolveError(Problem("no-inertia", message, hint="give the bodies that it moves a mass")) from None
    half = np.linalg.inv(L)
    return np.asarray(half.T @ half)


@record
class VelocityTerms:
    """C at given rates, and what answers it: the freed scene with only its velocity terms at work."""

    freed: FreedScene
    chosen: Chosen
    partials: Partials
    epsilon: Array
    t: float
    state: Array
    holding: Array

    def at(self, rates: Array) -> Array:
        """C (m, f) at rates of the coordinates (m, f), at the state's place."""
        layout = self.freed.layout
        place = places_of_rates(layout)
        states = np.repeat(self.state[None, :], len(rates), axis=0)
        states[:, place[place >= 0]] = rates @ self.chosen.S.T
        times = np.full(len(rates), self.t)
        answered = self.freed.runner.recovered(times, states, causes=True, holding=self.holding)
        moved = motion_alone(layout, answered)
        force, moment = inertia_loads(layout.mechanism, moved)
        along = np.einsum("tni,nif->tf", force, self.partials.shift) + np.einsum(
            "tni,nif->tf", moment, self.partials.turn
        )
        return np.asarray(along - accelerations(layout, self.chosen.names, moved) @ self.epsilon)

    def coriolis_matrix(self, rates: Array) -> Array:
        """G (f, f) with C = G q', and the rate of e less 2 G antisymmetric; rates (f,)."""
        f = len(rates)
        unit = np.eye(f) * max(float(np.abs(rates).max(initial=0.0)), 1.0)
        C = self.at(np.vstack([rates, rates + unit, unit]))
        return np.asarray(0.5 * (C[1 : f + 1] - C[0] - C[f + 1 :]).T / unit[0, 0])

    def christoffel(self) -> Array:
        """gamma[i, l, k], the symbols of the first kind."""
        f = len(self.epsilon)
        pairs = [(l, k) for l in range(f) for k in range(l, f)]
        unit = np.eye(f)
        C = self.at(np.array([unit[l] + unit[k] for l, k in pairs]))
        twice = {pair: C[n] for n, pair in enumerate(pairs)}  # C(2 e_l) = 4 C(e_l)
        gamma = np.zeros((f, f, f))
        for (l, k), value in twice.items():
            both = 0.25 * (twice[l, l] + twice[k, k])
            gamma[:, l, k] = gamma[:, k, l] = 0.25 * value if l == k else 0.5 * (value - both)
        return gamma


def motion_alone(layout: Layout, answered: Recovered) -> BodyStates:
    """The bodies' motion with the accelerations that the velocities alone ask for, without loads or drives."""
    assert answered.causes is not None, "recovered without causes"
    column = len(layout.tables["loads"]) + CAUSES.index(MOTION)
    bodies = answered.bodies.copy()
    own = answered.causes.bodies[:, column]
    bodies["alpha"] = own["alpha"]
    bodies["a"] = own["a"] - layout.mechanism.gravity  # told less g
    return body_states(layout, replace(answered, bodies=bodies))


def forces_by_cause(layout: Layout, partials: Partials, actions: Sequence[Action]) -> dict[str, Array]:
    """k (f,) of each cause: of weight, and of the applied loads by their names."""
    mechanism = layout.mechanism
    weight = np.array([body.mass for body in mechanism.bodies])[:, None] * mechanism.gravity
    k = {GRAVITY: np.einsum("ni,nif->f", weight, partials.shift)} if mechanism.gravity.any() else {}
    for action in actions:
        k[action.name] = k.get(action.name, 0.0) + partials.work(action)
    return k


def size_of_terms(layout: Layout, partials: Partials, actions: Sequence[Action], states: BodyStates) -> Array:
    """Of what size the parts are whose sums the terms of the equations are, (f,): |F| |x_P,i| + |M| |w_i| of each."""
    mechanism = layout.mechanism
    weight = np.array([body.mass for body in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = (norms(part[0], 1) for part in inertia_loads(mechanism, states))
    size = (norms(weight, 1) + force) @ norms(partials.shift, 1) + moment @ norms(partials.turn, 1)
    for action in actions:
        for end, F, M in action.on_bodies():
            size = size + norms(F[0], 0) * norms(partials.at(end.body, end.position[0]), 0)
            size = size + norms(M[0], 0) * norms(partials.turning(end.body), 0)
    return np.asarray(size)


def norms(vectors: Array, axis: int) -> Array:
    """Magnitudes of vectors along an axis."""
    return np.asarray(np.sqrt(np.sum(vectors**2, axis=axis)))
