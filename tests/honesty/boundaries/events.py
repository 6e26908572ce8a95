"""Events within a step."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.restitution import is_short_flight
from heuncli.motion.integration.contacts.touching import TouchingContacts
from tests.honesty.boundaries.part import Part, Row
from tests.shared.pushed_block import pushed_block
from tests.shared.scenes import near, study


def unseen_pulse(x: float) -> str:
    """A block pushed with 1 N and, for a moment, x more: whether steps end there."""
    run = study(pushed_block(f"1 + {x!r}*exp(-((t - 5.3)/1e-3)**2)"))
    near(run.results.coordinates["guide"]["speed"][-1], 10.0, 10.0, 2e-4 * x + 1e-9)
    return "looked into" if run.results.work["steps"] > 4 else "as seen"


def low_hop(x: float) -> str:
    """A flight of so much height, of a gap that is a sum of 1."""
    one = np.ones(1)
    reach = tolerances.KERNEL["touching"] * one
    touch = TouchingContacts(np.zeros(1, dtype=int), np.zeros((1, 1, 6)), one, one, reach, one, one)
    return "none" if is_short_flight(touch, one, -one / (2.0 * x), 0.0)[0] else "flies"


PART = Part(
    ("kernel: events",),
    rows=(
        Row("KERNEL.unseen", unseen_pulse, "as seen", "looked into"),
        Row("KERNEL.touching", low_hop, "none", "flies"),
    ),
    exempt={
        "KERNEL.still_rate": "the same as CONTACT_RATE, by which the state is decided that the kernel then follows",
        "KERNEL.friction_rounding": "how exactly breaking away is met: what sticks as much longer moves nothing",
        "KERNEL.one_instant": "to what an event is landed on, in roundings of its instant",
        "KERNEL.window": "where the end of a step is looked at for an event; else all of the step is",
        "KERNEL.seen_turn": "which steps bounds look through, also where stages would do: no number depends on it",
        "KERNEL.near_kink": "how near to a kink a step ends: its error, to the square, is that of the step",
        "KERNEL.no_jump": "which events are landed on to the last digit, which to near_kink",
        "KERNEL.leaving_first": "how an event's own rounding is left behind",
        "KERNEL.leaving_last": "how an event's own rounding is left behind; what chatters is driven back at once",
        "KERNEL.least_load": "which loads are so small that doubles lose their digits",
    },
    wanted={
        "KERNEL.flurry": "whether events gather at an instant",
        "KERNEL.finest": "which events of a step are told apart",
    },
)
