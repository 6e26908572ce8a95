"""The numbers of a page: what tables show of a run, each with its path, all its digits, and how many it shows of them.

A row is one quantity over the frames: a number, or a vector with its components. Its style is that of the tables: no
more digits than the run can stand behind (study/quantities/digits.py). Values stay in SI beside the unit in which they
are shown.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.output.tables.certain_sums import sums_table
from heuncli.output.tables.table_blocks import FAMILIES, POSITIONS, NumberRow, family_styles, rows_of
from heuncli.output.tables.table_plans import AXIS, IMPULSES, PLANS, TablePlan
from heuncli.output.web_page.packing import packed
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS, STRESSES
from heuncli.study.quantities.digits import OPEN, Certainty, Style
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, in_units, walk, walk_impulse

ZEROS = "0 throughout: "
LEFT_OUT = frozenset({"bodies", "points", "sections"})  # sections have rows of their own


def blocks_of(results: Results, labels: Labels, certain: Certainty) -> list[dict[str, Any]]:
    """The tables of what runs over the instants, each with its heading, which tells signs and axes."""
    series = [item for item in walk(results, labels) if not item.cause]
    plans = [plan for plan in PLANS if plan.kind not in LEFT_OUT and (plan.only is None or plan is AXIS)]
    found = [_block(plan, series, plan.heading(results, labels), labels, certain) for plan in plans]
    sums = sums_table(results, certain, unit=labels.units.of("N"))
    if sums is not None:
        found.append({"heading": sums.heading, "groups": [], "told": list(sums.notes), "missing": OPEN})
    return [block for block in found if block["groups"] or block["told"]]


def blow_tables(number: int, blow: Block, results: Results, labels: Labels, certain: Certainty) -> list[dict[str, Any]]:
    """The tables of one blow: numbers that hold at its instant alone."""
    series = [item for item in walk_impulse(blow, labels) if not item.cause]
    begin = f"AT {float(blow['time']):.6g} s, {', '.join(blow['names']) or 'blow'}: "
    found = []
    for plan in IMPULSES:
        if plan.kind in ("foundation", "joints", "stops", "sections") and plan.only is None:
            own = [item for item in series if item.quantity in plan.quantities and not item.of_cuts]
            block = _block(plan, own, begin + plan.heading(results, labels), labels, certain)
            found += [_at_a_blow(block, number)] if block["groups"] else []
    return found


def _at_a_blow(block: dict[str, Any], number: int) -> dict[str, Any]:
    """The block with the paths of a blow."""
    for group in block["groups"]:
        for row in group["rows"]:
            row["path"] = f"impulses.{number}.{row['path']}"
    return block


def _block(
    plan: TablePlan, series: Iterable[Series], heading: str, labels: Labels, certain: Certainty
) -> dict[str, Any]:
    """One table: heading, groups of rows by the name of what they are of, what is 0 throughout, what stands for nan."""
    named: dict[str, list[Series]] = {}
    for item in series:
        if item.kind == plan.kind and item.quantity in plan.quantities and _of_plan(plan, item.name):
            named.setdefault(item.name, []).append(item)
    told: list[str] = []
    if plan.of_foundation and len(named) == 2 and (only := [name for name in named if name.startswith("supports.")]):
        named = {"": named[""]}
        told = [f"all of it goes through {only[0].removeprefix('supports.')}, the only support"]
    if plan is AXIS and named and all(np.isnan(item.values).all() for own in named.values() for item in own):
        return {"heading": heading, "groups": [], "told": [plan.missing[1]], "missing": plan.missing[0]}
    groups, zero = [], []
    for name, own in named.items():
        label = name.replace("supports.", "support ", 1).replace("elements.", "element ", 1)
        order = sorted(own, key=lambda item: plan.quantities.index(item.quantity))
        rows = list(rows_in(order, labels, certain))
        shown = [row for row, seen in rows if seen or plan is AXIS]
        zero += [f"{label} {row['label']}".strip() for row, seen in rows if not seen and plan is not AXIS]
        if shown:
            spoken = "" if plan.only else label or ("total" if plan.of_foundation else "")
            groups.append({"name": spoken, "note": plan.note(label, labels), "rows": shown})
    told += [f"{ZEROS}{', '.join(zero)}"] if zero else []
    return {"heading": heading, "groups": groups, "told": told, "missing": plan.missing[0]}


def _of_plan(plan: TablePlan, name: str) -> bool:
    """Whether a name of the plan's kind stands in its table."""
    if plan.only is not None:
        return name == plan.only
    return not plan.of_foundation or name not in ("axis", "mass_effect")


def rows_in(series: Sequence[Series], labels: Labels, certain: Certainty) -> Iterator[tuple[dict[str, Any], bool]]:
    """The rows of one thing, and whether there is ever more to be read in each than 0."""
    shown = [rows_of(item) for item in in_units(series, labels.units)]
    flat = [row for rows in shown for row in rows]
    styles = iter(family_styles(flat, np.zeros((0, len(flat))), certain))
    for item, rows in zip(series, shown, strict=True):
        how, *_ = [next(styles) for _ in rows]
        yield _row(item, labels, how), any(not is_zero(row, how) for row in rows)


def _row(item: Series, labels: Labels, how: Style) -> dict[str, Any]:
    unit, size = labels.units.of(item.unit)
    parts = [[name, packed(column)] for name, column in zip(item.components, item.values.T, strict=True)]
    label = item.quantity.replace("_", " ")
    sized = len(parts) > 1 and item.quantity not in POSITIONS
    return {
        "path": item.path, "label": label, "unit": unit, "size": size, "style": style_told(how), "parts": parts,
        "sized": sized,
    }  # fmt: skip


def style_told(how: Style) -> list[Any]:
    """A style as a page reads it: decimals, whether with an exponent, what is 0, whether any digit is known."""
    return [how.decimals, how.exponent, how.rounding, how.known]


def is_zero(row: NumberRow, how: Style) -> bool:
    """Whether a row reads 0 at all instants."""
    values = row.values
    return not np.isnan(values).any() and how.write(float(np.abs(values).max(initial=0.0))) == "0"


def loads_of(name: str, section: Mapping[str, Any], labels: Labels, certain: Certainty) -> list[dict[str, Any]]:
    """Loads and stresses of a section: of each cut at each instant, (n_t, n_cuts), those left out that read 0.

    Those of one family (forces; moments) share their decimals.
    """
    rows = [
        NumberRow(quantity, *_kind(quantity, labels)[:1], FAMILIES.get(quantity, quantity), "sections", values)
        for quantity, values in _values(section)
    ]
    scaled = [row._replace(values=row.values.ravel() * _kind(row.label, labels)[1]) for row in rows]
    styles = family_styles(scaled, np.zeros((0, len(rows))), certain)
    found = []
    for row, shown, how in zip(rows, scaled, styles, strict=True):
        if is_zero(shown, how):
            continue
        below = "stress." if row.label in STRESSES else ""
        unit, size = _kind(row.label, labels)
        found.append({
            "path": f"sections.{name}.{below}{row.label}", "label": row.label.replace("_", " "), "unit": unit,
            "size": size, "style": style_told(how), "values": packed(row.values),
        })  # fmt: skip
    return found


def _kind(quantity: str, labels: Labels) -> tuple[str, float]:
    """The unit in which a load or stress of a section is shown, and how many of it are one in SI."""
    if quantity in STRESSES:
        return labels.units.of("1" if quantity == "utilisation" else "Pa")
    return labels.units.of(RESULTANT_UNITS[quantity])


def _values(section: Mapping[str, Any]) -> Iterator[tuple[str, Array]]:
    for quantity in RESULTANTS:
        if quantity in section:
            yield quantity, np.asarray(section[quantity])
    for quantity in STRESSES:
        if quantity in section.get("stress", {}):
            yield quantity, np.asarray(section["stress"][quantity])
