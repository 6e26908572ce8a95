"""Bodies that are welded together are one: the sum of their pseudo-inertias, held and loaded at all their points.

    P = sum G P_b G^T,   G = [[R, p], [0, 1]]        about their common centre, axes of the body nearest the ground
Those welded to the ground are part of it. Only welds of the tree count, and of a circle of welds the tree takes all
but one: what is left of it is then between two points of one body, and holds nothing more. A weld that the tree cuts
for a body without mass (multibody/tree/spanning.py) closes a loop as any joint does. What the welds carry, and cuts
through the bodies, are told from the whole scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import GROUND, Body, Mechanism
from heuncli.multibody.reduction.model import Reduction
from heuncli.multibody.reduction.slots import slots
from heuncli.multibody.reduction.smaller_scene import Parts, PlaceInBody, bound_to_axes, restated
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import properties, pseudo_inertia


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """The scene with bodies that are welded together made one; sentences alone if none can be."""
    layout = scene.layout
    apart: dict[int, str] = {}
    parts = welded(layout, apart)
    while found := not_inside(layout, parts):
        body, why = found
        apart[body] = why
        parts = welded(layout, apart)
    kept = tuple(apart.values())
    if len(parts.roots) == len(parts.of):
        return kept
    bodies = [whole(scene.mechanism, parts, root) for root in parts.roots]
    smaller = restated(scene, parts, bodies)
    places = slots(layout, smaller.layout, parts, layout.y0)
    begun = replace(smaller.layout, y0=places.restrict(0.0, layout.y0))
    told = tuple(sentences(scene.mechanism, parts))
    return Reduction(replace(smaller, layout=begun), places.embed, places.restrict, told, kept=kept)


def welded(layout: Layout, apart: dict[int, str]) -> Parts:
    """What each body is part of, by the welds of the tree; apart: bodies that are left as they are, and why.

    A body with a load that varies and is fixed in its axes is put among them if those are not of what it is part of.
    """
    mechanism = layout.mechanism
    bound = bound_to_axes(mechanism)
    found: dict[int, PlaceInBody] = {GROUND: PlaceInBody(GROUND, np.eye(3), np.zeros(3))}
    for h in layout.spanning.hangs:
        found[h.body] = PlaceInBody(h.body, np.eye(3), np.zeros(3))
        if h.joint < 0 or not JOINTS[mechanism.joints[h.joint].kind].is_rigid or h.body in apart:
            continue
        part = found[h.parent].holds(beside(layout, h.joint, h.reverse))
        turned = float(np.abs(part.R - np.eye(3)).max()) > tolerances.UNIT_EXACT
        if h.body in bound and turned and part.body != GROUND:
            name = mechanism.bodies[h.body].name
            apart[h.body] = f"bodies.{name} stays a body by itself: a load that varies is fixed in its own axes"
            continue
        found[h.body] = part
    of = tuple(found[i] for i in range(len(mechanism.bodies)))
    return Parts(of, tuple(i for i, part in enumerate(of) if part.body == i))


def beside(layout: Layout, joint: int, reverse: bool) -> PlaceInBody:
    """Where a body stands in the one it is welded to."""
    weld, R = layout.mechanism.joints[joint], layout.starts[joint].R_ref
    if reverse:
        return PlaceInBody(weld.b, R.T, weld.q - R.T @ weld.p)
    return PlaceInBody(weld.a, R, weld.p - R @ weld.q)


def not_inside(layout: Layout, parts: Parts) -> tuple[int, str] | None:
    """A body that may not become part of the one it would, and why: then something would be lost that ends the run."""
    mechanism = layout.mechanism
    limited = {stop.joint for stop in mechanism.stops}
    counted = {k for coupling in mechanism.couplings for k in coupling.joints}
    for k, joint in enumerate(mechanism.joints):
        ends_run = joint.tension_only or joint.drive is not None or k in limited or k in counted
        if parts.inside(joint) and ends_run:
            body = max(joint.a, joint.b, key=lambda i: layout.place.get(i, -1))
            what = f"joints.{joint.name} between it and what it is welded to is driven, limited, coupled or a rope"
            return body, f"bodies.{mechanism.bodies[body].name} stays a body by itself: {what}"
    for owner, own in enumerate(mechanism.couplings, len(mechanism.joints)):
        if parts.holds_all(own):
            body = max(own.bodies, key=lambda i: layout.place[i])
            what = f"{mechanism.owner(owner)} is between it and what it is welded to"
            return body, f"bodies.{mechanism.bodies[body].name} stays a body by itself: {what}"
    return None


def whole(mechanism: Mechanism, parts: Parts, root: int) -> Body:
    """A body with all that is part of it, in its own axes."""
    members = [i for i, part in enumerate(parts.of) if part.body == root]
    body = mechanism.bodies[root]
    if members == [root]:
        return body
    masses = np.array([mechanism.bodies[i].mass for i in members])
    centres = np.array([parts.of[i].point(mechanism.bodies[i].center) for i in members])
    about = masses @ centres / masses.sum()  # about their common centre no moment is the difference of larger ones
    P = sum((moved(mechanism.bodies[i], parts.of[i], about) for i in members), np.zeros((4, 4)))
    mass, center, inertia = properties(P)
    return replace(body, mass=mass, center=about + center, inertia=0.5 * (inertia + inertia.T))


def moved(body: Body, part: PlaceInBody, about: Array) -> Array:
    """The pseudo-inertia of a body about a point of what it is part of, in its axes."""
    centre = part.point(body.center) - about
    return pseudo_inertia(body.mass, centre, part.R @ body.inertia @ part.R.T)


def sentences(mechanism: Mechanism, parts: Parts) -> Iterable[str]:
    """What became part of what."""
    for root in (*parts.roots, GROUND):
        members = [i for i, part in enumerate(parts.of) if part.body == root and i != root]
        if members and root == GROUND:
            verb = "is" if len(members) == 1 else "are"
            yield f"{listed(mechanism, members)} {verb} welded to the ground and cannot move: part of the ground"
        elif members:
            yield f"{listed(mechanism, [root, *members])} are welded together: they move as one body"


def listed(mechanism: Mechanism, bodies: Sequence[int]) -> str:
    """Names of bodies, of many the first ones: "bodies.a, b and 3 others"."""
    names = [mechanism.bodies[i].name for i in bodies]
    if len(names) > 4:
        return f"bodies.{', '.join(names[:3])} and {len(names) - 3} others"
    return "bodies." + (" and ".join(filter(None, [", ".join(names[:-1]), names[-1]])))
