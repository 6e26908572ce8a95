"""The inertia that is seen from outside: along a coordinate, or by a blow on a point in a direction.

others locked: e_ii        others free: 1 / n_ii        at a point: 1 / (n . X eta X' n), X = dv_P/dq'
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import Chosen, candidates
from heuncli.analyses.lagrange.equations import Partials
from heuncli.analyses.lagrange.instant import Instant
from heuncli.analyses.lagrange.kinds import units_of
from heuncli.analyses.lagrange.results import Seen
from heuncli.base.errors import Problem, SolveError
from heuncli.base.nearest import did_you_mean
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.results.results import Array

STILL = 1e-12  # of the largest inverse inertia: what moves by less does not move


def seen(
    at: Instant, by: Chosen, partials: Partials, epsilon: Array, eta: Array, asked: Sequence[str]
) -> tuple[Seen, ...]:
    """What is seen along all coordinates, or at the places asked for: coordinates, or POINT:nx,ny,nz."""
    own = {
        name: Seen(name, units_of(name).inertia, float(epsilon[i, i]), float(1.0 / eta[i, i]))
        for i, name in enumerate(by.names)
    }
    if not asked:
        return tuple(own.values())
    return tuple(own[name] if name in own else beside(at, by, partials, eta, name) for name in asked)


def beside(at: Instant, by: Chosen, partials: Partials, eta: Array, name: str) -> Seen:
    """Along a coordinate that was not chosen, or at a point. Raises SolveError where nothing is seen there."""
    place, colon, direction = name.partition(":")
    if colon:
        row, unit = along_point(at, partials, place, direction, name) @ np.eye(len(eta)), "kg"
    else:
        rows = candidates(at.freed.layout, at.found)
        if name not in rows:
            hint = did_you_mean(name, list(rows), "coordinates") or "or BODY.POINT:nx,ny,nz"
            raise SolveError(Problem("no-coordinate", f"--seen {name}: no coordinate is called so", hint=hint))
        row, unit = rows[name] @ by.S, units_of(name).inertia
    inverse = float(row @ eta @ row)
    if inverse <= STILL * float(np.abs(eta).max()) * max(float(row @ row), STILL):
        message = f"--seen {name}: it cannot move there: the inertia seen is without bound"
        raise SolveError(Problem("no-coordinate", message, hint="look at another instant, or in another direction"))
    return Seen(name, unit, None, 1.0 / inverse)


def along_point(at: Instant, partials: Partials, place: str, direction: str, words: str) -> Array:
    """What the rates make of the velocity of a point along a direction, (f,)."""
    mechanism = at.freed.layout.mechanism
    points = {
        f"{body.name}.{name}": (i, p) for i, body in enumerate(mechanism.bodies) for name, p in body.points.items()
    }
    if place not in points:
        hint = did_you_mean(place, list(points), "points") or ""
        raise SolveError(Problem("no-coordinate", f"--seen {words}: no point is called {place}", hint=hint))
    n = np.array([float(word) for word in direction.split(",")])
    body, point = points[place]
    states = body_states(at.freed.layout, at.here)
    return np.asarray(n / np.sqrt(n @ n) @ partials.at(body, states.point_position(body, point)[0]))
