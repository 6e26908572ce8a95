"""Where what is given in time alone has to be looked at, that no turn of it is passed over: loads and laws of drives.

A body that is held feels no push, so that no step of an integration tells how fast a load on it runs; nor need a
drive's law be followed in small steps. Each is looked at on its own, which costs next to nothing against the machine:
its value and both its derivatives, for a ripple that hardly shows in a travel is the whole of an acceleration. Instants
are added to a grid until the cubics through four neighbours foretell it (study/search/turnings.py). What is shorter
than the distance at which it is looked at is found by bounds of its values over stretches of time, which hold for what
was not seen, too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.study.search.extremes import distinct
from heuncli.study.search.turnings import SampledTurns, resolved

EVENLY = 256  # stretches of a run whose bounds are looked at, however few instants the grid has
UNSEEN = 1e-9  # of the largest: what of a load or a law is less is in no digit that is told
BEYOND = 0.02  # of all that was seen of an expression: its bounds may go so far beyond what was seen near them
ORDERS = 3  # value, first and second derivative


def given_in_time(mechanism: Mechanism) -> tuple[list[Expression], list[Expression]]:
    """Loads that are functions of time alone, and the laws of drives that are no constants, each once."""
    laws = {law.value for law in mechanism.laws}
    in_time = dict.fromkeys(e for e in mechanism.expressions() if e.time_dependent and not e.uses)
    return [e for e in in_time if e not in laws], [e for e in in_time if e in laws]


def close_to(mechanism: Mechanism, grid: Array, most: int) -> tuple[Array, bool]:
    """A grid (n,), ascending, with more instants where what is given in time needs them; whether `most` are enough."""
    loads, laws = given_in_time(mechanism)
    in_time = [*loads, *laws]
    span = float(np.ptp(grid))
    if not in_time or not span > 0.0:
        return grid, True
    fine = distinct(np.concatenate([grid, np.linspace(grid[0], grid[-1], EVENLY + 1)]))
    fine, complete = within_bounds(in_time, fine, most)
    size = np.abs(columns(in_time, fine)).max(axis=0).reshape(len(in_time), ORDERS)
    of_load = np.arange(len(in_time)) < len(loads)

    def slack(_: Array, width: Array) -> Array:
        """What does not count of the values and derivatives over intervals of some widths, (m, 3 n)."""
        h = width[:, None]
        value, rate, second = (UNSEEN * size[None, :, k] + 0.0 * h for k in range(ORDERS))
        # of a load its value counts: of its derivatives what changes that within an interval
        rate, second = np.where(of_load, 4.0 * value / h, rate), np.where(of_load, 8.0 * value / (h * h), second)
        return np.asarray(np.stack([value, rate, second], axis=2).reshape(len(width), -1))

    begun = SampledTurns(grid, columns(in_time, grid), complete)
    probes = np.setdiff1d(fine, grid, assume_unique=True)
    found = resolved(lambda at: columns(in_time, at), begun, slack, most=most, probes=probes)
    return found.times, complete and found.complete


def columns(in_time: Sequence[Expression], times: Array) -> Array:
    """Values, first and second derivatives of expressions, (n_t, 3 n); 0 where there is none, as of a root at 0."""
    found = np.array([e.course(times.tolist()) for e in in_time]).reshape(-1, len(times)).T
    return np.where(np.isfinite(found), found, 0.0)


def within_bounds(in_time: Sequence[Expression], times: Array, most: int) -> tuple[Array, bool]:
    """Instants between which no expression may leave what is seen of it by much, as its bounds tell; if so many do."""
    span = float(np.ptp(times))
    for expression in in_time:
        values = np.array(expression.sample(times.tolist()))
        k = np.arange(len(times) - 1)  # the stretches whose bounds are not known
        while len(k):
            k = k[times[k + 1] - times[k] > tolerances.SIDE_BY_SIDE * span]
            if len(times) > most:
                return times, False
            least, largest = (np.array(x) for x in expression.bounds(times[k].tolist(), times[k + 1].tolist()))
            near = np.stack([values[np.clip(k + i, 0, len(times) - 1)] for i in (-1, 0, 1, 2)])
            allowed = np.maximum(np.ptp(near, axis=0), BEYOND * np.ptp(values))
            off = np.maximum(largest - near.max(axis=0), near.min(axis=0) - least) > allowed  # no bounds, no stretch
            k = k[off]
            at = 0.5 * (times[k] + times[k + 1])
            times = np.insert(times, k + 1, at)
            values = np.insert(values, k + 1, expression.sample(at.tolist()))
            left = k + np.arange(len(k))
            k = np.sort(np.concatenate([left, left + 1]))
    return times, True
