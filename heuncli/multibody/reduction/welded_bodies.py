"""Make bodies that are welded together one: the sum of their pseudo-inertias, held and loaded at all their points.

    P = sum G P_b G^T,   G = [[R, p], [0, 1]]        about their common centre, axes of the body nearest the ground

Those welded to the ground become part of it. Only welds of the tree count, and of a circle of welds the tree takes all
but one: the last one is then between two points of one body and constrains nothing more. A weld that the tree cuts for
a body without mass (multibody/tree/spanning.py) closes a loop as any joint does. The loads in the welds, and cuts
through the bodies, are computed from the whole scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import replace
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.smaller_scene import (
    BodyParts,
    BodyPlacement,
    bodies_with_varying_loads,
    make_smaller_scene,
)
from heuncli.multibody.reduction.state_embedding import make_state_embedding
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import pseudo_inertia, split_pseudo_inertia


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """Merge bodies that are welded together; return only sentences if there are none."""
    layout = scene.layout
    separate: dict[int, str] = {}
    parts = find_welded_parts(layout, separate)
    while excluded := find_excluded_body(layout, parts):
        body, reason = excluded
        separate[body] = reason
        parts = find_welded_parts(layout, separate)
    exceptions = tuple(separate.values())
    if len(parts.roots) == len(parts.placements):
        return exceptions
    bodies = [merge_parts(scene.mechanism, parts, root) for root in parts.roots]
    smaller = make_smaller_scene(scene, parts, bodies)
    embedding = make_state_embedding(layout, smaller.layout, parts, layout.y0)
    layout_at_start = replace(smaller.layout, y0=embedding.restrict(0.0, layout.y0))
    explanations = tuple(iter_explanations(scene.mechanism, parts))
    return Reduction(
        replace(smaller, layout=layout_at_start),
        embedding.embed,
        embedding.restrict,
        explanations,
        exceptions=exceptions,
    )


def find_welded_parts(layout: Layout, separate: dict[int, str]) -> BodyParts:
    """Find what each body is part of, by the welds of the tree; separate: bodies that are not merged, and why.

    A body with a load that varies and is fixed in its axes is added to these if its axes differ from the others.
    """
    mechanism = layout.mechanism
    bound = bodies_with_varying_loads(mechanism)
    placement_of: dict[int, BodyPlacement] = {GROUND: BodyPlacement(GROUND, np.eye(3), np.zeros(3))}
    for link in layout.spanning.links:
        placement_of[link.body] = BodyPlacement(link.body, np.eye(3), np.zeros(3))
        if link.joint < 0 or not JOINTS[mechanism.joints[link.joint].kind].is_rigid or link.body in separate:
            continue
        part = placement_of[link.parent].compose(weld_placement(layout, link.joint, link.reverse))
        is_turned = float(np.abs(part.R - np.eye(3)).max()) > tolerances.UNIT_EXACT
        if link.body in bound and is_turned and part.body != GROUND:
            name = mechanism.bodies[link.body].name
            separate[link.body] = f"bodies.{name} stays a separate body: a varying load is fixed in its own axes"
            continue
        placement_of[link.body] = part
    placements = tuple(placement_of[i] for i in range(len(mechanism.bodies)))
    return BodyParts(placements, tuple(i for i, part in enumerate(placements) if part.body == i))


def weld_placement(layout: Layout, joint: int, reverse: bool) -> BodyPlacement:
    """Return where a body sits in the body that it is welded to."""
    weld, R = layout.mechanism.joints[joint], layout.starts[joint].R_ref
    if reverse:
        return BodyPlacement(weld.b, R.T, weld.q - R.T @ weld.p)
    return BodyPlacement(weld.a, R, weld.p - R @ weld.q)


def find_excluded_body(layout: Layout, parts: BodyParts) -> tuple[int, str] | None:
    """Find a body that must not be merged, and why: otherwise something that may end the run would be lost."""
    mechanism = layout.mechanism
    limited = {stop.joint for stop in mechanism.stops} | {own.joint for own in mechanism.iter_sticking()}
    counted = {k for coupling in mechanism.couplings for k in coupling.joints}
    for k, joint in enumerate(mechanism.joints):
        ends_run = joint.tension_only or joint.drive is not None or k in limited or k in counted
        if parts.is_internal(joint) and ends_run:
            body = max(joint.a, joint.b, key=lambda i: layout.place.get(i, -1))
            what = f"joints.{joint.name} to a body welded to it is driven, limited, coupled or tension-only"
            return body, f"bodies.{mechanism.bodies[body].name} stays a separate body: {what}"
    for owner, candidate in enumerate(mechanism.couplings, len(mechanism.joints)):
        if parts.contains_coupling(candidate):
            body = max(candidate.bodies, key=lambda i: layout.place[i])
            what = f"{mechanism.owner_path(owner)} connects it to a body welded to it"
            return body, f"bodies.{mechanism.bodies[body].name} stays a separate body: {what}"
    return None


def merge_parts(mechanism: Mechanism, parts: BodyParts, root: int) -> Body:
    """Merge the masses, points and shapes of a body and its welded parts, in the body's axes."""
    members = [i for i, part in enumerate(parts.placements) if part.body == root]
    body = mechanism.bodies[root]
    if members == [root]:
        return body
    masses = np.array([mechanism.bodies[i].mass for i in members])
    if not masses.any():
        return body
    centres = np.array([parts.placements[i].transform_point(mechanism.bodies[i].center) for i in members])
    # about their common centre no moment is the difference of larger ones
    common_centre = masses @ centres / masses.sum()
    P = sum(
        (placed_pseudo_inertia(mechanism.bodies[i], parts.placements[i], common_centre) for i in members),
        np.zeros((4, 4)),
    )
    mass, center, inertia = split_pseudo_inertia(P)
    return replace(body, mass=mass, center=common_centre + center, inertia=0.5 * (inertia + inertia.T))


def placed_pseudo_inertia(body: Body, part: BodyPlacement, reference_point: Array) -> Array:
    """Return the pseudo-inertia of a part about a point of the merged body, in its axes."""
    centre = part.transform_point(body.center) - reference_point
    return pseudo_inertia(body.mass, centre, part.R @ body.inertia @ part.R.T)


def iter_explanations(mechanism: Mechanism, parts: BodyParts) -> Iterable[str]:
    """Yield a sentence for each body that others became part of."""
    for root in (*parts.roots, GROUND):
        members = [i for i, part in enumerate(parts.placements) if part.body == root and i != root]
        if members and root == GROUND:
            verb = "is" if len(members) == 1 else "are"
            yield (
                f"{format_body_names(mechanism, members)} {verb} welded to the ground and cannot move: "
                "part of the ground"
            )
        elif members:
            yield f"{format_body_names(mechanism, [root, *members])} are welded together: they move as one body"


def format_body_names(mechanism: Mechanism, bodies: Sequence[int]) -> str:
    """Format the names of bodies, of many the first ones: "bodies.a, b and 3 others"."""
    names = [mechanism.bodies[i].name for i in bodies]
    if len(names) > 4:
        return f"bodies.{', '.join(names[:3])} and {len(names) - 3} others"
    return "bodies." + (" and ".join(filter(None, [", ".join(names[:-1]), names[-1]])))
