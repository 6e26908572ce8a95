"""Impulses in Lagrange's equations, e [q'] = h + H, (32), and the apparent inertia that an impulse meets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import CoordinateChoice, compute_accelerations, make_candidate_rows
from heuncli.analyses.lagrange.equations import DriveRows, Partials, compute_section_forces
from heuncli.analyses.lagrange.freed_scene import Instant
from heuncli.analyses.lagrange.results import ApparentInertia, ImpulseResults, get_units
from heuncli.base.errors import Problem, SolveError
from heuncli.base.spelling import suggest
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


IMMOBILE = 1e-12  # of the largest inverse inertia: below, the place does not move


def compute_apparent_inertias(
    instant: Instant, choice: CoordinateChoice, partials: Partials, epsilon: Array, eta: Array, requested: Sequence[str]
) -> tuple[ApparentInertia, ...]:
    """Return the apparent inertias along all coordinates, or at the requested places: coordinates, or
    POINT:nx,ny,nz.
    """
    inertias = {
        name: ApparentInertia(name, get_units(name).inertia, float(epsilon[i, i]), float(1.0 / eta[i, i]))
        for i, name in enumerate(choice.names)
    }
    if not requested:
        return tuple(inertias.values())
    return tuple(
        inertias[name] if name in inertias else compute_apparent_inertia(instant, choice, partials, eta, name)
        for name in requested
    )


def compute_apparent_inertia(
    instant: Instant, choice: CoordinateChoice, partials: Partials, eta: Array, name: str
) -> ApparentInertia:
    """Return the apparent inertia along a coordinate that was not chosen, or at a point. Raises SolveError if nothing
    moves there.
    """
    place, colon, direction = name.partition(":")
    if colon:
        row, unit = make_point_row(instant, partials, place, direction, name) @ np.eye(len(eta)), "kg"
    else:
        rows = make_candidate_rows(instant.freed_scene.layout, instant.linear_equations)
        if name not in rows:
            hint = suggest(name, list(rows), "coordinates") or "or BODY.POINT:nx,ny,nz"
            raise SolveError(Problem("no-coordinate", f"--seen {name}: there is no such coordinate", hint=hint))
        row, unit = rows[name] @ choice.S, get_units(name).inertia
    inverse = float(row @ eta @ row)
    if inverse <= IMMOBILE * float(np.abs(eta).max()) * max(float(row @ row), IMMOBILE):
        message = f"--seen {name}: it cannot move there: the apparent inertia is infinite"
        raise SolveError(Problem("no-coordinate", message, hint="use another instant or another direction"))
    return ApparentInertia(name, unit, None, 1.0 / inverse)


def make_point_row(instant: Instant, partials: Partials, place: str, direction: str, option_text: str) -> Array:
    """Return the row (f,) of the velocity of a point along a direction."""
    mechanism = instant.freed_scene.layout.mechanism
    points = {
        f"{body.name}.{name}": (i, p) for i, body in enumerate(mechanism.bodies) for name, p in body.points.items()
    }
    if place not in points:
        hint = suggest(place, list(points), "points") or ""
        raise SolveError(Problem("no-coordinate", f"--seen {option_text}: there is no point {place}", hint=hint))
    n = np.array([float(word) for word in direction.split(",")])
    body, point = points[place]
    states = make_body_states(instant.freed_scene.layout, instant.freed_recovered)
    return np.asarray(n / np.sqrt(n @ n) @ partials.point_partials(body, states.point_position(body, point)[0]))
