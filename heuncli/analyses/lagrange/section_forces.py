"""Generalised forces of the piece beyond a cut on the rest: s' of loads, r' of an impulse; (50), (51), (53). s'_i = s'
. x_P,i + M'(P) . w_i         by the partials of the cut body
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.results import SectionForces
from heuncli.results.results import Array


def compute_section_forces(block: Mapping[str, Array], k: int, partials: Partials, body: int) -> SectionForces:
    """Return the generalised forces of a section of a body at instant k.

    block: its `point`, `force` and `moment`, (n_t, 3), for several cuts (n_t, cuts, 3); nan where indeterminate
    """
    points, force, moment = (np.atleast_2d(block[name][k]) for name in ("point", "force", "moment"))
    s = [
        F @ partials.point_partials(body, P) + M @ partials.turn_partials(body)
        for P, F, M in zip(points, force, moment, strict=True)
    ]
    shift, turn = (np.sqrt(np.sum(of**2, axis=1)).max(axis=0) for of in (partials.shift, partials.turn))
    largest = [np.nanmax(np.sqrt(np.sum(load**2, axis=1)), initial=0.0) for load in (force, moment)]
    scale = largest[0] * shift + largest[1] * turn
    return SectionForces(np.array(s), scale, block["force"][k].ndim > 1)


def to_lists(section: SectionForces) -> Any:
    """Return the forces as JSON lists: one per cut, or that of the only cut; None where indeterminate."""
    values = [None if np.isnan(s).any() else s.tolist() for s in section.s]
    return values if section.is_run else values[0]


def list_cuts(name: str, section: SectionForces) -> list[tuple[str, Array | None]]:
    """Return the cuts by name with their forces; None where indeterminate."""
    return [
        (f"{name}.{k}" if section.is_run else name, None if np.isnan(s).any() else s) for k, s in enumerate(section.s)
    ]
