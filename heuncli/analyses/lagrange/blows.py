"""A blow on Lagrange's side: e [q'] = h + H, (32), and what sections pass on of it.

    h_i = sum h . x_P,i        [q'] = n (h + H), H what drives exert
The reciprocal energy F = h n h / 2 is what h gives to the scene at rest.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import Chosen, accelerations
from heuncli.analyses.lagrange.drives import DriveRows
from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.instant import Instant
from heuncli.analyses.lagrange.results import BlowResults
from heuncli.analyses.lagrange.section_forces import section_forces
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve


def blows(
    spec: Spec, at: Instant, drives: DriveRows, by: Chosen, partials: Partials, epsilon: Array, eta: Array
) -> tuple[BlowResults, ...]:
    """The blows of an analysis of an impulse; none of another."""
    if spec.analysis.type != "impulse":
        return ()
    struck = solve(spec, Options(reduce=False)).struck
    count = 0 if struck is None else len(struck.jumps)
    return tuple(one(struck, k, at, drives, by, partials, epsilon, eta) for k in range(count) if struck is not None)


def one(
    struck: Impulses, k: int, at: Instant, drives: DriveRows, by: Chosen, partials: Partials, epsilon: Array, eta: Array
) -> BlowResults:
    """One blow of those that struck."""
    own = struck.recovery
    states = body_states(own.setup.scene.layout, own.recovered.at(np.array([k])))
    jumps = accelerations(at.freed.layout, by.names, states)[0]
    h = np.zeros(len(eta))
    for action in own.given:
        for end, force, moment in action.on_bodies():
            h = h + force[k] @ partials.at(end.body, end.position[k]) + moment[k] @ partials.turning(end.body)
    total = epsilon @ jumps
    exerted = drives.along(total - h)
    cut = struck.shown["sections"]
    return BlowResults(
        t=struck.jumps[k].time,
        h=h,
        drives=exerted,
        jumps=jumps,
        reciprocal_energy=float(0.5 * h @ eta @ h),
        sections={cuts.name: section_forces(cut[cuts.name], k, partials, cuts.body) for cuts in at.setup.cuts},
    )
