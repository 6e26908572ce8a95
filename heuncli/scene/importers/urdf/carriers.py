"""Which body carries each link, and where: links without mass are no bodies, but points of the body they are fixed to.

Links joined by fixed joints make one rigid group. In it every link with mass is a body, and one without is carried by
the nearest body above it; where there is none above, by the ground if the group stands on it, else by the first body of
the group below it. With every joint at 0, R_WL the attitude of a link and x_HL its origin from that of its carrier,
both along the world's axes:

    R_WL = R_WP R_PL,   x_HL = x_HP + R_WP p_PL      P the parent of L, p_PL, R_PL the pose of its joint
"""

from __future__ import annotations

from collections.abc import Collection

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Matrix, Vec
from heuncli.scene.file_format.turns import IDENTITY
from heuncli.scene.importers.attitudes import after, of_roll_pitch_yaw, shifted, turned
from heuncli.scene.importers.urdf.tree import LinkTree

GROUND = ""  # no name of a link


class PlacedLink(NamedTuple):
    """A link at the zero of all joints: its attitude and origin in the world; its carrier, and where from that."""

    R: Matrix
    origin: Vec
    carrier: str
    offset: Vec


def placed_links(
    tree: LinkTree, attitudes: dict[str, Matrix], massive: Collection[str], grounded: bool
) -> tuple[dict[str, PlacedLink], list[str]]:
    """Every link; and those without mass that have no carrier, whose group nobody carries.

    attitudes: R_WL of every link; massive: the links with mass; grounded: the root stands on the ground.
    """
    head = heads_of(tree)
    carrier = _carriers(tree, head, massive, grounded)
    offset = _offsets(tree, attitudes, head, carrier)
    origin: dict[str, Vec] = {}
    for link in tree.links:
        joint = tree.above.get(link.name)
        at = ZERO if joint is None else shifted(origin[joint.parent], turned(attitudes[joint.parent], joint.pose.xyz))
        origin[link.name] = at
    lost = [link.name for link in tree.links if link.name not in carrier]
    placed = {
        link.name: PlacedLink(attitudes[link.name], origin[link.name], carrier[link.name], offset[link.name])
        for link in tree.links
        if link.name in carrier
    }
    return placed, lost


def attitudes_of(tree: LinkTree) -> dict[str, Matrix]:
    """R_WL of every link with every joint at 0."""
    found: dict[str, Matrix] = {}
    for link in tree.links:
        joint = tree.above.get(link.name)
        found[link.name] = IDENTITY if joint is None else after(found[joint.parent], of_roll_pitch_yaw(joint.pose.rpy))
    return found


def heads_of(tree: LinkTree) -> dict[str, str]:
    """The first link of the rigid group of each link."""
    head: dict[str, str] = {}
    for link in tree.links:
        joint = tree.above.get(link.name)
        head[link.name] = link.name if joint is None or joint.movable else head[joint.parent]
    return head


def _carriers(tree: LinkTree, head: dict[str, str], massive: Collection[str], grounded: bool) -> dict[str, str]:
    first = {tree.root.name: GROUND} if grounded else {}
    for link in tree.links:
        if link.name in massive:
            first.setdefault(head[link.name], link.name)
    carrier: dict[str, str] = {}
    for link in tree.links:
        name, joint = link.name, tree.above.get(link.name)
        if name in massive:
            carrier[name] = name
        elif head[name] != name and joint is not None and joint.parent in carrier:
            carrier[name] = carrier[joint.parent]
        elif head[name] in first:
            carrier[name] = first[head[name]]
    return carrier


def _offsets(
    tree: LinkTree, attitudes: dict[str, Matrix], head: dict[str, str], carrier: dict[str, str]
) -> dict[str, Vec]:
    """x_HL: from a carrier below up to the head of its group, then from each head outward."""
    offset = {name: ZERO for name, by in carrier.items() if name == by}
    if carrier.get(tree.root.name) == GROUND:
        offset[tree.root.name] = ZERO
    for name in [*offset]:
        at = name
        while at != head[at] and carrier[tree.above[at].parent] == name:
            joint = tree.above[at]
            x, y, z = turned(attitudes[joint.parent], joint.pose.xyz)
            offset[joint.parent] = shifted(offset[at], (-x, -y, -z))
            at = joint.parent
    for link in tree.links:
        if link.name in carrier and link.name not in offset:
            joint = tree.above[link.name]
            offset[link.name] = shifted(offset[joint.parent], turned(attitudes[joint.parent], joint.pose.xyz))
    return offset
