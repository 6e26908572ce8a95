"""The hint below the table of joints where parallel pins in space leave reactions open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.output.documents.document import OutputTable
from heuncli.study.quantities.digits import OPEN_NOTE
from heuncli.study.queries.study import Study

PINS_NOTE = (
    "pins in a spatial model constrain more than the motion requires: try `space: planar`, or `line` or `ball` in "
    "place of some pins; heun model lists what helps, heun explain open says why"
)
HEADING = "JOINTS"  # as tables of joints begin
PARALLEL = 1e-6  # largest sine between the axes


def add_pins_note(tables: Sequence[OutputTable], study: Study) -> list[OutputTable]:
    """Add the hint to the tables of joints with open reactions, if parallel pins are the reason."""
    places = [n for n, each in enumerate(tables) if each.heading.startswith(HEADING) and OPEN_NOTE in each.notes]
    if not places or not has_open_parallel_pins(study):
        return list(tables)
    last = places[-1]
    return [
        table._replace(notes=(*table.notes, PINS_NOTE)) if number == last else table
        for number, table in enumerate(tables)
    ]


def has_open_parallel_pins(study: Study) -> bool:
    """Whether several pins of a spatial model have open reactions, and the axes of all these are parallel."""
    names = {name for name, block in study.results.joints.items() if block["open"]}
    if len(names) < 2 or study.results.model.get("space") != "spatial":
        return False
    recovery = study.find_recovery(study.results.time[:1], frozenset({"joints"}))
    axes = [
        load.axis[0]
        for load in recovery.requested_joints
        if load.joint.name in names and load.joint.kind == "pin" and load.axis is not None
    ]
    if len(axes) < 2:
        return False
    sines = np.linalg.norm(np.cross(axes[0], np.array(axes[1:])), axis=1)
    return bool((sines < PARALLEL).all())
