"""How the accelerations at rest change with the pose: their linear law about it, and its own directions.

    a(q + T z) = a + T A z,     A = V diag(lambda) V^-1,     c = V^-1 T+ a
T are displacements that the closures admit, orthonormal by the coordinates' weights
(motion/linearisation/linearise.py). c is what is left to be followed along each direction; noise is what rounding makes
of it: less than that is nothing. Directions that hardly differ share a block in place of eigenvalues of their own
(directions.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.loads.equilibrium.coordinates import Coordinates, resting, rounding_of
from heuncli.loads.equilibrium.directions import Directions, directions, split
from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.equilibrium.reasons import no_value
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.linearisation.indifference import Indifference
from heuncli.motion.linearisation.linearise import Linearised, linearised
from heuncli.multibody.response import columns
from heuncli.results.results import Array, Mask

SAMPLES = 4  # poses moved by rounding: that all of them hide a direction is unlikely


@record
class Slopes:
    """The linear law at a pose: T (n, f), T+ (f, n), A (f, f) by its directions, c and its noise (f,).

    known (f,): what rounding makes of the eigenvalues; summed (f,): of the sums in c alone, a part of its noise;
    bent (f,): by how much a pose moved by rounding leaves the law: rounding, but for loads that jump; rough (f,): what
    the law makes of the rounding of a pose.
    """

    law: Linearised
    T: Array
    back: Array
    A: Array
    directions: Directions
    c: Array
    noise: Array
    known: Array
    summed: Array
    bent: Array
    rough: Array

    @property
    def eigenvalues(self) -> Array:
        """Of A, (f,)."""
        return self.directions.eigenvalues

    @property
    def V(self) -> Array:
        """The directions, (f, f)."""
        return self.directions.X

    @property
    def inverse(self) -> Array:
        """V^-1."""
        return self.directions.inverse

    @property
    def left(self) -> Array:
        """c where it is more than rounding, else 0, (f,); of a block of directions all or nothing."""
        beyond = np.abs(self.c) > self.noise
        beyond[self.directions.alone :] = beyond[self.directions.alone :].any()
        return np.where(beyond, self.c, 0.0)

    @property
    def decided(self) -> Mask:
        """The directions that are not indifferent, (f,)."""
        return np.asarray(np.abs(self.eigenvalues) > self.known)

    def along(self, accelerations: Array) -> Array:
        """Accelerations (n,) by directions, (f,)."""
        return np.asarray(self.inverse @ (self.back @ accelerations))

    def way(self, h: float, c: Array | None = None) -> Array:
        """How far dq/ds = a leads in s = h, by the linear law, (n,): z = V h phi(h lambda) c, phi(x) = (e^x - 1)/x."""
        return self.by_directions(self.directions.led(h, self.left if c is None else c))

    def by_directions(self, z: Array) -> Array:
        """The displacement (n,) of coordinates z (f,) of the directions; not finite if they are not."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray(self.T @ (self.V @ z).real)

    def newton(self, accelerations: Array) -> Array:
        """The displacement (n,) that takes accelerations (n,) back, along all directions that are not indifferent."""
        c = self.along(accelerations)
        return self.by_directions(self.directions.softened(c, self.known))


def slopes(evaluator: Evaluator, coordinates: Coordinates, at: Pose) -> Slopes:
    """The linear law at a pose."""
    law = linearised(evaluator.layout, at.t, at.state, at.holding)
    T = law.tangent
    back = T.T * coordinates.weights**2
    A = back @ law.by_place @ T
    by = np.array([rounding_of(coordinates, at.state, k) for k in range(SAMPLES)])
    moved = resting(
        evaluator, at.t, coordinates.displaced(np.repeat(at.state[None, :], SAMPLES, axis=0), by), at.holding
    )
    change = (coordinates.accelerations(moved) - at.accelerations) @ back.T
    if not (np.isfinite(A).all() and np.isfinite(change).all()):
        raise SolveError(no_value(coordinates, change))
    own = directions(A, T.T @ law.mass @ T)
    inverse = own.inverse
    noise = np.abs(inverse @ change.T).max(axis=1, initial=0.0)
    sums = rounding(evaluator, coordinates, at)
    c = inverse @ (back @ at.accelerations)
    terms = np.abs(back) @ np.abs(law.by_place) @ np.abs(T)
    known = known_to(own, terms, float(np.abs(at.recovered.bodies["omega"]).max(initial=0.0)))
    summed = np.abs(inverse) @ (np.abs(back) @ sums)
    summed = summed + np.abs(inverse @ (back @ of_springs(evaluator, coordinates, at))).sum(axis=1)
    bent = np.abs(inverse @ (change.T - A @ (back @ by.T))).max(axis=1, initial=0.0)
    rough = np.abs(inverse) @ (np.abs(back) @ (np.abs(law.by_place) @ np.abs(by).max(axis=0)))
    noise = tolerances.PUSHED_BY_ROUNDING * (noise + summed)
    return Slopes(law, T, back, A, own, c, noise, known, summed, bent, rough)


def decided_by(own: Slopes, what: Indifference) -> Slopes:
    """The same law by the directions that nothing holds, and those of all that is held: which these are is known."""
    right, left = own.back @ what.free, own.back @ what.T @ what.found.left
    own_directions = split(own.A, own.T.T @ own.law.mass @ own.T, right, left)
    if own_directions is None:
        return own
    change = np.abs(own_directions.inverse @ own.V)
    noise, summed, bent, rough = (change @ x for x in (own.noise, own.summed, own.bent, own.rough))
    known = np.where(own_directions.eigenvalues == 0.0, 1.0, 0.0)
    known[idle(own.T @ own_directions.X, what.T)] = np.inf
    c = own_directions.inverse @ (own.V @ own.c)
    return replace(own, directions=own_directions, c=c, noise=noise, known=known, summed=summed, bent=bent, rough=rough)


def idle(ways: Array, moving: Array) -> Mask:
    """Which displacements (n, f) are spins without inertia: no combination of what moves mass (n, m) makes them."""
    if not moving.shape[1]:
        return np.ones(ways.shape[1], dtype=bool)
    left = ways - moving @ np.linalg.lstsq(moving, ways, rcond=None)[0]
    return np.asarray(np.sum(np.abs(left) ** 2, axis=0) > 0.5 * np.sum(np.abs(ways) ** 2, axis=0))


def known_to(own: Directions, terms: Array, spin: float) -> Array:
    """What rounding makes of the eigenvalues, (f,); terms (f, f): of A; spin: the fastest angular velocity.

    |y' dA x| of directions y, x; where k directions fall together with another one, dA to the power 1 / (k + 1), times
    |A| to what is left (Elsner).
    """
    known = tolerances.INDIFFERENT * ((np.abs(own.inverse) @ terms) * np.abs(own.X).T).sum(axis=1)
    # centrifugal terms cancel before they are seen
    known = np.maximum(known, tolerances.EPS * terms.max(initial=0.0)) + tolerances.INDIFFERENT * spin * spin
    if own.lost:
        together, power = known[own.alone :].sum(), 1.0 / (own.lost + 1)
        known[own.alone :] = together**power * (2.0 * np.linalg.norm(own.B) + together) ** (1.0 - power)
    return np.asarray(known)


def rounding(evaluator: Evaluator, coordinates: Coordinates, at: Pose) -> Array:
    """What rounding of the sums makes of the accelerations, (n,): of what each cause makes alone, and of weight."""
    terms = coordinates.terms(resting(evaluator, at.t, at.state[None, :], at.holding, causes=True))
    gravity = float(np.abs(evaluator.layout.mechanism.gravity).max()) / evaluator.size
    return tolerances.SUM_ROUNDING * (terms + gravity / coordinates.weights)


def of_springs(evaluator: Evaluator, coordinates: Coordinates, at: Pose) -> Array:
    """What rounding of each spring's length makes of the accelerations, (n, k): near its free length that is all."""
    layout, bodies = evaluator.layout, at.recovered.bodies[0]
    rows = layout.tables["loads"]
    own = [k for k in np.flatnonzero(rows["kind"] == kernel.SPRING).tolist() if at.recovered.loads["span"][0, k] > 0.0]
    ropes = np.flatnonzero(rows["kind"] == kernel.ROPE).tolist()
    units = np.zeros((len(own) + len(ropes), len(bodies), 6))
    for n, k in enumerate(ropes, len(own)):
        size = tolerances.SUM_ROUNDING * rows["stiffness"][k] * (at.recovered.loads["span"][0, k] + rows["length"][k])
        for part in range(int(rows["part"][k]), int(rows["part"][k] + rows["part_count"][k])):
            ends, answer = layout.tables["parts"][part], at.recovered.parts[0, part]
            for body, sign in ((int(ends["b"]), size), (int(ends["a"]), -size)):
                if body >= 0:
                    units[n, body, :3] += sign * (answer["m"] + np.cross(answer["Q"] - bodies["r"][body], answer["f"]))
                    units[n, body, 3:] += sign * answer["f"]
    for n, k in enumerate(own):
        load = at.recovered.loads[0, k]
        line = (load["at"] - load["from_at"]) / load["span"]
        force = tolerances.SUM_ROUNDING * rows["stiffness"][k] * (load["span"] + rows["length"][k]) * line
        for body, place, sign in ((int(rows["b"][k]), load["at"], 1.0), (int(rows["a"][k]), load["from_at"], -1.0)):
            if body >= 0:
                units[n, body, :3] += sign * np.cross(place - bodies["r"][body], force)
                units[n, body, 3:] += sign * force
    if not len(units):
        return np.zeros((coordinates.count, 0))
    answers = columns(evaluator.workspace, at.t, at.state, units, np.zeros(len(units)))
    return coordinates.along(answers.bodies["alpha"], answers.freedoms["udot"]).T
