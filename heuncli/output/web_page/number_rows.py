"""The numbers of a page: the rows of the tables of a run, each with its path, all digits, and the style to show them
in.

A row is one quantity over the frames: a number, or a vector with its components. Its style is that of the tables: no
more digits than the stated error of the run justifies (study/quantities/digits.py). Values are in SI; each row also has
its display unit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.output.tables.certain_sums import make_sums_table
from heuncli.output.tables.table_blocks import FAMILIES, POSITIONS, NumberRow, choose_styles, make_rows
from heuncli.output.tables.table_plans import AXIS, IMPULSES, PLANS, TablePlan
from heuncli.output.web_page.packing import pack_values
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS, STRESSES
from heuncli.study.quantities.digits import OPEN, StatedErrors, Style
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, convert_units, iter_impulse_series, iter_series

ZERO_ROWS_PREFIX = "All values 0: "
EXCLUDED_KINDS = frozenset({"bodies", "points", "sections"})  # sections have rows of their own


def make_blocks(results: Results, labels: Labels, certain: StatedErrors) -> list[dict[str, Any]]:
    """Make the tables of all quantities that run over the instants; each heading states signs and axes."""
    series = [item for item in iter_series(results, labels) if not item.cause]
    plans = [plan for plan in PLANS if plan.kind not in EXCLUDED_KINDS and (plan.only is None or plan is AXIS)]
    found = [_make_block(plan, series, plan.heading(results, labels), labels, certain) for plan in plans]
    sums = make_sums_table(results, certain, shown_unit=labels.units.find("N"))
    if sums is not None:
        found.append({"heading": sums.heading, "groups": [], "told": list(sums.notes), "missing": OPEN})
    return [block for block in found if block["groups"] or block["told"]]


def make_impact_page_tables(
    number: int, impact: Block, results: Results, labels: Labels, certain: StatedErrors
) -> list[dict[str, Any]]:
    """Make the tables of one impact; their numbers hold only at its instant."""
    series = [item for item in iter_impulse_series(impact, labels) if not item.cause]
    prefix = f"AT {float(impact['time']):.6g} s, {', '.join(impact['names']) or 'impulse'}: "
    tables = []
    for plan in IMPULSES:
        if plan.kind in ("foundation", "joints", "stops", "sections") and plan.only is None:
            plan_series = [item for item in series if item.quantity in plan.quantities and not item.has_cuts]
            block = _make_block(plan, plan_series, prefix + plan.heading(results, labels), labels, certain)
            tables += [_prefix_paths(block, number)] if block["groups"] else []
    return tables


def _prefix_paths(block: dict[str, Any], number: int) -> dict[str, Any]:
    """Change the paths of a block's rows to those of an impact."""
    for group in block["groups"]:
        for row in group["rows"]:
            row["path"] = f"impulses.{number}.{row['path']}"
    return block


def _make_block(
    plan: TablePlan, series: Iterable[Series], heading: str, labels: Labels, certain: StatedErrors
) -> dict[str, Any]:
    """Make one table: heading, groups of rows by object, the list of rows that are zero at all times, and the text for
    nan.
    """
    series_by_name: dict[str, list[Series]] = {}
    for item in series:
        if item.kind == plan.kind and item.quantity in plan.quantities and _is_in_plan(plan, item.name):
            series_by_name.setdefault(item.name, []).append(item)
    notes: list[str] = []
    if (
        plan.is_foundation
        and len(series_by_name) == 2
        and (only := [name for name in series_by_name if name.startswith("supports.")])
    ):
        series_by_name = {"": series_by_name[""]}
        notes = [f"carried entirely by {only[0].removeprefix('supports.')}, the only support"]
    if (
        plan is AXIS
        and series_by_name
        and all(np.isnan(item.values).all() for members in series_by_name.values() for item in members)
    ):
        return {"heading": heading, "groups": [], "told": [plan.missing[1]], "missing": plan.missing[0]}
    groups, zero_labels = [], []
    for name, members in series_by_name.items():
        label = name.replace("supports.", "support ", 1).replace("elements.", "element ", 1)
        series_in_order = sorted(members, key=lambda item: plan.quantities.index(item.quantity))
        rows = list(iter_page_rows(series_in_order, labels, certain))
        shown = [row for row, seen in rows if seen or plan is AXIS]
        zero_labels += [f"{label} {row['label']}".strip() for row, seen in rows if not seen and plan is not AXIS]
        if shown:
            title = "" if plan.only else label or ("total" if plan.is_foundation else "")
            groups.append({"name": title, "note": plan.note(label, labels), "rows": shown})
    notes += [f"{ZERO_ROWS_PREFIX}{', '.join(zero_labels)}"] if zero_labels else []
    return {"heading": heading, "groups": groups, "told": notes, "missing": plan.missing[0]}


def _is_in_plan(plan: TablePlan, name: str) -> bool:
    """Return whether an object of the plan's kind belongs to its table."""
    if plan.only is not None:
        return name == plan.only
    return not plan.is_foundation or name not in ("axis", "mass_effect")


def iter_page_rows(
    series: Sequence[Series], labels: Labels, certain: StatedErrors
) -> Iterator[tuple[dict[str, Any], bool]]:
    """Yield the rows of one object, each with whether it is ever different from zero."""
    rows_by_series = [make_rows(item) for item in convert_units(series, labels.units)]
    all_rows = [row for rows in rows_by_series for row in rows]
    styles = iter(choose_styles(all_rows, np.zeros((0, len(all_rows))), certain))
    for item, rows in zip(series, rows_by_series, strict=True):
        style, *_ = [next(styles) for _ in rows]
        yield _make_row(item, labels, style), any(not is_zero(row, style) for row in rows)


def _make_row(item: Series, labels: Labels, style: Style) -> dict[str, Any]:
    unit, size = labels.units.find(item.unit)
    parts = [[name, pack_values(column)] for name, column in zip(item.components, item.values.T, strict=True)]
    label = item.quantity.replace("_", " ")
    has_magnitude = len(parts) > 1 and item.quantity not in POSITIONS
    return {
        "path": item.path, "label": label, "unit": unit, "size": size, "style": to_style_list(style), "parts": parts,
        "sized": has_magnitude,
    }  # fmt: skip


def to_style_list(style: Style) -> list[Any]:
    """Return a style in the form that the page reads: decimals, use of an exponent, rounding threshold, any digit
    known.
    """
    return [style.decimals, style.has_exponent, style.rounding, style.is_known]


def is_zero(row: NumberRow, style: Style) -> bool:
    """Return whether a row shows 0 at all instants."""
    values = row.values
    return not np.isnan(values).any() and style.write(float(np.abs(values).max(initial=0.0))) == "0"


def make_section_loads(
    name: str, section: Mapping[str, Any], labels: Labels, certain: StatedErrors
) -> list[dict[str, Any]]:
    """Make the rows of a section's forces and stresses, each (n_t, n_cuts), without those that show 0 everywhere.

    Rows of one family (forces; moments) have the same decimals.
    """
    rows = [
        NumberRow(
            quantity, *_find_display_unit(quantity, labels)[:1], FAMILIES.get(quantity, quantity), "sections", values
        )
        for quantity, values in _iter_values(section)
    ]
    scaled = [row._replace(values=row.values.ravel() * _find_display_unit(row.label, labels)[1]) for row in rows]
    styles = choose_styles(scaled, np.zeros((0, len(rows))), certain)
    loads = []
    for row, scaled_row, style in zip(rows, scaled, styles, strict=True):
        if is_zero(scaled_row, style):
            continue
        prefix = "stress." if row.label in STRESSES else ""
        unit, size = _find_display_unit(row.label, labels)
        loads.append({
            "path": f"sections.{name}.{prefix}{row.label}", "label": row.label.replace("_", " "), "unit": unit,
            "size": size, "style": to_style_list(style), "values": pack_values(row.values),
        })  # fmt: skip
    return loads


def _find_display_unit(quantity: str, labels: Labels) -> tuple[str, float]:
    """Find the display unit of a section force or stress, and its factor from SI."""
    if quantity in STRESSES:
        return labels.units.find("1" if quantity == "utilisation" else "Pa")
    return labels.units.find(RESULTANT_UNITS[quantity])


def _iter_values(section: Mapping[str, Any]) -> Iterator[tuple[str, Array]]:
    for quantity in RESULTANTS:
        if quantity in section:
            yield quantity, np.asarray(section[quantity])
    for quantity in STRESSES:
        if quantity in section.get("stress", {}):
            yield quantity, np.asarray(section["stress"][quantity])
