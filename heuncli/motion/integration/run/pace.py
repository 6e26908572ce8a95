"""Estimate whether a run will finish: how many steps the rest of it would take at the pace of those done.

What grows without bound, or turns ever faster, takes ever shorter steps: no step is wrong, and the end is never
reached. With t(n) the instant after n steps, the times of the steps n/4 -> n/2 and n/2 -> n have a ratio r. r = 2 is a
steady pace, √2 a rate in proportion to the time, 1 an exponential growth, less than 1 one that ends at a finite
instant. Every further doubling of n is assumed to last r times the one before:

    last - t = d (r + r^2 + ... + r^k),  d of the last doubling,  n 2^k steps

This applies only where the last steps are the shortest: those of an irregular motion become shorter for a while, and
longer again; then the pace of its last part is assumed to continue.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

PARTS = 8  # of the steps done, whose lengths are compared
FIRST_LOOK = 2_000  # steps; then each time that their number has doubled


def project_steps(ends: Array, last: float) -> float:
    """Project how many steps a run to `last` takes in all; ends (n,): of the steps done."""
    n = len(ends)
    quarter, half, now = (float(ends[k - 1]) for k in (n // 4, n // 2, n))
    d, previous_doubling = now - half, half - quarter
    if not (d > 0.0 and previous_doubling > 0.0):
        return math.inf
    r, rest = d / previous_doubling, (last - now) / d
    if r == 1.0:
        doublings = rest
    else:
        left = 1.0 + rest * (r - 1.0) / r  # r^k
        doublings = math.log(left) / math.log(r) if left > 0.0 else math.inf
    return n * 2.0**doublings if doublings < 1000.0 else math.inf


def find_hopeless_steps(ends: Array, last: float, max_steps: int, *, irregular: bool = True) -> float | None:
    """Return how many steps a run would take if it cannot come near its end within `max_steps` of them; else None.

    irregular: whether steps may become shorter for a while; those along a branch do so towards its end

    The longer a pace has lasted, the less it may still change: the tolerated excess is the square root of the part done
    of the maximum, a hundredth after 2,000 of 20 million.
    """
    part_times = np.diff(ends[np.linspace(0, len(ends) - 1, PARTS + 1).astype(int)])
    if part_times[-1] <= part_times.min() or not irregular:
        steps = project_steps(ends, last)
    else:
        steps = len(ends) * (1.0 + float((last - ends[-1]) / part_times[-1]) / PARTS)
    return steps if steps > tolerances.HOPELESS * max_steps * math.sqrt(max_steps / len(ends)) else None


def estimate_seconds_left(ends: Array, last: float, seconds: float) -> float:
    """Estimate the time for the rest of a run at the pace of its last steps [s]; ends (n,): of the steps done in
    `seconds`.
    """
    n = len(ends)
    last_part = float(ends[-1] - ends[-1 - n // PARTS]) if n >= PARTS else 0.0
    return float(last - ends[-1]) / last_part * seconds / PARTS if last_part > 0.0 else math.inf


def format_seconds_left(ends: Array, last: float, seconds: float) -> str:
    """Say how long the rest of a stopped run would have taken at the pace of its last steps."""
    left = estimate_seconds_left(ends, last, seconds) if len(ends) >= FIRST_LOOK else math.inf
    return f"; at the pace of its last steps the rest would take about {left:.1g} s" if left < math.inf else ""
