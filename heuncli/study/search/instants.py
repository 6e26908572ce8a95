"""Instants of a run close enough to each other to bracket every extreme of what is told of it."""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.segments import limits_of
from heuncli.results.results import Array
from heuncli.scene.shapes.by_component import rows, squares
from heuncli.study.model.setup import Setup
from heuncli.study.search.extremes import distinct, finite
from heuncli.study.solve.history import History, resample

WITHIN_STEP = (0.0, 0.23, 0.52, 0.77)  # of each step of the integrator: where it is looked at for extremes first
TURNED = np.pi / 8.0  # rad: so far a body may turn between two of these instants, an eighth period of what goes twice
MOST_SEARCHED = 100_000


def search_times(setup: Setup, history: History, most: int = MOST_SEARCHED) -> tuple[Array, bool]:
    """Instants close enough to bracket every extreme, (n,) ascending; and whether there are enough of them.

    The asked ones; some within each step, at uneven distances, so that nothing that repeats itself looks at rest; both
    sides of all jumps; as many as show how loads and drives run; and so many that no body turns far
    between two of them: a rotor that is driven, or spins on, needs no steps, but its loads turn. most: so many, about.
    """
    times = history.times
    if history.checked is None:
        return times, True
    marks = np.concatenate([[0.0], history.checked.run.ends])
    per_step = max(1, min(len(WITHIN_STEP), most // max(len(marks), 1)))
    inner = (marks[:-1, None] + np.diff(marks)[:, None] * np.array(WITHIN_STEP[:per_step])).ravel()
    # a jump has a value on either side of it
    grid = inner
    if history.jumps:
        before, after = limits_of(history.jumps)
        grid = np.concatenate([inner, before[before > 0.0], after[before > 0.0]])
    grid = distinct(np.concatenate([times, grid[(grid > times[0]) & (grid < times[-1])]]))
    grid, followed = with_those_in_time(setup, grid, most)
    turns = np.ceil(turned_between(setup, history, grid) / TURNED)
    parts = np.clip(turns, 1, most + 1).astype(int)  # what turns faster is not searched to its turns
    enough = followed and per_step == len(WITHIN_STEP) and int(parts.sum()) <= most
    parts = np.minimum(parts, max(1, most // len(grid))) if not enough else parts
    first = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(first)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[first]
    times = np.append(grid[first] + share * np.diff(grid)[first], grid[-1:])
    if not enough or not has_loads_along_coordinates(setup):
        return times, enough
    from heuncli.study.search.along_coordinates import close_to_loads

    return close_to_loads(setup, history, times, most)


def has_loads_along_coordinates(setup: Setup) -> bool:
    """Whether loads are functions of coordinates or points: where these push nothing, no step tells how fast."""
    return any(value.uses for load in setup.scene.mechanism.loads for value in load.values)


def with_those_in_time(setup: Setup, grid: Array, most: int) -> tuple[Array, bool]:
    """The grid with instants where loads and drives in time need them; whether so many are enough."""
    if not any(e.time_dependent and not e.uses for e in setup.scene.mechanism.expressions()):
        return grid, True
    from heuncli.study.search.in_time import close_to

    return close_to(setup.scene.mechanism, grid, most)


def turned_between(setup: Setup, history: History, grid: Array) -> Array:
    """The largest angle [rad] by which any body turns between neighbouring instants, (n - 1,)."""
    driven = setup.scene.layout.driven
    known = resample(setup.runner, history, grid) if driven else history.recovered
    omega = np.sqrt(finite(squares(rows(known.bodies["omega"]))).max(axis=0, initial=0.0))
    omega = np.interp(grid, known.times, omega)
    return np.asarray(np.maximum(omega[1:], omega[:-1]) * np.diff(grid))
