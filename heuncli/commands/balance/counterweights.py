"""Counterweights that leave the least force and moment over a cycle: of each body mass times radius, and its angle.

A point mass m at place + ρ û of a body adds what is linear in its moments (m, m p, m p p^T), p from the body's origin:
    m p = m place + U,   m p p^T = m place place^T + place U^T + U place^T + ρ U U^T/|U|,   U = m ρ û,  m = |U|/ρ
Of a body that turns evenly about an axis fixed in the ground the terms in m and ρ do nothing (they turn with it and
make nothing), so F and M are linear in U: one system of linear least squares over the angles, of least |U| where
several U serve as well. Else Gauss and Newton's iteration begins there. U stands across the axis of the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.commands.balance.cycle import Cycle
from heuncli.commands.balance.effects import mass_effects
from heuncli.commands.balance.harmonics import plane_across
from heuncli.errors import Problem, SolveError
from heuncli.mechanism.model import Body, Mechanism
from heuncli.records import record, replace
from heuncli.results import Array
from heuncli.shapes.inertia import assembled, properties, pseudo_inertia
from heuncli.shapes.rotations import cross_rows

MOST_ITERATIONS = 100
CONVERGED = 1e-13  # of |U|: a step that rounding makes
DEPENDENT = 1e-10  # of the largest singular value: places that serve as well as each other
NO_EFFECT = 1e-10  # of what the moments of first order make: rounding of a cycle's accelerations
HALVINGS = 40


@record
class WeightPlace:
    """Where a counterweight may stand: a body's point, and how far from it (None: the body's farthest joint)."""

    body: int
    name: str
    place: Array
    radius: float | None


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


@record
class Candidate:
    """A place with the two directions across its body's axis, and the answers to the moments of a weight there.

    by_mass (n, 6), by_product (n, 6, 2), by_square (n, 6, 2, 2): force and moment (times what they are weighed by) that
    a mass at the place, a product along each direction, and moments of second order make ON the foundation at unit
    rate.
    """

    at: WeightPlace
    radius: float
    across: Array
    by_mass: Array
    by_product: Array
    by_square: Array

    def effect(self, U: Array) -> Array:
        """What a weight of product U (2,) adds, (n, 6)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return np.zeros_like(self.by_mass)
        square = self.radius / size * np.einsum("tkij,i,j->tk", self.by_square, U, U)
        return np.asarray(size / self.radius * self.by_mass + self.by_product @ U + square)

    def slope(self, U: Array) -> Array:
        """Its derivative by U, (n, 6, 2)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return self.by_product
        u = U / size
        square = np.einsum("tkij,j->tki", self.by_square, u) + np.einsum("tkij,i->tkj", self.by_square, u)
        whole = np.einsum("tkij,i,j->tk", self.by_square, u, u)
        own = self.by_mass[..., None] * u / self.radius + self.by_product
        return np.asarray(own + self.radius * (square - whole[..., None] * u))

    @property
    def is_linear(self) -> bool:
        """Whether mass and second moments do nothing that counts beside the product."""
        size = float(np.abs(self.by_product).max(initial=0.0))
        other = (
            np.abs(self.by_mass).max(initial=0.0) / self.radius,
            self.radius * np.abs(self.by_square).max(initial=0.0),
        )
        return bool(max(other) <= NO_EFFECT * size)


def least(cycle: Cycle, places: Sequence[WeightPlace], about: Array, force: float, moment: float) -> Balanced:
    """The weights with the least mean of |force F|² + |moment M|² over the cycle; moment [1/m] counts against force."""
    found = mass_effects(cycle, about)
    weigh = np.repeat([force, moment], 3)
    left = -np.concatenate([found.force.sum(axis=1), found.moment.sum(axis=1)], axis=1) * weigh
    candidates = [candidate(cycle, place, about, weigh) for place in places]
    A = np.concatenate([one.by_product for one in candidates], axis=2).reshape(left.size, -1)
    U, several = solved_least(A, left.ravel())
    linear = all(one.is_linear for one in candidates)
    if not linear:
        require_radii(candidates)
        U = iterated(candidates, left, U)
    weights = tuple(weight(one, U[2 * k : 2 * k + 2]) for k, one in enumerate(candidates))
    return Balanced(weights, several, linear)


def solved_least(A: Array, left: Array) -> tuple[Array, bool]:
    """The U of least |A U + left|, of these the least; whether there are several."""
    size = float(np.abs(A).max(initial=0.0))
    if size == 0.0:
        return np.zeros(A.shape[1]), True
    U, _, rank, _ = np.linalg.lstsq(A / size, -left / size, rcond=DEPENDENT)
    return np.asarray(U), int(rank) < A.shape[1]


def iterated(candidates: Sequence[Candidate], left: Array, start: Array) -> Array:
    """Gauss and Newton's iteration from a start, each step halved until it leads down."""

    def rest(U: Array) -> Array:
        effects = (one.effect(U[2 * k : 2 * k + 2]) for k, one in enumerate(candidates))
        return np.asarray(left + sum(effects, np.zeros_like(left))).ravel()

    U, r = start, rest(start)
    for _ in range(MOST_ITERATIONS):
        slopes = [one.slope(U[2 * k : 2 * k + 2]) for k, one in enumerate(candidates)]
        step, _ = solved_least(np.concatenate(slopes, axis=2).reshape(left.size, -1), r)
        for _ in range(HALVINGS):
            tried = rest(U + step)
            if tried @ tried <= r @ r:
                break
            step = 0.5 * step
        else:
            return U
        U, r = U + step, tried
        if np.abs(step).max() <= CONVERGED * np.abs(U).max():
            return U
    message = "the counterweights are not found: their least squares do not settle"
    raise SolveError(Problem("counterweights-unsettled", message, hint="another radius, or fewer places"))


def require_radii(candidates: Sequence[Candidate]) -> None:
    """Raise SolveError where a weight's own mass counts and nobody said how far out it stands."""
    wanting = [one.at.name for one in candidates if not one.is_linear and one.at.radius is None]
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
        by_mass * weigh, by_product * weigh[:, None], square * weigh[:, None, None],
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
    found = fixed_point(cycle, at.body, axis)
    return at.place if found is None else found + (axis @ (at.place - found)) * axis


def fixed_point(cycle: Cycle, body: int, axis: Array) -> Array | None:
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
