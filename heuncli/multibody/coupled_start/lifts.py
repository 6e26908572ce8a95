"""Whether the discs of cams stand at the start where they have a lift, which of some covers a part of a turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.tree.layout import Layout


def require_lifts(layout: Layout, t: float) -> None:
    """Raise SolveError (path-ends) for every cam whose disc stands off its lift."""
    problems = list(off_lifts(layout, t))
    if problems:
        raise SolveError(*problems)


def off_lifts(layout: Layout, t: float) -> Iterator[Problem]:
    """The problems of such cams; a disc that is driven stands where its drive says."""
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
        message = f"the disc of cam {coupling.name} stands at {joint.name}.angle = {math.degrees(angle):.6g} deg, off "
        message += f"its lift, which covers {first:.6g} to {last:.6g} deg"
        hint = "turn it onto its lift (initial, or the drive), or give the lift a period"
        yield Problem("path-ends", message, hint=hint, about=f"couplings.{coupling.name}")
