"""Make the documents of Lagrange's equations: at an instant, and over a range of the coordinate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from operator import attrgetter

import numpy as np

from heuncli.analyses.lagrange.equations import list_cuts
from heuncli.analyses.lagrange.results import ANGLE, LENGTH, InertiaCurve, LagrangeResults, StateSpace, get_units
from heuncli.app.commands.lagrange.forms import (
    COURSE_CSV_COLUMNS,
    CSV_COLUMNS,
    iter_course_records,
    iter_records,
    to_block,
    to_course_block,
)
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable, format_head
from heuncli.results.results import Array
from heuncli.study.quantities.labels import distinguish
from heuncli.study.quantities.table_units import Units

HEADING = "LAGRANGE  {at}: coordinates q and rates q'; ε q'' + C = k + drive"
MASS = "MASS MATRIX  ε = ∂²E/∂q'∂q'; effective inertia with the other coordinates fixed or free"
RECIPROCAL = "INVERSE MASS MATRIX  η = ε⁻¹: E = p η p / 2"
FORCES = "GENERALISED FORCES  k by cause; C: centrifugal and Coriolis terms"
CHRISTOFFEL = "CHRISTOFFEL  γ(i; l, k) = (∂ε_il/∂q_k + ∂ε_ik/∂q_l − ∂ε_lk/∂q_i) / 2 and α(i; l, k) = −Σ η_ij γ(j; l, k)"
BLOWS = "IMPULSES  ε [q'] = h + drives; r': impulse of the far side on the near side of the cut"
SECTIONS = "SECTIONS  s' along each coordinate: force of the far side on the near side of the cut"
STATE_SPACE = "STATE SPACE  x' = A x + B u: columns of A: states, of B: inputs"
OUTPUTS = "OUTPUTS  y = C x + D u"
OWN_ROWS = ("k", "C")  # after the rows of the causes
SI = Units()
MAX_COORDINATES = 6  # with more coordinates matrices are not shown
ROUNDING = 1e-13  # relative to the summed terms, or to the largest entry: less is shown as 0
MIXED = ". Angles in {}, {}; lengths in {}, {}"
COLUMNS: tuple[tuple[str, attrgetter[str]], ...] = (
    ("q", attrgetter("value")), ("q'", attrgetter("rate")), ("p = ∂E/∂q'", attrgetter("momentum")),
    ("C", attrgetter("force")), ("k", attrgetter("force")), ("drive", attrgetter("force")),
    ("q''", attrgetter("acceleration")),
)  # fmt: skip


def make_document(results: LagrangeResults, parts: Sequence[str] = (), units: Units = SI) -> OutputDocument:
    """Make the document.

    parts: the parts to show, as forms.KEYS names them; empty: all
    """
    tables = (table for part, table in make_tables(results, units) if not parts or part in parts)
    facts = list(list_facts(results, units))
    return OutputDocument(
        results.title,
        facts,
        tables,
        lambda: to_block(results, parts),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(results))),
    )


def list_facts(results: LagrangeResults, units: Units) -> Iterator[tuple[str, str]]:
    """Yield label and text of the lines above the tables."""
    unit, size = units.find("J")
    free, mixed, driven = (size * part for part in results.energies)
    parts = (
        f": free {free:.6g}, mixed {mixed:.6g}, driven {driven:.6g} {unit}"
        if any(results.is_driven) and free and not np.isnan(free)
        else ""
    )
    sizes = (size * energy for energy in (results.energy, results.reciprocal_energy))
    energy, reciprocal = (f"{value:.6g} {unit}" for value in sizes)
    yield "energy", f"kinetic E = {energy}, from momenta F = {reciprocal}{parts}"
    yield "", f"ε q'' + C = k + drive: relative residual {results.residual:.1g}"
    for note in results.notes:
        yield "", note


def make_tables(results: LagrangeResults, units: Units) -> Iterator[tuple[str, OutputTable]]:
    """Yield the parts to show, one table each; matrices only for few coordinates."""
    yield "equations", make_equation_table(results, units)
    yield "mass", make_mass_table(results)
    if len(results.names) <= MAX_COORDINATES:
        yield "reciprocal", make_reciprocal_table(results)
        yield "forces", make_force_table(results, units)
        if results.gamma is not None:
            yield "christoffel", make_christoffel_table(results)
    if results.sections:
        yield "sections", make_section_table(results, units)
    if results.impulses:
        yield "blows", make_impulse_table(results, units)
    if results.state_space is not None:
        yield from (("state_space", table) for table in make_linear_tables(results.state_space))


def make_linear_tables(linear: StateSpace) -> Iterator[OutputTable]:
    """Yield the table of A and B, and that of C and D."""
    for heading, left, right, rows in (
        (STATE_SPACE, linear.A, linear.B, [f"d/dt {name}" for name in linear.states]),
        (OUTPUTS, linear.C, linear.D, linear.outputs),
    ):
        whole = np.hstack([left, right])
        sizes = np.abs(whole).max(axis=1, initial=0.0)
        cells_of_rows = tuple(
            (name, *(make_cell(x, size) for x in row)) for name, row, size in zip(rows, whole, sizes, strict=True)
        )
        yield OutputTable(
            heading, (OutputColumn("", "text"), *map(OutputColumn, (*linear.states, *linear.inputs))), cells_of_rows
        )


def make_cell(value: float | None, scale: float = 0.0) -> Cell:
    """Make the cell of a number, which is printed to six digits; rounding errors relative to the scale become 0."""
    if value is None or np.isnan(value):
        return None
    return 0 if abs(value) <= ROUNDING * scale else float(value)


def format_label(results: LagrangeResults, i: int) -> str:
    """Return the name of a coordinate, and whether a drive moves it."""
    return f"{results.names[i]}{'  driven' if results.is_driven[i] else ''}"


def make_equation_table(results: LagrangeResults, units: Units) -> OutputTable:
    """Make the table with one row per coordinate; units stand in the heads, or in the heading if angles and lengths are
    mixed.
    """
    columns = (
        results.values,
        results.rates,
        results.momenta,
        results.coriolis,
        results.total_force,
        results.drives,
        results.accelerations,
    )
    none = np.zeros(len(results.names))
    scales = (none, none, none, results.scale, results.scale, results.scale, np.abs(results.eta) @ results.scale)
    rows = []
    for i, name in enumerate(results.names):
        unit_set = get_units(name)
        sizes = [units.find(unit(unit_set))[1] for _, unit in COLUMNS]
        cells = (
            make_cell(x[i] * factor, scale[i] * factor) for x, scale, factor in zip(columns, scales, sizes, strict=True)
        )
        rows.append((format_label(results, i), *cells))
    heading, kinds = HEADING.format(at=results.instant_text), {get_units(name) for name in results.names}
    if len(kinds) == 1:
        heads = [format_head(name, units.find(unit(unit_set))[0]) for unit_set in kinds for name, unit in COLUMNS]
    else:
        heads = [name for name, _ in COLUMNS]
        heading += MIXED.format(
            *(units.find(unit)[0] for unit_set in (ANGLE, LENGTH) for unit in (unit_set.value, unit_set.force))
        )
    return OutputTable(heading, (OutputColumn("coordinate", "text"), *map(OutputColumn, heads)), tuple(rows))


def make_mass_table(results: LagrangeResults) -> OutputTable:
    """Make the table of the mass matrix if it is small, and of the effective inertias."""
    has_all = {inertia.name for inertia in results.apparent_inertias} == set(results.names)
    shows_matrix = len(results.names) <= MAX_COORDINATES and has_all
    sizes = bound_entries(results.epsilon)
    rows = []
    for inertia in results.apparent_inertias:
        matrix_cells: list[Cell] = []
        if shows_matrix:
            i = results.names.index(inertia.name)
            matrix_cells = [make_cell(x, size) for x, size in zip(results.epsilon[i], sizes[i], strict=True)]
        rows.append(
            (
                inertia.name,
                *matrix_cells,
                inertia.unit,
                make_cell(inertia.others_locked),
                make_cell(inertia.others_free),
            )
        )
    columns = [OutputColumn(f"ε {name}") for name in results.names] if shows_matrix else []
    heads = (OutputColumn("at", "text"), *columns, OutputColumn("unit", "text"), OutputColumn("others fixed"))
    return OutputTable(MASS, (*heads, OutputColumn("others free")), tuple(rows))


def bound_entries(matrix: Array) -> Array:
    """Return an upper bound of the entries of a positive definite matrix: sqrt(m_ii m_jj)."""
    root = np.sqrt(np.diag(matrix))
    return np.asarray(np.outer(root, root))


def make_reciprocal_table(results: LagrangeResults) -> OutputTable:
    """Make the table of the inverse of the mass matrix."""
    rows_of_matrix = zip(results.names, results.eta, bound_entries(results.eta), strict=True)
    rows = tuple((name, *map(make_cell, row, sizes)) for name, row, sizes in rows_of_matrix)
    return OutputTable(RECIPROCAL, (OutputColumn("", "text"), *map(OutputColumn, results.names)), rows)


def make_force_table(results: LagrangeResults, units: Units) -> OutputTable:
    """Make the table of the generalized forces k by cause."""
    display_units = [units.find(get_units(name).force) for name in results.names]

    def make_row(cause: str, k: Array) -> tuple[Cell, ...]:
        """Make the row of a cause from its generalised forces."""
        cells = zip(k, results.scale, display_units, strict=True)
        return cause, *(make_cell(x * factor, size * factor) for x, size, (_, factor) in cells)

    rows = [make_row(distinguish(cause, OWN_ROWS), k) for cause, k in results.forces.items()]
    rows += [make_row(name, k) for name, k in zip(OWN_ROWS, (results.total_force, results.coriolis), strict=True)]
    heads = (
        OutputColumn(format_head(name, unit)) for name, (unit, _) in zip(results.names, display_units, strict=True)
    )
    return OutputTable(FORCES, (OutputColumn("cause", "text"), *heads), tuple(rows))


def make_christoffel_table(results: LagrangeResults) -> OutputTable:
    """Make the table of the Christoffel symbols that are not 0, each pair l, k once."""
    assert results.gamma is not None and results.alpha is not None
    sizes = [float(np.abs(x).max(initial=0.0)) for x in (results.gamma, results.alpha)]
    rows = []
    f = len(results.names)
    for i, j, k in product(range(f), repeat=3):
        if k < j:
            continue
        both = [make_cell(x[i, j, k], size) for x, size in zip((results.gamma, results.alpha), sizes, strict=True)]
        if both != [0, 0]:
            rows.append((results.names[i], results.names[j], results.names[k], *both))
    heads = (*(OutputColumn(name, "text") for name in ("i", "l", "k")), OutputColumn("γ"), OutputColumn("α"))
    return OutputTable(CHRISTOFFEL, heads, tuple(rows), () if rows else ("all are 0",))


def make_section_table(results: LagrangeResults, units: Units) -> OutputTable:
    """Make the table of s' of each cut."""
    display_units = [units.find(get_units(name).force) for name in results.names]
    sizes = [factor for _, factor in display_units]
    rows = [
        (cut, *make_cells(s, sizes, section.scale))
        for name, section in results.sections.items()
        for cut, s in list_cuts(name, section)
    ]
    heads = (
        OutputColumn(format_head(name, unit)) for name, (unit, _) in zip(results.names, display_units, strict=True)
    )
    return OutputTable(SECTIONS, (OutputColumn("section", "text"), *heads), tuple(rows))


def make_impulse_table(results: LagrangeResults, units: Units) -> OutputTable:
    """Make the table of each impulse h, of the drives, of the jumps of the rates, and of what the sections transmit."""
    unit_sets = [get_units(name) for name in results.names]
    impulses, rates = (
        [units.find(unit)[1] for unit in by] for by in ([x.momentum for x in unit_sets], [x.rate for x in unit_sets])
    )
    rows = []
    for impulse in results.impulses:
        time_text = f"t = {impulse.t:.6g} s"
        rows += [
            (time_text, "h", *make_cells(impulse.h, impulses)),
            (time_text, "[q']", *make_cells(impulse.jumps, rates)),
        ]
        rows += [(time_text, "drives", *make_cells(impulse.drives, impulses))] if impulse.drives.any() else []
        for section, passed in impulse.sections.items():
            rows += [
                (time_text, f"r' {cut}", *make_cells(r, impulses, passed.scale))
                for cut, r in list_cuts(section, passed)
            ]
    unit, size = units.find("J")
    notes = [f"F = h η h / 2 = {impulse.reciprocal_energy * size:.6g} {unit}" for impulse in results.impulses]
    for kind in sorted(set(unit_sets)):
        unit_names = ", ".join(units.find(unit)[0] for unit in (kind.momentum, kind.rate))
        notes.append(f"along {'lengths' if kind is LENGTH else 'angles'}: {unit_names}")
    heads = (
        OutputColumn("impulse", "text", is_shown_once=True),
        OutputColumn("", "text"),
        *map(OutputColumn, results.names),
    )
    return OutputTable(BLOWS, heads, tuple(rows), tuple(notes))


def make_cells(values: Array | None, sizes: Sequence[float], reach: Array | float = 0.0) -> list[Cell]:
    """Make the cells of numbers along the coordinates in display units; rounding errors are 0, indeterminate numbers
    `open`.
    """
    if values is None:
        return ["open"] * len(sizes)
    factors = np.array(sizes)
    return [make_cell(x, size) for x, size in zip(values * factors, reach * factors, strict=True)]


TOTAL = "k"
COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def make_course_document(course: InertiaCurve, units: Units) -> OutputDocument:
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
        [make_course_table(course, units)],
        lambda: to_course_block(course),
        lambda: OutputTable("", COURSE_CSV_COLUMNS, list(iter_course_records(course))),
    )


def make_course_table(course: InertiaCurve, units: Units) -> OutputTable:
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
