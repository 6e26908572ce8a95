"""The bodies that carry links, their named points, and the joints between them.

Links joined by fixed joints form one rigid group. In it, every link with mass is a body. A link without mass is carried
by the nearest body above it; if there is none, by the ground if the group is grounded, else by the first body of the
group below it. With every joint at 0, R_WL is the attitude of a link and x_HL its origin from that of its carrier, both
along the world's axes:

    R_WL = R_WP R_PL,   x_HL = x_HP + R_WP p_PL      P the parent of L, p_PL, R_PL the pose of its joint

Joints are pins, slides, planes and welds, in the order of the tree. A planar joint holds three points of its child in
the plane through its origin. Together they prevent it from tilting, and let it shift and turn in the plane. A floating
joint makes no joint. A fixed joint is a weld between bodies with mass; a link without mass is a point of the body to
which it is fixed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import IDENTITY, cross_product, unit_vector, vector_length
from heuncli.scene.importers.attitudes import (
    add_vectors,
    compose_rotations,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
    round_vector,
)
from heuncli.scene.importers.description import DescribedPoint, assign_names, format_original_name
from heuncli.scene.importers.urdf.document import LoopJoint, UrdfJoint
from heuncli.scene.importers.urdf.tree import LinkTree

# Carriers

GROUND = ""  # differs from every link name


class PlacedLink(NamedTuple):
    """A link with all joints at zero.

    R: its attitude in the world
    origin: its origin in the world [m]
    carrier: the link, or GROUND, that carries it
    offset: its origin relative to that of the carrier [m]
    """

    R: Matrix
    origin: Vec
    carrier: str
    offset: Vec


def place_links(
    tree: LinkTree, attitudes: dict[str, Matrix], links_with_mass: Collection[str], is_grounded: bool
) -> tuple[dict[str, PlacedLink], list[str]]:
    """Place every link. Also returns the links without mass whose rigid group has no body.

    attitudes: R_WL of every link
    is_grounded: whether the root is fixed to the ground
    """
    heads = find_group_heads(tree)
    carriers = _find_carriers(tree, heads, links_with_mass, is_grounded)
    offsets = _compute_offsets(tree, attitudes, heads, carriers)
    origins: dict[str, Vec] = {}
    for link in tree.links:
        joint = tree.parent_joints.get(link.name)
        place = (
            ZERO
            if joint is None
            else add_vectors(origins[joint.parent], rotate_vector(attitudes[joint.parent], joint.pose.xyz))
        )
        origins[link.name] = place
    uncarried = [link.name for link in tree.links if link.name not in carriers]
    placed = {
        link.name: PlacedLink(attitudes[link.name], origins[link.name], carriers[link.name], offsets[link.name])
        for link in tree.links
        if link.name in carriers
    }
    return placed, uncarried


def compute_attitudes(tree: LinkTree) -> dict[str, Matrix]:
    """Compute R_WL of every link with every joint at 0."""
    attitudes: dict[str, Matrix] = {}
    for link in tree.links:
        joint = tree.parent_joints.get(link.name)
        attitudes[link.name] = (
            IDENTITY
            if joint is None
            else compose_rotations(attitudes[joint.parent], rotation_from_roll_pitch_yaw(joint.pose.rpy))
        )
    return attitudes


def find_group_heads(tree: LinkTree) -> dict[str, str]:
    """Find the first link of the rigid group of each link."""
    heads: dict[str, str] = {}
    for link in tree.links:
        joint = tree.parent_joints.get(link.name)
        heads[link.name] = link.name if joint is None or joint.is_movable else heads[joint.parent]
    return heads


def _find_carriers(
    tree: LinkTree, heads: dict[str, str], links_with_mass: Collection[str], is_grounded: bool
) -> dict[str, str]:
    first_carrier = {tree.root.name: GROUND} if is_grounded else {}
    for link in tree.links:
        if link.name in links_with_mass:
            first_carrier.setdefault(heads[link.name], link.name)
    carriers: dict[str, str] = {}
    for link in tree.links:
        name, joint = link.name, tree.parent_joints.get(link.name)
        if name in links_with_mass:
            carriers[name] = name
        elif heads[name] != name and joint is not None and joint.parent in carriers:
            carriers[name] = carriers[joint.parent]
        elif heads[name] in first_carrier:
            carriers[name] = first_carrier[heads[name]]
    return carriers


def _compute_offsets(
    tree: LinkTree, attitudes: dict[str, Matrix], heads: dict[str, str], carriers: dict[str, str]
) -> dict[str, Vec]:
    """Compute x_HL: from a carrier below up to the head of its group, then outward from each head."""
    offsets = {name: ZERO for name, carrier_name in carriers.items() if name == carrier_name}
    if carriers.get(tree.root.name) == GROUND:
        offsets[tree.root.name] = ZERO
    for name in [*offsets]:
        link_name = name
        while link_name != heads[link_name] and carriers[tree.parent_joints[link_name].parent] == name:
            joint = tree.parent_joints[link_name]
            x, y, z = rotate_vector(attitudes[joint.parent], joint.pose.xyz)
            offsets[joint.parent] = add_vectors(offsets[link_name], (-x, -y, -z))
            link_name = joint.parent
    for link in tree.links:
        if link.name in carriers and link.name not in offsets:
            joint = tree.parent_joints[link.name]
            offsets[link.name] = add_vectors(
                offsets[joint.parent], rotate_vector(attitudes[joint.parent], joint.pose.xyz)
            )
    return offsets


# Points


class PointKey(NamedTuple):
    """Identifies a collected point: its carrier, and its number there."""

    carrier: str
    number: int


class RobotPoints:
    """The points of one machine; kinds of names: `joint`, `link`."""

    def __init__(self) -> None:
        self.entries: dict[str, list[tuple[str, str, Vec]]] = {}
        self.point_names: dict[str, list[str]] = {}
        self.bodies: Mapping[str, str] = {}

    def add(self, carrier: str, kind: str, original: str, place: Vec) -> PointKey:
        """Add a point to a carrier. original: the name of its joint or link; place: relative to the carrier's origin
        [m].
        """
        carrier_points = self.entries.setdefault(carrier, [])
        carrier_points.append((kind, original, place))
        return PointKey(carrier, len(carrier_points) - 1)

    def assign_names(self, bodies: Mapping[str, str]) -> None:
        """Assign the names. bodies: the names of the carriers in the spec."""
        self.bodies = bodies
        self.point_names = {
            carrier: assign_names("point", [wanted for _, wanted, _ in own]) for carrier, own in self.entries.items()
        }

    def format_end(self, key: PointKey) -> str:
        """Format a point as the end of a joint: `arm.elbow`."""
        body = "ground" if key.carrier == GROUND else self.bodies[key.carrier]
        return f"{body}.{self.point_names[key.carrier][key.number]}"

    def get_points(self, carrier: str) -> tuple[DescribedPoint, ...]:
        """Return the points of a carrier."""
        own = zip(self.point_names.get(carrier, ()), self.entries.get(carrier, ()), strict=True)
        return tuple(
            DescribedPoint(name, place, format_original_name(kind, name, wanted)) for name, (kind, wanted, place) in own
        )


# Links

TYPES = {"revolute": "pin", "continuous": "pin", "prismatic": "slide"}
BALL = "ball"  # a type of joint that only SDF has
UNIT_LENGTH_TOLERANCE = 1e-6  # deviation from length 1 of an axis typed with seven digits


class SpecJoint(NamedTuple):
    """A joint of the spec.

    original: the name in the file
    start, end: its points on the parent and on the child
    joint: the joint of the URDF, if any
    in_loop: whether it is a part of a closed loop, whose other joints move with it
    """

    original: str
    type: str
    start: PointKey
    end: PointKey
    keys: dict[str, Any]
    remarks: tuple[str, ...] = ()
    joint: UrdfJoint | None = None
    in_loop: bool = False


def iter_spec_joints(
    tree: LinkTree,
    placed_links: dict[str, PlacedLink],
    is_grounded: bool,
    points: RobotPoints,
    loop_joints: Sequence[LoopJoint] = (),
) -> Iterator[SpecJoint]:
    """Yield every joint of the spec, those that close loops last; its points are added to those of the bodies."""
    links_in_loops = find_links_in_loops(tree, loop_joints)
    for one in _iter_tree_joints(tree, placed_links, is_grounded, points):
        yield one._replace(in_loop=one.joint is not None and one.joint.child in links_in_loops)
    for joint, pose_in_child in loop_joints:
        parent, child = placed_links[joint.parent], placed_links[joint.child]
        if joint.kind == "fixed" and parent.carrier == child.carrier:
            continue
        place = add_vectors(parent.offset, rotate_vector(parent.R, joint.pose.xyz))
        offset = add_vectors(child.offset, rotate_vector(child.R, pose_in_child.xyz))
        R = compose_rotations(parent.R, rotation_from_roll_pitch_yaw(joint.pose.rpy))
        end = PlacedLink(R, ZERO, child.carrier, offset)
        for spec_joint in _iter_joints(joint, place, end, parent.carrier, points):
            yield spec_joint._replace(remarks=(*spec_joint.remarks, "closes a loop"), in_loop=True)


def find_links_in_loops(tree: LinkTree, loop_joints: Sequence[LoopJoint]) -> set[str]:
    """Find the links whose joint in the tree is a part of a loop: on the way from one end of a loop joint to the
    other.
    """
    found: set[str] = set()
    for joint, _ in loop_joints:
        ways = [_list_ancestors(tree, name) for name in (joint.parent, joint.child)]
        found |= set(ways[0]) ^ set(ways[1])
    return found


def _list_ancestors(tree: LinkTree, name: str) -> list[str]:
    """List a link and those that carry it, up to the root."""
    names = [name]
    while (joint := tree.parent_joints.get(names[-1])) is not None:
        names.append(joint.parent)
    return names


def _iter_tree_joints(
    tree: LinkTree, placed_links: dict[str, PlacedLink], is_grounded: bool, points: RobotPoints
) -> Iterator[SpecJoint]:
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
    if joint.kind == BALL:
        yield SpecJoint(joint.name, "ball", start, end, {}, (), joint)
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
