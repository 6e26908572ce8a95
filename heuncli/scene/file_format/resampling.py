"""Resample a table at even steps, after it is smoothed, differentiated or integrated.

Steps that are longer than half of the period at the cut-off would not show what the low pass keeps (sampling theorem),
and are refused. Without a low pass, a note says how far the points that are left out are from the resampled curve.
"""

from __future__ import annotations

from array import array

import numpy as np

from heuncli.base.records import replace
from heuncli.base.units import TIME, describe
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.format import TableEntry
from heuncli.scene.file_format.table_signals import SignalKeyError, format_amount

KEY = "resample"
MIN_STEPS, MAX_STEPS = 4, 1_000_000
COEFFICIENTS = 4  # of a piece


def resample_table(table: TableFunction, entry: TableEntry) -> TableFunction:
    """Return a table through points at even steps, about as long as its entry says. Raises SignalKeyError."""
    assert entry.resample is not None and entry.resample.constant is not None
    asked, own, expected = entry.resample.constant, entry.resample.dimension, table.dimensions[0]
    if own is not None and expected is not None and own != expected:
        hint = "give the step in the unit of x" + (", or the rate in Hz" * (expected == TIME))
        raise SignalKeyError(KEY, f"the step is {describe(own)}, but x is {describe(expected)}", hint, "dimension")
    x = np.frombuffer(table.x)
    span = float(x[-1] - x[0])
    if asked <= 0.0:
        raise SignalKeyError(KEY, f"the step is {asked:g}", "give a step above 0, or a rate in Hz")
    count = max(round(span / asked), 1)
    if not MIN_STEPS <= count <= MAX_STEPS:
        message = f"the table of length {format_amount(span, expected)} takes {count:,} steps"
        raise SignalKeyError(KEY, message, f"choose a step that gives {MIN_STEPS} to {MAX_STEPS:,} of them")
    step = span / count
    cut_off = None if entry.smooth is None else entry.smooth.constant
    if cut_off is not None and step > 0.5 * cut_off:
        message = f"steps of {format_amount(step, expected)} lose what smooth keeps"
        raise SignalKeyError(KEY, message, f"give at most {format_amount(0.5 * cut_off, expected)}, or a longer smooth")
    places = np.linspace(x[0], x[-1], count + 1)
    y = evaluate_points(table, places)
    if entry.period is not None:
        y[-1] = y[0]
    columns = array("d", places.tobytes()), array("d", y.tobytes())
    made = interpolate_points(table.name, *columns, table.interpolation, entry.outside, entry.period)
    rows = evaluate_points(made, x) - np.frombuffer(table.y)
    deviation, rms = (format_amount(float(size), table.dimensions[1])
                      for size in (np.abs(rows).max(), np.sqrt(np.mean(rows**2))))  # fmt: skip
    steps = f"{count:,} steps of {format_amount(step, expected)}"
    note = f"table {table.name}: resampled, {steps}; its {len(x):,} points deviate by up to {deviation}, {rms} (rms)"
    return replace(made, dimensions=table.dimensions, notes=(*table.notes, note))


def evaluate_points(table: TableFunction, places: Array) -> Array:
    """Return the values of a table at places within its range."""
    numbers, count = np.frombuffer(table.numbers), table.pieces
    knots = numbers[1 : count + 2]
    pieces = np.clip(np.searchsorted(knots, places, side="right") - 1, 0, count - 1)
    coefficients = numbers[count + 2 :].reshape(-1, COEFFICIENTS)[pieces]
    return np.asarray(np.polynomial.polynomial.polyval(places - knots[pieces], coefficients.T, tensor=False))
