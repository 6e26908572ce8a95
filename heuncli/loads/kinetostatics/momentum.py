"""Momentum and moment of momentum of the bodies: Heun (1901), (16) and (17).

    sum m x_s.        sum m_s x x_s. + sum I sigma       about a fixed point

Their rates are the mass effects.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import project_to_plane
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows


@record
class Momenta:
    """Momenta of each body, (n_t, n, 3), world axes: linear [N s]; orbital, spin: moments of momentum about a point [N
    m s].
    """

    linear: Array
    orbital: Array
    spin: Array

    def sum_bodies(self) -> Block:
        """Return the sums over all bodies."""
        parts = {"total": self.linear, "moment_orbital": self.orbital, "moment_spin": self.spin}
        return {name: part.sum(axis=1) for name, part in parts.items()}


def find_momenta(mechanism: Mechanism, states: BodyStates, reference: Array) -> Momenta:
    """Return momentum and moment of momentum about a point (3,)."""
    m = np.array([body.mass for body in mechanism.bodies])
    inertia = np.array([body.inertia for body in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    linear = m[:, None] * states.v_centre
    spin: Array = np.einsum("tnij,njk,tnk->tni", states.R, inertia, w)
    orbital = cross_rows(states.centre - reference, linear)
    if mechanism.planar:
        linear, orbital = project_to_plane(linear, orbital)
        _, spin = project_to_plane(linear, spin)
    return Momenta(linear, orbital, spin)
