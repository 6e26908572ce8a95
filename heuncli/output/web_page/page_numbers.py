"""The numbers of a page: rows of the tables of a run, acting loads as vectors, section forces at the cuts of bars.

A row is one quantity over the frames: a number, or a vector with its components, with its path, all digits, and the
style to show them in. It is shown as a reader needs it, with four significant digits of the largest number of its
object (study/quantities/digits.py), and fewer where the stated error of the run does not justify them. Values
are in SI; each row also has its display unit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.output.tables.indeterminate import make_sums_table
from heuncli.output.tables.table_blocks import choose_styles
from heuncli.output.tables.table_plans import AXIS, BEARING, IMPULSES, PLANS, SECTIONS, TablePlan
from heuncli.output.web_page.packing import pack_points, pack_values
from heuncli.results.results import Array, Block, Results
from heuncli.scene.file_format.models import Section, Spec
from heuncli.study.quantities.captions import describe_object, describe_path
from heuncli.study.quantities.channels import (
    POSITIONS,
    Channel,
    iter_channels,
    iter_impulse_channels,
    make_section_channels,
)
from heuncli.study.quantities.digits import READER_DIGITS, StatedErrors, Style, choose_reader_style, largest_magnitude
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study

ZERO_ROWS_PREFIX = "All values 0: "
EXCLUDED_KINDS = frozenset({"bodies", "points", "sections"})  # sections have rows of their own
HEADING = re.compile(r"[A-Z][A-Z ]*[A-Z](?![a-z])")  # the words that head a table; its signs and axes follow
LARGE, SMALL = 1e7, 1e-3  # families beyond these are written with an exponent
RPM = 30.0 / math.pi  # of a rad/s
MIN_LOAD = 1e-4  # of the largest of its kind: a smaller one has no arrow
UNITS = {"force": "N", "moment": "N·m"}
ORIGIN = (0.0, 0.0, 0.0)


def make_blocks(results: Results, labels: Labels, stated_errors: StatedErrors) -> list[dict[str, Any]]:
    """Make the tables of all quantities that run over the instants; each heading states signs and axes."""
    channels = [item for item in iter_channels(results, labels) if not item.cause]
    plans = [plan for plan in PLANS if plan.kind not in EXCLUDED_KINDS and (plan.only is None or plan is AXIS)]
    found = [_make_block(plan, channels, plan.heading(results, labels), labels, stated_errors) for plan in plans]
    sums = make_sums_table(results, stated_errors)
    if sums is not None:
        found.append({**split_heading(sums.heading), "kind": "joints", "groups": [], "notes": list(sums.notes)})
    return [block for block in found if block["groups"] or block["notes"]]


def make_impact_page_tables(
    number: int, impact: Block, results: Results, labels: Labels, stated_errors: StatedErrors
) -> list[dict[str, Any]]:
    """Make the tables of one impact; their numbers hold only at its instant."""
    channels = [item for item in iter_impulse_channels(impact, labels) if not item.cause]
    tables = []
    for plan in IMPULSES:
        if plan.kind in ("foundation", "joints", "sensors", "stops", "sections") and plan.only is None:
            plan_channels = [item for item in channels if item.quantity in plan.quantities and not item.has_cuts]
            block = _make_block(plan, plan_channels, plan.heading(results, labels), labels, stated_errors)
            block["heading"] += f" at {float(impact['time']):.6g} s, {', '.join(impact['names']) or 'impulse'}"
            tables += [_prefix_paths(block, number)] if block["groups"] else []
    return tables


def _prefix_paths(block: dict[str, Any], number: int) -> dict[str, Any]:
    """Change the paths of a block's rows to those of an impact."""
    for group in block["groups"]:
        for row in group["rows"]:
            row["path"] = f"impulses.{number}.{row['path']}"
    return block


def _make_block(
    plan: TablePlan, channels: Iterable[Channel], heading: str, labels: Labels, stated_errors: StatedErrors
) -> dict[str, Any]:
    """Make one table: heading, groups of rows by object, a note on the rows that are zero throughout, word for nan."""
    head = {**split_heading(heading), "kind": plan.kind, "missing": plan.missing[0]}
    channels_by_name: dict[str, list[Channel]] = {}
    for item in channels:
        if item.kind == plan.kind and item.quantity in plan.quantities and _is_in_plan(plan, item.name):
            channels_by_name.setdefault(item.name, []).append(item)
    notes: list[str] = []
    supports = [name for name in channels_by_name if name.startswith("supports.")]
    if plan.is_foundation and len(channels_by_name) == 2 and supports:
        channels_by_name = {"": channels_by_name[""]}
        notes = [f"carried entirely by {supports[0].removeprefix('supports.')}, the only support"]
    all_channels = [channel for members in channels_by_name.values() for channel in members]
    if plan is AXIS and all_channels and all(np.isnan(channel.values).all() for channel in all_channels):
        return {**head, "groups": [], "notes": [plan.missing[1]]}
    groups, zero_labels = [], []
    for name, members in channels_by_name.items():
        label = name.replace("supports.", "support ", 1).replace("elements.", "element ", 1)
        channels_in_order = sorted(members, key=lambda item: plan.quantities.index(item.quantity))
        rows = list(iter_page_rows(channels_in_order, labels, stated_errors))
        shown = [row for row, is_nonzero in rows if is_nonzero or plan is AXIS]
        hidden = [row for row, is_nonzero in rows if not is_nonzero and plan is not AXIS]
        zero_labels += [f"{label} {row['label']}".strip() for row in hidden]
        if shown:
            title = "" if plan.only else label or ("total" if plan.is_foundation else "")
            groups.append({"name": title, "note": plan.note(label, labels), "rows": shown})
    notes += [f"{ZERO_ROWS_PREFIX}{', '.join(zero_labels)}"] if zero_labels else []
    return {**head, "groups": groups, "notes": notes}


def split_heading(heading: str) -> dict[str, str]:
    """Split the heading of a table into its words and what it says of signs and axes."""
    words = HEADING.match(heading)
    if words is None:
        return {"heading": heading, "note": ""}
    return {"heading": words[0].capitalize(), "note": heading[words.end() :].strip()}


def _is_in_plan(plan: TablePlan, name: str) -> bool:
    """Return whether an object of the plan's kind belongs to its table."""
    if plan.only is not None:
        return name == plan.only
    if plan.kind == "joints":
        return (BEARING in name) == bool(plan.part)
    return not plan.is_foundation or name not in ("axis", "mass_effect")


def iter_page_rows(
    channels: Sequence[Channel], labels: Labels, stated_errors: StatedErrors
) -> Iterator[tuple[dict[str, Any], bool]]:
    """Yield the rows of one object, each with whether it is ever different from zero."""
    numbers_of = [channel.numbers for channel in channels]
    all_numbers = [number for numbers in numbers_of for number in numbers]
    styles = iter(choose_styles(all_numbers, np.zeros((0, len(all_numbers))), stated_errors))
    scales: dict[str, float] = {}
    for channel in channels:
        scales[channel.unit] = max(scales.get(channel.unit, 0.0), largest_magnitude(channel.values))
    is_turning = any(
        channel.quantity == "angle" and float(np.ptp(channel.values)) >= 2.0 * math.pi for channel in channels
    )
    for channel, numbers in zip(channels, numbers_of, strict=True):
        style, *_ = [next(styles) for _ in numbers]
        shown = choose_shown_style(channel, scales[channel.unit], style, labels, stated_errors)
        if is_turning and channel.unit == "rad/s" and not labels.units.is_chosen("rad/s"):
            shown = choose_rotational_speed(scales[channel.unit], stated_errors.find_error(channel))
        yield _make_row(channel, labels, shown), any(not is_zero(number, style, stated_errors) for number in numbers)


def _make_row(item: Channel, labels: Labels, style: dict[str, Any]) -> dict[str, Any]:
    largest = largest_magnitude(item.values)
    parts = [
        [
            name,
            pack_values(column, largest=largest),
            describe_path(f"{item.path}.{name}" if name else item.path, labels),
        ]
        for name, column in zip(item.components, item.values.T, strict=True)
    ]
    label = item.quantity.replace("_", " ")
    has_magnitude = len(parts) > 1 and item.quantity not in POSITIONS
    return {
        "path": item.path, "label": label, "caption": describe_path(item.path, labels), **style, "parts": parts,
        "sized": has_magnitude,
    }  # fmt: skip


def choose_shown_style(
    channel: Channel, scale: float, style: Style, labels: Labels, stated_errors: StatedErrors
) -> dict[str, Any]:
    """Choose unit, size and style of a family of numbers whose largest magnitude is `scale`, SI.

    style: the one of the tables, which says what is rounding, and whether any digit is known
    """
    reader = choose_reader_style(channel.unit, scale, labels.units, stated_errors.find_error(channel))
    rounding = style.rounding * reader.per_si / labels.units.find(channel.unit)[1]
    return _to_shown(reader.unit, reader.per_si, scale, reader.error, (rounding, style.is_known))


def choose_family_style(
    kind: str, unit: str, scale: float, labels: Labels, stated_errors: StatedErrors
) -> dict[str, Any]:
    """Choose unit, size and style of numbers of a kind and unit whose largest magnitude is `scale`, SI."""
    reader = choose_reader_style(unit, scale, labels.units, stated_errors.error_of(kind, unit))
    rounding = reader.per_si * stated_errors.rounding_of(unit)
    return _to_shown(reader.unit, reader.per_si, scale, reader.error, (rounding, reader.error < reader.per_si * scale))


def choose_rotational_speed(scale: float, error: float) -> dict[str, Any]:
    """Choose the style of the speed of a shaft that turns round and round: rpm."""
    return _to_shown("rpm", RPM, scale, RPM * error, (0.0, error < scale))


def _to_shown(unit: str, size: float, scale: float, error: float, certainty: tuple[float, bool]) -> dict[str, Any]:
    """Return unit, size and style in the form that the page reads: decimals, use of an exponent, rounding threshold,
    any digit known.

    error: in the display unit; certainty: rounding in the display unit, and whether any digit is known
    """
    shown = size * scale
    decimals = READER_DIGITS - 1 - math.floor(math.log10(shown)) if shown > 0.0 else 0
    if 0.0 < error < math.inf:
        decimals = min(decimals, math.floor(-math.log10(error)))
    has_exponent = shown > 0.0 and not SMALL <= shown < LARGE
    return {
        "unit": unit, "size": size, "style": [decimals if has_exponent else max(decimals, 0), has_exponent, *certainty],
    }  # fmt: skip


def is_zero(channel: Channel, style: Style, stated_errors: StatedErrors) -> bool:
    """Return whether a channel shows 0 at all instants."""
    largest = stated_errors.units.find(channel.unit)[1] * float(np.abs(channel.values).max(initial=0.0))
    return not np.isnan(channel.values).any() and style.write(largest) == "0"


def make_acting_loads(study: Study, times: Array, labels: Labels, stated_errors: StatedErrors) -> list[dict[str, Any]]:
    """Make an entry for each force and moment ON the `to` body: name, point of action and vector at all frames.

    times: of the frames (n,)
    """
    is_own = study.has_one_instant or np.array_equal(times, study.results.time)
    recovery = study.recovery if is_own else study.find_recovery(times, frozenset({"joints"}))
    applied = [(load.load.name, load.action) for load in recovery.loads]
    found = [
        (name, what, action.to_end.position, vectors)
        for name, action in applied
        for what, vectors in (("force", action.force), ("moment", action.moment))
    ]
    largest = {what: max((_find_size(row[3]) for row in found if row[1] == what), default=0.0) for what in UNITS}
    entries = []
    for name, what, points, vectors in found:
        size = _find_size(vectors)
        rounding = tolerances.NOTHING_ACTS * study.load_magnitudes.by_unit.get(UNITS[what], 0.0)
        if size > max(rounding, MIN_LOAD * largest[what]):
            style = choose_family_style("forces", UNITS[what], size, labels, stated_errors)
            entries.append({
                "name": name, "caption": describe_object("forces", name, labels), "what": what, **style,
                "at": pack_points(points), "forces": pack_values(vectors, 3),
            })  # fmt: skip
    return entries


def _find_size(vectors: Array) -> float:
    """Find the largest magnitude among vectors (n, 3)."""
    return float(np.sqrt((np.asarray(vectors) ** 2).sum(axis=1)).max(initial=0.0))


def make_sections(spec: Spec, results: Results, labels: Labels, stated_errors: StatedErrors) -> list[dict[str, Any]]:
    """Make the page's entry for every section: points of the cuts and axes n, e1, e2 in body axes, and the section
    forces.
    """
    body_numbers = {name: k for k, name in enumerate(spec.bodies)}
    sections = []
    for name, block in results.sections.items():
        section = spec.sections[name]
        to_body = results.bodies[section.body]["rotation"][0].T
        normal, first_axis = to_body @ block["normal"][0], to_body @ block["first_axis"][0]
        sections.append({
            "name": name, "body": body_numbers[section.body], "note": SECTIONS.note(name, labels),
            "cuts": _compute_cut_points(section, block, normal).tolist(),
            "s": [float(s) for s in block["s"]] if "s" in block else None,
            "side": list(block.get("side", [])), "normal": normal.tolist(), "first": first_axis.tolist(),
            "second": np.cross(normal, first_axis).tolist(),
            "loads": make_section_loads(name, block, labels, stated_errors),
        })  # fmt: skip
    return sections


def _compute_cut_points(section: Section, block: dict[str, Any], normal: Array) -> Array:
    """Compute the points of the cuts, (n_cuts, 3), body axes."""
    if "s" not in block:
        return np.array([section.at or ORIGIN], dtype=np.float64)
    start = np.array(section.from_ or ORIGIN, dtype=np.float64)
    return np.asarray(start + np.asarray(block["s"])[:, None] * normal)


def make_section_loads(
    name: str, section: Mapping[str, Any], labels: Labels, stated_errors: StatedErrors
) -> list[dict[str, Any]]:
    """Make the rows of a section's forces and stresses, each (n_t, n_cuts), without those that show 0 everywhere.

    Rows of one family (forces; moments) have the same decimals.
    """
    channels = make_section_channels(name, section)
    styles = choose_styles(channels, np.zeros((0, len(channels))), stated_errors)
    scales: dict[str, float] = {}
    for channel in channels:
        scales[channel.unit] = max(scales.get(channel.unit, 0.0), largest_magnitude(channel.values))
    loads = []
    for channel, style in zip(channels, styles, strict=True):
        if not is_zero(channel, style, stated_errors):
            loads.append({
                "path": channel.path, "label": channel.label, "caption": describe_path(channel.path, labels),
                **choose_shown_style(channel, scales[channel.unit], style, labels, stated_errors),
                "values": pack_values(channel.values, channel.values[0].size),
            })  # fmt: skip
    return loads
