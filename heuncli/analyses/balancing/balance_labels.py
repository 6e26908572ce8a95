"""Labels of a balance that tables and figures share: its cycle, its units, the reference point of its moments."""

from __future__ import annotations

import math

from heuncli.analyses.balancing.results import BalanceResults

UNITS = {"force": "N", "moment": "N·m", "torque": "N·m", "load": "N·m"}
UNITS_PER_RATE = {
    "force": "kg·m",
    "moment": "kg·m²",
    "torque": "kg·m²",
    "load": "N·m",
}  # at 1 rad/s, if no rate is known
UNIT_RATE_TEXT = "at 1 rad/s (loads grow with its square; in kg·m)"
RPM = 30.0 / math.pi


def format_cycle(results: BalanceResults) -> str:
    """Describe the cycle in words."""
    if results.period is not None:
        period = results.period
        difference = f"the previous period differs by {period.relative_difference:.1g} of the mean"
        return f"the last {period.seconds:.6g} s of the motion, {results.samples} samples; order k is k/T; {difference}"
    turns = "one revolution" if results.turns == 1 else "two revolutions"
    rate = f"at {results.rate:.6g} rad/s ({results.rate * RPM:.6g} rpm)" if results.rate is not None else UNIT_RATE_TEXT
    return f"{turns} of {results.coordinate} {rate}, {results.samples} angles"


def get_unit(results: BalanceResults, quantity: str) -> str:
    """Return the unit of a quantity's amplitudes."""
    return (UNITS if results.rate is not None else UNITS_PER_RATE)[quantity]


def format_reference_point(results: BalanceResults) -> str:
    """Describe the point about which moments are taken."""
    x, y, z = (f"{value:.6g}" for value in results.reference_point + 0.0)
    return (
        f"{results.place or 'O' if results.place or not results.reference_point.any() else 'the point'} = "
        f"({x}, {y}, {z}) m"
    )
