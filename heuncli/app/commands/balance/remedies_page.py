"""Make the tables of counterweights with their cost, and of a flywheel."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.analyses.balancing.results import BalanceResults, Counterbalance, CycleLoad, Flywheel
from heuncli.base.tolerances import WRITTEN
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, make_number_cells
from heuncli.results.results import Array
from heuncli.study.quantities.digits import OPEN, choose_style

WEIGHTS = "COUNTERWEIGHTS  for minimum {}; mass times radius from the body's axis, else its point; angle in body axes"
COST = "COST  model solved again with the counterweights, loads and gravity included: over the cycle, before -> after"
FLYWHEEL = "FLYWHEEL  on {}: (max. - min. speed) / mean speed = {:.4g}"
OBJECTIVES = {
    "force": "force", "moment": "moment", "mix": "force² + moment²/lever², lever {:.6g} m",
}  # fmt: skip
SEVERAL = "not unique: these are the smallest; a second plane, --minimise mix or moment makes them unique"
NO_RATE = "at 1 rad/s, as no speed is known: give one with --rate"
INDETERMINATE = "open: statically indeterminate (heun explain open)"
LABELS = {"force": "inertia force [N]", "moment": "inertia moment [N·m]", "drive": "drive [N·m]"}
RATE_FREE_LABELS = {
    "force": "inertia force [kg·m]",
    "moment": "inertia moment [kg·m²]",
    "drive": "drive [N·m]",
}
AXES = ("x", "y", "z")
RPM = 30.0 / math.pi


def make_remedy_tables(results: BalanceResults) -> Iterator[OutputTable]:
    """Yield the tables of the requested remedies."""
    if results.counterbalance is not None:
        yield make_weights_table(results.counterbalance)
        yield make_cost_table(results.counterbalance, results)
    if results.flywheel is not None:
        yield make_wheel_table(results.flywheel)


def make_weights_table(counterbalance: Counterbalance) -> OutputTable:
    """Make the table of the counterweights, with notes on what remains."""
    columns = (
        OutputColumn("at", "path"), OutputColumn("mass·radius", unit="kg·m"), OutputColumn("angle°"),
        OutputColumn("from", "text"), OutputColumn("radius", unit="m"), OutputColumn("mass", unit="kg"),
    )  # fmt: skip
    products = make_cells([weight.product for weight in counterbalance.weights])
    masses = make_cells([weight.mass for weight in counterbalance.weights])
    rows = [
        (
            f"{weight.body}.{weight.place}",
            products[k],
            NumberCell(math.degrees(weight.angle), write="{:.4f}".format),
            format_direction(weight.reference_direction),
            weight.radius,
            masses[k],
        )
        for k, weight in enumerate(counterbalance.weights)
    ]
    notes = [
        f"remaining force: {counterbalance.summaries['force']}",
        f"remaining moment: {counterbalance.summaries['moment']}",
    ]
    notes += [SEVERAL] if counterbalance.several else []
    unneeded = [f"{weight.body}.{weight.place}" for weight in counterbalance.weights if weight.product == 0.0]
    notes += [f"a counterweight at {' or '.join(unneeded)} does not help"] if unneeded else []
    return OutputTable(
        WEIGHTS.format(OBJECTIVES[counterbalance.objective].format(counterbalance.lever or 0.0)),
        columns,
        rows,
        tuple(notes),
    )


def format_direction(first: Array) -> str:
    """Format the direction from which an angle is counted, in the body's axes."""
    k = max(range(3), key=lambda i: abs(float(first[i])))
    if abs(abs(float(first[k])) - 1.0) <= WRITTEN:
        return f"{'-' if first[k] < 0.0 else ''}{AXES[k]}"
    return f"({', '.join(f'{value + 0.0:.4g}' for value in first)})"


def make_cost_table(counterbalance: Counterbalance, results: BalanceResults) -> OutputTable:
    """Make the table of the loads before and after."""
    labels = LABELS if results.rate is not None else RATE_FREE_LABELS
    columns = (
        OutputColumn("", "path"), OutputColumn("rms"), OutputColumn("-> after"), OutputColumn("peak"),
        OutputColumn("-> after"), OutputColumn("ratio"),
    )  # fmt: skip
    rows = []
    for name, old in counterbalance.loads_without.items():
        new = counterbalance.loads_with[name]
        largest = max((x for x in (old.peak, new.peak) if x is not None), default=0.0)
        error = max(old.error or 0.0, new.error or 0.0)
        cells = [make_cell(value, largest, error) for value in (old.rms, new.rms, old.peak, new.peak)]
        rows.append((labels.get(name, f"{name} [N]"), *cells, format_ratio(old, new)))
    notes = [NO_RATE] if results.rate is None else []
    notes += [INDETERMINATE] if any(loads.rms is None for loads in counterbalance.loads_without.values()) else []
    return OutputTable(COST, columns, tuple(rows), tuple(notes))


def format_ratio(old: CycleLoad, new: CycleLoad) -> str:
    """Format the ratio of the root mean squares after and before."""
    if old.rms is None or new.rms is None or old.rms <= WRITTEN * new.rms:
        return ""
    return f"{new.rms / old.rms:.3g}" if new.rms > WRITTEN * old.rms else "0"


def make_wheel_table(wheel: Flywheel) -> OutputTable:
    """Make the table of the flywheel, with the textbook's value; each number with its error."""
    errors = wheel.error
    rows = (
        (
            "added", f"{format_certain(wheel.added, errors['added'])} kg·m²", f"{errors['added']:.1g}",
            f"textbook ΔE/(δ ω²) minus the constant inertia: {format_certain(wheel.textbook, errors['textbook'])}",
        ),
        ("machine", f"{wheel.own:.6g} kg·m²", f"{errors['own']:.1g}", "mean reduced inertia of the machine"),
        ("ΔE", f"{wheel.energy:.6g} J", f"{errors['energy']:.1g}",
         "energy fluctuation of loads and inertia at constant speed"),
        ("fluctuation", f"{wheel.present:.6g}", f"{errors['present']:.1g}", "without the flywheel"),
        ("mean", f"{wheel.mean_rate * RPM:.9g} rpm", "", "cycle angle divided by cycle time"),
        ("start", *format_speed(wheel.start, errors["start"]),
         "speed at the start of the cycle for this mean, with the flywheel"),
        ("slowest", *format_speed(wheel.slowest, errors["slowest"]), "with the flywheel"),
        ("fastest", *format_speed(wheel.fastest, errors["fastest"]), "with the flywheel"),
    )  # fmt: skip
    columns = OutputColumn("", "text"), OutputColumn("", "text"), OutputColumn("error"), OutputColumn("", "text")
    return OutputTable(FLYWHEEL.format(wheel.joint, wheel.delta), columns, rows)


def format_certain(value: float, error: float) -> str:
    """Format a number with nine digits, or with as many as its error allows."""
    digits = 9
    if error > 0.0 and value != 0.0:
        digits = min(digits, max(1, math.floor(math.log10(abs(value) / error)) + 1)) if error < abs(value) else 1
    return f"{value:.{digits}g}"


def format_speed(rate: float, error: float) -> tuple[str, str]:
    """Format a rate [rad/s] and its error in rpm."""
    return f"{format_certain(rate * RPM, error * RPM)} rpm", f"{error * RPM:.1g}"


def make_cell(value: float | None, largest: float, error: float) -> Cell:
    """Make the cell of a number of a family with a common error, or `open` if it is indeterminate."""
    uncertainty = max(WRITTEN * largest, error)
    style = choose_style(largest, uncertainty, uncertainty)
    return OPEN if value is None else NumberCell(value, uncertainty, style.write)


def make_cells(values: Sequence[float]) -> list[NumberCell]:
    """Make the cells of numbers of one family with the digits of the largest."""
    scale = max((abs(value) for value in values), default=0.0)
    return make_number_cells(values, choose_style(scale, WRITTEN * scale))
