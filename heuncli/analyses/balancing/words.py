"""How a balance is told in tables and pictures alike: its cycle, its units, the point of its moments."""

from __future__ import annotations

import math

from heuncli.analyses.balancing.results import BalanceResults

UNITS = {"force": "N", "moment": "N·m", "torque": "N·m", "load": "N·m"}
BY_RATE = {"force": "kg·m", "moment": "kg·m²", "torque": "kg·m²", "load": "N·m"}  # of 1 rad/s, where no rate is known
AT_ONE = "at 1 rad/s: by the square of the rate, in kg·m"
RPM = 30.0 / math.pi


def cycle_of(found: BalanceResults) -> str:
    """The cycle in words."""
    if found.period is not None:
        own = found.period
        back = f"the period before differs by {own.off:.1g} of the mean"
        return f"the last {own.seconds:.6g} s of the motion, {found.samples} instants; order k is k/T; {back}"
    turns = "one turn" if found.turns == 1 else "two turns"
    rate = f"at {found.rate:.6g} rad/s ({found.rate * RPM:.6g} rpm)" if found.rate is not None else AT_ONE
    return f"{turns} of {found.coordinate} {rate}, {found.samples} angles"


def unit_of(found: BalanceResults, quantity: str) -> str:
    """The unit in which a quantity's amplitudes are told."""
    return (UNITS if found.rate is not None else BY_RATE)[quantity]


def place_of(found: BalanceResults) -> str:
    """The point that moments are taken about, in words."""
    x, y, z = (f"{value:.6g}" for value in found.about + 0.0)
    return f"{found.place or 'O' if found.place or not found.about.any() else 'the point'} = ({x}, {y}, {z}) m"
