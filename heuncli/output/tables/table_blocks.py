"""Results as rows of numbers with short names, in groups and blocks: the tables before they are laid out.

A block is one table of the report, a group holds the rows of one name in it, a row is one number over the instants.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.table_plans import MASS_EFFECT, TablePlan
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import (
    AXIAL_FORCES,
    MAGNITUDES,
    SECTION_FORCES,
    SECTION_MOMENTS,
    TILTING_MOMENTS,
    XYZ,
)
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    StatedErrors,
    Style,
    find_error_kind,
    largest_magnitude,
    write_numbers,
)
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series

# Vector -> the symbol with which its components begin. Others keep their own name.
SYMBOLS = {
    "force": "F",
    "moment": "M",
    "moment_orbital": "M orbital ",
    "moment_spin": "M spin ",
    "position": "",
    "center": "",
    "velocity": "v",
    "center_velocity": "v",
    "acceleration": "a",
    "center_acceleration": "a",
    "angular_velocity": "ω",
    "angular_acceleration": "α",
    "center_velocity_jump": "Δv",
    "angular_velocity_jump": "Δω",
}
# Quantities with the same decimals as another, so that noise in one shows against the others.
FAMILIES = {
    **dict.fromkeys((*AXIAL_FORCES, *SECTION_FORCES), "force"),
    **dict.fromkeys((*TILTING_MOMENTS, *SECTION_MOMENTS, "moment_orbital", "moment_spin"), "moment"),
}
POSITIONS = frozenset({"position", "center", "point", "direction"})  # vectors whose length has no meaning
FREE_SCENE_NOTE = "no connection to the ground: the model is free"


class NumberRow(NamedTuple):
    """One number over the instants, (n_t,).

    family: rows of one family show the same decimals
    kind: of the number's error
    is_magnitude: whether it is never negative, with a kink at zero that its square does not have
    vector: symbol shared by the components and the magnitude of one vector
    largest_term: the largest number of which it is a sum
    """

    label: str
    unit: str
    family: str
    kind: str
    values: Array
    is_magnitude: bool = False
    vector: str = ""
    largest_term: float = 0.0


class RowGroup(NamedTuple):
    """The rows of one joint, force, ...

    note: says what it is
    is_whole_scene: whether it stands for the scene as a whole
    """

    name: str
    note: str
    rows: tuple[NumberRow, ...]
    is_whole_scene: bool = False

    @property
    def title(self) -> str:
        """Name and note as one line."""
        return f"{self.name}  {self.note}".rstrip()


class TableBlock(NamedTuple):
    """One table of the report before it is laid out.

    key: the report that it belongs to
    kind: the block of the results, as in its plan
    what: heads the column of the groups' names
    missing: the text for nan, and the note that explains it
    """

    key: str
    kind: str
    heading: str
    what: str
    groups: tuple[RowGroup, ...]
    notes: tuple[str, ...] = ()
    missing: tuple[str, str] = (OPEN, OPEN_NOTE)


def choose_styles(rows: Sequence[NumberRow], numbers: Array, certain: StatedErrors) -> list[Style]:
    """Choose the number style of each row, that of its family, from its values and from `numbers`, (n, n_rows)."""
    scales: dict[tuple[str, ...], float] = {}
    for row, shown in zip(rows, numbers.T, strict=True):
        scale = max(largest_magnitude(row.values), largest_magnitude(shown))
        scales[_find_family(row)] = max(scales.get(_find_family(row), 0.0), scale)
    styles = []
    for row in rows:
        row_style, term_style = (
            certain.choose_style(row.kind, row.unit, scale) for scale in (scales[_find_family(row)], row.largest_term)
        )
        # a sum that is zero to the digits of its cancelling terms is shown as zero
        styles.append(
            term_style if row.largest_term and term_style.write(scales[_find_family(row)]) == "0" else row_style
        )
    return styles


def _find_family(row: NumberRow) -> tuple[str, ...]:
    return row.family, row.kind, row.unit


def format_numbers(group: RowGroup, numbers: Array, certain: StatedErrors) -> list[list[str]]:
    """Format the numbers of each row, (n, n_rows) -> n_rows lists of n; the rows of a family show the same decimals."""
    texts: list[list[str]] = [[] for _ in group.rows]
    styles = choose_styles(group.rows, numbers, certain)
    families = [_find_family(row) for row in group.rows]
    for family in dict.fromkeys(families):
        members = [i for i, other in enumerate(families) if other == family]
        flat = write_numbers(numbers[:, members].ravel().tolist(), styles[members[0]])
        for column, member in enumerate(members):
            texts[member] = flat[column :: len(members)]
    return texts


def build_block(plan: TablePlan, results: Results, labels: Labels, series: Iterable[Series]) -> TableBlock | None:
    """Build the block of one plan from the series of its kind; None if there is nothing to show.

    Runs of cuts are left to output/tables/cut_runs.py.
    """
    runs = {name for name, section in results.sections.items() if "s" in section} if plan.kind == "sections" else set()
    named: dict[str, dict[str, Series]] = {}
    for item in series:
        if item.cause or item.kind != plan.kind or item.quantity not in plan.quantities:
            continue
        if plan.only not in (None, item.name):
            continue
        if plan.is_foundation and item.name == MASS_EFFECT.only:
            continue
        if item.name.split(".")[0] not in runs:
            name = item.name.removesuffix(".stress") if plan.kind == "sections" else item.name
            named.setdefault(name, {})[item.quantity] = item
    groups = []
    for name, series_of_quantity in named.items():
        rows = [
            row
            for quantity in plan.quantities
            if quantity in series_of_quantity
            for row in make_rows(series_of_quantity[quantity])
        ]
        label = _make_group_name(plan, name)
        groups.append(RowGroup(label, plan.note(label, labels), tuple(rows), is_whole_scene=not name))
    notes: tuple[str, ...] = ()
    if plan.is_foundation:
        groups, notes = _select_foundation_groups(groups, results)
    if plan.kind == "joints":
        notes = describe_chosen_components(results)
    if plan.kind == "energy" and groups:
        groups = [_append_energy_sum(groups[0])]
    heading = plan.heading(results, labels)
    return TableBlock(plan.key, plan.kind, heading, plan.what, tuple(groups), notes, plan.missing) if groups else None


def make_rows(series: Series) -> list[NumberRow]:
    """Make the rows of one quantity: itself, or its components and the magnitude of a free vector."""
    quantity, unit = series.quantity, series.unit
    title, family, kind = quantity.replace("_", " "), FAMILIES.get(quantity, quantity), find_error_kind(series)
    if len(series.components) == 1:
        return [NumberRow(title, unit, family, kind, series.values[:, 0], is_magnitude=quantity in MAGNITUDES)]
    symbol = SYMBOLS.get(quantity, f"{title} ")
    vector = "" if quantity in POSITIONS else symbol.strip()
    columns = zip(series.components, series.values.T, strict=True)
    rows = [
        NumberRow(f"{symbol}{component}", unit, family, kind, column, vector=vector) for component, column in columns
    ]
    if series.components == XYZ and vector:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        rows.append(NumberRow(f"|{vector}|", unit, family, kind, np.sqrt(squares), is_magnitude=True, vector=vector))
    return rows


def _make_group_name(plan: TablePlan, name: str) -> str:
    if not plan.is_foundation:
        return "" if plan.only else name
    return name.replace("supports.", "support ", 1).replace("elements.", "element ", 1) or "total"


def _select_foundation_groups(groups: list[RowGroup], results: Results) -> tuple[list[RowGroup], tuple[str, ...]]:
    """Return groups and notes of the foundation: a single support is the total, except for the point of its moment."""
    supports, elements = results.foundation.get("supports", {}), results.foundation.get("elements", {})
    if not supports and not elements:
        return groups, (FREE_SCENE_NOTE,) * ("supports" in results.foundation)
    if len(supports) == 1 and not elements and "force" in results.foundation:
        note = f"carried entirely by {next(iter(supports))}, the only support"
        return [group for group in groups if group.is_whole_scene], (note,)
    return groups, ('supports: moment about the joint\'s "to" point; elements: about their own point',)


def describe_chosen_components(results: Results) -> tuple[str, ...]:
    """Return the note on indeterminate components whose values are those of one chosen split."""
    chosen = [
        f"{name} {' '.join(format_component(component) for component in joint['chosen'])}"
        for name, joint in results.joints.items()
        if joint.get("chosen")
    ]
    return (f"indeterminate, one distribution chosen: {', '.join(chosen)}",) if chosen else ()


def format_component(component: str) -> str:
    """Format a component as the tables name it: `force.z` becomes `Fz`; others keep their name."""
    quantity, _, axis = component.partition(".")
    return f"{SYMBOLS[quantity]}{axis}" if axis in XYZ and quantity in SYMBOLS else component


def _append_energy_sum(group: RowGroup) -> RowGroup:
    """Append the sum of the energies, which is constant."""
    part = {row.label: row.values for row in group.rows}
    if not {"kinetic", "potential", "work"} <= part.keys():
        return group
    total = part["kinetic"] + part["potential"] - part["work"]
    terms = max(largest_magnitude(values) for values in part.values())
    rows = (*group.rows, NumberRow("sum", group.rows[0].unit, "sum", "energy", total, largest_term=terms))
    return RowGroup(group.name, group.note, rows, is_whole_scene=True)
