"""Whether a run gets on: how many steps the rest of it would take at the pace of those done.

What grows without bound, or turns ever faster, takes steps that become ever shorter: no step is wrong, and the end is
never reached. With t(n) the instant after n steps, the times that n/4 -> n/2 and n/2 -> n took have a ratio r; r = 2 is
a steady pace, √2 a rate in proportion to the time, 1 an exponential growth, less than 1 one that ends at an instant
of its own. Every further doubling of n is taken to last r times the one before:

    last - t = d (r + r^2 + ... + r^k),  d of the last doubling,  n 2^k steps

So only where its shortest steps are its last: those of an irregular motion become shorter for a while, and longer
again; it is taken to go on at the pace of its last part.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

PARTS = 8  # of the steps done, whose lengths are compared
FIRST_LOOK = 2_000  # steps; then each time that their number has doubled


def projected_steps(ends: Array, last: float) -> float:
    """How many steps a run to `last` takes in all if it goes on as it did; ends (n,): of the steps done."""
    n = len(ends)
    quarter, half, now = (float(ends[k - 1]) for k in (n // 4, n // 2, n))
    d, before = now - half, half - quarter
    if not (d > 0.0 and before > 0.0):
        return math.inf
    r, rest = d / before, (last - now) / d
    if r == 1.0:
        doublings = rest
    else:
        left = 1.0 + rest * (r - 1.0) / r  # r^k
        doublings = math.log(left) / math.log(r) if left > 0.0 else math.inf
    return n * 2.0**doublings if doublings < 1000.0 else math.inf


def hopeless(ends: Array, last: float, most: int, *, irregular: bool = True) -> float | None:
    """How many steps a run would take that cannot come near its end within `most` of them; None: it may.

    irregular: whether steps may become shorter for a while; those along a branch do so towards where it ends.

    The longer a pace has been kept the less may still change it: what may be left of the steps projected is the root of
    the part done of the most, a hundredth after 2,000 of 20 million.
    """
    took = np.diff(ends[np.linspace(0, len(ends) - 1, PARTS + 1).astype(int)])
    if took[-1] <= took.min() or not irregular:
        steps = projected_steps(ends, last)
    else:
        steps = len(ends) * (1.0 + float((last - ends[-1]) / took[-1]) / PARTS)
    return steps if steps > tolerances.HOPELESS * most * math.sqrt(most / len(ends)) else None


def seconds_left(ends: Array, last: float, took: float) -> float:
    """What the rest of a run would take at the pace of its last steps [s]; ends (n,): of the steps done in `took` s."""
    n = len(ends)
    begun = float(ends[-1] - ends[-1 - n // PARTS]) if n >= PARTS else 0.0
    return float(last - ends[-1]) / begun * took / PARTS if begun > 0.0 else math.inf


def in_words(ends: Array, last: float, took: float) -> str:
    """What a run that was given up would have taken, at the pace of its last steps; took: those done [s]."""
    left = seconds_left(ends, last, took) if len(ends) >= FIRST_LOOK else math.inf
    return f"; at the pace of its last steps the rest would take about {left:.1g} s" if left < math.inf else ""
