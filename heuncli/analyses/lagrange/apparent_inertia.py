"""Apparent inertia: along a coordinate, or as an impulse at a point in a direction meets it.
others locked: e_ii        others free: 1 / n_ii        at a point: 1 / (n . X eta X' n), X = dv_P/dq'
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinate_units import get_units
from heuncli.analyses.lagrange.coordinates import CoordinateChoice, make_candidate_rows
from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.instant import Instant
from heuncli.analyses.lagrange.results import ApparentInertia
from heuncli.base.errors import Problem, SolveError
from heuncli.base.spelling import suggest
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.results.results import Array

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
