"""Couplings whose conditions are told by where bodies stand at the start: ropes."""

from __future__ import annotations

from heuncli.mechanism.model import Assembly, Mechanism
from heuncli.records import replace
from heuncli.tree.rope_ways import routed


def with_started(mechanism: Mechanism, start: Assembly) -> Mechanism:
    """The mechanism with the conditions of such couplings. Raises SolveError where they cannot be as they are asked."""
    made = tuple(
        MADE[coupling.given.type](mechanism, start, coupling) if coupling.given.type in MADE else coupling
        for coupling in mechanism.couplings
    )
    return replace(mechanism, couplings=made)


MADE = {"rope": routed}
