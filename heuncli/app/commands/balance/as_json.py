"""A balance as JSON, and its orders as CSV, one number per row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.analyses.balancing.results import BalanceResults, Counterbalance, CycleLoad, OrderRow, Period, get_unit
from heuncli.output.documents.as_data import FORMAT, make_columns
from heuncli.output.documents.document import Cell
from heuncli.results.results import Array, Block
from heuncli.results.results_schema import XYZ
from heuncli.version import VERSION

JOINTS = "joints."
CSV_COLUMNS = make_columns("kind order quantity component unit value")


def to_block(results: BalanceResults) -> dict[str, Any]:
    """Return the balance as the JSON has it."""
    effects = results.effects
    content: Block = {
        "heun": FORMAT,
        "title": results.title,
        "spec": dict(results.spec),
        "version": VERSION,
        "cycle": {
            "coordinate": results.coordinate,
            "turns": results.turns,
            "rate": results.rate,
            "samples": results.samples,
            "settled": results.is_resolved,
            **make_period_block(results.period),
        },
        "about": results.reference_point,
        "axis": results.axis,
        "words": dict(results.summaries),
        "notes": list(results.notes),
        "mean": dict(results.mean),
        "mean_error": dict(results.mean_error),
        "harmonics": {name: [row.to_block() for row in rows] for name, rows in results.orders.items()},
        "residual": {name: residual.to_block() for name, residual in results.residual.items()},
    }
    if results.period is None:
        content["per_rate"] = {
            "angle": effects.angles,
            "second": {
                "force": effects.force.sum(axis=1), "moment": effects.moment.sum(axis=1),
                "moment_orbital": effects.orbital.sum(axis=1), "moment_spin": effects.spin.sum(axis=1),
                "torque": effects.half_slope.sum(axis=1),
            },
            "first": {
                "force": effects.first_force.sum(axis=1),
                "moment": (effects.first_orbital + effects.first_spin).sum(axis=1),
                "moment_orbital": effects.first_orbital.sum(axis=1), "moment_spin": effects.first_spin.sum(axis=1),
                "torque": effects.eps.sum(axis=1),
            },
        }  # fmt: skip
    content["counterweights"] = []
    if results.counterbalance is not None:
        content |= make_weights_block(results.counterbalance)
    if results.flywheel is not None:
        content["flywheel"] = results.flywheel.to_block()
    as_lists: dict[str, Any] = to_plain_data(content)
    return as_lists


def make_period_block(period: Period | None) -> Block:
    """Return the period [s] as the JSON has it, and how much the last one differs from the one before, relative to the
    largest value.
    """
    return {} if period is None else {"period": period.seconds, "differs_by": period.relative_difference}


def make_weights_block(counterbalance: Counterbalance) -> Block:
    """Return the counterweights as the JSON has them, with the remaining orders and the cost."""
    return {
        "counterweights": [weight.to_block() for weight in counterbalance.weights],
        "minimised": {
            "what": counterbalance.objective,
            "lever": counterbalance.lever,
            "several": counterbalance.several,
        },
        "left": {
            "words": dict(counterbalance.summaries),
            "harmonics": {name: [row.to_block() for row in rows] for name, rows in counterbalance.orders.items()},
        },
        "cost": {
            name: make_cost_block(loads)
            for name, loads in (("before", counterbalance.loads_without), ("after", counterbalance.loads_with))
        },
    }


def make_cost_block(loads: Mapping[str, CycleLoad]) -> Block:
    """Return the loads before or after, with the joints by name."""
    joints = {name.removeprefix(JOINTS): spread.to_block() for name, spread in loads.items() if name.startswith(JOINTS)}
    return {name: spread.to_block() for name, spread in loads.items() if not name.startswith(JOINTS)} | {
        "joints": joints
    }


def to_plain_data(value: Any) -> Any:
    """Convert arrays to lists, and their numbers to Python's."""
    if isinstance(value, dict):
        return {key: to_plain_data(member) for key, member in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_plain_data(member) for member in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value


def iter_records(results: BalanceResults) -> Iterator[tuple[Cell, ...]]:
    """Yield the orders in long form, one number per row."""
    for kind, rows in results.orders.items():
        unit = get_unit(results, kind)
        for row in rows:
            for quantity, component, of, value in iter_order_values(row):
                yield kind, f"{row.order:g}", quantity, component, of or unit, value
    for kind, residual in results.residual.items():
        unit = get_unit(results, kind.partition("_")[0])
        for name, value in (("rms", residual.rms), ("peak", residual.peak), ("error", residual.error)):
            yield kind, "", name, "", unit, value
        yield kind, "", "at", "", "rad", residual.peak_angle


def iter_order_values(row: OrderRow) -> Iterator[tuple[str, str, str, float]]:
    """Yield quantity, component, unit (empty: that of the kind) and value of each number of an order."""
    letters = XYZ if len(row.amplitude) == len(XYZ) else ("",)
    sets: list[tuple[str, Array, Array]] = [("", row.amplitude, row.phase)]
    sets += [(f"{name}_", *both) for name, both in (row.parts or {}).items()]
    for name, amplitude, phase in sets:
        for letter, a, p in zip(letters, amplitude.tolist(), phase.tolist(), strict=True):
            yield f"{name}amplitude", letter, "", a
            yield f"{name}phase", letter, "rad", p
    for name, value in (("with", row.with_turn), ("against", row.against_turn), ("error", row.error)):
        if value is not None:
            yield name, "", "", value
