"""Make the matrix of the measures over the load cases: in each case the extremes over everything else that is varied.

A sweep of the load cases alone has no such matrix, because its rows already are the cases.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.sweep_rows import SweepHead
from heuncli.analyses.variants.parameters import CASE, ParameterAxis
from heuncli.analyses.variants.plans import Plan
from heuncli.app.commands.sweep.statistics import ShownRows
from heuncli.app.commands.sweep.tables import choose_number_style
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, trim_cells
from heuncli.results.results import Indices
from heuncli.study.quantities.digits import largest_magnitude
from heuncli.study.quantities.table_units import Units

HEADING = "CASES  minimum and maximum of each measure in each load case"


def make_case_matrix(head: SweepHead, selection: ShownRows, units: Units) -> list[OutputTable]:
    """Make the table with a column per load case and two rows per measure; none unless a case has several variants."""
    axis = find_case_axis(head.plan)
    if axis is None:
        return []
    names = list(dict.fromkeys(map(str, axis.values)))
    if len(names) < 2 or head.plan.size <= len(names):
        return []
    cases = np.array([names.index(str(value)) for value in axis.values])
    case_of_row = cases[head.plan.find_axis_places(axis, selection.columns.numbers.astype(np.intp))]
    rows: list[tuple[Cell, ...]] = []
    for k, measure in enumerate(head.measures):
        unit, size = units.find(measure.unit)
        heading = f"{measure.text} [{unit}]" if unit else measure.text
        minima, maxima = _find_extremes_by_case(selection, k, case_of_row, len(names))
        rows.append((heading, "min", *_make_cells(selection, k, minima, size)))
        rows.append(("", "max", *_make_cells(selection, k, maxima, size)))
    columns = (OutputColumn("measure", "text"), OutputColumn("", "text"), *map(OutputColumn, names))
    return [OutputTable(HEADING, columns, tuple(rows))]


def find_case_axis(plan: Plan) -> ParameterAxis | None:
    """Return the axis of the load cases; None if there is none. A parameter may have its name, but holds numbers."""
    axes = (axis for axis in (*plan.columns, *plan.axes) if axis.name == CASE and axis.unit is None)
    return next(axes, None)


def _find_extremes_by_case(
    selection: ShownRows, k: int, case_of_row: Indices, case_count: int
) -> tuple[list[int | None], list[int | None]]:
    """Find the rows with the least and the greatest value of a measure in each case; None where none is known."""
    values = selection.columns.values(k)
    minima: list[int | None] = []
    maxima: list[int | None] = []
    for case in range(case_count):
        rows = np.flatnonzero((case_of_row == case) & np.isfinite(values))
        minima.append(int(rows[np.argmin(values[rows])]) if len(rows) else None)
        maxima.append(int(rows[np.argmax(values[rows])]) if len(rows) else None)
    return minima, maxima


def _make_cells(selection: ShownRows, k: int, rows: list[int | None], size: float) -> list[Cell]:
    """Make the cells of a measure at some rows with the digits that their errors support; size: of the display unit."""
    values, errors = size * selection.columns.values(k), size * selection.columns.errors(k)
    scale = largest_magnitude(values)
    known = [(float(values[row]), float(errors[row])) for row in rows if row is not None]
    numbers = iter(trim_cells([(value, error, choose_number_style(value, error, scale)) for value, error in known]))
    return [None if row is None else next(numbers) for row in rows]
