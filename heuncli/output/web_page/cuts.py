"""The sections of a page: where they cut their bodies, and what is carried there."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.number_rows import loads_of
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Section, Spec
from heuncli.study.quantities.digits import Certainty
from heuncli.study.quantities.labels import Labels

NOTHING = (0.0, 0.0, 0.0)


def sections_of(spec: Spec, results: Results, labels: Labels, certain: Certainty) -> list[dict[str, Any]]:
    """The sections with the places of their cuts and the axes n, e1, e2, all in body axes, and their loads."""
    numbers = {name: k for k, name in enumerate(spec.bodies)}
    found = []
    for name, block in results.sections.items():
        section = spec.sections[name]
        to_body = results.bodies[section.body]["rotation"][0].T
        normal, first = to_body @ block["normal"][0], to_body @ block["first_axis"][0]
        found.append({
            "name": name, "body": numbers[section.body], "note": SECTIONS.note(name, labels),
            "cuts": _places(section, block, normal).tolist(),
            "s": [float(s) for s in block["s"]] if "s" in block else None,
            "side": list(block.get("side", [])), "normal": normal.tolist(), "first": first.tolist(),
            "second": np.cross(normal, first).tolist(), "loads": loads_of(name, block, labels, certain),
        })  # fmt: skip
    return found


def _places(section: Section, block: dict[str, Any], normal: Array) -> Array:
    """Where the cuts stand, (n_cuts, 3), body axes."""
    if "s" not in block:
        return np.array([section.at or NOTHING], dtype=np.float64)
    begin = np.array(section.from_ or NOTHING, dtype=np.float64)
    return np.asarray(begin + np.asarray(block["s"])[:, None] * normal)
