"""Read the joints of an SDF, and make those of URDF from them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.importers.attitudes import rotate_vector, rotation_from_roll_pitch_yaw
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.sdf.frames import (
    MODEL,
    NO_POSE,
    WORLD,
    FrameTree,
    invert_pose,
)
from heuncli.scene.importers.sdf.values import read_child_flag, read_child_number, read_child_word, read_values
from heuncli.scene.importers.urdf.document import (
    NO_LIMIT,
    X_AXIS,
    LinkPose,
    LoopJoint,
    Mimic,
    UrdfJoint,
    UrdfLink,
    make_massless_link,
)
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

KINDS = ("revolute", "continuous", "prismatic", "fixed", "ball", "universal", "revolute2")
KINDS_OF_TWO_AXES = ("universal", "revolute2")  # the first axis is fixed in the parent, the second in the child
KIND_HINTS = {
    "screw": "write a joint of type prismatic, import, and add a coupling of type screw to the spec",
    "gearbox": "write a joint of type revolute, import, and add a coupling of type ratio to the spec",
}
JOINT_NOISE = ("sensor", "physics", "plugin")
AXIS_PARTS = ("xyz", "limit", "dynamics", "mimic", "use_parent_model_frame", "initial_position")
LIMIT_PARTS = ("lower", "upper", "effort", "velocity", "stiffness", "dissipation")
DYNAMICS_PARTS = ("damping", "friction", "spring_stiffness", "spring_reference")
UNLIMITED_WORDS = ("inf", "+inf", "-inf", "infinity", "-infinity")


class JointAxis(NamedTuple):
    """What stands in the <axis> of a joint.

    direction: in the axes of the frame whose scoped name is `frame`, of any length
    limits: lower and upper limit [rad or m], or None
    damping, friction, stiffness: [N m s/rad, N m, N m/rad] or [N s/m, N, N/m]
    reference: position where the spring is relaxed [rad or m]
    """

    direction: Vec
    frame: str
    limits: tuple[float, float] | None
    effort: float | None
    mimic: Mimic | None
    damping: float
    friction: float
    stiffness: float
    reference: float


NO_AXIS = JointAxis((0.0, 0.0, 1.0), "", None, None, None, 0.0, 0.0, 0.0, 0.0)  # of a joint that is fixed or a ball


class SdfJoint(NamedTuple):
    """A joint as the file has it. Its ends are scoped names of frames.

    second_axis: of a joint of two axes, which turn one after the other
    """

    name: str
    element: XmlElement
    kind: str
    parent: str
    child: str
    axis: JointAxis
    second_axis: JointAxis | None = None

    @property
    def path(self) -> str:
        return f"joint {self.name}"

    @property
    def ends(self) -> tuple[tuple[str, str], tuple[str, str]]:
        """The two ends, each with its tag."""
        return (self.parent, "parent"), (self.child, "child")


def read_joint(
    element: XmlElement, scope: str, has_model_axes: bool, fields: UrdfFields, ignored_tags: Counter[str]
) -> SdfJoint | None:
    """Read a joint; None, and problems, if something in it is wrong.

    has_model_axes: whether axes are along the model's frame where nothing else is said, as up to SDF 1.4
    """
    name = fields.read_word(element, "name", "joint")
    path = f"joint {scope}{name}" if name is not None else "joint"
    kind = fields.read_word(element, "type", path)
    if kind is not None and kind not in KINDS:
        hint = KIND_HINTS.get(kind, f"known: {', '.join(KINDS)}")
        fields.report("import-joint", element, path, f"a joint of type '{kind}' cannot be read", hint)
        kind = None
    for part in element.children:
        if part.tag in JOINT_NOISE or ":" in part.tag:
            ignored_tags[f"{part.tag} in joints"] += 1
    fields.report_unknown_parts(element, path, "pose", "parent", "child", "axis", *_list_axis_tags(kind), *JOINT_NOISE)
    ends = [read_child_word(element, tag, path, fields) for tag in ("parent", "child")]
    parent, child = (None if end is None else WORLD if end == WORLD else f"{scope}{end}" for end in ends)
    problem_count = len(fields.problems)
    own = f"{scope}{name}"
    axes: list[JointAxis] = []
    for tag in _list_axis_tags(kind):
        axis = fields.find_child(element, tag, path)
        if axis is None:
            hint = f"add <{tag}><xyz>0 0 1</xyz></{tag}>"
            fields.report("import-missing", element, path, f"<{tag}> is missing", hint)
        else:
            axes.append(_read_axis(axis, scope, own, has_model_axes, path, fields))
    if name is None or kind is None or parent is None or child is None or len(fields.problems) > problem_count:
        return None
    if not axes:
        return SdfJoint(own, element, kind, parent, child, NO_AXIS._replace(frame=own))
    if kind not in ("prismatic", "continuous"):
        kind = _find_kind_of_turning(axes[0])
    return SdfJoint(own, element, kind, parent, child, *axes)


def _list_axis_tags(kind: str | None) -> tuple[str, ...]:
    """List the tags of the axes that a kind of joint has."""
    if kind in (None, "fixed", "ball"):
        return ()
    return ("axis", "axis2") if kind in KINDS_OF_TWO_AXES else ("axis",)


def _find_kind_of_turning(axis: JointAxis) -> str:
    return "continuous" if axis.limits is None else "revolute"


def _read_axis(
    axis: XmlElement, scope: str, joint: str, has_model_axes: bool, path: str, fields: UrdfFields
) -> JointAxis:
    """Read the <axis> of a joint."""
    fields.report_unknown_parts(axis, path, *AXIS_PARTS)
    xyz_part, direction = fields.find_child(axis, "xyz", path), (0.0, 0.0, 1.0)
    frame = joint
    if xyz_part is not None:
        fields.report_unknown_attributes(xyz_part, path, "expressed_in")
        numbers = read_values(xyz_part, path, fields, 3, is_length=True)
        direction = direction if numbers is None else (numbers[0], numbers[1], numbers[2])
        expressed_in = xyz_part.attributes.get("expressed_in", "").strip()
        frame = joint if not expressed_in else WORLD if expressed_in == WORLD else f"{scope}{expressed_in}"
        if direction == ZERO:
            fields.report("import-joint", xyz_part, path, "the axis is 0 0 0", "give a direction, e.g. 0 0 1")
    if read_child_flag(axis, "use_parent_model_frame", path, fields, has_model_axes and frame == joint):
        frame = f"{scope}{MODEL}"
    _leave_out_initial_position(axis, path, fields)
    limits, effort = _read_limits(axis, path, fields)
    damping, friction, stiffness, reference = _read_dynamics(axis, path, fields)
    mimic = _read_mimic(axis, scope, path, fields)
    return JointAxis(direction, frame, limits, effort, mimic, damping, friction, stiffness, reference)


def _leave_out_initial_position(axis: XmlElement, path: str, fields: UrdfFields) -> None:
    for part in axis.find_all("initial_position"):
        if read_values(part, path, fields, 1) not in (None, [0.0]):
            message = "<initial_position> is left out"
            hint = "set the parameter of the joint in the spec"
            fields.left_out.append(fields.make_problem(LEFT_OUT_CODE, part, path, message, hint))


def _read_limits(axis: XmlElement, path: str, fields: UrdfFields) -> tuple[tuple[float, float] | None, float | None]:
    """Read the limits, None where neither bounds the motion, and the effort."""
    part = fields.find_child(axis, "limit", path)
    if part is None:
        return None, None
    fields.report_unknown_parts(part, path, *LIMIT_PARTS)
    bounds = [_read_bound(part, tag, path, fields) for tag in ("lower", "upper", "effort")]
    lower, upper, effort = bounds
    effort = None if effort is None or effort < 0.0 else effort
    if lower is None and upper is None:
        return None, effort
    if lower is None or upper is None:
        message = "a limit on one side only is left out"
        fields.left_out.append(fields.make_problem(LEFT_OUT_CODE, part, path, message, "add a stop to the spec"))
        return None, effort
    return (lower, upper), effort


def _read_bound(part: XmlElement, tag: str, path: str, fields: UrdfFields) -> float | None:
    found = part.find_all(tag)
    if len(found) == 1 and found[0].text.lower() in UNLIMITED_WORDS:
        return None
    value = read_child_number(part, tag, path, fields, None) if found else None
    return None if value is None or abs(value) >= NO_LIMIT else value


def _read_dynamics(axis: XmlElement, path: str, fields: UrdfFields) -> tuple[float, float, float, float]:
    """Read the damping, the friction, and the stiffness of a spring with the position where it is relaxed."""
    part = fields.find_child(axis, "dynamics", path)
    if part is None:
        return 0.0, 0.0, 0.0, 0.0
    fields.report_unknown_parts(part, path, *DYNAMICS_PARTS)
    values = [read_child_number(part, tag, path, fields, 0.0) for tag in DYNAMICS_PARTS]
    for tag, value in zip(DYNAMICS_PARTS[:3], values, strict=False):
        if value is not None and value < 0.0:
            fields.report("import-joint", part, path, f"{tag} is {value:g}", "give a value of 0 or above")
    damping, friction, stiffness, reference = (value or 0.0 for value in values)
    return damping, friction, stiffness, reference


def _read_mimic(axis: XmlElement, scope: str, path: str, fields: UrdfFields) -> Mimic | None:
    """Read what a joint follows: position = multiplier (position of the leader - reference) + offset."""
    part = fields.find_child(axis, "mimic", path)
    if part is None:
        return None
    fields.report_unknown_parts(part, path, "multiplier", "offset", "reference")
    joint = fields.read_word(part, "joint", path)
    if part.attributes.get("axis", "axis") != "axis":
        fields.report("import-mimic", part, path, "it follows the second axis of a joint", "joints have one axis here")
    multiplier = read_child_number(part, "multiplier", path, fields, 1.0)
    offset = read_child_number(part, "offset", path, fields, 0.0)
    reference = read_child_number(part, "reference", path, fields, 0.0)
    if joint is None or multiplier is None or offset is None or reference is None:
        return None
    return Mimic(part, f"{scope}{joint}", multiplier, offset - multiplier * reference)


def make_joints(
    joints: list[SdfJoint], links: dict[str, UrdfLink], frames: FrameTree, model: XmlElement
) -> tuple[dict[str, UrdfJoint], tuple[LoopJoint, ...]]:
    """Make the joints of URDF in the order of the file, and those that close loops of the others. The links without
    mass that they need are added to `links`: the world, and the frames, which are fixed to what they are attached to,
    and so become points.
    """
    fields, urdf_joints, loop_joints = frames.fields, dict[str, UrdfJoint](), list[LoopJoint]()
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
        elif name in frame_names and (link := frames.find_link(name, link_names)) not in (None, WORLD):
            attached_to = frame.attached_to if frame.attached_to in frame_names else link
            assert attached_to is not None
            links[name] = make_massless_link(name, frame.element)
            pose = frames.compute_pose(name, attached_to)
            mount = frames.choose_name(f"{name}_mount")
            urdf_joints[mount] = UrdfJoint(mount, frame.element, "fixed", attached_to, name, pose, X_AXIS)
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


def _turn_axis(axis: JointAxis, joint: str, frames: FrameTree) -> Vec:
    """Return an axis of a joint in the joint's own frame."""
    turn = frames.compute_pose(axis.frame, joint)
    if turn.rpy == ZERO:
        return axis.direction
    return rotate_vector(rotation_from_roll_pitch_yaw(turn.rpy), axis.direction)


def _make_urdf_joint(joint: SdfJoint, parent: str, child: str, pose: LinkPose, frames: FrameTree) -> UrdfJoint:
    part = joint.axis
    return UrdfJoint(
        joint.name, joint.element, joint.kind, parent, child, pose, _turn_axis(part, joint.name, frames), part.limits,
        part.effort, part.mimic, part.damping, part.friction, part.stiffness, part.reference,
    )  # fmt: skip


def _make_loop_joint(joint: SdfJoint, parent: str, child: str, frames: FrameTree) -> LoopJoint:
    if joint.second_axis is not None:
        message, hint = "a joint of two axes closes a loop", "exchange it with another joint of the loop in the file"
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
    is_at_child = in_child == NO_POSE or joint.kind == "fixed"
    in_parent = frames.compute_pose(child if is_at_child else joint.name, parent)
    own_child = child
    if not is_at_child:
        own_child = frames.choose_name(f"{joint.name}_frame")
        links[own_child] = make_massless_link(own_child, joint.element)
        name = frames.choose_name(f"{joint.name}_mount")
        urdf_joints[name] = UrdfJoint(name, joint.element, "fixed", own_child, child, invert_pose(in_child), X_AXIS)
    if joint.second_axis is None:
        urdf_joints[joint.name] = _make_urdf_joint(joint, parent, own_child, in_parent, frames)
        return
    cross = frames.choose_name(f"{joint.name}_cross")
    links[cross] = make_massless_link(cross, joint.element)
    urdf_joints[joint.name] = _make_urdf_joint(joint, parent, cross, in_parent, frames)
    second = joint._replace(axis=joint.second_axis, kind=_find_kind_of_turning(joint.second_axis))
    name = frames.choose_name(f"{joint.name}_2")
    urdf_joints[name] = replace(_make_urdf_joint(second, cross, own_child, NO_POSE, frames), name=name)
