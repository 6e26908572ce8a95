"""Load cases of solved scenes, and what a mesh would make of them: point masses under the acceleration of the body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from heuncli.analyses.load_cases.assembly import assemble_load_cases
from heuncli.analyses.load_cases.model import LoadCases, LoadedBody
from heuncli.results.results import Array
from heuncli.study.queries.at_option import parse
from heuncli.study.queries.study import Study


def cases_of(run: Study, body: str, at: str) -> LoadCases:
    """The load cases of a body at some instants."""
    return assemble_load_cases(run, body, parse(at))


class PointMasses(NamedTuple):
    """Masses (n,) at places (n, 3): as good as a mesh for everything rigid."""

    masses: Array
    places: Array


def point_masses(body: LoadedBody) -> PointMasses:
    """Seven masses that have a body's mass, centre of mass and second moments: one at the centre, two on each axis.

    Of the second moment T about the centre with principal values t_i two masses m/12 at +-sqrt(6 t_i/m) have t_i.
    """
    T = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia
    values, axes = np.linalg.eigh(T)
    arms = np.sqrt(6.0 * np.maximum(values, 0.0) / body.mass) * axes
    places = [body.center, *(body.center + sign * arms[:, i] for i in range(3) for sign in (1.0, -1.0))]
    return PointMasses(np.array([0.5, *[1.0 / 12.0] * 6]) * body.mass, np.array(places))
