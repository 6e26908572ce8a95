"""Results as rows of numbers with short names, in groups, in blocks: the tables before they are laid out.

A block is one table of the report, a group what belongs to one name in it, a row one number over the instants.
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
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, Certainty, Style, kind_of, largest, write
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series

# Vector -> the short name its components begin with. What is not listed is called by its own name.
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
# Quantities that share their decimals with another: noise in one shows against the others.
FAMILIES = {
    **dict.fromkeys((*AXIAL_FORCES, *SECTION_FORCES), "force"),
    **dict.fromkeys((*TILTING_MOMENTS, *SECTION_MOMENTS, "moment_orbital", "moment_spin"), "moment"),
}
POSITIONS = frozenset({"position", "center", "point", "direction"})  # vectors whose length means nothing
FREE = "nothing stands on the ground: the scene is free"


class NumberRow(NamedTuple):
    """One number over the instants, (n_t,). Rows of one `family` share their decimals; `kind`: of their error.

    An `even` one is a magnitude: never negative, with a kink at zero that its square does not have. Components and
    magnitude of one vector have its symbol as `vector`. beside: the largest number that it is a sum of.
    """

    label: str
    unit: str
    family: str
    kind: str
    values: Array
    even: bool = False
    vector: str = ""
    beside: float = 0.0


class RowGroup(NamedTuple):
    """The rows of one joint, force, ...; `note` says what it is, `whole` that it stands for the scene as a whole."""

    name: str
    note: str
    rows: tuple[NumberRow, ...]
    whole: bool = False

    @property
    def title(self) -> str:
        """Name and note as one line."""
        return f"{self.name}  {self.note}".rstrip()


class TableBlock(NamedTuple):
    """One table of the report before it is laid out; `what` heads the column of the groups' names.

    key: the report that it is of, kind: the block of the results, as in its plan.
    `missing` is what stands for nan, and the note that explains it.
    """

    key: str
    kind: str
    heading: str
    what: str
    groups: tuple[RowGroup, ...]
    notes: tuple[str, ...] = ()
    missing: tuple[str, str] = (OPEN, OPEN_NOTE)


def family_styles(rows: Sequence[NumberRow], numbers: Array, certain: Certainty) -> list[Style]:
    """The style of each row, that of its family, by all that is shown of it: its values and `numbers`, (n, n_rows)."""
    scales: dict[tuple[str, ...], float] = {}
    for row, shown in zip(rows, numbers.T, strict=True):
        scale = max(largest(row.values), largest(shown))
        scales[_family(row)] = max(scales.get(_family(row), 0.0), scale)
    styles = []
    for row in rows:
        own, whole = (certain.style(row.kind, row.unit, scale) for scale in (scales[_family(row)], row.beside))
        # a sum whose terms cancel, to the digits that are shown of them, is nothing beside them
        styles.append(whole if row.beside and whole.write(scales[_family(row)]) == "0" else own)
    return styles


def _family(row: NumberRow) -> tuple[str, ...]:
    return row.family, row.kind, row.unit


def texts_of(group: RowGroup, numbers: Array, certain: Certainty) -> list[list[str]]:
    """The numbers of each row as text, (n, n_rows) -> n_rows lists of n; the rows of a family share their decimals."""
    texts: list[list[str]] = [[] for _ in group.rows]
    styles = family_styles(group.rows, numbers, certain)
    families = [_family(row) for row in group.rows]
    for family in dict.fromkeys(families):
        members = [i for i, own in enumerate(families) if own == family]
        flat = write(numbers[:, members].ravel().tolist(), styles[members[0]])
        for column, member in enumerate(members):
            texts[member] = flat[column :: len(members)]
    return texts


def build(plan: TablePlan, results: Results, labels: Labels, series: Iterable[Series]) -> TableBlock | None:
    """The block of one plan out of the walked series of its kind; None where there is nothing to show.

    Runs of cuts are left to output/tables/cut_runs.py.
    """
    runs = {name for name, section in results.sections.items() if "s" in section} if plan.kind == "sections" else set()
    named: dict[str, dict[str, Series]] = {}
    for item in series:
        if item.cause or item.kind != plan.kind or item.quantity not in plan.quantities:
            continue
        if plan.only not in (None, item.name):
            continue
        if plan.of_foundation and item.name == MASS_EFFECT.only:
            continue
        if item.name.split(".")[0] not in runs:
            name = item.name.removesuffix(".stress") if plan.kind == "sections" else item.name
            named.setdefault(name, {})[item.quantity] = item
    groups = []
    for name, own in named.items():
        rows = [row for quantity in plan.quantities if quantity in own for row in rows_of(own[quantity])]
        label = _group_name(plan, name)
        groups.append(RowGroup(label, plan.note(label, labels), tuple(rows), whole=not name))
    notes: tuple[str, ...] = ()
    if plan.of_foundation:
        groups, notes = _supports(groups, results)
    if plan.kind == "joints":
        notes = chosen_components(results)
    if plan.kind == "energy" and groups:
        groups = [_with_sum(groups[0])]
    heading = plan.heading(results, labels)
    return TableBlock(plan.key, plan.kind, heading, plan.what, tuple(groups), notes, plan.missing) if groups else None


def rows_of(series: Series) -> list[NumberRow]:
    """The rows of one quantity: itself, or its components and the magnitude of a free vector."""
    quantity, unit = series.quantity, series.unit
    spoken, family, kind = quantity.replace("_", " "), FAMILIES.get(quantity, quantity), kind_of(series)
    if len(series.components) == 1:
        return [NumberRow(spoken, unit, family, kind, series.values[:, 0], even=quantity in MAGNITUDES)]
    symbol = SYMBOLS.get(quantity, f"{spoken} ")
    vector = "" if quantity in POSITIONS else symbol.strip()
    columns = zip(series.components, series.values.T, strict=True)
    rows = [
        NumberRow(f"{symbol}{component}", unit, family, kind, column, vector=vector) for component, column in columns
    ]
    if series.components == XYZ and vector:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        rows.append(NumberRow(f"|{vector}|", unit, family, kind, np.sqrt(squares), even=True, vector=vector))
    return rows


def _group_name(plan: TablePlan, name: str) -> str:
    if not plan.of_foundation:
        return "" if plan.only else name
    return name.replace("supports.", "support ", 1).replace("elements.", "element ", 1) or "total"


def _supports(groups: list[RowGroup], results: Results) -> tuple[list[RowGroup], tuple[str, ...]]:
    """Groups and notes of the foundation: a support alone is the total, apart from the point of its moment."""
    supports, elements = results.foundation.get("supports", {}), results.foundation.get("elements", {})
    if not supports and not elements:
        return groups, (FREE,) * ("supports" in results.foundation)
    if len(supports) == 1 and not elements and "force" in results.foundation:
        only = f"all of it goes through {next(iter(supports))}, the only support"
        return [group for group in groups if group.whole], (only,)
    return groups, ('supports: moment about the joint\'s "to" point; elements: about their own point',)


def chosen_components(results: Results) -> tuple[str, ...]:
    """Which open components are shown with the values of one chosen split."""
    chosen = [
        f"{name} {' '.join(short(component) for component in joint['chosen'])}"
        for name, joint in results.joints.items()
        if joint.get("chosen")
    ]
    return (f"chosen, not certain: {', '.join(chosen)}",) if chosen else ()


def short(component: str) -> str:
    """A component as the tables call it: `force.z` is `Fz`; others keep their name."""
    quantity, _, axis = component.partition(".")
    return f"{SYMBOLS[quantity]}{axis}" if axis in XYZ and quantity in SYMBOLS else component


def _with_sum(group: RowGroup) -> RowGroup:
    """The energies and their sum, which is constant."""
    part = {row.label: row.values for row in group.rows}
    if not {"kinetic", "potential", "work"} <= part.keys():
        return group
    total = part["kinetic"] + part["potential"] - part["work"]
    terms = max(largest(values) for values in part.values())
    rows = (*group.rows, NumberRow("sum", group.rows[0].unit, "sum", "energy", total, beside=terms))
    return RowGroup(group.name, group.note, rows, whole=True)
