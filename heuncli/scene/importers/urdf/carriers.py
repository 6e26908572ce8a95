"""Find the body that carries each link, and where. A link without mass is a point of the body to which it is fixed.

Links joined by fixed joints form one rigid group. In it, every link with mass is a body. A link without mass is carried
by the nearest body above it; if there is none, by the ground if the group is grounded, else by the first body of the
group below it. With every joint at 0, R_WL is the attitude of a link and x_HL its origin from that of its carrier, both
along the world's axes:

    R_WL = R_WP R_PL,   x_HL = x_HP + R_WP p_PL      P the parent of L, p_PL, R_PL the pose of its joint
"""

from __future__ import annotations

from collections.abc import Collection

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Matrix, Vec
from heuncli.scene.file_format.rotations import IDENTITY
from heuncli.scene.importers.attitudes import (
    add_vectors,
    compose_rotations,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
)
from heuncli.scene.importers.urdf.tree import LinkTree

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
