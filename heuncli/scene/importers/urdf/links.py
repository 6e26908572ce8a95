"""How the bodies of a robot hang together: its joints as pins, slides, planes and welds, in the order of the tree.

A planar joint holds three points of its child in the plane through its origin: together they keep it from tilting, and
leave it to shift and turn in the plane. A floating joint is none. A fixed one is a weld between bodies that have mass;
a link without mass is a point of the body that it is fixed to.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.turns import cross, length, unit
from heuncli.scene.importers.attitudes import kept, shifted, turned
from heuncli.scene.importers.urdf.carriers import GROUND, PlacedLink
from heuncli.scene.importers.urdf.document import UrdfJoint
from heuncli.scene.importers.urdf.points import PointKey, RobotPoints
from heuncli.scene.importers.urdf.tree import LinkTree

TYPES = {"revolute": "pin", "continuous": "pin", "prismatic": "slide"}
STRAIGHT = 1e-6  # of 1: an axis typed with seven digits has the length 1


class Linked(NamedTuple):
    """A joint of the spec: the name it would have, its type, ends, keys, remarks, and the joint of the URDF, if any."""

    wanted: str
    type: str
    from_: PointKey
    to: PointKey
    keys: dict[str, Any]
    remarks: tuple[str, ...] = ()
    joint: UrdfJoint | None = None


def links_of(tree: LinkTree, placed: dict[str, PlacedLink], grounded: bool, points: RobotPoints) -> Iterator[Linked]:
    """Every joint of the spec; its points are added to those of the bodies."""
    root = tree.root.name
    if grounded and placed[root].carrier == root:
        ends = points.add(GROUND, "link", root, ZERO), points.add(root, "link", root, ZERO)
        yield Linked(f"{root}_on_ground", "weld", *ends, {}, ("the root stands on the ground",))
    for link in islice(tree.links, 1, None):
        joint = tree.above[link.name]
        own, parent = placed[link.name], placed[joint.parent]
        place = shifted(parent.offset, turned(parent.R, joint.pose.xyz))
        if joint.kind == "fixed" and own.carrier == parent.carrier:
            if own.carrier != link.name:  # else it carries its parent, whose point is its own origin
                points.add(own.carrier, "link", link.name, own.offset)
        elif joint.kind != "floating":
            yield from _linked(joint, place, own, parent.carrier, points)


def _linked(joint: UrdfJoint, place: Vec, own: PlacedLink, parent: str, points: RobotPoints) -> Iterator[Linked]:
    """The joint, or the joints, that it is. place: its origin from that of the carrier of its parent."""
    start = points.add(parent, "joint", joint.name, place)
    end = points.add(own.carrier, "joint", joint.name, own.offset)
    if joint.kind == "fixed":
        yield Linked(joint.name, "weld", start, end, {}, (), joint)
        return
    axis = turned(own.R, joint.axis)
    remarks = [joint.kind] if joint.kind == "continuous" else []
    if abs(length(joint.axis) - 1.0) > STRAIGHT:
        remarks.append(f"the axis of the file has the length {length(joint.axis):.6g}")
    if joint.kind != "planar":
        if joint.effort is not None:
            remarks.append(f"effort at most {joint.effort:g} {'N' if joint.kind == 'prismatic' else 'N m'}")
        yield Linked(joint.name, TYPES[joint.kind], start, end, {"axis": axis}, tuple(remarks), joint)
        return
    remarks.append("planar: three points of it stay in the plane")
    for number, arm in enumerate((ZERO, *_across(axis)), 1):
        name = f"{joint.name}_{number}"
        corner = points.add(own.carrier, "joint", name, shifted(own.offset, arm))
        yield Linked(name, "plane", start, corner, {"normal": axis}, tuple(remarks) if number == 1 else (), joint)


def _across(axis: Vec) -> tuple[Vec, Vec]:
    """Two directions of length 1 across an axis and each other."""
    n = unit(axis)
    least = min(range(3), key=lambda i: abs(n[i]))
    first = unit(cross(n, (float(least == 0), float(least == 1), float(least == 2))))
    return kept(first), kept(cross(n, first))
