"""Make the joints of a URDF, a tree and what closes its loops, from those of an SDF.

A joint of two axes becomes two with a link without mass between; so does a screw, whose second joint slides as far as
the first turns. A gearbox becomes a <mimic> of one of the two joints that it couples.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from heuncli.base.records import replace
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import are_parallel, unit_vector
from heuncli.scene.importers.attitudes import rotate_vector, rotation_from_roll_pitch_yaw
from heuncli.scene.importers.sdf.frames import NO_POSE, WORLD, FrameTree, invert_pose
from heuncli.scene.importers.sdf.joints import NO_AXIS, JointAxis, SdfJoint, find_kind_of_turning
from heuncli.scene.importers.urdf.document import (
    ROTARY_TYPES,
    X_AXIS,
    LinkPose,
    LoopJoint,
    Mimic,
    UrdfJoint,
    UrdfLink,
    make_massless_link,
)
from heuncli.scene.importers.xml_elements import XmlElement


def make_joints(
    joints: list[SdfJoint], links: dict[str, UrdfLink], frames: FrameTree, model: XmlElement
) -> tuple[dict[str, UrdfJoint], tuple[LoopJoint, ...]]:
    """Make the joints of URDF in the order of the file, and those that close loops of the others. The links without
    mass that they need are added to `links`: the world, and the frames, which are fixed to what they are attached to,
    and so become points.
    """
    fields, urdf_joints, loop_joints = frames.fields, dict[str, UrdfJoint](), list[LoopJoint]()
    gearboxes = [joint for joint in joints if joint.gear is not None]
    joints = [joint for joint in joints if joint.gear is None]
    frame_names = {name for name, frame in frames.frames.items() if frame.element.tag == "frame"}
    link_names = {*links, WORLD}
    by_name = {joint.name: joint for joint in joints}
    names_of_loop_joints = _find_loop_joints(joints, link_names, frames)
    for name, frame in frames.frames.items():
        if name in by_name:
            joint = by_name[name]
            parent, child = (_find_end(end, tag, link_names, frame_names, joint, frames) for end, tag in joint.ends)
            if parent is None or child is None:
                continue
            if child == WORLD:
                message, hint = "its child is the world", "exchange <parent> and <child>"
                fields.report("import-tree", joint.element, joint.path, message, hint)
            elif joint.axis.frame not in frames.frames:
                message = f"its axis is expressed in '{joint.axis.frame}', which is not there"
                fields.report(
                    "import-tree",
                    joint.element,
                    joint.path,
                    message,
                    suggest(joint.axis.frame, frames.frames, "frames"),
                )
            else:
                if parent == WORLD and WORLD not in links:
                    links[WORLD] = make_massless_link(WORLD, model)
                if name in names_of_loop_joints:
                    loop_joints.append(_make_loop_joint(joint, parent, child, frames))
                else:
                    _make_joint(joint, parent, child, links, urdf_joints, frames)
        # a frame becomes a link without mass, fixed to what it is attached to
        elif name in frame_names and (link := frames.find_link(name, link_names)) not in (None, WORLD):
            attached_to = frame.attached_to if frame.attached_to in frame_names else link
            assert attached_to is not None
            links[name] = make_massless_link(name, frame.element)
            pose = frames.compute_pose(name, attached_to)
            mount = frames.choose_name(f"{name}_mount")
            urdf_joints[mount] = UrdfJoint(mount, frame.element, "fixed", attached_to, name, pose, X_AXIS)
    if not fields.problems:
        for gearbox in gearboxes:
            _couple_by_gearbox(gearbox, joints, urdf_joints, link_names, frames)
    return urdf_joints, tuple(loop_joints)


def _find_loop_joints(joints: Iterable[SdfJoint], links: set[str], frames: FrameTree) -> set[str]:
    """Find the joints that close loops: those that a walk from the roots outward does not take, as it reached their
    child by another joint before. Roots are the links that no joint carries, and the first of a loop without one.
    """
    outward: dict[str, list[SdfJoint]] = {}
    carried: set[str] = set()
    for joint in joints:
        parent = frames.find_link(joint.parent, links)
        child = frames.find_link(joint.child, links)
        if parent is not None and child is not None:
            outward.setdefault(parent, []).append(joint)
            carried.add(child)
    names = [name for name in frames.frames if name in links]
    reached, found = set[str](), set[str]()
    for start in (*(name for name in names if name not in carried), *names):
        queue = [] if start in reached else [start]
        reached.update(queue)
        for name in queue:  # the list grows during the loop
            for joint in outward.get(name, ()):
                child = frames.find_link(joint.child, links)
                if child in reached:
                    found.add(joint.name)
                elif child is not None:
                    reached.add(child)
                    queue.append(child)
    return found


def _find_end(
    name: str, tag: str, link_names: set[str], frame_names: set[str], joint: SdfJoint, frames: FrameTree
) -> str | None:
    """Find the link, or for a parent the frame, that an end of a joint names; None, and a problem, if there is none."""
    link = frames.find_link(name, link_names)
    if link is None:
        hint = suggest(name, frames.frames, "frames")
        frames.fields.report("import-tree", joint.element, joint.path, f"its {tag} '{name}' is not there", hint)
    return name if tag == "parent" and name in frame_names and link not in (None, WORLD) else link


def _express_axis_in_joint(axis: JointAxis, joint: str, frames: FrameTree) -> Vec:
    """Return an axis of a joint in the joint's own frame."""
    pose = frames.compute_pose(axis.frame, joint)
    if pose.rpy == ZERO:
        return axis.direction
    return rotate_vector(rotation_from_roll_pitch_yaw(pose.rpy), axis.direction)


def _make_urdf_joint(joint: SdfJoint, parent: str, child: str, pose: LinkPose, frames: FrameTree) -> UrdfJoint:
    """Make a joint of URDF about the first axis of a joint of SDF."""
    part = joint.axis
    return UrdfJoint(
        joint.name, joint.element, joint.kind, parent, child, pose,
        _express_axis_in_joint(part, joint.name, frames), part.limits, part.effort,
        part.mimic, part.damping, part.friction, part.stiffness, part.reference,
    )  # fmt: skip


def _make_loop_joint(joint: SdfJoint, parent: str, child: str, frames: FrameTree) -> LoopJoint:
    """Make a joint that closes a loop; with a problem if it has more than one freedom to turn or slide."""
    if joint.second_axis is not None or joint.lead:
        kind = "screw" if joint.lead else "joint of two axes"
        message, hint = f"a {kind} closes a loop", "exchange it with another joint of the loop in the file"
        frames.fields.report("import-joint", joint.element, joint.path, message, hint)
    in_parent, in_child = (frames.compute_pose(joint.name, link) for link in (parent, child))
    return LoopJoint(_make_urdf_joint(joint, parent, child, in_parent, frames), in_child)


def _make_joint(
    joint: SdfJoint,
    parent: str,
    child: str,
    links: dict[str, UrdfLink],
    urdf_joints: dict[str, UrdfJoint],
    frames: FrameTree,
) -> None:
    """Make one joint: with a link without mass between its two axes, if it has two, and with a second joint that fixes
    the child to it where its pose differs from that of the child.
    """
    in_child = frames.compute_pose(joint.name, child)
    is_at_child = in_child == NO_POSE or joint.kind == "fixed"  # a fixed joint needs no frame of its own
    in_parent = frames.compute_pose(child if is_at_child else joint.name, parent)
    own_child = child
    if not is_at_child:
        own_child = frames.choose_name(f"{joint.name}_frame")
        links[own_child] = make_massless_link(own_child, joint.element)
        name = frames.choose_name(f"{joint.name}_mount")
        urdf_joints[name] = UrdfJoint(name, joint.element, "fixed", own_child, child, invert_pose(in_child), X_AXIS)
    if joint.second_axis is None and not joint.lead:
        urdf_joints[joint.name] = _make_urdf_joint(joint, parent, own_child, in_parent, frames)
        return
    cross = frames.choose_name(f"{joint.name}_cross")
    links[cross] = make_massless_link(cross, joint.element)
    urdf_joints[joint.name] = _make_urdf_joint(joint, parent, cross, in_parent, frames)
    # the second keeps the first one's name, by which its axis is turned, until it is made
    if joint.second_axis is not None:
        second = joint._replace(axis=joint.second_axis, kind=find_kind_of_turning(joint.second_axis))
    else:  # a screw: what turns is followed by what slides
        follows = Mimic(joint.element, joint.name, joint.lead / (2.0 * math.pi), 0.0)
        second = joint._replace(kind="prismatic", axis=NO_AXIS._replace(
            direction=joint.axis.direction, frame=joint.axis.frame, mimic=follows,
        ))  # fmt: skip
    name = frames.choose_name(f"{joint.name}_2")
    urdf_joints[name] = replace(_make_urdf_joint(second, cross, own_child, NO_POSE, frames), name=name)


# Gearboxes


def _couple_by_gearbox(
    gearbox: SdfJoint, joints: list[SdfJoint], urdf_joints: dict[str, UrdfJoint], links: set[str], frames: FrameTree
) -> None:
    """Let one of the two joints that a gearbox couples follow the other; a problem where there are no such joints."""
    gear = gearbox.gear
    assert gear is not None and gearbox.second_axis is not None
    turning = [joint for joint in joints if joint.name in urdf_joints and urdf_joints[joint.name].kind in ROTARY_TYPES]
    first, second = (
        _find_geared_joint(gear.reference, end, axis, turning, links, frames)
        for (end, _), axis in zip(gearbox.ends, (gearbox.axis, gearbox.second_axis), strict=True)
    )
    if first is None or second is None:
        message = "it couples no two joints that turn about its axes"
        hint = "parent and child each need a revolute joint with <gearbox_reference_body>, about <axis> and <axis2>"
        frames.fields.report("import-joint", gearbox.element, gearbox.path, message, hint)
        return
    (leader, leader_sign), (follower, sign) = first, second
    # theta_2 = -ratio theta_1; each sign turns a joint's position into its theta
    multiplier = -gear.ratio * leader_sign * sign
    if urdf_joints[follower].mimic is not None:
        leader, follower, multiplier = follower, leader, 1.0 / multiplier
    if urdf_joints[follower].mimic is not None or leader == follower:
        message, hint = "both joints that it couples follow others", "leave out the gearbox, or a <mimic>"
        frames.fields.report("import-mimic", gearbox.element, gearbox.path, message, hint)
        return
    mimic = Mimic(gearbox.element, leader, multiplier, 0.0)
    urdf_joints[follower] = replace(urdf_joints[follower], mimic=mimic)


def _find_geared_joint(
    reference: str, end: str, axis: JointAxis, turning: list[SdfJoint], links: set[str], frames: FrameTree
) -> tuple[str, float] | None:
    """Find the joint between a reference and another end that turns about an axis, and its sign in the angle from the
    reference to the end; None if there is none.
    """
    wanted_links = frames.find_link(reference, links), frames.find_link(end, links)
    for joint in turning:
        joined_links = frames.find_link(joint.parent, links), frames.find_link(joint.child, links)
        wanted, own = (unit_vector(_express_axis_in_joint(part, joint.name, frames)) for part in (axis, joint.axis))
        if joined_links in (wanted_links, wanted_links[::-1]) and are_parallel(wanted, own):
            cosine = sum(a * b for a, b in zip(wanted, own, strict=True))
            return joint.name, math.copysign(1.0, cosine) * (1.0 if joined_links == wanted_links else -1.0)
    return None
