"""Prepare a mechanism to run with its couplings satisfied: multibody/tree/prepare.py, extended by couplings.

Cams that cover only part of a turn must be on their lift at the start, and no wheel may lie flat on its plane.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, prepare
from heuncli.multibody.tree.starts import body_state


def prepare_coupled(mechanism: Mechanism, t0: float = 0.0, stages: Stages = NO_CACHE) -> PreparedScene:
    """Assemble at t0 and lay out. Raises SolveError as `prepare`, and where couplings contradict each other or what is
    held.
    """
    if not mechanism.couplings:
        return prepare(mechanism, t0, stages)
    from heuncli.multibody.coupled_start.start import find_start_rows, fit_start  # few scenes have couplings

    def with_couplings(scene: PreparedScene) -> PreparedScene:
        require_upright(mechanism, scene.start)
        if any(coupling.entry.type == "cam" for coupling in mechanism.couplings):
            from heuncli.multibody.tree.cam_flanks import require_flanks  # few scenes have them

            require_flanks(scene.layout)
            require_lifts(scene.layout, t0)
        return fit_start(scene, t0, find_start_rows(scene))

    return prepare(mechanism, t0, stages, with_couplings)


def require_lifts(layout: Layout, t: float) -> None:
    """Raise SolveError [path-ends] for every cam whose disc is off its lift."""
    problems = list(iter_lift_problems(layout, t))
    if problems:
        raise SolveError(*problems)


def iter_lift_problems(layout: Layout, t: float) -> Iterator[Problem]:
    """Yield a problem for every cam whose disc is off its lift; a driven disc is where its drive puts it."""
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


def require_upright(mechanism: Mechanism, start: Assembly) -> None:
    """Raise SolveError [does-not-fit] for discs whose axles are normal to their planes at the start."""
    for coupling in mechanism.couplings:
        part = coupling.rows[0].parts[0] if coupling.rows else None  # of a rope they are found later
        if part is None or part.kind != "touches":
            continue
        n, k = body_state(start, part.a)[1] @ part.e, body_state(start, part.b)[1] @ part.g
        across = np.cross(n, k)
        if float(across @ across) <= 1.0 - tolerances.ALONG_SQUARED:
            message = f"the wheel {coupling.name} lies flat on its plane: it touches everywhere and cannot roll"
            hint = "set it upright with its orientation; for a body lying on a plane use three joints of type plane"
            raise SolveError(Problem("does-not-fit", message, hint=hint, entry_path=f"rolling.{coupling.name}"))
