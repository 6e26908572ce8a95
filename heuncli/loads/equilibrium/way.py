"""The way of one step along dq/ds = a(q, rates 0): an exponential Rosenbrock step of third order.

    z(s) = s phi_1(s A) c + 2 s phi_3(s A) (s/h)^2 d,     d = rates at z(h) - c - A z(h)
z by the displacements that the closures admit, from where the linear law (A, c) holds. Without d the step is of second
order, follows stiff directions to their end and is exact where the law is; d is what the law leaves out at the step's
end, and its share of the way is what the step is off by. Hochbruck, Ostermann, Schweitzer 2009: exprb32.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.slopes import Slopes
from heuncli.results.results import Array


@record
class Way:
    """The way from a pose up to s = h; d (f,) by the law's own directions."""

    own: Slopes
    h: float
    d: Array

    def by(self, s: float) -> Array:
        """The displacement (n,) at some s, up to h."""
        return np.asarray(self.own.way(s) + self.correction(s))

    def correction(self, s: float) -> Array:
        """What d adds to it, (n,)."""
        if not self.d.any():
            return np.zeros(len(self.own.T))
        return self.own.by_directions(self.own.directions.led(s, 2.0 * (s / self.h) ** 2 * self.d, order=3))

    def bent(self, rates: Array, by: Array, accelerations: Array) -> Way:
        """The way with d, by the rates (n,) of its coordinates met behind a displacement (n,), and those before."""
        own = self.own
        d = own.along(rates - accelerations - own.T @ (own.A @ (own.back @ by)))
        # an unstable direction that rounding alone pushes is left alone
        return replace(self, d=np.where(np.abs(d) > own.noise, d, 0.0))


def straight(own: Slopes, h: float) -> Way:
    """The way by the linear law alone."""
    return Way(own, h, np.zeros(len(own.c)))
