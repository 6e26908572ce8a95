"""Counterweights with what they cost, and a flywheel, as tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.analyses.balancing.results import BalanceResults, Counterbalance, Flywheel, OverCycle
from heuncli.base.tolerances import WRITTEN
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.results.results import Array
from heuncli.study.quantities.digits import OPEN, style, trim

WEIGHTS = "COUNTERWEIGHTS  of least {}; mass times radius from the body's axis, else its point; angle in body axes"
COST = "COST  the scene solved again with the weights in it, loads and weight included: over the cycle, before -> after"
FLYWHEEL = "FLYWHEEL  on {}: fastest less slowest is {:.4g} of the mean rate"
OF = {
    "force": "force", "moment": "moment", "mix": "force² + moment²/lever², lever {:.6g} m",
}  # fmt: skip
SEVERAL = "others leave as little: these are the least; a second plane, --minimise mix or moment tells them apart"
NO_RATE = "at 1 rad/s, for no rate is known: --rate tells one"
LEFT_OPEN = "open: redundant joints leave it so (heun explain open)"
LABELS = {"force": "force of the masses [N]", "moment": "moment of the masses [N·m]", "drive": "drive [N·m]"}
BY_RATE = {"force": "force of the masses [kg·m]", "moment": "moment of the masses [kg·m²]", "drive": "drive [N·m]"}
AXES = ("x", "y", "z")
RPM = 30.0 / math.pi


def remedies(found: BalanceResults) -> Iterator[TextTable]:
    """The tables of what was asked for."""
    if found.counterbalance is not None:
        yield weights_table(found.counterbalance)
        yield cost_table(found.counterbalance, found)
    if found.flywheel is not None:
        yield wheel_table(found.flywheel)


def weights_table(found: Counterbalance) -> TextTable:
    """The counterweights, and what is left."""
    columns = (
        TextColumn("at", "left"), TextColumn("mass·radius [kg·m]"), TextColumn("angle°"), TextColumn("from", "left"),
        TextColumn("radius [m]"), TextColumn("mass [kg]"),
    )  # fmt: skip
    products = numbers([weight.product for weight in found.weights])
    masses = numbers([weight.mass for weight in found.weights])
    rows = tuple(
        (
            f"{weight.body}.{weight.place}", products[k], f"{math.degrees(weight.angle):.4f}", side(weight.first),
            f"{weight.radius:.6g}", masses[k],
        )
        for k, weight in enumerate(found.weights)
    )  # fmt: skip
    notes = [f"left of force: {found.words['force']}", f"left of moment: {found.words['moment']}"]
    notes += [SEVERAL] if found.several else []
    idle = [f"{weight.body}.{weight.place}" for weight in found.weights if weight.product == 0.0]
    notes += [f"no weight at {' or '.join(idle)} leaves less"] if idle else []
    return TextTable(WEIGHTS.format(OF[found.minimised].format(found.lever or 0.0)), columns, rows, tuple(notes))


def side(first: Array) -> str:
    """The direction that an angle is counted from, in the body's axes."""
    k = max(range(3), key=lambda i: abs(float(first[i])))
    if abs(abs(float(first[k])) - 1.0) <= WRITTEN:
        return f"{'-' if first[k] < 0.0 else ''}{AXES[k]}"
    return f"({', '.join(f'{value + 0.0:.4g}' for value in first)})"


def cost_table(found: Counterbalance, all_found: BalanceResults) -> TextTable:
    """Loads before and after."""
    labels = LABELS if all_found.rate is not None else BY_RATE
    columns = (
        TextColumn("", "left"), TextColumn("rms"), TextColumn("-> after"), TextColumn("peak"), TextColumn("-> after"),
        TextColumn("times"),
    )  # fmt: skip
    rows = []
    for name, before in found.before.items():
        after = found.after[name]
        largest = max((x for x in (before.peak, after.peak) if x is not None), default=0.0)
        off = max(before.error or 0.0, after.error or 0.0)
        cells = [number(value, largest, off) for value in (before.rms, after.rms, before.peak, after.peak)]
        rows.append((labels.get(name, f"{name} [N]"), *cells, factor(before, after)))
    notes = [NO_RATE] if all_found.rate is None else []
    notes += [LEFT_OPEN] if any(own.rms is None for own in found.before.values()) else []
    return TextTable(COST, columns, tuple(rows), tuple(notes))


def factor(before: OverCycle, after: OverCycle) -> str:
    """How many times the root of the mean square is what it was."""
    if before.rms is None or after.rms is None or before.rms <= WRITTEN * after.rms:
        return ""
    return f"{after.rms / before.rms:.3g}" if after.rms > WRITTEN * before.rms else "0"


def wheel_table(wheel: Flywheel) -> TextTable:
    """The flywheel, beside the textbook's; each number with what it is known within."""
    off = wheel.error
    rows = (
        (
            "added", f"{sure(wheel.added, off['added'])} kg·m²", f"{off['added']:.1g}",
            f"ΔE/(δ ω²) less what turns evenly, the textbook's: {sure(wheel.textbook, off['textbook'])}",
        ),
        ("own", f"{wheel.own:.6g} kg·m²", f"{off['own']:.1g}", "the machine's reduced inertia, mean over the cycle"),
        ("ΔE", f"{wheel.energy:.6g} J", f"{off['energy']:.1g}",
         "of work that loads and inertia give and take at an even rate"),
        ("unevenness", f"{wheel.present:.6g}", f"{off['present']:.1g}", "as it is, without the wheel"),
        ("mean", f"{wheel.mean_rate * RPM:.9g} rpm", "", "angle of the cycle over its time"),
        ("start", *speed(wheel.start, off["start"]),
         "the rate at the start of the cycle that has this mean, with the wheel"),
        ("slowest", *speed(wheel.slowest, off["slowest"]), "with the wheel"),
        ("fastest", *speed(wheel.fastest, off["fastest"]), "with the wheel"),
    )  # fmt: skip
    columns = TextColumn("", "left"), TextColumn("", "left"), TextColumn("within"), TextColumn("", "left")
    return TextTable(FLYWHEEL.format(wheel.joint, wheel.delta), columns, rows)


def sure(value: float, error: float) -> str:
    """A number to nine digits, or to as many as its error leaves."""
    digits = 9
    if error > 0.0 and value != 0.0:
        digits = min(digits, max(1, math.floor(math.log10(abs(value) / error)) + 1)) if error < abs(value) else 1
    return f"{value:.{digits}g}"


def speed(rate: float, error: float) -> tuple[str, str]:
    """A rate and its error, in rpm."""
    return f"{sure(rate * RPM, error * RPM)} rpm", f"{error * RPM:.1g}"


def number(value: float | None, largest: float, error: float) -> str:
    """A number of a family that is known within an error, or that it is open."""
    off = max(WRITTEN * largest, error)
    return OPEN if value is None else style(largest, off, off).write(value)


def numbers(values: Sequence[float]) -> list[str]:
    """Numbers of one family to the digits of the largest."""
    scale = max((abs(value) for value in values), default=0.0)
    how = style(scale, WRITTEN * scale)
    return trim([how.write(value) for value in values])
