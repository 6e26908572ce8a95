"""Impulses in Lagrange's equations: e [q'] = h + H, (32), and what sections transmit of them.
    h_i = sum h . x_P,i        [q'] = n (h + H), H what drives exert
The reciprocal energy F = h n h / 2 is the energy that h gives to the scene at rest.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import CoordinateChoice, compute_accelerations
from heuncli.analyses.lagrange.drives import DriveRows
from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.instant import Instant
from heuncli.analyses.lagrange.results import ImpulseResults
from heuncli.analyses.lagrange.section_forces import compute_section_forces
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve


def compute_impulses(
    spec: Spec,
    instant: Instant,
    drives: DriveRows,
    choice: CoordinateChoice,
    partials: Partials,
    epsilon: Array,
    eta: Array,
) -> tuple[ImpulseResults, ...]:
    """Return the impulses of an impulse analysis; empty for other analyses."""
    if spec.analysis.type != "impulse":
        return ()
    impulses = solve(spec, Options(reduce=False)).impulse_results
    count = 0 if impulses is None else len(impulses.jumps)
    return tuple(
        compute_impulse(impulses, k, instant, drives, choice, partials, epsilon, eta)
        for k in range(count)
        if impulses is not None
    )


def compute_impulse(
    impulses: Impulses,
    k: int,
    instant: Instant,
    drives: DriveRows,
    choice: CoordinateChoice,
    partials: Partials,
    epsilon: Array,
    eta: Array,
) -> ImpulseResults:
    """Return one impulse of the analysis."""
    recovery = impulses.recovery
    states = make_body_states(recovery.setup.scene.layout, recovery.solutions.select(np.array([k])))
    jumps = compute_accelerations(instant.freed_scene.layout, choice.names, states)[0]
    h = np.zeros(len(eta))
    for action in recovery.given_actions:
        for end, force, moment in action.iter_ends():
            h = (
                h
                + force[k] @ partials.point_partials(end.body, end.position[k])
                + moment[k] @ partials.turn_partials(end.body)
            )
    total = epsilon @ jumps
    drive_impulses = drives.project_on_drives(total - h)
    section_blocks = impulses.all_blocks["sections"]
    return ImpulseResults(
        t=impulses.jumps[k].time,
        h=h,
        drives=drive_impulses,
        jumps=jumps,
        reciprocal_energy=float(0.5 * h @ eta @ h),
        sections={
            cuts.name: compute_section_forces(section_blocks[cuts.name], k, partials, cuts.body)
            for cuts in instant.setup.cuts
        },
    )
