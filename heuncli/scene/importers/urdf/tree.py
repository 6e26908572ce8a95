"""Join the links and joints of a URDF to one tree: every link except the root is the child of one joint."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words, suggest
from heuncli.scene.importers.urdf.document import Mimic, Robot, UrdfJoint, UrdfLink
from heuncli.scene.importers.urdf.fields import UrdfFields


class MimicRelation(NamedTuple):
    """The relation that a joint follows: its position is multiplier * that of the leader + offset."""

    leader: UrdfJoint
    multiplier: float
    offset: float


class LinkTree(NamedTuple):
    """links: from the root outward, parents before their children
    parent_joints: by link name, the joint that carries the link; the root has none
    leaders: by joint name, the leader at the end of its mimic chain
    """

    links: list[UrdfLink]
    parent_joints: dict[str, UrdfJoint]
    leaders: dict[str, MimicRelation]

    @property
    def root(self) -> UrdfLink:
        return self.links[0]


def build_tree(robot: Robot, fields: UrdfFields) -> LinkTree | None:
    """Build the tree; None, and problems, if links and joints form none."""
    problem_count = len(fields.problems)
    parent_joints = _find_parent_joints(robot, fields)
    if not robot.links:
        if not fields.problems:
            fields.report("import-tree", robot.element, "", "the robot has no links", "is it the right file?")
        return None
    if len(fields.problems) > problem_count or not robot.is_complete:
        return None
    roots = [link for name, link in robot.links.items() if name not in parent_joints]
    if len(roots) > 1:
        names = list_words([link.name for link in roots[1:]])
        message = f"{len(roots)} links have no parent, but only one may be the root: {roots[0].name}, {names}"
        hint = f'connect them by a joint of type fixed, or delete unused links: <parent link="{roots[0].name}"/>'
        fields.report("import-tree", roots[1].element, roots[1].path, message, hint)
    order = _order_outward(robot, parent_joints, roots)
    unreached = [link for name, link in robot.links.items() if name not in order]
    if unreached:
        _report_cycle(unreached[0], parent_joints, fields)
    leaders = _resolve_mimics(robot, fields)
    return LinkTree([*order.values()], parent_joints, leaders) if len(fields.problems) == problem_count else None


def _find_parent_joints(robot: Robot, fields: UrdfFields) -> dict[str, UrdfJoint]:
    """Find the joint of which each link is the child. Ends that are no link, and second parents, are problems."""
    parent_joints: dict[str, UrdfJoint] = {}
    for joint in robot.joints.values():
        ends = (("parent", joint.parent), ("child", joint.child))
        for tag, name in ends:
            if name not in robot.links and robot.is_complete:
                hint = suggest(name, robot.links, "links")
                fields.report("import-tree", joint.element, joint.path, f"its {tag} '{name}' is not a link", hint)
        first = parent_joints.setdefault(joint.child, joint)
        if first is not joint and joint.child in robot.links:
            message = f"the link {joint.child} has two parents: it is also the child of joint {first.name}"
            hint = "URDF has no loops: cut the loop, and close it in the spec by a joint"
            fields.report("import-tree", joint.element, joint.path, message, hint)
    return parent_joints


def _order_outward(robot: Robot, parent_joints: dict[str, UrdfJoint], roots: Iterable[UrdfLink]) -> dict[str, UrdfLink]:
    """List the links that are reached from the roots, each after its parent."""
    children: dict[str, list[str]] = {}
    for name, joint in parent_joints.items():
        children.setdefault(joint.parent, []).append(name)
    order = {link.name: link for link in roots}
    queue = list(order)
    for name in queue:  # the list grows during the loop
        for child in children.get(name, ()):
            order[child] = robot.links[child]
            queue.append(child)
    return order


def _report_cycle(start: UrdfLink, parent_joints: dict[str, UrdfJoint], fields: UrdfFields) -> None:
    """Report a cycle, found by walking from child to parent from a link that no root reaches."""
    seen: dict[str, UrdfJoint] = {}
    name = start.name
    while name not in seen:
        seen[name] = parent_joints[name]
        name = parent_joints[name].parent
    names = list(seen)
    cycle = [*reversed(names[names.index(name) :])]
    joint = seen[name]
    message = f"the links form a loop: {list_words([name, *cycle])}"
    hint = "one link must not depend on the others: cut the loop, and close it in the spec by a joint"
    fields.report("import-tree", joint.element, joint.path, message, hint)


def _resolve_mimics(robot: Robot, fields: UrdfFields) -> dict[str, MimicRelation]:
    """Find the leader at the end of the mimic chain of each joint. Chains may have any length; each is walked once."""
    resolved: dict[str, MimicRelation | None] = {}
    for joint in robot.joints.values():
        chain: dict[str, UrdfJoint] = {}
        current: UrdfJoint | None = joint
        while (
            current is not None
            and current.mimic is not None
            and current.name not in resolved
            and current.name not in chain
        ):
            chain[current.name] = current
            current = _find_leader(current, current.mimic, robot, fields)
        relation = (
            None
            if current is None
            else resolved.get(current.name)
            if current.mimic
            else MimicRelation(current, 1.0, 0.0)
        )
        if current is not None and current.mimic is not None and current.name in chain:
            message = "it follows itself" + (
                "" if current.mimic.joint == current.name else f", through {list_words([*chain])}"
            )
            fields.report(
                "import-mimic",
                current.mimic.element,
                current.path,
                message,
                "one joint of the chain must not follow another",
            )
        for name, follower in reversed(chain.items()):
            mimic = follower.mimic
            if relation is not None and mimic is not None:
                relation = MimicRelation(
                    relation.leader,
                    mimic.multiplier * relation.multiplier,
                    mimic.multiplier * relation.offset + mimic.offset,
                )
            resolved[name] = relation
    return {name: relation for name, relation in resolved.items() if relation is not None}


def _find_leader(joint: UrdfJoint, mimic: Mimic, robot: Robot, fields: UrdfFields) -> UrdfJoint | None:
    """Find the joint that a mimic names; None, and a problem, if there is none or it does not have exactly one
    coordinate.
    """
    leader = robot.joints.get(mimic.joint)
    if leader is None:
        hint = suggest(mimic.joint, robot.joints, "joints")
        fields.report(
            "import-mimic", mimic.element, joint.path, f"it follows '{mimic.joint}', which is not a joint", hint
        )
        return None
    unsuitable = next((one for one in (joint, leader) if not one.has_one_coordinate), None)
    if unsuitable is not None:
        message = f"it follows {leader.name}, but {unsuitable.name} is {unsuitable.kind}: it has no single coordinate"
        hint = "only revolute, continuous and prismatic joints can follow and be followed"
        fields.report("import-mimic", mimic.element, joint.path, message, hint)
        return None
    return leader
