"""Counterweights that leave the least force and moment over a cycle: of each body mass times radius, and its angle.

What a weight does is linear in its moments (candidates.py), of the angles of the cycle alone; the least squares of it
stand in least_squares.py. U stands across the axis that the body turns about.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.balancing.candidates import Candidate, WeightPlace
from heuncli.analyses.balancing.cycle import Cycle
from heuncli.analyses.balancing.effects import mass_effects
from heuncli.analyses.balancing.harmonics import plane_across
from heuncli.analyses.balancing.least_squares import solved
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assembled, properties, pseudo_inertia
from heuncli.scene.shapes.rotations import cross_rows


@record
class Weight:
    """A counterweight in its body's axes: product (3,) = mass · radius, across the axis, from `place`."""

    at: WeightPlace
    product: Array
    mass: float
    radius: float
    angle: float
    first: Array

    @property
    def position(self) -> Array:
        """Where its mass stands, body axes (3,) [m]."""
        size = float(np.sqrt(self.product @ self.product))
        return self.at.place + (self.radius / size) * self.product if size > 0.0 else self.at.place


@record
class Balanced:
    """The weights, and whether others would serve as well; linear: whether one system of equations told them."""

    weights: tuple[Weight, ...]
    several: bool
    linear: bool


def least(cycle: Cycle, places: Sequence[WeightPlace], about: Array, force: float, moment: float) -> Balanced:
    """The weights with the least mean of |force F|² + |moment M|² over the cycle; moment [1/m] counts against force."""
    found = mass_effects(cycle, about)
    weigh = np.repeat([force, moment], 3)
    often = np.sqrt(cycle.nodes.weights * len(cycle.nodes.weights))  # by which the mean of squares is one over rows
    weigh = often[:, None] * weigh
    left = -np.concatenate([found.force.sum(axis=1), found.moment.sum(axis=1)], axis=1) * weigh
    unit = max(force, moment * (cycle.size + float(np.abs(about - cycle.states.centre).max())))
    candidates = [candidate(cycle, place, about, weigh) for place in places]
    linear = [one.is_linear(unit) for one in candidates]
    require_radii([one for one, easy in zip(candidates, linear, strict=True) if not easy])
    U, several = solved(left, candidates, linear, unit)
    weights = tuple(weight(one, own) for one, own in zip(candidates, U, strict=True))
    return Balanced(weights, several, all(linear))


def require_radii(candidates: Sequence[Candidate]) -> None:
    """Raise SolveError where a weight's own mass counts and nobody said how far out it stands."""
    wanting = [one.at.name for one in candidates if one.at.radius is None]
    if wanting:
        raise SolveError(*(
            Problem("radius-needed", f"{name}: what a weight does there hangs on its radius, too",
                    hint=f"say how far out it stands: --counterweight {name}:radius=50mm")
            for name in wanting
        ))  # fmt: skip


def candidate(cycle: Cycle, at: WeightPlace, about: Array, weigh: Array) -> Candidate:
    """A place with what weights there do. Raises SolveError where its body turns about no axis of its own."""
    states = cycle.states
    axis = own_axis(cycle, at)
    first, second = plane_across(axis)
    across = np.stack([first, second], axis=1)
    radius = at.radius if at.radius is not None else reach(cycle.mechanism, at, axis)
    R, w, al = (getattr(states, name)[:, at.body] for name in ("R", "omega", "alpha"))
    place = on_axis(cycle, at, axis)
    x = states.x[:, at.body] + R @ place - about
    arm = R @ place
    a = states.a[:, at.body] + cross_rows(al, arm) + cross_rows(w, cross_rows(w, arm))
    spread = np.einsum("tij,jk->tki", R, across)  # (n, 2, 3): the directions in the world
    turned = np.stack([cross_rows(al, e) + cross_rows(w, cross_rows(w, e)) for e in np.moveaxis(spread, 1, 0)], axis=1)
    by_mass = -np.concatenate([a, cross_rows(x, a)], axis=1)
    moment = cross_rows(spread, np.broadcast_to(a[:, None], spread.shape)) + cross_rows(
        np.broadcast_to(x[:, None], turned.shape), turned
    )
    by_product = -np.moveaxis(np.concatenate([turned, moment], axis=2), 1, 2)
    square = np.zeros((len(x), 6, 2, 2))
    for i in range(2):
        for j in range(2):
            both = cross_rows(spread[:, i], turned[:, j]) + cross_rows(spread[:, j], turned[:, i])
            square[:, 3:, i, j] = -0.5 * both
    return Candidate(
        replace(at, place=place), radius, across,
        (by_mass * weigh).ravel(), (by_product * weigh[:, :, None]).reshape(-1, 2),
        (square * weigh[:, :, None, None]).reshape(-1, 2, 2),
    )  # fmt: skip


def own_axis(cycle: Cycle, at: WeightPlace) -> Array:
    """The direction, in body axes, about which a body turns all the time. Raises SolveError where there is none."""
    own = np.einsum("tji,tj->ti", cycle.states.R[:, at.body], cycle.states.omega[:, at.body])
    _, sizes, directions = np.linalg.svd(own, full_matrices=False)
    name = cycle.mechanism.bodies[at.body].name
    if sizes[0] <= tolerances.SAME_VALUE * math.sqrt(len(own)):
        message = f"bodies.{name} does not turn: a weight on it adds to what moves to and fro, and takes nothing away"
        raise SolveError(Problem("no-counterweight", message, hint="name a point of a crank or a coupler"))
    if sizes[1] > tolerances.PARALLEL * sizes[0]:
        message = f"bodies.{name} turns about no one axis of its own: across what its weight should stand is not known"
        raise SolveError(Problem("no-counterweight", message, hint="name a point of a body that turns about one axis"))
    axis = directions[0]
    return np.asarray(axis if axis[np.argmax(np.abs(axis))] > 0.0 else -axis)


def on_axis(cycle: Cycle, at: WeightPlace, axis: Array) -> Array:
    """The place that a weight is counted from: of a body with a fixed axis the point of the axis level with it."""
    found = fixed_point(cycle, at.body)
    return at.place if found is None else found + (axis @ (at.place - found)) * axis


def fixed_point(cycle: Cycle, body: int) -> Array | None:
    """A point of the body, its axes (3,), that stays where it is; None where none does."""
    states = cycle.states
    R, w = states.R[:, body], states.omega[:, body]
    local = np.einsum("tji,tj->ti", R, w)
    hats = np.zeros((len(local), 3, 3))
    hats[:, 0, 1], hats[:, 0, 2], hats[:, 1, 2] = -local[:, 2], local[:, 1], -local[:, 0]
    hats -= np.swapaxes(hats, 1, 2)
    v = np.einsum("tji,tj->ti", R, states.v[:, body])
    point = np.linalg.lstsq(hats.reshape(-1, 3), -v.ravel(), rcond=tolerances.PARALLEL)[0]
    left = np.abs(v + hats @ point).max()
    scale = np.abs(states.v).max() + np.abs(v).max()
    return np.asarray(point) if left <= tolerances.SAME_VALUE * scale else None


def reach(mechanism: Mechanism, at: WeightPlace, axis: Array) -> float:
    """How far the farthest joint of a body is from its axis [m]. Raises SolveError where none is off it."""
    body = mechanism.bodies[at.body]
    ends = [joint.p for joint in mechanism.joints if joint.a == at.body]
    ends += [joint.q for joint in mechanism.joints if joint.b == at.body]
    arms = [end - at.place for end in [*ends, body.center]]
    found = max((float(np.linalg.norm(arm - (axis @ arm) * axis)) for arm in arms), default=0.0)
    if found <= tolerances.PARALLEL:
        hint = f"such as --counterweight {at.name}:radius=50mm"
        raise SolveError(Problem("radius-needed", f"{at.name}: nothing tells how far out a weight stands", hint=hint))
    return found


def weight(one: Candidate, U: Array) -> Weight:
    """A counterweight of product U (2,) along the place's two directions."""
    product = one.across @ U
    size = math.sqrt(float(U @ U))
    angle = math.atan2(U[1], U[0])
    angle = abs(angle) if math.pi - abs(angle) <= tolerances.WRITTEN else angle  # and not minus a half turn
    return Weight(one.at, product, size / one.radius, one.radius, angle, one.across[:, 0])


def applied(mechanism: Mechanism, weights: Sequence[Weight]) -> Mechanism:
    """The mechanism with the weights as point masses of their bodies."""
    bodies = list(mechanism.bodies)
    for one in weights:
        bodies[one.at.body] = with_mass(bodies[one.at.body], one)
    return replace(mechanism, bodies=tuple(bodies))


def with_mass(body: Body, one: Weight) -> Body:
    """A body with a weight as a point mass of it."""
    p = one.position
    P = pseudo_inertia(body.mass, body.center, body.inertia)
    P = P + assembled(np.array(one.mass), one.mass * p, one.mass * np.outer(p, p))
    mass, center, inertia = properties(P)
    heavier: Body = replace(body, mass=mass, center=center, inertia=inertia)
    return heavier
