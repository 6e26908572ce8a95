"""Make the document of inertia and forces over a range of the coordinate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.results import LENGTH, InertiaCurve, get_units
from heuncli.app.commands.lagrange.page import make_cell
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable
from heuncli.study.quantities.labels import distinguish
from heuncli.study.quantities.table_units import Units

TOTAL = "k"
CSV_COLUMNS = make_columns("coordinate at quantity component unit value")
COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def make_document(course: InertiaCurve, units: Units) -> OutputDocument:
    """Make the document of a course; its table in the given units."""
    unit_set = get_units(course.name)
    unit, size = units.find(unit_set.value)
    low, high = int(np.argmin(course.epsilon)), int(np.argmax(course.epsilon))
    least, largest = (
        f"{course.epsilon[i]:.6g} {unit_set.inertia} at {course.values[i] * size:.6g} {unit}" for i in (low, high)
    )
    mean = (
        "mean does not converge"
        if np.isnan(course.mean)
        else f"mean {course.mean:.6g} {unit_set.inertia} over the range"
    )
    facts = [("inertia", f"ε {mean}; smallest value {least}, largest {largest}")]
    return OutputDocument(
        course.title,
        facts,
        [make_table(course, units)],
        lambda: to_block(course),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(course))),
    )


def make_table(course: InertiaCurve, units: Units) -> OutputTable:
    """Make the table with one row per value of the coordinate."""
    unit_set = get_units(course.name)
    length_scale = np.abs(course.values).max() if unit_set is LENGTH else 1.0
    largest_inertia = float(course.epsilon.max())
    columns_of_values = [
        (course.name, unit_set.value, course.values, 0.0),
        ("ε", unit_set.inertia, course.epsilon, 0.0),
        ("½ dε/dq", unit_set.slope, course.half, largest_inertia / length_scale),
    ]
    forces = [(TOTAL, course.total_force), *((distinguish(name, (TOTAL,)), k) for name, k in course.forces.items())]
    columns_of_values += [(name, unit_set.force, k, course.force_scale) for name, k in forces]
    columns, cells = [], []
    for name, unit, values, scale in columns_of_values:
        shown_unit, size = units.find(unit)
        columns.append(OutputColumn(name, unit=shown_unit))
        largest = max(scale, float(np.abs(values).max(initial=0.0)))
        cells.append([make_cell(x * size, largest * size) for x in values])
    rows = tuple(zip(*cells, strict=True))
    unit, size = units.find(unit_set.rate)
    return OutputTable(COURSE.format(rate=course.rate * size, unit=unit), columns, rows)


def to_block(course: InertiaCurve) -> dict[str, Any]:
    """Return the course as the JSON has it: lists over the coordinates have an additional first axis over the
    values.
    """
    return {
        "title": course.title,
        "over": {"coordinate": course.name, "values": course.values.tolist()},
        "coordinates": [course.name],
        "units": [get_units(course.name).value],
        "driven": [course.is_driven],
        "rates": [[course.rate]] * len(course.values),
        "epsilon": course.epsilon[:, None, None].tolist(),
        "eta": (1.0 / course.epsilon)[:, None, None].tolist(),
        "gamma": course.half[:, None, None, None].tolist(),
        "momenta": (course.epsilon * course.rate)[:, None].tolist(),
        "coriolis": (course.half * course.rate**2)[:, None].tolist(),
        "half_slope": course.half.tolist(),
        "forces": {
            "total": course.total_force[:, None].tolist(),
            "shares": {name: k[:, None].tolist() for name, k in course.forces.items()},
        },
        "mean": None if np.isnan(course.mean) else course.mean,
    }


def iter_records(course: InertiaCurve) -> Iterator[tuple[Cell, ...]]:
    """Yield the course in long form, one row per value and quantity."""
    unit_set = get_units(course.name)
    for i, value in enumerate(course.values.tolist()):
        lead = (course.name, value)
        yield *lead, "epsilon", "", unit_set.inertia, float(course.epsilon[i])
        yield *lead, "half_slope", "", unit_set.slope, float(course.half[i])
        yield *lead, "force", "", unit_set.force, float(course.total_force[i])
        for name, k in course.forces.items():
            yield *lead, "force", name, unit_set.force, float(k[i])
