"""What impulses, forces at requested places and sections meet: jumps of rates, apparent inertias, section forces.
    ε [q̇] = h + H      (32)
An impulse meets the apparent inertia of the point where it acts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinate_rates import compute_accelerations
from heuncli.analyses.lagrange.coordinates import make_candidate_rows
from heuncli.analyses.lagrange.equations import DriveRows, InstantEquations, Partials
from heuncli.analyses.lagrange.results import ApparentInertia, ImpulseResults, SectionForces, get_units
from heuncli.base.errors import Problem, SolveError
from heuncli.base.spelling import suggest
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

IMMOBILE = 1e-12  # of the largest inverse inertia: below, the place does not move


def compute_impulses(spec: Spec, equations: InstantEquations, drives: DriveRows) -> tuple[ImpulseResults, ...]:
    """Return the impulses of an impulse analysis; empty for other analyses."""
    if spec.analysis.type != "impulse":
        return ()
    impulses = solve(spec, Options(reduce=False)).impulse_results
    if impulses is None:
        return ()
    return tuple(compute_impulse(impulses, k, equations, drives) for k in range(len(impulses.jumps)))


def compute_impulse(impulses: Impulses, k: int, equations: InstantEquations, drives: DriveRows) -> ImpulseResults:
    """Return the k-th impulse of the analysis."""
    instant, partials = equations.instant, equations.partials
    recovery = impulses.recovery
    # of impulses the recovered accelerations are the jumps of the velocities
    states = make_body_states(recovery.setup.scene.layout, recovery.solutions.select(np.array([k])))
    jumps = compute_accelerations(instant.freed_scene.layout, equations.choice.names, states)[0]
    h = np.zeros(len(equations.eta))
    for action in recovery.given_actions:
        for end, force, moment in action.iter_ends():
            force_part = force[k] @ partials.point_partials(end.body, end.position[k])
            h = h + force_part + moment[k] @ partials.turn_partials(end.body)
    drive_impulses = drives.project_on_drives(equations.epsilon @ jumps - h)
    section_blocks = impulses.all_blocks["sections"]
    return ImpulseResults(
        t=impulses.jumps[k].time,
        h=h,
        drives=drive_impulses,
        jumps=jumps,
        reciprocal_energy=float(0.5 * h @ equations.eta @ h),
        sections={
            cuts.name: compute_section_forces(section_blocks[cuts.name], k, partials, cuts.body)
            for cuts in instant.setup.cuts
        },
    )


def compute_apparent_inertias(equations: InstantEquations, requested: Sequence[str]) -> tuple[ApparentInertia, ...]:
    """Return the apparent inertias along all coordinates, or at the requested places: coordinates, or
    POINT:nx,ny,nz.
    """
    epsilon, eta = equations.epsilon, equations.eta
    inertias = {
        name: ApparentInertia(name, get_units(name).inertia, float(epsilon[i, i]), float(1.0 / eta[i, i]))
        for i, name in enumerate(equations.choice.names)
    }
    if not requested:
        return tuple(inertias.values())
    return tuple(
        inertias[name] if name in inertias else compute_apparent_inertia(equations, name) for name in requested
    )


def compute_apparent_inertia(equations: InstantEquations, name: str) -> ApparentInertia:
    """Return the apparent inertia along a coordinate that was not chosen, or at a point. Raises SolveError if nothing
    moves there.
    """
    instant, eta = equations.instant, equations.eta
    if ":" in name:
        row, unit = make_point_row(equations, name), "kg"
    else:
        rows = make_candidate_rows(instant.freed_scene.layout, instant.linear_equations)
        if name not in rows:
            hint = suggest(name, list(rows), "coordinates") or "or BODY.POINT:nx,ny,nz"
            raise SolveError(Problem("no-coordinate", f"--seen {name}: there is no such coordinate", hint=hint))
        row, unit = rows[name] @ equations.choice.S, get_units(name).inertia
    inverse = float(row @ eta @ row)
    if inverse <= IMMOBILE * float(np.abs(eta).max()) * max(float(row @ row), IMMOBILE):
        message = f"--seen {name}: it cannot move there: the apparent inertia is infinite"
        raise SolveError(Problem("no-coordinate", message, hint="use another instant or another direction"))
    return ApparentInertia(name, unit, None, 1.0 / inverse)


def make_point_row(equations: InstantEquations, name: str) -> Array:
    """Return the row (f,) of the velocity of a point along a direction, both named as POINT:nx,ny,nz."""
    instant = equations.instant
    place, _, direction = name.partition(":")
    mechanism = instant.freed_scene.layout.mechanism
    points = {
        f"{body.name}.{point_name}": (i, point)
        for i, body in enumerate(mechanism.bodies)
        for point_name, point in body.points.items()
    }
    if place not in points:
        hint = suggest(place, list(points), "points") or ""
        raise SolveError(Problem("no-coordinate", f"--seen {name}: there is no point {place}", hint=hint))
    n = np.array([float(word) for word in direction.split(",")])
    body, point = points[place]
    states = make_body_states(instant.freed_scene.layout, instant.freed_recovered)
    position = states.point_position(body, point)[0]
    return np.asarray(n / np.sqrt(n @ n) @ equations.partials.point_partials(body, position))


def compute_section_forces(block: Mapping[str, Array], k: int, partials: Partials, body: int) -> SectionForces:
    """Return the generalised forces of a section of a body at instant k.

    block: its `point`, `force` and `moment`, (n_t, 3), for several cuts (n_t, cuts, 3); nan where indeterminate
    """
    points, force, moment = (np.atleast_2d(block[name][k]) for name in ("point", "force", "moment"))
    generalised_forces = [
        F @ partials.point_partials(body, P) + M @ partials.turn_partials(body)
        for P, F, M in zip(points, force, moment, strict=True)
    ]
    shift, turn = (np.sqrt(np.sum(part**2, axis=1)).max(axis=0) for part in (partials.shift, partials.turn))
    largest = [np.nanmax(np.sqrt(np.sum(load**2, axis=1)), initial=0.0) for load in (force, moment)]
    scale = largest[0] * shift + largest[1] * turn
    return SectionForces(np.array(generalised_forces), scale, block["force"][k].ndim > 1)
