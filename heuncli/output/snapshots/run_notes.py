"""What a run says besides its numbers: its warnings, and the hint where parallel pins in space leave reactions open."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.documents.document import OutputTable
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery
from heuncli.study.quantities.digits import OPEN_NOTE
from heuncli.study.queries.study import Study


def collect_warnings(spec: Spec, results: Results | None, later: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the warnings of reading, with their places, and those of solving and later ones that are not among
    them.
    """
    reading_messages = {problem.message for problem in spec.warnings}
    solving_warnings = [text for text in results.warnings if text not in reading_messages] if results else []
    return [str(problem) for problem in spec.warnings], solving_warnings + list(later)


PINS_NOTE = (
    "pins in a spatial model constrain more than the motion requires: try `space: planar`, or `line` or `ball` in "
    "place of some pins; heun model lists what helps, heun explain open says why"
)
HEADING = "JOINTS"  # as tables of joints begin


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
    """Whether several pins of a spatial model have open reactions, the axes of all these are parallel, and something
    is open that a planar model does not have: gears leave open what is in the plane, which no other joints change.
    """
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
    return bool((sines < tolerances.PARALLEL).all()) and is_open_across_plane(recovery, axes[0])


def is_open_across_plane(recovery: Recovery, normal: Array) -> bool:
    """Whether a joint's force along a normal (3,), or its moment about an axis in the plane, is open."""
    stress = recovery.indeterminate
    if stress is None:
        return False
    forces, moments = stress.shares[:, :, :3], stress.shares[:, :, 3:]
    along = np.einsum("i,jtik->jtk", normal, forces)[:, :, None]
    tilting = moments - normal[:, None] * np.einsum("i,jtik->jtk", normal, moments)[:, :, None]
    return bool(stress.has_share(along).any() or stress.has_share(tilting, stress.length).any())
