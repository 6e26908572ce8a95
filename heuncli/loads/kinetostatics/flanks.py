"""Separating forces of tooth flanks: the radial part of tooth forces, whichever of the two flanks carries.

    F = |lambda| h    ON b at the pitch point, the opposite ON a        h per unit of tangential force (gearing.py)

It does no work, however the two turn. So it moves nothing, loads no closure row, and passes from one gear to the other
through the joints of the tree between them, each of which exerts the opposite of the force that it resists.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.records import replace
from heuncli.loads.kinetostatics.couplings import CouplingLoads, PartLoad
from heuncli.loads.kinetostatics.reactions import JointLoads, project_to_plane
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


def has_separating_forces(mechanism: Mechanism) -> bool:
    """Return whether a coupling has such flanks."""
    return any(np.any(part.separating_force) for own in mechanism.couplings for row in own.rows for part in row.parts)


def find_joints_between(layout: Layout, part: CouplingPart) -> dict[int, float]:
    """Return the joints of the tree between the two bodies of a part, with the factor of its load ON b in each joint's
    load ON `to`.
    """
    on_a, on_b = set(layout.path_to_root(part.a)), set(layout.path_to_root(part.b))
    factors = {}
    for i in on_a ^ on_b:
        link = layout.spanning.links[i]
        factors[link.joint] = (-1.0 if i in on_b else 1.0) * (-1.0 if link.reverse else 1.0)
    return factors


def add_separating_forces(
    layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]
) -> list[JointLoads]:
    """Add the separating forces to joint loads that were computed without them."""
    if not has_separating_forces(layout.mechanism):
        return list(joints)
    added = {load.joint.name: load for load in joints}
    for part in (part for own in couplings for part in own.parts if part.separating_force is not None):
        for k, share in find_joints_between(layout, part.part).items():
            name = layout.mechanism.joints[k].name
            if name in added:
                added[name] = _add_to_joint(added[name], share, part, layout.mechanism.planar)
    return list(added.values())


def _add_to_joint(load: JointLoads, share: float, part: PartLoad, planar: bool) -> JointLoads:
    force, moment = transfer_force(load, share * part.separation, part.place)
    if planar:
        force, moment = project_to_plane(force, moment)
    result: JointLoads = replace(load, force=load.force + force, moment=load.moment + moment)
    return result


def transfer_force(load: JointLoads, force: Array, place: Array) -> tuple[Array, Array]:
    """Return a force at a place as force and moment about a joint's point."""
    return force, cross_rows(place - load.point, force)
