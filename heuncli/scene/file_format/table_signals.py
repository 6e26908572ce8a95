"""Apply the keys of a table that treat its points as a measured signal: smooth, derivative, integral, drift.

The points are smoothed, then differentiated or integrated; the table interpolates what comes out. Notes on it say the
cut-off, the error of a derivative, and the drift that was taken out.
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
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.format import TableEntry

INTEGRAL_ERROR = 1e-9  # of the range of an integral, between its points
MAX_ADDED_PIECES = 20_000  # of finer points at which an integral is compared; larger tables are fine enough
MAX_CUT_OFF_STEPS = 1e5  # beyond, the smoothed values lose more than eight digits to rounding
TIMES = {1: "once", 2: "twice"}
FINE_HINT = "give a longer period (a lower frequency), or leave smooth out"
NOISE_HINT = "give smooth: a lower cut-off frequency; or measure more finely"

KeyedFinding = tuple[str, Finding]


class SignalKeyError(Exception):
    """A problem of one key of an entry."""

    def __init__(self, key: str, message: str, hint: str, code: str = "table-form") -> None:
        super().__init__(message)
        self.key, self.finding = key, Finding(code, message, hint)


def has_signal_keys(entry: TableEntry) -> bool:
    """Return whether an entry treats its points as a signal."""
    return any(key is not None for key in (entry.smooth, entry.derivative, entry.integral))


def check_signal_keys(entry: TableEntry) -> Iterator[KeyedFinding]:
    """Yield what is wrong with the keys of an entry that treat its points as a signal, with the key."""
    for key in ("derivative", "integral"):
        if getattr(entry, key) not in (None, *TIMES):
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
    """Return the table of an entry after smoothing, and its derivative or integral, with notes; and warnings.

    Raises SignalKeyError.
    """
    x, y = np.frombuffer(table.x), np.frombuffer(table.y)
    is_periodic, notes = entry.period is not None, []
    cut_off = None if entry.smooth is None else choose_cut_off(table, entry)
    if cut_off is not None:
        smoothed = smooth_points(x, y, cut_off, is_periodic)
        removed = format_amount(float(np.sqrt(np.mean((y - smoothed) ** 2))), table.dimensions[1])
        notes.append(f"table {table.name}: smoothed, {describe_cut_off(cut_off, table)}; it takes out {removed} (rms)")
        table = rebuild_table(table, entry, smoothed)
    if entry.integral is not None:
        return integrate_entry(table, entry, notes), []
    if entry.derivative is None:
        return replace(table, notes=tuple(notes)), []
    order, curve = entry.derivative, table.interpolation
    derivative = differentiate_points(x, np.frombuffer(table.y), curve, is_periodic, order)
    error = estimate_derivative_error(x, y, curve, is_periodic, order, cut_off)
    dimension = derive_dimension(table, -order)
    largest = float(np.abs(derivative).max())
    amount = "is not known: too few points" if error is None else f"up to {format_amount(error, dimension)}"
    size = f"error of the derivative {amount}, of at most {format_amount(largest, dimension)}"
    warnings = []
    if error is None or error > tolerances.DERIVATIVE_ERROR * largest:
        warnings.append(("derivative", Finding("table-derivative", f"table {table.name}: {size}", NOISE_HINT)))
    notes.append(f"table {table.name}: differentiated {TIMES[order]}; {size}")
    made = rebuild_table(table, entry, derivative)
    return replace(made, dimensions=(table.dimensions[0], dimension), notes=tuple(notes)), warnings


def integrate_entry(table: TableFunction, entry: TableEntry, notes: list[str]) -> TableFunction:
    """Return the integral of a table, with points added until it is right between them, too."""
    order, drift = entry.integral or 1, entry.drift or "keep"
    found, dimension = integrate_table(table, order, drift), derive_dimension(table, order)
    taken = f"offset {format_amount(found.offset, table.dimensions[1])} taken out (drift: {drift})"
    moved = f"it would have moved the end by {format_amount(found.displacement, dimension)}"
    what = "no drift taken out" if drift == "keep" else f"{taken}, {moved}"
    note = f"table {table.name}: integrated {TIMES[order]}; {what}"
    made, finest = rebuild_integral(table, entry, found), halve_pieces(halve_pieces(table))
    while 4 * table.pieces == finest.pieces <= MAX_ADDED_PIECES:
        exact = integrate_table(finest, order, drift).values
        if find_deviation(made, exact) <= INTEGRAL_ERROR * float(np.ptp(exact)):
            break
        table, finest = halve_pieces(table), halve_pieces(finest)
        made = rebuild_integral(table, entry, integrate_table(table, order, drift))
    return replace(made, dimensions=(table.dimensions[0], dimension), notes=(*notes, note))


def rebuild_integral(table: TableFunction, entry: TableEntry, integrals: Integrals) -> TableFunction:
    """Return the table through the exact values of an integral: of a spline a not-a-knot one, because the integral of a
    natural one is not straight at its ends; of other curves with the exact slopes.
    """
    if entry.period is not None:
        integrals.values[-1] = integrals.values[0]
    is_spline = entry.interpolation == "cubic"
    source = replace(table, interpolation="cubic") if is_spline else table
    return rebuild_table(source, entry, integrals.values, None if is_spline else integrals.slopes)


def rebuild_table(table: TableFunction, entry: TableEntry, y: Array, slopes: Array | None = None) -> TableFunction:
    """Return the table through the same x and other values."""
    values, curve = array("d", y.tobytes()), table.interpolation
    made = interpolate_points(table.name, table.x, values, curve, entry.outside, entry.period, slopes)
    return replace(made, dimensions=table.dimensions)


def choose_cut_off(table: TableFunction, entry: TableEntry) -> float:
    """Return the period at the cut-off [as x]. Raises SignalKeyError if the points cannot be smoothed by it."""
    assert entry.smooth is not None and entry.smooth.constant is not None
    cut_off, own, expected = entry.smooth.constant, entry.smooth.dimension, table.dimensions[0]
    if own is not None and expected is not None and own != expected:
        hint = "give the period at the cut-off in the unit of x" + (", or its frequency in Hz" * (expected == TIME))
        raise SignalKeyError(
            "smooth", f"the cut-off is {describe(own)}, but x is {describe(expected)}", hint, "dimension"
        )
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
    """Return the dimension of y times a power of x; None if one of them is not known."""
    x, y = table.dimensions
    if x is None or y is None:
        return None
    return y[0] + order * x[0], y[1] + order * x[1], y[2] + order * x[2]


def format_amount(value: float, dimension: Dimension | None) -> str:
    """Format a number in SI with its unit; without one if it is not known."""
    unit = si_unit(dimension) if dimension is not None and any(dimension) else ""
    return f"{value:.3g} {unit}".strip()
