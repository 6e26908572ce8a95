"""Apply the keys of a table that treat its points as a measured signal: smooth, derivative, integral, drift, resample.

The points (x, y) are smoothed by a spline with a cut-off, then differentiated or integrated; the table interpolates
the result. Smoothing and differentiation are approximations: notes state the cut-off, what smoothing removed, and an
estimate of the derivative's error. The integral is that of the interpolating curve, exact at the points; points are
added until the new table is right between them, too. The mathematics stands in expressions/measured_signals.py.

The table is resampled last, at even steps. Steps that are longer than half of the period at the cut-off would not show
what the low pass keeps (sampling theorem), and are refused. Without a low pass, a note says how far the points that are
left out are from the resampled curve.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import replace
from heuncli.base.units import TIME, Dimension, describe, si_unit
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.measured_signals import (
    MIN_POINTS,
    Integrals,
    differentiate_points,
    estimate_derivative_error,
    find_deviation,
    halve_pieces,
    integrate_table,
    smooth_points,
)
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.file_format.format import TableEntry

INTEGRAL_ERROR = 1e-9  # largest error between the points, as a part of the integral's range
MAX_ADDED_PIECES = 20_000  # pieces between points at which an integral is compared; larger tables are fine enough
MAX_CUT_OFF_STEPS = 1e5  # median steps of x; beyond, the smoothed values lose more than eight digits to rounding
ORDER_WORDS = {1: "once", 2: "twice"}
FINE_HINT = "give a longer period (a lower frequency), or leave smooth out"
NOISE_HINT = "give smooth: a lower cut-off frequency; or measure more finely"
NATURAL_HINT = "write ends: not-a-knot: the second derivative of a natural spline is 0 at its ends"

KeyedFinding = tuple[str, Finding]  # the key of the entry, and its problem


class SignalKeyError(Exception):
    """A problem of one key of an entry that shows only when its points are read."""

    def __init__(self, key: str, message: str, hint: str, code: str = "table-form") -> None:
        super().__init__(message)
        self.key, self.finding = key, Finding(code, message, hint)


def has_signal_keys(entry: TableEntry) -> bool:
    """Return whether an entry has keys that treat its points as a signal."""
    return any(key is not None for key in (entry.smooth, entry.derivative, entry.integral))


def check_signal_keys(entry: TableEntry) -> Iterator[KeyedFinding]:
    """Yield the problems of the signal keys of an entry that do not depend on its points."""
    for key in ("derivative", "integral"):
        if getattr(entry, key) not in (None, *ORDER_WORDS):
            yield key, Finding("table-form", f"{key} is {getattr(entry, key)}", "give 1 or 2")
    if entry.derivative is not None and entry.integral is not None:
        yield "integral", Finding("table-form", "both derivative and integral are given", "give one of them")
    if entry.drift is not None and entry.integral is None:
        yield "drift", Finding("table-form", "drift is given without integral", "write integral: 1 or integral: 2")
    if entry.derivative is not None and entry.interpolation == "linear":
        message = "the derivative of a linear table jumps at its points"
        yield "derivative", Finding("table-form", message, "write interpolation: cubic")
    if entry.derivative == 2 and entry.interpolation == "pchip":
        message = "the second derivative of a pchip table jumps at its points"
        yield "derivative", Finding("table-form", message, "write interpolation: cubic")
    if entry.integral is not None and entry.period is not None and entry.drift != "mean":
        message = "the integral of a periodic table repeats only without its mean"
        yield "integral", Finding("table-form", message, "write drift: mean")


def prepare_signal(table: TableFunction, entry: TableEntry) -> tuple[TableFunction, list[KeyedFinding]]:
    """Smooth a table, then differentiate or integrate it, as its entry says; its notes tell how. Also returns warnings.

    Raises SignalKeyError if the points cannot be smoothed.
    """
    measured, notes = table, []
    cut_off = None if entry.smooth is None else choose_cut_off(table, entry)
    if cut_off is not None:
        table, note = smooth_table(table, entry, cut_off)
        notes.append(note)
    warnings: list[KeyedFinding] = []
    if entry.integral is not None:
        table, note = integrate_entry(table, entry)
        notes.append(note)
    elif entry.derivative is not None:
        table, note, warnings = differentiate_entry(table, entry, measured, cut_off)
        notes.append(note)
    return replace(table, notes=tuple(notes)), warnings


def smooth_table(table: TableFunction, entry: TableEntry, cut_off: float) -> tuple[TableFunction, str]:
    """Smooth a table by a cut-off period, in the unit of x; also returns a note on what this removed."""
    x, y = np.frombuffer(table.x), np.frombuffer(table.y)
    smoothed = smooth_points(x, y, cut_off, entry.period is not None)
    removed = format_amount(float(np.sqrt(np.mean((y - smoothed) ** 2))), table.dimensions[1])
    note = f"table {table.name}: smoothed, {describe_cut_off(cut_off, table)}; it takes out {removed} (rms)"
    return rebuild_table(table, entry, smoothed), note


def differentiate_entry(
    table: TableFunction, entry: TableEntry, measured: TableFunction, cut_off: float | None
) -> tuple[TableFunction, str, list[KeyedFinding]]:
    """Differentiate a table; also returns a note on the error, and a warning if that is large.

    measured: the table before smoothing, from which the error is estimated
    cut_off: period of the smoothing, in the unit of x; None without it
    """
    order, curve, is_periodic = entry.derivative or 1, table.interpolation, entry.period is not None
    x = np.frombuffer(table.x)
    derivative = differentiate_points(x, np.frombuffer(table.y), curve, is_periodic, order)
    error = estimate_derivative_error(x, np.frombuffer(measured.y), curve, is_periodic, order, cut_off)
    dimension = derive_dimension(table, -order)
    largest = float(np.abs(derivative).max())
    amount = "is not known: too few points" if error is None else f"up to {format_amount(error, dimension)}"
    size = f"error of the derivative {amount}, of at most {format_amount(largest, dimension)}"
    warnings = []
    if error is None or error > tolerances.DERIVATIVE_ERROR * largest:
        hint = NATURAL_HINT if curve == "natural" and order > 1 else NOISE_HINT
        warnings.append(("derivative", Finding("table-derivative", f"table {table.name}: {size}", hint)))
    made = replace(rebuild_table(table, entry, derivative), dimensions=(table.dimensions[0], dimension))
    return made, f"table {table.name}: differentiated {ORDER_WORDS[order]}; {size}", warnings


def integrate_entry(table: TableFunction, entry: TableEntry) -> tuple[TableFunction, str]:
    """Integrate a table, and add points until the result is right between them, too; also returns a note on the drift.

    The pieces of the table are halved until the interpolated integral agrees with the exact one at the points of a
    table four times finer.
    """
    order, drift = entry.integral or 1, entry.drift or "keep"
    found, dimension = integrate_table(table, order, drift), derive_dimension(table, order)
    taken = f"offset {format_amount(found.offset, table.dimensions[1])} taken out (drift: {drift})"
    moved = f"it would have moved the end by {format_amount(found.displacement, dimension)}"
    what = "no drift taken out" if drift == "keep" else f"{taken}, {moved}"
    note = f"table {table.name}: integrated {ORDER_WORDS[order]}; {what}"
    made, finest = rebuild_integral(table, entry, found), halve_pieces(halve_pieces(table))
    # halve_pieces returns the same table where a piece is too short for a point in its middle: then it ends, too
    while finest.pieces == 4 * table.pieces and finest.pieces <= MAX_ADDED_PIECES:
        exact = integrate_table(finest, order, drift).values
        if find_deviation(made, exact) <= INTEGRAL_ERROR * float(np.ptp(exact)):
            break
        table, finest = halve_pieces(table), halve_pieces(finest)
        made = rebuild_integral(table, entry, integrate_table(table, order, drift))
    return replace(made, dimensions=(table.dimensions[0], dimension)), note


def rebuild_integral(table: TableFunction, entry: TableEntry, integrals: Integrals) -> TableFunction:
    """Make the table through the exact values of an integral.

    The integral of a spline is a not-a-knot spline, because that of a natural one is not straight at its ends; other
    curves get the exact slopes.
    """
    values = integrals.values
    if entry.period is not None:
        values = np.append(values[:-1], values[0])
    is_spline = entry.interpolation == "cubic"  # whatever its ends: as a table's word `cubic` means not-a-knot
    source = replace(table, interpolation="cubic") if is_spline else table
    return rebuild_table(source, entry, values, None if is_spline else integrals.slopes)


def rebuild_table(table: TableFunction, entry: TableEntry, y: Array, slopes: Array | None = None) -> TableFunction:
    """Make the table through the same x and other values y (n,), with given slopes (n,) or those of its curve."""
    values, curve = array("d", y.tobytes()), table.interpolation
    made = interpolate_points(table.name, table.x, values, curve, entry.outside, entry.period, slopes)
    return replace(made, dimensions=table.dimensions)


def require_unit_of_x(key: str, amount: Expression, table: TableFunction, words: tuple[str, str, str]) -> None:
    """Raise SignalKeyError for an amount along x that has another dimension than x.

    words: what it is; how the hint calls it; what may be given in Hz instead where x is a time
    """
    own, expected = amount.dimension, table.dimensions[0]
    if own is not None and expected is not None and own != expected:
        what, to_give, in_hertz = words
        hint = f"give the {to_give} in the unit of x" + (f", or {in_hertz} in Hz" * (expected == TIME))
        raise SignalKeyError(key, f"the {what} is {describe(own)}, but x is {describe(expected)}", hint, "dimension")


def choose_cut_off(table: TableFunction, entry: TableEntry) -> float:
    """Return the period of the cut-off [as x]. Raises SignalKeyError if the points cannot be smoothed by it."""
    assert entry.smooth is not None and entry.smooth.constant is not None
    cut_off, expected = entry.smooth.constant, table.dimensions[0]
    require_unit_of_x("smooth", entry.smooth, table, ("cut-off", "period at the cut-off", "its frequency"))
    x = np.frombuffer(table.x)
    step, span = float(np.median(np.diff(x))), float(x[-1] - x[0])
    if cut_off <= 0.0:
        raise SignalKeyError("smooth", f"the cut-off is {cut_off:g}", "give a period above 0, or a frequency in Hz")
    if len(x) < MIN_POINTS:
        raise SignalKeyError(
            "smooth", f"{len(x)} points are too few to be smoothed", f"give at least {MIN_POINTS} points"
        )
    text = describe_cut_off(cut_off, table)
    if cut_off < 2.0 * step:
        message = f"{text} is shorter than two steps of the points ({format_amount(step, expected)} each)"
        raise SignalKeyError("smooth", message, FINE_HINT)
    if cut_off > min(span, MAX_CUT_OFF_STEPS * step):
        limit = "the table" if cut_off > span else f"{MAX_CUT_OFF_STEPS:g} of its steps"
        raise SignalKeyError("smooth", f"{text} is longer than {limit}", "give a shorter period (a higher frequency)")
    return cut_off


def describe_cut_off(cut_off: float, table: TableFunction) -> str:
    """Describe a cut-off by its period, and over a time by its frequency."""
    period = format_amount(cut_off, table.dimensions[0])
    frequency = f"{1.0 / cut_off:.4g} Hz, " if table.dimensions[0] in (None, TIME) else ""
    return f"cut-off {frequency}period {period}"


def derive_dimension(table: TableFunction, order: int) -> Dimension | None:
    """Return the dimension of y times x to the power `order`; None if one of them is unknown."""
    x, y = table.dimensions
    if x is None or y is None:
        return None
    return y[0] + order * x[0], y[1] + order * x[1], y[2] + order * x[2]


def format_amount(value: float, dimension: Dimension | None) -> str:
    """Format a number in SI with its unit, or without one if the dimension is unknown."""
    unit = si_unit(dimension) if dimension is not None and any(dimension) else ""
    return f"{value:.3g} {unit}".strip()


# Resampling

RESAMPLE_KEY = "resample"
MIN_RESAMPLED_STEPS, MAX_RESAMPLED_STEPS = 4, 1_000_000
PIECE_COEFFICIENTS = 4  # a piece of a table is a cubic


def resample_table(table: TableFunction, entry: TableEntry) -> TableFunction:
    """Return a table through points at even steps, about as long as its entry says. Raises SignalKeyError."""
    assert entry.resample is not None and entry.resample.constant is not None
    requested_step, expected = entry.resample.constant, table.dimensions[0]
    require_unit_of_x(RESAMPLE_KEY, entry.resample, table, ("step", "step", "the rate"))
    x = np.frombuffer(table.x)
    span = float(x[-1] - x[0])
    if requested_step <= 0.0:
        raise SignalKeyError(RESAMPLE_KEY, f"the step is {requested_step:g}", "give a step above 0, or a rate in Hz")
    count = max(round(span / requested_step), 1)
    if not MIN_RESAMPLED_STEPS <= count <= MAX_RESAMPLED_STEPS:
        message = f"the table of length {format_amount(span, expected)} takes {count:,} steps"
        raise SignalKeyError(
            RESAMPLE_KEY, message, f"choose a step that gives {MIN_RESAMPLED_STEPS} to {MAX_RESAMPLED_STEPS:,} of them"
        )
    step = span / count
    cut_off = None if entry.smooth is None else entry.smooth.constant
    if cut_off is not None and step > 0.5 * cut_off:
        message = f"steps of {format_amount(step, expected)} lose what smooth keeps"
        raise SignalKeyError(
            RESAMPLE_KEY, message, f"give at most {format_amount(0.5 * cut_off, expected)}, or a longer smooth"
        )
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
    coefficients = numbers[count + 2 :].reshape(-1, PIECE_COEFFICIENTS)[pieces]
    return np.asarray(np.polynomial.polynomial.polyval(places - knots[pieces], coefficients.T, tensor=False))
