"""What flanks push apart with: the radial part of tooth forces, whichever of the two flanks carries.

    F = |lambda| h    ON b at the pitch point, the opposite ON a        h per unit of tangential force (gearing.py)
It does no work, however the two turn. So nothing moves by it, no closure row feels it, and it goes from the one gear to
the other through the joints of the tree between them, each of which exerts the opposite of what it holds off.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.records import replace
from heuncli.loads.kinetostatics.couplings import CouplingLoads, PartLoad
from heuncli.loads.kinetostatics.reactions import JointLoads, in_plane
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


def pushes_apart(mechanism: Mechanism) -> bool:
    """Whether a coupling has such flanks."""
    return any(np.any(part.apart) for own in mechanism.couplings for row in own.rows for part in row.parts)


def between(layout: Layout, part: CouplingPart) -> dict[int, float]:
    """The joints of the tree between the two bodies of a part: by how much of its load ON b each loads its `to`."""
    on_a, on_b = set(layout.path(part.a)), set(layout.path(part.b))
    found = {}
    for i in on_a ^ on_b:
        hang = layout.spanning.hangs[i]
        found[hang.joint] = (-1.0 if i in on_b else 1.0) * (-1.0 if hang.reverse else 1.0)
    return found


def with_flanks(layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]) -> list[JointLoads]:
    """Joint loads that hold flanks together, too; from those by which nothing is pushed apart."""
    if not pushes_apart(layout.mechanism):
        return list(joints)
    added = {load.joint.name: load for load in joints}
    for part in (part for own in couplings for part in own.parts if part.pushed is not None):
        for k, share in between(layout, part.part).items():
            name = layout.mechanism.joints[k].name
            if name in added:
                added[name] = _with(added[name], share, part, layout.mechanism.planar)
    return list(added.values())


def _with(load: JointLoads, share: float, part: PartLoad, planar: bool) -> JointLoads:
    force, moment = held_off(load, share * part.push, part.place)
    if planar:
        force, moment = in_plane(force, moment)
    found: JointLoads = replace(load, force=load.force + force, moment=load.moment + moment)
    return found


def held_off(load: JointLoads, force: Array, place: Array) -> tuple[Array, Array]:
    """A force at a place as force and moment about a joint's point."""
    return force, cross_rows(place - load.point, force)
