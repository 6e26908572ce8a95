"""What a load or drive does in time between the instants at which a run has looked at it.

A step of the integrator judges itself by its stages. A pulse between two of them leaves no trace there, however high it
is. So the steps that were done are looked at again: bounds over parts of each (kernel/enclosure.py) that stay near
what the stages saw settle it; where they do not, the part is halved, until the bounds come down or an instant is found
whose value no stage has seen. The ends of that part become instants to stop at, and the run is made again.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.expressions.programs import Expression
from heuncli.integration.runner import Trajectory
from heuncli.mechanism.model import Mechanism
from heuncli.results import Array

PARTS = 4  # of each step, looked at first
MOST_PARTS = 20_000  # looked at together; where more are in doubt, the widest are
HALVINGS = 60


def unseen(mechanism: Mechanism, run: Trajectory) -> list[float]:
    """Instants to stop at, ascending: about what the steps of a run have not seen of loads and drives in time alone."""
    in_time = {e for e in mechanism.expressions() if e.time_dependent and not e.uses}
    begins = np.concatenate([[0.0], run.ends[:-1]])
    return sorted({t for expression in in_time for t in missed(expression, begins, run.ends, run.method.nodes)})


def missed(expression: Expression, begins: Array, ends: Array, nodes: Sequence[float]) -> list[float]:
    """Ends of the spans within the steps in which an expression takes values that none of their stages met."""
    # a step ends just before a jump at its end
    last = np.nextafter(ends, -np.inf)
    at = begins[:, None] + (last - begins)[:, None] * np.unique([*nodes, 1.0])
    seen = np.array(expression.sample(at.ravel().tolist())).reshape(at.shape)
    low, high = seen.min(axis=1), seen.max(axis=1)
    step = np.repeat(np.arange(len(ends)), PARTS)
    cuts = begins[:, None] + (last - begins)[:, None] * (np.arange(PARTS + 1) / PARTS)
    a, b = cuts[:, :-1].ravel(), cuts[:, 1:].ravel()
    found: list[float] = []
    for _ in range(HALVINGS):
        lowest, highest = map(np.array, expression.bounds(a.tolist(), b.tolist()))
        finite = np.abs(np.concatenate([lowest, highest]))
        scale = float(finite[np.isfinite(finite)].max(initial=0.0))
        room = (high - low + tolerances.UNSEEN * scale)[step]
        doubt = ~((lowest >= low[step] - room) & (highest <= high[step] + room)) & np.isfinite(room)
        middle = 0.5 * (a + b)
        doubt &= (a < middle) & (middle < b)
        if not doubt.any():
            break
        a, b, middle, step, room = a[doubt], b[doubt], middle[doubt], step[doubt], room[doubt]
        value = np.array(expression.sample(middle.tolist()))
        new = (value < low[step] - room) | (value > high[step] + room)
        found += [*a[new].tolist(), *middle[new].tolist(), *b[new].tolist()]
        # one find a step is enough: the next run looks closer there
        open_still = ~new & ~np.isin(step, step[new])
        a, b, middle, step = a[open_still], b[open_still], middle[open_still], step[open_still]
        a, b, step = np.concatenate([a, middle]), np.concatenate([middle, b]), np.concatenate([step, step])
        if len(a) > MOST_PARTS:
            widest = np.argsort(a - b, kind="stable")[:MOST_PARTS]
            a, b, step = a[widest], b[widest], step[widest]
    return found
