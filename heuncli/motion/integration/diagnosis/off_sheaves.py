"""Whether ropes stay on their sheaves: none that lifts off one, and none that leaves its plane too far.

Looked at where loads are told and compared, at the ends of all steps among these; a rope that is slack is on none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask

BY_HAND = "a sheave on a bearing that turns with the rope, or a plain point in its place"


def require_on_sheaves(layout: Layout, recovered: Recovered) -> None:
    """Raise SolveError at the first instant at which a rope has left a sheave, or its plane."""
    found: list[tuple[float, Problem]] = []
    for coupling, part, k, taut in rope_parts(layout, recovered):
        if part.kind == "arc":
            angle = recovered.parts["gap"][:, k] / abs(part.radius)
            off = np.flatnonzero(taut & (angle < -tolerances.OFF_SHEAVE))
            message, hint = "lifts off a sheave", "the run up to there; a rope that lies on it at times is not told"
        elif part.kind == "strand":
            off = np.flatnonzero(taut & (np.abs(slant(layout, recovered, part, k)) > tolerances.FLEET_ANGLE))
            message, hint = f"leaves a sheave's plane by more than {FLEET}", BY_HAND
            askew = np.flatnonzero(taut & skewed(layout, recovered, part))
            if len(askew) and not (len(off) and off[0] <= askew[0]):
                off, message = askew, "runs between two sheaves whose axes do not stay parallel"
        else:
            continue
        if len(off):
            t = float(recovered.times[off[0]])
            path = f"couplings.{coupling.name}"
            found.append((t, Problem("rope-off-sheave", f"at t = {t:.9g} s {path} {message}", None, hint, path)))
    if found:
        raise SolveError(min(found, key=lambda one: one[0])[1])


FLEET = f"{math.degrees(tolerances.FLEET_ANGLE):.0f} deg"


def slanting(layout: Layout, recovered: Recovered) -> list[str]:
    """A sentence on each rope that leaves a sheave's plane so far that its forces are seen to be off."""
    most: dict[str, float] = {}
    for coupling, part, k, taut in rope_parts(layout, recovered):
        if part.kind == "strand":
            angles = np.where(taut, np.abs(slant(layout, recovered, part, k)), 0.0)
            most[coupling.name] = max(most.get(coupling.name, 0.0), float(angles.max(initial=0.0)))
    return [
        f"couplings.{name} leaves a sheave's plane by up to {math.degrees(angle):.2g} deg: its forces are right to "
        f"{1.0 - math.cos(angle):.1g} of them"
        for name, angle in most.items()
        if angle > tolerances.FLEET_SEEN
    ]


def rope_parts(layout: Layout, recovered: Recovered) -> Iterator[tuple[Coupling, CouplingPart, int, Mask]]:
    """The parts of ropes: the coupling, the part, its place among the kernel's, and at which instants it is taut."""
    mechanism = layout.mechanism
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if coupling.given.type != "rope":
            continue
        if coupling.stretched is not None:
            load = mechanism.row_of_rope(coupling.name)
            taut = recovered.loads["value"][:, load] < 0.0
            for k, part in enumerate(coupling.stretched.parts, int(layout.tables["loads"][load]["part"])):
                yield coupling, part, k, taut
        rows = [r for r, k in enumerate(layout.rows) if k == owner]
        for r, row in zip(rows, coupling.rows, strict=True):
            first = int(layout.tables["closures"][r]["part"])
            taut = recovered.rows["closed"][:, r] != 0.0
            for k, part in enumerate(row.parts, first):
                yield coupling, part, k, taut


def skewed(layout: Layout, recovered: Recovered, part: CouplingPart) -> Mask:
    """Whether the axes of a strand's two sheaves have left each other, (n_t,)."""
    if not part.g[1]:
        return np.zeros(len(recovered.times), dtype=bool)
    a, b = (axis_of(layout, recovered, body, axis) for body, axis in ((part.a, part.e), (part.b, part.other_axis)))
    return np.asarray(np.sum((a - b) ** 2, axis=1) > tolerances.ASKEW**2)


def axis_of(layout: Layout, recovered: Recovered, body: int, axis: object) -> Array:
    """A direction fixed in a body, or the ground, world axes, (n_t, 3)."""
    e = np.asarray(axis)
    return np.tile(e, (len(recovered.times), 1)) if body < 0 else recovered.bodies["R"][:, layout.place[body]] @ e


def slant(layout: Layout, recovered: Recovered, part: CouplingPart, k: int) -> Array:
    """The angle between a strand and the plane of the sheave that it is seen from [rad], (n_t,)."""
    n = axis_of(layout, recovered, part.a, part.e)
    way = recovered.parts["on_b"][:, k] - recovered.parts["on_a"][:, k]
    long = np.sqrt(np.sum(way * way, axis=1))
    return np.asarray(np.arcsin(np.clip(np.sum(way * n, axis=1) / np.where(long > 0.0, long, 1.0), -1.0, 1.0)))
