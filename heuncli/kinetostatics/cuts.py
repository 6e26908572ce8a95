"""Section planes laid out: where each cut of a body runs, on which side of it things lie, and what it separates.

The piece is what lies on the side the normal n points into. A run of cuts has one normal; where something lies in the
plane of a cut inside the run, two cuts are made, just before it and just beyond it; at the ends the one from inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SpecError
from heuncli.joint_kinds import JOINTS
from heuncli.mechanism.model import GROUND, Mechanism
from heuncli.records import record
from heuncli.results import Array
from heuncli.shapes.forms import Form
from heuncli.shapes.inertia import pseudo_inertia

BEFORE, BEYOND = 1.0, -1.0


@record
class Cuts:
    """The cuts of one section, k of them; body axes, SI.

    n: normal; e1, e2: axes in the plane, (e1, e2, n) right-handed; points (k, 3); s (k,): distance along the run, None
    for a single cut; side (k,): +1 just before what lies in the plane, -1 just beyond, 0 nothing there; near: what
    counts as in it; pieces (k, 4, 4): pseudo-inertias about the body's origin; centroids (k, 3) of the cross-sections,
    None without shapes; about: where moments are taken: "at", "centroid", or (body, point);
    properties, strength [Pa]: for stresses, None where not given.
    """

    name: str
    body: int
    n: Array
    e1: Array
    e2: Array
    points: Array
    s: Array | None
    side: Array
    near: float
    pieces: Array
    centroids: Array | None
    about: str | tuple[int, Array]
    line: bool
    properties: Any
    strength: float | None
    warnings: tuple[str, ...]


def attached(mechanism: Mechanism, body: int) -> list[tuple[str, Array]]:
    """Joints that stay where they are and loads with the points of the body, in its axes, at which they act."""
    found: list[tuple[str, Array]] = []
    for joint in mechanism.joints:
        if joint.b == body:
            found.append((f"joint {joint.name}", joint.q))
        if joint.a == body and not JOINTS[joint.kind].wanders:
            found.append((f"joint {joint.name}", joint.p))
    for load in mechanism.loads:
        found += [(f"force {load.name}", point) for owner, point in load.points if owner == body]
    return found


def lay_cuts(mechanism: Mechanism, spec: Any, forms: dict[str, Form]) -> tuple[Cuts, ...]:
    """All sections of a spec. Raises SpecError with every section that cannot be cut."""
    cuts: list[Cuts] = []
    problems: list[Problem] = []
    index = {b.name: i for i, b in enumerate(mechanism.bodies)}
    for name, section in spec.sections.items():
        try:
            cuts.append(_lay(mechanism, spec, name, section, index, forms.get(section.body)))
        except SpecError as error:
            problems += error.problems
    if problems:
        raise SpecError(*problems)
    return tuple(cuts)


def first_axis(n: Array, given: Sequence[float] | None) -> Array:
    """e1: the given direction, or the body axis most nearly in the plane (x before y before z), made normal to n."""
    if given is not None:
        a = np.array(given, dtype=float)
        a = a / np.sqrt(a @ a)
    else:
        out = np.abs(n)
        a = np.eye(3)[int(np.flatnonzero(out <= out.min() + tolerances.EQUAL_COMPONENTS)[0])]
    e = a - (a @ n) * n
    found: Array = e / np.sqrt(e @ e)
    return found


def _lay(mechanism: Mechanism, spec: Any, name: str, section: Any, index: dict[str, int], form: Form | None) -> Cuts:
    body = index[section.body]
    n = np.array(section.normal, dtype=float)
    n = n / np.sqrt(n @ n)
    e1 = first_axis(n, section.first_axis)
    there = attached(mechanism, body)
    things = np.array([point for _, point in there]).reshape(-1, 3) @ n
    if section.at is not None:
        points, s = np.array([section.at], dtype=float), None
    else:
        first, last = np.array(section.from_), np.array(section.to)
        share = np.linspace(0.0, 1.0, section.count)
        points = first + share[:, None] * (last - first)
        points[-1] = last
        s = share * float(np.sqrt((last - first) @ (last - first)))
    d = points @ n
    if form is not None:
        near = max(form.near, tolerances.IN_PLANE * float(np.abs(things).max(initial=0.0)))
    else:
        extent = max(np.abs(things).max(initial=0.0), np.abs(d).max(), tolerances.LEAST_EXTENT)
        near = tolerances.IN_PLANE * float(extent)
    touches = np.abs(things[None, :] - d[:, None]) <= near
    meets = touches.any(axis=1)
    if form is not None:
        meets = meets | form.masses_in_plane(n, d) | form.rods_in_plane(n, d)
    where = spec.location(f"sections.{name}")
    if s is None:
        wish = {"before": BEFORE, "beyond": BEYOND, None: 0.0}[section.side]
        if meets[0] and section.side is None:
            names = [name for (name, _), met in zip(there, touches[0].tolist(), strict=True) if met]
            what = " and ".join(names) if names else "a point mass or rod of the body"
            raise SpecError(Problem(
                "needs-side", f"{what} {'lie' if len(names) > 1 else 'lies'} in the plane of the cut", where,
                hint="add side: before (the cut just before it, so that it belongs to the piece) or side: beyond",
            ))  # fmt: skip
        side = np.array([wish])  # also for what only comes into the plane later
    else:
        rows = []
        for k, meet in enumerate(meets.tolist()):
            if not meet:
                rows.append((k, 0.0))
            elif k == 0:
                rows.append((k, BEYOND))
            elif k == len(d) - 1:
                rows.append((k, BEFORE))
            else:
                rows += [(k, BEFORE), (k, BEYOND)]
        take = [k for k, _ in rows]
        points, s, d, side = points[take], s[take], d[take], np.array([x for _, x in rows])
    pieces, centroids, warnings = _pieces(where, name, section, form, n, d, side, s is not None)
    about: str | tuple[int, Array] = "at"
    if section.reduce_to == "centroid":
        about = "centroid"
    elif not isinstance(section.reduce_to, str):
        end = section.reduce_to
        about = (GROUND if end.body == "ground" else index[end.body], np.array(end.point))
    return Cuts(
        name,
        body,
        n,
        e1,
        np.cross(n, e1),
        points,
        s,
        side,
        near,
        pieces,
        centroids,
        about,
        section.reduce_to == "line",
        section.properties,
        section.strength,
        warnings,
    )


def _pieces(
    where: Any, name: str, section: Any, form: Form | None, n: Array, d: Array, side: Array, run: bool
) -> tuple[Array, Array | None, tuple[str, ...]]:
    if form is None:
        if section.piece is None:
            raise SpecError(Problem(
                "needs-shapes", f"the body {section.body} has no shapes to cut", where,
                hint="build the body from shapes, or give a single cut its piece: {mass, center, inertia}",
            ))  # fmt: skip
        piece = section.piece
        return pseudo_inertia(piece.mass, np.array(piece.center), np.array(piece.inertia))[None], None, ()
    # the ends of a run lie in end faces: there the limit from inside counts
    inside = side.copy()
    if run:
        inside[0], inside[-1] = BEYOND, BEFORE
    figures = form.figures(n, d, inside)
    if (figures.places == 0).any():
        at = "a cut of the run" if run else "the plane"
        low, high = form.extent(n)
        lies = float(d[figures.places == 0][0])
        hint = f"along the normal the body reaches from {low:.6g} to {high:.6g} m, the plane lies at {lies:.6g} m"
        raise SpecError(Problem("misses-body", f"{at} does not meet the body {section.body}", where, hint))
    warnings = []
    if (figures.places > 1).any():
        most = int(figures.places.max())
        what = f"meets the body {section.body} in {most} separate places; the loads are their sum"
        warnings.append(f"sections.{name}: the plane {what}")
    if form.rods_in_plane(n, d).any():
        what = f"runs along a rod of the body {section.body}; the rod's mass lies on the side chosen"
        warnings.append(f"sections.{name}: the plane {what}")
    return form.pieces(n, d, side), figures.centroid, tuple(warnings)
