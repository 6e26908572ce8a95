"""The mass effects (56) of a cycle by its angle: exact for one freedom, whatever the angle does in time.

    F = -(F2 ω² + F1 ω̇)     F1 = sum m x',          F2 = sum m x''                               ON the foundation
    M = -(M2 ω² + M1 ω̇)     M1 = sum m x × x' | sum I σ',
                            M2 = sum m x × x'' | sum (I σ'' + σ' × I σ')                         orbital | spin
    ε = sum m x'² + σ' I σ',   torque of the inertia = ε ω̇ + ½ ε' ω²
x from where moments are taken; σ' and σ'' are angular velocity and acceleration at unit rate. Heun (1901), no. 26.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.analyses.balancing.cycle import Cycle
from heuncli.analyses.balancing.nodes import CycleNodes
from heuncli.base.records import record
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.reactions import in_plane
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class MassEffects:
    """What the masses of a cycle do at unit rate, of every body: (n, bodies, 3), world axes.

    first_...: what ω̇ multiplies, the others what ω² does. eps, half_slope (n, bodies): the bodies' parts of the reduced
    inertia [kg m2] and of ½ dε/dφ. terms: what force, moment and torque are sums of, whose rounding is none of theirs.
    """

    nodes: CycleNodes
    force: Array
    orbital: Array
    spin: Array
    first_force: Array
    first_orbital: Array
    first_spin: Array
    eps: Array
    half_slope: Array
    terms: Mapping[str, float]

    @property
    def angles(self) -> Array:
        """Those of the nodes, (n,)."""
        return self.nodes.angles

    @property
    def moment(self) -> Array:
        """Orbital and spin together."""
        return self.orbital + self.spin


def mass_effects(cycle: Cycle, about: Array) -> MassEffects:
    """The mass effects of a cycle; about (3,): where moments are taken [m], world axes."""
    mechanism, states = cycle.mechanism, cycle.states
    masses = np.array([body.mass for body in mechanism.bodies])
    inertia = np.array([body.inertia for body in mechanism.bodies])
    ma, spin = inertia_loads(mechanism, states)
    arms = states.centre - about
    momentum = masses[:, None] * states.v_centre
    turning = np.einsum("tnij,njk,tnlk,tnl->tni", states.R, inertia, states.R, states.omega)
    orbital, first_orbital = cross_rows(arms, ma), cross_rows(arms, momentum)
    if mechanism.planar:
        momentum, turning = in_plane(momentum, turning)
        _, orbital = in_plane(ma, orbital)
        _, first_orbital = in_plane(momentum, first_orbital)
    eps = np.einsum("tni,tni->tn", momentum, states.v_centre) + np.einsum("tni,tni->tn", turning, states.omega)
    slope = np.einsum("tni,tni->tn", ma, states.v_centre) + np.einsum("tni,tni->tn", spin, states.omega)
    return MassEffects(
        cycle.nodes, ma, orbital, spin, momentum, first_orbital, turning, eps, slope, terms_of(cycle, masses, arms)
    )


def terms_of(cycle: Cycle, masses: Array, arms: Array) -> dict[str, float]:
    """How large terms of force, moment and torque are at unit rate: all masses, moved by the scene's size."""
    force = float(masses.sum()) * cycle.size
    return {"force": force, "moment": force * (cycle.size + float(np.abs(arms).max())), "torque": force * cycle.size}
