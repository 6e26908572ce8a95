"""The channels of results in groups and blocks: the tables before they are laid out.

A block is one table of the report, a group holds the rows of one name in it, a row is the channel of one number. Rows
are SI; numbers are converted to display units where they are formatted.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import NumberCell
from heuncli.output.tables.table_plans import BEARING, MASS_EFFECT, TablePlan
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import find_label
from heuncli.study.quantities.channels import SYMBOLS, Channel, make_energy_sum
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    StatedErrors,
    Style,
    largest_magnitude,
    write_numbers,
)
from heuncli.study.quantities.labels import Labels

FREE_SCENE_NOTE = "no connection to the ground: the model is free"


class RowGroup(NamedTuple):
    """The rows of one joint, force, ...

    note: says what it is
    label: its label in the spec, if it has one
    is_whole_scene: whether it stands for the scene as a whole
    """

    name: str
    note: str
    rows: tuple[Channel, ...]
    is_whole_scene: bool = False
    label: str = ""

    @property
    def caption(self) -> str:
        """Label and name."""
        return f"{self.label} ({self.name})" if self.label else self.name

    @property
    def title(self) -> str:
        """Label, name and note as one line."""
        return f"{self.caption}  {self.note}".rstrip()


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

    @property
    def paths(self) -> list[str]:
        """The paths of its rows."""
        return [row.path for group in self.groups for row in group.rows]


def choose_styles(rows: Sequence[Channel], numbers: Array, stated_errors: StatedErrors) -> list[Style]:
    """Choose the number style of each row in its display unit, by the largest of its family.

    numbers (n, n_rows): those that are shown besides the values of the rows, SI
    """
    families = [_find_family(row) for row in rows]
    scales: dict[tuple[str, ...], float] = {}
    for row, family, shown in zip(rows, families, numbers.T, strict=True):
        scales[family] = max(scales.get(family, 0.0), largest_magnitude(row.values), largest_magnitude(shown))
    styles = []
    for row, family in zip(rows, families, strict=True):
        row_style, term_style = (
            stated_errors.choose_style(row.error_kind, row.unit, scale) for scale in (scales[family], row.largest_term)
        )
        # a sum that is zero to the digits of its cancelling terms is shown as zero
        is_zero = row.largest_term and term_style.write(stated_errors.units.find(row.unit)[1] * scales[family]) == "0"
        styles.append(term_style if is_zero else row_style)
    return styles


def _find_family(row: Channel) -> tuple[str, ...]:
    return row.family, row.error_kind, row.unit


def make_cells(group: RowGroup, numbers: Array, stated_errors: StatedErrors) -> list[list[NumberCell]]:
    """Make the cells of each row from its numbers: n_rows lists of n. The rows of a family show the same decimals.

    numbers (n, n_rows): SI
    """
    cells: list[list[NumberCell]] = [[] for _ in group.rows]
    styles = choose_styles(group.rows, numbers, stated_errors)
    factors = [stated_errors.units.find(row.unit)[1] for row in group.rows]
    shown = numbers * np.array(factors)
    errors = [per_si * stated_errors.find_error(row) for per_si, row in zip(factors, group.rows, strict=True)]
    families = [_find_family(row) for row in group.rows]
    for family in dict.fromkeys(families):
        members = [i for i, other in enumerate(families) if other == family]
        values = shown[:, members].ravel().tolist()
        texts = write_numbers(values, styles[members[0]])
        for column, member in enumerate(members):
            own = slice(column, None, len(members))
            numbers_of_row = zip(values[own], texts[own], strict=True)
            cells[member] = [NumberCell(value, errors[member], None, text) for value, text in numbers_of_row]
    return cells


def build_block(plan: TablePlan, results: Results, labels: Labels, channels: Iterable[Channel]) -> TableBlock | None:
    """Build the block of one plan from the channels of its kind; None if there is nothing to show.

    Series of cuts have tables of their own (cut_tables.py).
    """
    groups = []
    for name, channel_of_quantity in _group_channels(plan, results, channels).items():
        shown = [channel_of_quantity[quantity] for quantity in plan.quantities if quantity in channel_of_quantity]
        rows = tuple(row for channel in shown for row in channel.numbers)
        group_name = _make_group_name(plan, name)
        label = find_label(plan.kind, name, labels) if name else ""
        groups.append(RowGroup(group_name, plan.note(group_name, labels), rows, is_whole_scene=not name, label=label))
    notes: tuple[str, ...] = ()
    if plan.is_foundation:
        groups, notes = _select_foundation_groups(groups, results)
    if plan.kind == "joints" and not plan.part:
        notes = describe_chosen_components(results)
    if plan.kind == "energy" and groups and (energy_sum := make_energy_sum(results)) is not None:
        groups = [groups[0]._replace(rows=(*groups[0].rows, energy_sum), is_whole_scene=True)]
    heading = plan.heading(results, labels)
    return TableBlock(plan.key, plan.kind, heading, plan.what, tuple(groups), notes, plan.missing) if groups else None


def _group_channels(plan: TablePlan, results: Results, channels: Iterable[Channel]) -> dict[str, dict[str, Channel]]:
    """Return the channels that a plan shows, by the name of their object and by their quantity."""
    cut_series = {name for name, section in results.sections.items() if "s" in section and plan.kind == "sections"}
    found: dict[str, dict[str, Channel]] = {}
    for channel in channels:
        if channel.cause or channel.kind != plan.kind or channel.quantity not in plan.quantities:
            continue
        if plan.kind == "joints" and (BEARING in channel.name) != (plan.part == BEARING):
            continue
        is_mass_effect = plan.is_foundation and channel.name == MASS_EFFECT.only
        if (
            plan.only not in (None, channel.name)
            or is_mass_effect
            or (channel.has_cuts and channel.name.split(".")[0] in cut_series)
        ):
            continue
        name = channel.name.removesuffix(".stress") if plan.kind == "sections" else channel.name
        found.setdefault(name, {})[channel.quantity] = channel
    return found


def _make_group_name(plan: TablePlan, name: str) -> str:
    """Return the name of a group as the table shows it: "support pin1" of `supports.pin1`; "" for the whole scene."""
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
