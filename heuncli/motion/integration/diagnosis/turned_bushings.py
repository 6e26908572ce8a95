"""Find bushings that come to half a turn, where their moment has two values. Imported only where there are bushings."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import BushingLoad, Mechanism

HINT = "bushings allow less than half a revolution; for more use a joint, such as a pin with a turn_spring"


def find_turning_bushings(mechanism: Mechanism) -> list[tuple[BushingLoad, int]]:
    """Return the bushings that resist rotation, each with its row in the kernel's table of loads."""
    return [
        (load, rows.start + 1)
        for load, rows in mechanism.iter_load_rows()
        if isinstance(load, BushingLoad)
        and (load.turn.stiffness.any() or any(e.constant != 0.0 for e in load.turn.extra_load))
    ]


def make_problem(name: str, t: float) -> Problem:
    """Make the problem of a bushing at an instant."""
    message = (
        f"at t = {t:.9g} s forces.{name} has rotated by half a revolution: the direction of its moment is undefined"
    )
    return Problem("bushing-turned", message, hint=HINT, entry_path=f"forces.{name}")


def find_half_turned(mechanism: Mechanism, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return the problems of bushings that have turned so far at one of the instants, or are about to."""
    loads, t = evaluation.loads[instant], float(evaluation.times[instant])
    bushings, limit = find_turning_bushings(mechanism), np.pi - tolerances.NEARLY_TURNED_OVER
    return [make_problem(b.name, t) for b, row in bushings if loads["span"][row] >= limit]
