"""One step along dq/ds = a(q, rates 0): an exponential Rosenbrock step of third order.

    z(s) = s phi_1(s A) c + 2 s phi_3(s A) (s/h)^2 d,     d = rates at z(h) - c - A z(h)

z is the displacement within the closures from the pose where the linear law (A, c) holds. Without d the step is of
second order, follows stiff directions to their end and is exact where the law is; d is what the law misses at the
step's end, and its share of the step is the error estimate. Hochbruck, Ostermann, Schweitzer 2009: exprb32.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.slopes import RestLaw
from heuncli.results.results import Array


@record
class RosenbrockStep:
    """The step from a pose up to s = h; d (f,): correction along the law's directions."""

    law: RestLaw
    h: float
    d: Array

    def displacement_at(self, s: float) -> Array:
        """Return the displacement (n,) at some s, up to h."""
        return np.asarray(self.law.follow(s) + self.correction_at(s))

    def correction_at(self, s: float) -> Array:
        """Return the part of the displacement from d, (n,)."""
        if not self.d.any():
            return np.zeros(len(self.law.T))
        return self.law.to_displacement(self.law.directions.integrate(s, 2.0 * (s / self.h) ** 2 * self.d, order=3))

    def with_correction(self, rates: Array, displacement: Array, accelerations: Array) -> RosenbrockStep:
        """Return the step with d, from the rates (n,) of its coordinates after a displacement (n,), and those
        before.
        """
        law = self.law
        d = law.project(rates - accelerations - law.T @ (law.A @ (law.T_inverse @ displacement)))
        # an unstable direction that only rounding pushes stays as it is
        return replace(self, d=np.where(np.abs(d) > law.noise, d, 0.0))


def uncorrected_step(law: RestLaw, h: float) -> RosenbrockStep:
    """Return the step by the linear law alone."""
    return RosenbrockStep(law, h, np.zeros(len(law.c)))
