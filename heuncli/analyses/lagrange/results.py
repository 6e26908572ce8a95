"""What `heun lagrange` tells of an instant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base.records import record, replace
from heuncli.results.results import Array


@record
class Seen:
    """The inertia that is seen along a coordinate, or at a point along a direction.

    locked: with the other coordinates held; None at a point, which others may hold in many ways. free: with them free.
    """

    name: str
    unit: str
    locked: float | None
    free: float


@record
class SectionForces:
    """What a section's piece exerts along the coordinates, s (cuts, f), nan where the section is open.

    reach (f,): of what size such loads are along what the coordinates move most; is_run: of several cuts.
    """

    s: Array
    reach: Array
    is_run: bool


@record
class BlowResults:
    """A blow along the coordinates, (f,): h of what is given, of drives, jumps of the rates; F of h; r' of sections."""

    t: float
    h: Array
    drives: Array
    jumps: Array
    reciprocal_energy: float
    sections: Mapping[str, SectionForces]


@record
class LagrangeResults:
    """The Lagrange side of a scene at an instant; f coordinates.

    values: of the coordinates, not a number of quasi-velocities; rates q'; accelerations q'' of the scene as it is,
    with its drives; forces k by cause; drives Q: what drives do beside them, 0 where nothing drives; C: coriolis, with
    its matrix; gamma[i, l, k], alpha[i, l, k]: None where they were not asked for, or of rates without coordinates.
    energy: E; energies: of what is free, mixed, driven, nan where driven coordinates are not among these.
    scale: of what size the parts are whose sums the forces are; residual: of e q'' + C = k + Q where Q is known
    otherwise, of these.
    """

    title: str
    t: float
    at: str
    names: tuple[str, ...]
    driven: tuple[bool, ...]
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
    seen: tuple[Seen, ...]
    sections: Mapping[str, SectionForces]
    partials: Mapping[str, Any]
    left_out: tuple[str, ...]
    notes: tuple[str, ...] = ()
    state_space: StateSpace | None = None
    blows: tuple[BlowResults, ...] = ()

    @property
    def total(self) -> Array:
        """k: the sum of all causes."""
        return sum(self.forces.values(), np.zeros(len(self.names)))


@record
class StateSpace:
    """x. = A x + B u, y = C x + D u beside a state; offset: x. there, 0 of a rest. Names and units of x, u and y."""

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
class InertiaCourse:
    """The inertia and the forces over a range of the one free coordinate, (n,) each.

    epsilon, half: e and de/dq / 2; forces k by cause, at a rate of the coordinate; reach: of what size the
    products are that they are sums of; mean: of e, over the range, nan where it does not settle.
    """

    title: str
    name: str
    driven: bool
    mean: float
    values: Array
    rate: float
    epsilon: Array
    half: Array
    forces: Mapping[str, Array]
    reach: float

    @property
    def total(self) -> Array:
        """k."""
        return sum(self.forces.values(), np.zeros(len(self.values)))

    @property
    def reversed(self) -> InertiaCourse:
        """The other way round."""
        forces = {name: k[::-1] for name, k in self.forces.items()}
        own = {name: getattr(self, name)[::-1] for name in ("values", "epsilon", "half")}
        return replace(self, forces=forces, **own)
