"""Bushings that come to half a turn, where their moment has two values. Imported only where there are bushings."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import BushingLoad, Mechanism

HINT = "bushings are for less than half a turn: what turns on needs a joint, as a pin with a turn_spring"


def turning(mechanism: Mechanism) -> list[tuple[BushingLoad, int]]:
    """The bushings that resist turning, with the row of it in the kernel's table of loads."""
    return [
        (load, rows.start + 1)
        for load, rows in mechanism.load_rows()
        if isinstance(load, BushingLoad)
        and (load.turn.stiffness.any() or any(e.constant != 0.0 for e in load.turn.given))
    ]


def half_turned(name: str, t: float) -> Problem:
    """The problem of a bushing at an instant."""
    message = f"at t = {t:.9g} s forces.{name} has come to half a turn: which way its moment acts there, nothing tells"
    return Problem("bushing-turned", message, hint=HINT, about=f"forces.{name}")


def at_half_turn(mechanism: Mechanism, recovered: Recovered, instant: int) -> list[Problem]:
    """The problems of bushings that are so far turned at one of the instants, or about to be."""
    loads, t = recovered.loads[instant], float(recovered.times[instant])
    own, nearly = turning(mechanism), np.pi - tolerances.NEARLY_TURNED_OVER
    return [half_turned(b.name, t) for b, row in own if loads["span"][row] >= nearly]
