"""The sections of a page: the points of their cuts, their axes and the section forces there."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.number_rows import make_section_loads
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Section, Spec
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels

ORIGIN = (0.0, 0.0, 0.0)


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
