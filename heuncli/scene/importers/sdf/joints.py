"""Read the joints of an SDF."""

from __future__ import annotations

import math
from collections import Counter

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.sdf.frames import (
    MODEL,
    WORLD,
)
from heuncli.scene.importers.sdf.values import read_child_flag, read_child_number, read_child_word, read_values
from heuncli.scene.importers.urdf.document import (
    NO_LIMIT,
    Mimic,
)
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

SCREW, GEARBOX = "screw", "gearbox"
KINDS = ("revolute", "continuous", "prismatic", "fixed", "ball", "universal", "revolute2", SCREW, GEARBOX)
# Of a universal joint the first axis is fixed in the parent, the second in the child; of a gearbox they are those of
# the two joints that it couples.
KINDS_OF_TWO_AXES = ("universal", "revolute2", GEARBOX)
IGNORED_JOINT_TAGS = ("sensor", "physics", "plugin")
# Values of screws and gearboxes, which some programs write with every joint.
TAGS_OF_SOME_KINDS = ("thread_pitch", "screw_thread_pitch", "gearbox_ratio", "gearbox_reference_body")
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


class Gearbox(NamedTuple):
    """The relation theta_2 = -ratio theta_1 of a gearbox.

    reference: scoped name of the link from which both angles count: theta_1 to the parent about the first axis,
    theta_2 to the child about the second
    """

    ratio: float
    reference: str


class SdfJoint(NamedTuple):
    """A joint as the file has it. Its ends are scoped names of frames.

    second_axis: of a joint of two axes, which turn one after the other
    lead: of a screw, along the axis for each revolution about it [m]; otherwise 0
    gear: of a gearbox, which is no joint of the tree
    """

    name: str
    element: XmlElement
    kind: str
    parent: str
    child: str
    axis: JointAxis
    second_axis: JointAxis | None = None
    lead: float = 0.0
    gear: Gearbox | None = None

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
    fields: reads attributes and collects problems
    """
    name = fields.read_word(element, "name", "joint")
    path = f"joint {scope}{name}" if name is not None else "joint"
    kind = fields.read_word(element, "type", path)
    if kind is not None and kind not in KINDS:
        hint = f"known: {', '.join(KINDS)}"
        fields.report("import-joint", element, path, f"a joint of type '{kind}' cannot be read", hint)
        kind = None
    for part in element.children:
        if part.tag in IGNORED_JOINT_TAGS or ":" in part.tag:
            ignored_tags[f"{part.tag} in joints"] += 1
    known_tags = ("pose", "parent", "child", "axis", *_list_axis_tags(kind))
    fields.report_unknown_parts(element, path, *known_tags, *TAGS_OF_SOME_KINDS, *IGNORED_JOINT_TAGS)
    ends = [read_child_word(element, tag, path, fields) for tag in ("parent", "child")]
    parent, child = (None if end is None else _scope_name(end, scope) for end in ends)
    problem_count = len(fields.problems)
    scoped_name = f"{scope}{name}"
    axes: list[JointAxis] = []
    for tag in _list_axis_tags(kind):
        axis = fields.find_child(element, tag, path)
        if axis is None:
            hint = f"add <{tag}><xyz>0 0 1</xyz></{tag}>"
            fields.report("import-missing", element, path, f"<{tag}> is missing", hint)
        else:
            axes.append(_read_axis(axis, scope, scoped_name, has_model_axes, path, fields))
    lead = _read_lead(element, path, fields) if kind == SCREW else 0.0
    gear = _read_gear(element, scope, path, fields) if kind == GEARBOX else None
    if name is None or kind is None or parent is None or child is None or len(fields.problems) > problem_count:
        return None
    if not axes:
        return SdfJoint(scoped_name, element, kind, parent, child, NO_AXIS._replace(frame=scoped_name))
    # all others turn about their first axis; second_axis, lead and gear say what else they do
    if kind not in ("prismatic", "continuous"):
        kind = find_kind_of_turning(axes[0])
    second_axis = axes[1] if len(axes) > 1 else None
    return SdfJoint(scoped_name, element, kind, parent, child, axes[0], second_axis, lead, gear)


def _scope_name(name: str, scope: str) -> str:
    """Return the scoped name of a frame; the world has no scope."""
    return name if name == WORLD else f"{scope}{name}"


def _list_axis_tags(kind: str | None) -> tuple[str, ...]:
    """List the tags of the axes that a kind of joint has."""
    if kind in (None, "fixed", "ball"):
        return ()
    return ("axis", "axis2") if kind in KINDS_OF_TWO_AXES else ("axis",)


def _read_lead(element: XmlElement, path: str, fields: UrdfFields) -> float:
    """Read the travel of a screw for each revolution [m]: positive if it is right-handed.

    Up to SDF 1.9 it stands as <thread_pitch> in radians per metre, positive if it is left-handed.
    """
    lead = read_child_number(element, "screw_thread_pitch", path, fields, 0.0)
    turns = read_child_number(element, "thread_pitch", path, fields, 0.0)
    if lead == 0.0 and turns == 0.0:  # None: already reported
        hint = "write <screw_thread_pitch>, the metres for each revolution"
        fields.report("import-missing", element, path, "the lead of the screw is missing, or 0", hint)
    return lead or (-2.0 * math.pi / turns if turns else 0.0)


def _read_gear(element: XmlElement, scope: str, path: str, fields: UrdfFields) -> Gearbox | None:
    """Read the ratio of a gearbox, and from which link its angles count."""
    ratio = read_child_number(element, "gearbox_ratio", path, fields, 1.0)
    reference = read_child_word(element, "gearbox_reference_body", path, fields)
    if ratio == 0.0:
        fields.report("import-joint", element, path, "gearbox_ratio is 0", "give the ratio of the angles")
    return None if ratio is None or reference is None else Gearbox(ratio, f"{scope}{reference}")


def find_kind_of_turning(axis: JointAxis) -> str:
    """Return the kind of a joint that turns: revolute if it has limits."""
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
        frame = _scope_name(expressed_in, scope) if expressed_in else joint
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
    """Note an initial position other than 0 as left out."""
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
    """Read one bound; None if it is absent or unlimited."""
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
