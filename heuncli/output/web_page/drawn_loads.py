"""What a page draws of loads over the frames: those that act on the bodies (springs, gas, bushings, torques, forces
from outside) as vectors, and the section forces at the cuts of bars.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.output.tables.table_blocks import choose_styles
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.number_rows import choose_family_style, choose_shown_style, is_zero
from heuncli.output.web_page.packing import pack_points, pack_values
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Section, Spec
from heuncli.study.quantities.captions import describe_object, describe_path
from heuncli.study.quantities.channels import make_section_channels
from heuncli.study.quantities.digits import StatedErrors, largest_magnitude
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study

MIN_LOAD = 1e-4  # of the largest of its kind: a smaller one has no arrow
UNITS = {"force": "N", "moment": "N·m"}
ORIGIN = (0.0, 0.0, 0.0)


def make_acting_loads(study: Study, times: Array, labels: Labels, certain: StatedErrors) -> list[dict[str, Any]]:
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
            style = choose_family_style("forces", UNITS[what], size, labels, certain)
            entries.append({
                "name": name, "caption": describe_object("forces", name, labels), "what": what, **style,
                "at": pack_points(points), "forces": pack_values(vectors, 3),
            })  # fmt: skip
    return entries


def _find_size(vectors: Array) -> float:
    """Find the largest magnitude among vectors (n, 3)."""
    return float(np.sqrt((np.asarray(vectors) ** 2).sum(axis=1)).max(initial=0.0))


def make_sections(spec: Spec, results: Results, labels: Labels, certain: StatedErrors) -> list[dict[str, Any]]:
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
            "second": np.cross(normal, first_axis).tolist(), "loads": make_section_loads(name, block, labels, certain),
        })  # fmt: skip
    return sections


def _compute_cut_points(section: Section, block: dict[str, Any], normal: Array) -> Array:
    """Compute the points of the cuts, (n_cuts, 3), body axes."""
    if "s" not in block:
        return np.array([section.at or ORIGIN], dtype=np.float64)
    start = np.array(section.from_ or ORIGIN, dtype=np.float64)
    return np.asarray(start + np.asarray(block["s"])[:, None] * normal)


def make_section_loads(
    name: str, section: Mapping[str, Any], labels: Labels, certain: StatedErrors
) -> list[dict[str, Any]]:
    """Make the rows of a section's forces and stresses, each (n_t, n_cuts), without those that show 0 everywhere.

    Rows of one family (forces; moments) have the same decimals.
    """
    channels = make_section_channels(name, section)
    styles = choose_styles(channels, np.zeros((0, len(channels))), certain)
    scales: dict[str, float] = {}
    for channel in channels:
        scales[channel.unit] = max(scales.get(channel.unit, 0.0), largest_magnitude(channel.values))
    loads = []
    for channel, style in zip(channels, styles, strict=True):
        if not is_zero(channel, style, certain):
            loads.append({
                "path": channel.path, "label": channel.label, "caption": describe_path(channel.path, labels),
                **choose_shown_style(channel, scales[channel.unit], style, labels, certain),
                "values": pack_values(channel.values, channel.values[0].size),
            })  # fmt: skip
    return loads
