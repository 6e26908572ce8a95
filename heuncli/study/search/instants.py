"""Choose instants of a run that are close enough to each other to bracket every extreme of its results."""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.integrated_scene import find_one_sided_limits
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import instants_last, squared_lengths
from heuncli.study.model.setup import Setup
from heuncli.study.search.extremes import replace_non_finite, sort_distinct
from heuncli.study.solve.history import History, resample

WITHIN_STEP = (0.0, 0.23, 0.52, 0.77)  # of each step of the integrator: the first samples for extremes
MAX_TURN = np.pi / 8.0  # rad: largest turn of a body between two of these instants, 1/8 period of the second order
MAX_INSTANTS = 100_000


def choose_search_times(setup: Setup, history: History, max_instants: int = MAX_INSTANTS) -> tuple[Array, bool]:
    """Choose instants close enough to bracket every extreme, (n,) ascending; and whether there are enough of them.

    They are the requested ones; some within each step, at uneven distances, so that nothing periodic looks constant;
    both sides of all jumps; enough to show how loads and drives change; and so many that no body turns far between two
    of them: a rotor that is driven, or spins on, needs no steps, but its loads turn. max_instants: approximate limit of
    their number.
    """
    times = history.times
    if history.checked_run is None:
        return times, True
    marks = np.concatenate([[0.0], history.checked_run.run.ends])
    per_step = max(1, min(len(WITHIN_STEP), max_instants // max(len(marks), 1)))
    inside_steps = (marks[:-1, None] + np.diff(marks)[:, None] * np.array(WITHIN_STEP[:per_step])).ravel()
    # a jump has a value on either side of it
    grid = inside_steps
    if history.jumps:
        before, after = find_one_sided_limits(history.jumps)
        grid = np.concatenate([inside_steps, before[before > 0.0], after[before > 0.0]])
    grid = sort_distinct(np.concatenate([times, grid[(grid > times[0]) & (grid < times[-1])]]))
    grid, is_followed = add_time_law_instants(setup, grid, max_instants)
    turn_parts = np.ceil(find_largest_turns(setup, history, grid) / MAX_TURN)
    parts = np.clip(turn_parts, 1, max_instants + 1).astype(int)  # for faster turning the search is incomplete
    enough = is_followed and per_step == len(WITHIN_STEP) and int(parts.sum()) <= max_instants
    parts = np.minimum(parts, max(1, max_instants // len(grid))) if not enough else parts
    first = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(first)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[first]
    times = np.append(grid[first] + share * np.diff(grid)[first], grid[-1:])
    if not enough or not has_loads_along_coordinates(setup):
        return times, enough
    from heuncli.study.search.along_coordinates import refine_for_loads

    return refine_for_loads(setup, history, times, max_instants)


def has_loads_along_coordinates(setup: Setup) -> bool:
    """Whether loads depend on coordinates or points: if they push a constrained direction, no step shows how fast they
    change.
    """
    return any(value.uses for load in setup.scene.mechanism.loads for value in load.values)


def add_time_law_instants(setup: Setup, grid: Array, max_instants: int) -> tuple[Array, bool]:
    """Add instants to the grid where loads and drives in time need them; and whether `max_instants` are enough."""
    if not any(e.time_dependent and not e.uses for e in setup.scene.mechanism.iter_expressions()):
        return grid, True
    from heuncli.study.search.in_time import refine_for_time_laws

    return refine_for_time_laws(setup.scene.mechanism, grid, max_instants)


def find_largest_turns(setup: Setup, history: History, grid: Array) -> Array:
    """Return the largest angle [rad] by which any body turns between neighbouring instants, (n - 1,)."""
    driven = setup.scene.layout.has_laws
    known = resample(setup.runner, history, grid) if driven else history.solutions
    omega = np.sqrt(replace_non_finite(squared_lengths(instants_last(known.bodies["omega"]))).max(axis=0, initial=0.0))
    omega = np.interp(grid, known.times, omega)
    return np.asarray(np.maximum(omega[1:], omega[:-1]) * np.diff(grid))
