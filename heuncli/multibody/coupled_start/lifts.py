"""Check that the discs of cams are on their lift at the start, for lifts that cover only part of a turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.tree.layout import Layout


def require_lifts(layout: Layout, t: float) -> None:
    """Raise SolveError [path-ends] for every cam whose disc is off its lift."""
    problems = list(iter_lift_problems(layout, t))
    if problems:
        raise SolveError(*problems)


def iter_lift_problems(layout: Layout, t: float) -> Iterator[Problem]:
    """Yield the problems of such cams; a driven disc is where its drive puts it."""
    for coupling in layout.mechanism.couplings:
        part = coupling.rows[0].parts[0] if coupling.rows else None
        if part is None or part.cam is None or part.cam.lift.period:
            continue
        k, lift = part.coordinates[0].joint, part.cam.lift
        joint = layout.mechanism.joints[k]
        angle = layout.starts[k].angle if joint.drive is None else joint.drive.value.value(t)
        if lift.first <= angle <= lift.last:
            continue
        first, last = math.degrees(lift.first), math.degrees(lift.last)
        message = f"the disc of cam {coupling.name} is at {joint.name}.angle = {math.degrees(angle):.6g} deg, outside "
        message += f"its lift, which covers {first:.6g} to {last:.6g} deg"
        hint = "start it within the lift (initial, or the drive), or give the lift a period"
        yield Problem("path-ends", message, hint=hint, entry_path=f"couplings.{coupling.name}")
