"""What a thread's friction makes of it, in a sentence: whether it is self-locking, and what comes out either way.

eta = tan(lambda) / tan(lambda + rho) of turning into thrust,   tan(lambda - rho) / tan(lambda) of thrust into turning
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.multibody.mechanism.model import Mechanism
from heuncli.scene.file_format.couplings import Screw, ThreadFriction

LOCKED = "self-locking"


def of_threads(mechanism: Mechanism) -> Iterator[str]:
    """A sentence for each thread with friction."""
    for coupling in mechanism.couplings:
        if isinstance(coupling.given, Screw) and coupling.given.friction is not None:
            yield f"{coupling.name}: {judged(coupling.given.lead, coupling.given.friction)}"


def judged(lead: float, rubs: ThreadFriction) -> str:
    """Of a thread the angles that decide, and what they decide; the friction full."""
    slope, mu = abs(lead) / (math.tau * rubs.radius), rubs.coefficient
    a, b = (f"{math.degrees(math.atan(x)):.4g} deg" for x in (slope, mu))
    angles = f"(slope {a}, angle of friction {b})"
    if slope * mu >= 1.0:
        return f"no torque turns it against a thrust {angles}"
    comes_out = f"efficiency {slope * (1.0 - slope * mu) / (slope + mu):.3g} of turning into thrust"
    if slope <= mu:
        return f"{LOCKED} {angles}: no thrust turns it; {comes_out}"
    return f"not {LOCKED} {angles}: {comes_out}, {(slope - mu) / (1.0 + slope * mu) / slope:.3g} of thrust into turning"
