"""The mass effects (56) over a cycle as functions of its angle: exact for one freedom, for any motion of the angle in
time.
    F = -(F2 ω² + F1 ω̇)     F1 = sum m x',          F2 = sum m x''                               ON the foundation
    M = -(M2 ω² + M1 ω̇)     M1 = sum m x × x' | sum I σ',
                            M2 = sum m x × x'' | sum (I σ'' + σ' × I σ')                         orbital | spin
    ε = sum m x'² + σ' I σ',   torque of the inertia = ε ω̇ + ½ ε' ω²
x is measured from the reference point of moments; σ' and σ'' are angular velocity and acceleration at unit rate. Heun
(1901), no. 26.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.analyses.balancing.cycle import Cycle
from heuncli.analyses.balancing.cycle_nodes import CycleNodes
from heuncli.base.records import record
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.reactions import project_to_plane
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class MassEffects:
    """Mass effects of a cycle at unit rate, for every body: (n, bodies, 3), world axes.

    The `first_...` fields are the factors of ω̇, the others those of ω².
    eps, half_slope (n, bodies): the bodies' parts of the reduced inertia [kg m2] and of ½ dε/dφ
    terms: size of the terms that make up force, moment and torque, for estimates of rounding
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
        """Angles of the nodes, (n,)."""
        return self.nodes.angles

    @property
    def moment(self) -> Array:
        """The sum of the orbital and spin moments."""
        return self.orbital + self.spin


def compute_mass_effects(cycle: Cycle, reference_point: Array) -> MassEffects:
    """Compute the mass effects of a cycle.

    reference_point (3,): where moments are taken [m], world axes
    """
    mechanism, states = cycle.mechanism, cycle.states
    masses = np.array([body.mass for body in mechanism.bodies])
    inertia = np.array([body.inertia for body in mechanism.bodies])
    ma, spin = inertia_loads(mechanism, states)
    arms = states.centre - reference_point
    momentum = masses[:, None] * states.v_centre
    angular_momentum = np.einsum("tnij,njk,tnlk,tnl->tni", states.R, inertia, states.R, states.omega)
    orbital, first_orbital = cross_rows(arms, ma), cross_rows(arms, momentum)
    if mechanism.planar:
        momentum, angular_momentum = project_to_plane(momentum, angular_momentum)
        _, orbital = project_to_plane(ma, orbital)
        _, first_orbital = project_to_plane(momentum, first_orbital)
    eps = np.einsum("tni,tni->tn", momentum, states.v_centre) + np.einsum("tni,tni->tn", angular_momentum, states.omega)
    slope = np.einsum("tni,tni->tn", ma, states.v_centre) + np.einsum("tni,tni->tn", spin, states.omega)
    return MassEffects(
        cycle.nodes,
        ma,
        orbital,
        spin,
        momentum,
        first_orbital,
        angular_momentum,
        eps,
        slope,
        estimate_term_sizes(cycle, masses, arms),
    )


def estimate_term_sizes(cycle: Cycle, masses: Array, arms: Array) -> dict[str, float]:
    """Estimate the size of the terms of force, moment and torque at unit rate: all masses, moved by the scene's
    size.
    """
    force = float(masses.sum()) * cycle.size
    return {"force": force, "moment": force * (cycle.size + float(np.abs(arms).max())), "torque": force * cycle.size}
