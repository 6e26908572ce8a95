"""Results of `heun lagrange` at an instant, with the SI units along an angle and along a length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base.joint_kinds import is_length
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.results.results import Array


@record
class ApparentInertia:
    """The apparent inertia along a coordinate, or at a point along a direction.

    others_locked: with the other coordinates held; None at a point, where this is not unique
    others_free: with the other coordinates free
    """

    name: str
    unit: str
    others_locked: float | None
    others_free: float


@record
class SectionForces:
    """Generalised forces that the piece beyond a section exerts, s (cuts, f); nan if the section is indeterminate.

    scale (f,): size of such loads at the largest partials of the body, for comparison
    is_cut_series: whether there are several cuts
    """

    s: Array
    scale: Array
    is_cut_series: bool


@record
class ImpulseResults:
    """An impulse along the coordinates, (f,): h of the given impulse, of drives, jumps of the rates; F of h; r' of
    sections.
    """

    t: float
    h: Array
    drives: Array
    jumps: Array
    reciprocal_energy: float
    sections: Mapping[str, SectionForces]


@record
class LagrangeResults:
    """Lagrange's equations of a scene at an instant; f coordinates.

    values: of the coordinates, nan for quasi-velocities; rates q'; accelerations q'' of the scene with its drives
    forces: k by cause; drives: Q of the drives, 0 where nothing drives
    coriolis, coriolis_matrix: C and its matrix
    gamma, alpha: symbols [i, l, k]; None if not requested, or for rates without coordinates
    energy: E; energies: its free, mixed and driven parts, nan if driven coordinates are not among the chosen ones
    scale: size of the terms in the equations
    residual: of e q'' + C = k + Q relative to these, where Q is known otherwise
    """

    title: str
    t: float
    instant_text: str
    names: tuple[str, ...]
    is_driven: tuple[bool, ...]
    values: Array
    rates: Array
    accelerations: Array
    epsilon: Array
    eta: Array
    momenta: Array
    forces: Mapping[str, Array]
    drives: Array
    coriolis: Array
    coriolis_matrix: Array
    gamma: Array | None
    alpha: Array | None
    energy: float
    energies: tuple[float, float, float]
    reciprocal_energy: float
    scale: Array
    residual: float
    apparent_inertias: tuple[ApparentInertia, ...]
    sections: Mapping[str, SectionForces]
    partials: Mapping[str, Any]
    left_out: tuple[str, ...]
    notes: tuple[str, ...] = ()
    state_space: StateSpace | None = None
    impulses: tuple[ImpulseResults, ...] = ()

    @property
    def total_force(self) -> Array:
        """k: the sum of all causes."""
        return sum(self.forces.values(), np.zeros(len(self.names)))


@record
class StateSpace:
    """x. = A x + B u, y = C x + D u for small motions about a state, with the names and units of x, u and y.

    offset: x. at the state, 0 at rest
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: Mapping[str, list[str]]
    offset: Array


@record
class InertiaCurve:
    """The inertia and the forces over a range of the one free coordinate, (n,) each.

    epsilon, half: e and de/dq / 2
    forces: k by cause, at a rate of the coordinate; force_scale: size of their terms
    mean: of e over the range, nan if it does not converge
    """

    title: str
    name: str
    is_driven: bool
    mean: float
    values: Array
    rate: float
    epsilon: Array
    half: Array
    forces: Mapping[str, Array]
    force_scale: float

    @property
    def total_force(self) -> Array:
        """k: the sum of all causes."""
        return sum(self.forces.values(), np.zeros(len(self.values)))

    @property
    def reversed_curve(self) -> InertiaCurve:
        """The same curve in the opposite direction."""
        forces = {name: k[::-1] for name, k in self.forces.items()}
        reversed_values = {name: getattr(self, name)[::-1] for name in ("values", "epsilon", "half")}
        return replace(self, forces=forces, **reversed_values)


class CoordinateUnits(NamedTuple):
    """The units of a coordinate q, its rate and acceleration, and of quantities along it.

    force: of k, C and drives
    momentum: of p and h
    inertia: of its diagonal entry in the mass matrix
    """

    value: str
    rate: str
    acceleration: str
    force: str
    momentum: str
    inertia: str

    @property
    def slope(self) -> str:
        """Unit of the derivative of the inertia by the coordinate."""
        return f"{self.inertia}/{self.value}"


ANGLE = CoordinateUnits("rad", "rad/s", "rad/s²", "N·m", "N·m·s", "kg·m²")
LENGTH = CoordinateUnits("m", "m/s", "m/s²", "N", "N·s", "kg")
MIXED_INERTIA_UNIT = "kg·m"  # of an angle and a length


def get_units(coordinate: str) -> CoordinateUnits:
    """Return the units along a coordinate owner.quantity."""
    return LENGTH if is_length(coordinate) else ANGLE
