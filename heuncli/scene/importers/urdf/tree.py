"""Links and joints of a URDF as one tree: every link but the root is the child of one joint."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean, listed
from heuncli.scene.importers.urdf.document import Mimic, Robot, UrdfJoint, UrdfLink
from heuncli.scene.importers.urdf.fields import UrdfFields


class Followed(NamedTuple):
    """What a joint follows: its position is multiplier * that of the leader + offset."""

    leader: UrdfJoint
    multiplier: float
    offset: float


class LinkTree(NamedTuple):
    """Links from the root outward, parents before their children; above: the joint that carries a link, but the root's.

    followed: of every joint that follows another, by its name, what it follows in the end.
    """

    links: list[UrdfLink]
    above: dict[str, UrdfJoint]
    followed: dict[str, Followed]

    @property
    def root(self) -> UrdfLink:
        return self.links[0]


def tree_of(robot: Robot, fields: UrdfFields) -> LinkTree | None:
    """The tree; None, and problems, where links and joints make none."""
    before = len(fields.problems)
    above = _carried(robot, fields)
    if not robot.links:
        if not fields.problems:
            fields.report("import-tree", robot.element, "", "the robot has no links", "is it the right file?")
        return None
    if len(fields.problems) > before or not robot.whole:
        return None
    roots = [link for name, link in robot.links.items() if name not in above]
    if len(roots) > 1:
        names = listed([link.name for link in roots[1:]])
        message = f"{len(roots)} links are nobody's child: {roots[0].name}, {names}"
        hint = f'join them by a joint of type fixed, or delete what is not used: <parent link="{roots[0].name}"/>'
        fields.report("import-tree", roots[1].element, roots[1].path, message, hint)
    order = _outward(robot, above, roots)
    left = [link for name, link in robot.links.items() if name not in order]
    if left:
        _report_circle(left[0], above, fields)
    followed = _followed(robot, fields)
    return LinkTree([*order.values()], above, followed) if len(fields.problems) == before else None


def _carried(robot: Robot, fields: UrdfFields) -> dict[str, UrdfJoint]:
    """The joint of which each link is the child; what leads to no link, and second parents, are problems."""
    above: dict[str, UrdfJoint] = {}
    for joint in robot.joints.values():
        ends = (("parent", joint.parent), ("child", joint.child))
        for tag, name in ends:
            if name not in robot.links and robot.whole:
                hint = did_you_mean(name, robot.links, "links")
                fields.report("import-tree", joint.element, joint.path, f"its {tag} '{name}' is no link", hint)
        first = above.setdefault(joint.child, joint)
        if first is not joint and joint.child in robot.links:
            message = f"the link {joint.child} has two parents: it is the child of {first.name}, too"
            hint = "URDF has no loops: cut the loop, and close it in the spec by a joint of heun"
            fields.report("import-tree", joint.element, joint.path, message, hint)
    return above


def _outward(robot: Robot, above: dict[str, UrdfJoint], roots: Iterable[UrdfLink]) -> dict[str, UrdfLink]:
    """The links that are reached from the roots, each behind its parent."""
    below: dict[str, list[str]] = {}
    for name, joint in above.items():
        below.setdefault(joint.parent, []).append(name)
    order = {link.name: link for link in roots}
    waiting = list(order)
    for name in waiting:  # which grows as it is walked
        for child in below.get(name, ()):
            order[child] = robot.links[child]
            waiting.append(child)
    return order


def _report_circle(start: UrdfLink, above: dict[str, UrdfJoint], fields: UrdfFields) -> None:
    """A circle that is come upon from a link that no root leads to, going from child to parent."""
    seen: dict[str, UrdfJoint] = {}
    name = start.name
    while name not in seen:
        seen[name] = above[name]
        name = above[name].parent
    names = list(seen)
    circle = [*reversed(names[names.index(name) :])]
    joint = seen[name]
    message = f"a circle of links: {listed([name, *circle])}"
    hint = "one link stands on none of the others: cut the circle, and close it in the spec by a joint of heun"
    fields.report("import-tree", joint.element, joint.path, message, hint)


def _followed(robot: Robot, fields: UrdfFields) -> dict[str, Followed]:
    """Of every joint that follows another the one that leads the chain; chains of any length, each walked once."""
    known: dict[str, Followed | None] = {}
    for joint in robot.joints.values():
        chain: dict[str, UrdfJoint] = {}
        at: UrdfJoint | None = joint
        while at is not None and at.mimic is not None and at.name not in known and at.name not in chain:
            chain[at.name] = at
            at = _leader(at, at.mimic, robot, fields)
        found = None if at is None else known.get(at.name) if at.mimic else Followed(at, 1.0, 0.0)
        if at is not None and at.mimic is not None and at.name in chain:
            message = "it follows itself" + ("" if at.mimic.joint == at.name else f", by {listed([*chain])}")
            fields.report("import-mimic", at.mimic.element, at.path, message, "one joint of a chain leads it")
        for name, follower in reversed(chain.items()):
            mimic = follower.mimic
            if found is not None and mimic is not None:
                found = Followed(
                    found.leader, mimic.multiplier * found.multiplier, mimic.multiplier * found.offset + mimic.offset
                )
            known[name] = found
    return {name: found for name, found in known.items() if found is not None}


def _leader(joint: UrdfJoint, mimic: Mimic, robot: Robot, fields: UrdfFields) -> UrdfJoint | None:
    """The joint that this one names; None, and a problem, where it is none or has no position of one number."""
    leader = robot.joints.get(mimic.joint)
    if leader is None:
        hint = did_you_mean(mimic.joint, robot.joints, "joints")
        fields.report("import-mimic", mimic.element, joint.path, f"it follows '{mimic.joint}', which is no joint", hint)
        return None
    wrong = next((one for one in (joint, leader) if not one.single), None)
    if wrong is not None:
        message = f"it follows {leader.name}, but {wrong.name} is {wrong.kind}: it has no position of one number"
        hint = "revolute, continuous and prismatic joints follow, and are followed"
        fields.report("import-mimic", mimic.element, joint.path, message, hint)
        return None
    return leader
