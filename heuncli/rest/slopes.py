"""How the accelerations at rest change with the pose: their linear law about it, and its own directions.

    a(q + T z) = a + T A z,     A = V diag(lambda) V^-1,     c = V^-1 T+ a
T are displacements that the closures admit, orthonormal by the coordinates' weights (linearisation/linearise.py). c is
what is left to be followed along each direction; noise is what rounding makes of it: less than that is nothing.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import SolveError
from heuncli.integration.evaluator import Evaluator
from heuncli.kernel.choose import scene as kernel
from heuncli.linearisation.linearise import Linearised, linearised
from heuncli.records import record
from heuncli.response import columns
from heuncli.rest.coordinates import Coordinates, resting, rounding_of
from heuncli.rest.pose import Pose
from heuncli.rest.reasons import no_value
from heuncli.results import Array, Mask

SAMPLES = 4  # poses moved by rounding: that all of them hide a direction is unlikely
MOST_GROWTH = 300.0  # exponents beyond it are as good as infinite
SERIES = 1e-8  # below it the series has all digits


@record
class Slopes:
    """The linear law at a pose: T (n, f), T+ (f, n), A (f, f), its eigenvalues, V and V^-1, c and its noise (f,).

    known (f,): what rounding makes of the eigenvalues; summed (f,): of the sums in c alone, a part of its noise;
    bent (f,): by how much a pose moved by rounding leaves the law: rounding, but for loads that jump; rough (f,): what
    the law makes of the rounding of a pose.
    """

    law: Linearised
    T: Array
    back: Array
    A: Array
    eigenvalues: Array
    V: Array
    inverse: Array
    c: Array
    noise: Array
    known: Array
    summed: Array
    bent: Array
    rough: Array

    @property
    def left(self) -> Array:
        """c where it is more than rounding, else 0, (f,)."""
        return np.where(np.abs(self.c) > self.noise, self.c, 0.0)

    @property
    def decided(self) -> Mask:
        """The directions that are not indifferent, (f,)."""
        return np.asarray(np.abs(self.eigenvalues) > self.known)

    def along(self, accelerations: Array) -> Array:
        """Accelerations (n,) by directions, (f,)."""
        return np.asarray(self.inverse @ (self.back @ accelerations))

    def way(self, h: float, c: Array | None = None) -> Array:
        """How far dq/ds = a leads in s = h, by the linear law, (n,): z = V h phi(h lambda) c, phi(x) = (e^x - 1)/x."""
        x = h * self.eigenvalues
        x = np.where(x.real > MOST_GROWTH, MOST_GROWTH, x)
        small = np.abs(x) < SERIES
        phi = np.where(small, 1.0 + 0.5 * x, np.expm1(x) / np.where(small, 1.0, x))
        z = self.V @ (h * phi * (self.left if c is None else c))
        return np.asarray(self.T @ z.real)

    def newton(self, accelerations: Array) -> Array:
        """The displacement (n,) that takes accelerations (n,) back, along all directions that are not indifferent."""
        decided = self.decided
        softness = np.where(decided, -1.0 / np.where(decided, self.eigenvalues, 1.0), 0.0)
        return np.asarray(self.T @ (self.V @ (softness * self.along(accelerations))).real)


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
    eigenvalues, V = np.linalg.eig(A) if len(A) else (np.zeros(0), np.zeros((0, 0)))
    inverse = np.linalg.pinv(V) if len(A) else V
    noise = np.abs(inverse @ change.T).max(axis=1, initial=0.0)
    sums = rounding(evaluator, coordinates, at)
    c = inverse @ (back @ at.accelerations)
    terms = np.abs(back) @ np.abs(law.by_place) @ np.abs(T)
    known = tolerances.INDIFFERENT * np.einsum("ij,jk,ki->i", np.abs(inverse), terms, np.abs(V))
    spin = float(np.abs(at.recovered.bodies["omega"]).max(initial=0.0))  # centrifugal terms cancel before they are seen
    known = np.maximum(known, tolerances.EPS * terms.max(initial=0.0)) + tolerances.INDIFFERENT * spin * spin
    summed = np.abs(inverse) @ (np.abs(back) @ sums)
    summed = summed + np.abs(inverse @ (back @ of_springs(evaluator, coordinates, at))).sum(axis=1)
    bent = np.abs(inverse @ (change.T - A @ (back @ by.T))).max(axis=1, initial=0.0)
    rough = np.abs(inverse) @ (np.abs(back) @ (np.abs(law.by_place) @ np.abs(by).max(axis=0)))
    noise = tolerances.PUSHED_BY_ROUNDING * (noise + summed)
    return Slopes(law, T, back, A, eigenvalues, V, inverse, c, noise, known, summed, bent, rough)


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
    units = np.zeros((len(own), len(bodies), 6))
    for n, k in enumerate(own):
        load = at.recovered.loads[0, k]
        line = (load["at"] - load["from_at"]) / load["span"]
        force = tolerances.SUM_ROUNDING * rows["stiffness"][k] * (load["span"] + rows["length"][k]) * line
        for body, place, sign in ((int(rows["b"][k]), load["at"], 1.0), (int(rows["a"][k]), load["from_at"], -1.0)):
            if body >= 0:
                units[n, body, :3] += sign * np.cross(place - bodies["r"][body], force)
                units[n, body, 3:] += sign * force
    if not own:
        return np.zeros((coordinates.count, 0))
    answers = columns(evaluator.workspace, at.t, at.state, units, np.zeros(len(own)))
    return coordinates.along(answers.bodies["alpha"], answers.freedoms["udot"]).T
