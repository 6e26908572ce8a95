"""What the piece beyond a cut does on the rest along the coordinates: s' of loads, r' of a blow; (50), (51), (53).

s'_i = s' . x_P,i + M'(P) . w_i         by the partials of the body that is cut
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.results import SectionForces
from heuncli.results.results import Array


def section_forces(block: Mapping[str, Array], k: int, partials: Partials, body: int) -> SectionForces:
    """Along the coordinates, of a section of a body at instant k.

    block: its `point`, `force` and `moment`, (n_t, 3), of a run of cuts (n_t, cuts, 3); nan where they are open.
    """
    points, force, moment = (np.atleast_2d(block[name][k]) for name in ("point", "force", "moment"))
    s = [F @ partials.at(body, P) + M @ partials.turning(body) for P, F, M in zip(points, force, moment, strict=True)]
    shift, turn = (np.sqrt(np.sum(of**2, axis=1)).max(axis=0) for of in (partials.shift, partials.turn))
    largest = [np.nanmax(np.sqrt(np.sum(load**2, axis=1)), initial=0.0) for load in (force, moment)]
    reach = largest[0] * shift + largest[1] * turn
    return SectionForces(np.array(s), reach, block["force"][k].ndim > 1)


def lists(of: SectionForces) -> Any:
    """As JSON has it: of each cut of a run, or of the one; None where it is open."""
    found = [None if np.isnan(s).any() else s.tolist() for s in of.s]
    return found if of.is_run else found[0]


def cuts(name: str, of: SectionForces) -> list[tuple[str, Array | None]]:
    """The cuts by their names, with their numbers; None where they are open."""
    return [(f"{name}.{k}" if of.is_run else name, None if np.isnan(s).any() else s) for k, s in enumerate(of.s)]
