"""Describe the effect of a thread's friction in a sentence: whether it is self-locking, and its efficiency either way.

eta = tan(lambda) / tan(lambda + rho) of turning into thrust,   tan(lambda - rho) / tan(lambda) of thrust into turning
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.multibody.mechanism.model import Mechanism
from heuncli.scene.file_format.couplings import Screw, ThreadFriction

SELF_LOCKING = "self-locking"


def describe_threads(mechanism: Mechanism) -> Iterator[str]:
    """Yield a sentence for each thread with friction."""
    for coupling in mechanism.couplings:
        if isinstance(coupling.entry, Screw) and coupling.entry.friction is not None:
            yield f"{coupling.name}: {describe_thread(coupling.entry.lead, coupling.entry.friction)}"


def describe_thread(lead: float, friction: ThreadFriction) -> str:
    """Describe a thread by its slope, its angle of friction, and its efficiency at full friction."""
    slope, mu = abs(lead) / (math.tau * friction.radius), friction.coefficient
    a, b = (f"{math.degrees(math.atan(x)):.4g} deg" for x in (slope, mu))
    angles = f"(slope {a}, angle of friction {b})"
    if slope * mu >= 1.0:
        return f"no torque rotates it against a thrust {angles}"
    efficiency = f"efficiency {slope * (1.0 - slope * mu) / (slope + mu):.3g} from torque to thrust"
    if slope <= mu:
        return f"{SELF_LOCKING} {angles}: no thrust rotates it; {efficiency}"
    return (
        f"not {SELF_LOCKING} {angles}: {efficiency}, {(slope - mu) / (1.0 + slope * mu) / slope:.3g} "
        "from thrust to torque"
    )
