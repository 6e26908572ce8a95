"""Check that ropes stay on their sheaves: that none lifts off one, and none leaves its plane too far.

This is checked where loads are reported and compared, including the ends of all steps; a slack rope is on no sheave.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask

WOUND_UP = "winds up: a strand has no length left between a sheave and the next point"
WOUND_UP_HINT = "end the run before it is wound up, or start further from the sheave"
HINT = "mount the sheave on a bearing that swivels with the rope, or use a plain point instead"


def require_on_sheaves(layout: Layout, evaluation: Evaluation) -> None:
    """Raise SolveError at the first instant at which a rope has left a sheave, or its plane."""
    problems: list[tuple[float, Problem]] = []
    for coupling, part, k, is_taut in iter_rope_parts(layout, evaluation):
        if part.kind == "arc":
            angle = evaluation.parts["gap"][:, k] / abs(part.radius)
            violations = np.flatnonzero(is_taut & (angle < -tolerances.OFF_SHEAVE))
            message, hint = (
                "lifts off a sheave",
                "end the run earlier; a rope that touches a sheave only at times cannot be modelled",
            )
        elif part.kind == "strand":
            violations = np.flatnonzero(
                is_taut & (np.abs(slant_angle(layout, evaluation, part, k)) > tolerances.FLEET_ANGLE)
            )
            message, hint = f"leaves a sheave's plane by more than {FLEET}", HINT
            wound_up = np.flatnonzero(is_taut & (evaluation.parts["gap"][:, k] <= 0.0))
            if len(wound_up) and not (len(violations) and violations[0] <= wound_up[0]):
                violations, message, hint = wound_up, WOUND_UP, WOUND_UP_HINT
            skewed_instants = np.flatnonzero(is_taut & is_skewed(layout, evaluation, part))
            if len(skewed_instants) and not (len(violations) and violations[0] <= skewed_instants[0]):
                violations, message = skewed_instants, "runs between two sheaves whose axes are no longer parallel"
        else:
            continue
        if len(violations):
            t = float(evaluation.times[violations[0]])
            path = f"couplings.{coupling.name}"
            problems.append((t, Problem("rope-off-sheave", f"at t = {t:.9g} s {path} {message}", None, hint, path)))
    if problems:
        raise SolveError(min(problems, key=lambda one: one[0])[1])


FLEET = f"{math.degrees(tolerances.FLEET_ANGLE):.0f} deg"


def format_slant_warnings(layout: Layout, evaluation: Evaluation) -> list[str]:
    """Format a sentence on each rope that leaves a sheave's plane so far that its forces become visibly inexact."""
    largest_angles: dict[str, float] = {}
    for coupling, part, k, is_taut in iter_rope_parts(layout, evaluation):
        if part.kind == "strand":
            angles = np.where(is_taut, np.abs(slant_angle(layout, evaluation, part, k)), 0.0)
            largest_angles[coupling.name] = max(largest_angles.get(coupling.name, 0.0), float(angles.max(initial=0.0)))
    return [
        f"couplings.{name} leaves a sheave's plane by up to {math.degrees(angle):.2g} deg: relative error of "
        f"its forces {1.0 - math.cos(angle):.1g}"
        for name, angle in largest_angles.items()
        if angle > tolerances.FLEET_SEEN
    ]


def iter_rope_parts(layout: Layout, evaluation: Evaluation) -> Iterator[tuple[Coupling, CouplingPart, int, Mask]]:
    """Yield for each part of a rope: the coupling, the part, its number in the kernel, and at which instants it is
    taut.
    """
    mechanism = layout.mechanism
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if coupling.entry.type != "rope":
            continue
        if coupling.stretched_row is not None:
            load = mechanism.rope_load_row(coupling.name)
            is_taut = evaluation.loads["value"][:, load] < 0.0
            for k, part in enumerate(coupling.stretched_row.parts, int(layout.tables["loads"][load]["part"])):
                yield coupling, part, k, is_taut
        rows = [r for r, k in enumerate(layout.rows) if k == owner]
        for r, row in zip(rows, coupling.rows, strict=True):
            first = int(layout.tables["closures"][r]["part"])
            is_taut = evaluation.rows["closed"][:, r] != 0.0
            for k, part in enumerate(row.parts, first):
                yield coupling, part, k, is_taut


def find_wound_up(layout: Layout, evaluation: Evaluation) -> list[Problem]:
    """Return the problems of ropes with a strand that all but ends at its sheave, in the one state where a run failed.

    Towards that the strand turns without bound, so that steps collapse a little before.
    """
    problems: dict[str, Problem] = {}
    for coupling, part, k, _ in iter_rope_parts(layout, evaluation):
        limit = tolerances.WOUND_UP * max(abs(part.g[0]), abs(part.g[1]))
        if part.kind == "strand" and evaluation.parts["gap"][0, k] <= limit:
            path = f"couplings.{coupling.name}"
            message = f"at t = {float(evaluation.times[0]):.9g} s {path} {WOUND_UP}"
            problems[path] = Problem("rope-off-sheave", message, None, WOUND_UP_HINT, path)
    return list(problems.values())


def is_skewed(layout: Layout, evaluation: Evaluation, part: CouplingPart) -> Mask:
    """Return whether the axes of a strand's two sheaves are no longer parallel, (n_t,)."""
    if not part.g[1]:
        return np.zeros(len(evaluation.times), dtype=bool)
    a, b = (
        world_direction(layout, evaluation, body, axis) for body, axis in ((part.a, part.e), (part.b, part.other_axis))
    )
    return np.asarray(np.sum((a - b) ** 2, axis=1) > tolerances.ASKEW**2)


def world_direction(layout: Layout, evaluation: Evaluation, body: int, axis: object) -> Array:
    """Return a direction fixed in a body or the ground in world axes, (n_t, 3)."""
    e = np.asarray(axis)
    return np.tile(e, (len(evaluation.times), 1)) if body < 0 else evaluation.bodies["R"][:, layout.place[body]] @ e


def slant_angle(layout: Layout, evaluation: Evaluation, part: CouplingPart, k: int) -> Array:
    """Return the angle between a strand and the plane of the sheave it is measured from [rad], (n_t,)."""
    n = world_direction(layout, evaluation, part.a, part.e)
    strand = evaluation.parts["on_b"][:, k] - evaluation.parts["on_a"][:, k]
    length = np.sqrt(np.sum(strand * strand, axis=1))
    return np.asarray(np.arcsin(np.clip(np.sum(strand * n, axis=1) / np.where(length > 0.0, length, 1.0), -1.0, 1.0)))
