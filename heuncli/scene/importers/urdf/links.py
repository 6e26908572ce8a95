"""Make the joints of the spec: pins, slides, planes and welds, in the order of the tree.

A planar joint holds three points of its child in the plane through its origin. Together they prevent it from tilting,
and let it shift and turn in the plane. A floating joint makes no joint. A fixed joint is a weld between bodies with
mass; a link without mass is a point of the body to which it is fixed.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import cross_product, unit_vector, vector_length
from heuncli.scene.importers.attitudes import add_vectors, rotate_vector, round_vector
from heuncli.scene.importers.urdf.carriers import GROUND, PlacedLink
from heuncli.scene.importers.urdf.document import UrdfJoint
from heuncli.scene.importers.urdf.points import PointKey, RobotPoints
from heuncli.scene.importers.urdf.tree import LinkTree

TYPES = {"revolute": "pin", "continuous": "pin", "prismatic": "slide"}
UNIT_LENGTH_TOLERANCE = 1e-6  # deviation from length 1 of an axis typed with seven digits


class SpecJoint(NamedTuple):
    """A joint of the spec.

    original: the name in the file
    start, end: its points on the parent and on the child
    joint: the joint of the URDF, if any
    """

    original: str
    type: str
    start: PointKey
    end: PointKey
    keys: dict[str, Any]
    remarks: tuple[str, ...] = ()
    joint: UrdfJoint | None = None


def iter_spec_joints(
    tree: LinkTree, placed_links: dict[str, PlacedLink], is_grounded: bool, points: RobotPoints
) -> Iterator[SpecJoint]:
    """Yield every joint of the spec; its points are added to those of the bodies."""
    root = tree.root.name
    if is_grounded and placed_links[root].carrier == root:
        ends = points.add(GROUND, "link", root, ZERO), points.add(root, "link", root, ZERO)
        yield SpecJoint(f"{root}_on_ground", "weld", *ends, {}, ("the root is fixed to the ground",))
    for link in islice(tree.links, 1, None):
        joint = tree.parent_joints[link.name]
        placed_link, parent = placed_links[link.name], placed_links[joint.parent]
        place = add_vectors(parent.offset, rotate_vector(parent.R, joint.pose.xyz))
        if joint.kind == "fixed" and placed_link.carrier == parent.carrier:
            if placed_link.carrier != link.name:  # otherwise the link carries its parent, whose point is its own origin
                points.add(placed_link.carrier, "link", link.name, placed_link.offset)
        elif joint.kind != "floating":
            yield from _iter_joints(joint, place, placed_link, parent.carrier, points)


def _iter_joints(
    joint: UrdfJoint, place: Vec, placed_link: PlacedLink, parent: str, points: RobotPoints
) -> Iterator[SpecJoint]:
    """Yield the joint, or the joints, of the spec for one joint. place: its origin relative to that of its parent's
    carrier.
    """
    start = points.add(parent, "joint", joint.name, place)
    end = points.add(placed_link.carrier, "joint", joint.name, placed_link.offset)
    if joint.kind == "fixed":
        yield SpecJoint(joint.name, "weld", start, end, {}, (), joint)
        return
    axis = rotate_vector(placed_link.R, joint.axis)
    remarks = [joint.kind] if joint.kind == "continuous" else []
    if abs(vector_length(joint.axis) - 1.0) > UNIT_LENGTH_TOLERANCE:
        remarks.append(f"the axis in the file has length {vector_length(joint.axis):.6g}")
    if joint.kind != "planar":
        if joint.effort is not None:
            remarks.append(f"maximum effort {joint.effort:g} {'N' if joint.kind == 'prismatic' else 'N m'}")
        yield SpecJoint(joint.name, TYPES[joint.kind], start, end, {"axis": axis}, tuple(remarks), joint)
        return
    remarks.append("planar: three of its points stay in the plane")
    for number, arm in enumerate((ZERO, *_perpendicular_directions(axis)), 1):
        name = f"{joint.name}_{number}"
        corner = points.add(placed_link.carrier, "joint", name, add_vectors(placed_link.offset, arm))
        yield SpecJoint(name, "plane", start, corner, {"normal": axis}, tuple(remarks) if number == 1 else (), joint)


def _perpendicular_directions(axis: Vec) -> tuple[Vec, Vec]:
    """Return two unit vectors perpendicular to an axis and to each other."""
    n = unit_vector(axis)
    least = min(range(3), key=lambda i: abs(n[i]))
    first = unit_vector(cross_product(n, (float(least == 0), float(least == 1), float(least == 2))))
    return round_vector(first), round_vector(cross_product(n, first))
