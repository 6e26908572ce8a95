"""What `heun lagrange` tells of an instant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.records import record
from heuncli.results import Array


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
class LagrangeResults:
    """The Lagrange side of a scene at an instant; f coordinates.

    values: of the coordinates, not a number of quasi-velocities; rates q'; accelerations q'' of the scene as it is,
    with its drives; forces k by cause; drives Q: what drives do beside them, 0 where nothing drives; C: coriolis, with
    its matrix; gamma[i, l, k], alpha[i, l, k]: None where they were not asked for or the rates are those of no coordinates.
    energies: of what is free, mixed, driven. scale: of what size the parts are whose sums the forces are; residual: of
    e q'' + C = k + Q where Q is known otherwise, of these.
    """

    title: str
    t: float
    at: str
    names: tuple[str, ...]
    driven: tuple[bool, ...]
    lengths: tuple[bool, ...]
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
    energies: tuple[float, float, float]
    reciprocal_energy: float
    scale: Array
    residual: float
    seen: tuple[Seen, ...]
    sections: Mapping[str, Mapping[str, Any]]
    partials: Mapping[str, Any]
    left_out: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def total(self) -> Array:
        """k: the sum of all causes."""
        return sum(self.forces.values(), np.zeros(len(self.names)))

    @property
    def energy(self) -> float:
        """E."""
        return sum(self.energies)
