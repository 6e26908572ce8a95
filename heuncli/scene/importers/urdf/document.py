"""Read the elements of a URDF into links and joints, as the file has them: names, poses, masses, not yet validated."""

from __future__ import annotations

from collections import Counter

from heuncli.base.errors import SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.importers.attitudes import rotate_vector, rotation_from_roll_pitch_yaw
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.urdf.fields import UrdfFields, find_misspelt
from heuncli.scene.importers.urdf.foreign_parts import find_mechanical_hint, leave_out_part
from heuncli.scene.importers.xml_elements import XmlElement, make_xacro_hint

MAX_LINKS = 100_000
WORLD_LINK = "world"  # a root link of this name is the ground
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
ROTARY_TYPES, SLIDING_TYPES = ("revolute", "continuous"), ("prismatic",)
X_AXIS: Vec = (1.0, 0.0, 0.0)
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
LOWER_MOMENTS = ("iyx", "izx", "izy")  # the products once more, as some programs write them
LINK_PARTS = ("inertial", "visual", "collision")
PLACES_IN_LINKS = ("origin", "pose", "frame", "axis")  # a link has none: its joint places it
INERTIAL_PARTS = ("origin", "mass", "inertia")
NO_LIMIT = 1e15  # [m, rad] SDF writes 1e16 for a limit that is none, and so does heun in a URDF, whose slides need one
JOINT_PARTS = ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration")
OLD_DYNAMICS = "joint_properties"  # the name of <dynamics> before ROS Fuerte
JOINT_TYPE_HINT = (
    "known: " + ", ".join(JOINT_TYPES) + "; for a ball joint use three revolute joints with links between them"
)


class LinkPose(NamedTuple):
    """The pose of one frame in another: x, y, z [m]; roll, pitch, yaw [rad] about its fixed axes."""

    xyz: Vec = ZERO
    rpy: Vec = ZERO


class Inertial(NamedTuple):
    """mass: [kg]
    pose: of the axes of the inertia, whose origin is the centre of mass
    moments: ixx, iyy, izz, ixy, ixz, iyz [kg m^2]; None if the file has none
    has_center: whether the file gives the centre of mass, which otherwise is the link's origin
    """

    element: XmlElement
    mass: float
    pose: LinkPose
    moments: tuple[float, ...] | None
    has_center: bool


@record
class UrdfLink:
    """A link; its visual and collision elements are read from `element` when they are needed."""

    name: str
    element: XmlElement
    inertial: Inertial | None

    @property
    def path(self) -> str:
        return f"link {self.name}"


class Mimic(NamedTuple):
    """The relation position = multiplier * position of the named joint + offset."""

    element: XmlElement
    joint: str
    multiplier: float
    offset: float


@record
class UrdfJoint:
    """A joint: the pose of the child's frame in the parent's at position 0, and the axis in the child's frame, of any
    length.

    limits: lower and upper limit [rad or m], or None
    damping: [N m s/rad] or [N s/m]
    stiffness: of a spring in it [N m/rad] or [N/m], relaxed at the position `reference` [rad] or [m]
    """

    name: str
    element: XmlElement
    kind: str
    parent: str
    child: str
    pose: LinkPose
    axis: Vec
    limits: tuple[float, float] | None = None
    effort: float | None = None
    mimic: Mimic | None = None
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    reference: float = 0.0

    @property
    def path(self) -> str:
        return f"joint {self.name}"

    @property
    def is_movable(self) -> bool:
        return self.kind != "fixed"

    @property
    def has_one_coordinate(self) -> bool:
        """Return whether the joint has exactly one coordinate."""
        return self.kind in (*ROTARY_TYPES, *SLIDING_TYPES)


def make_massless_link(name: str, element: XmlElement) -> UrdfLink:
    """Make a link without mass and shapes that stands at the place of an element of the file."""
    return UrdfLink(name, XmlElement("link", {}, [], element.line, element.column), None)


class LoopJoint(NamedTuple):
    """A joint that closes a loop: each of its ends is carried by another joint, or is the root.

    joint: with its pose in the parent
    pose_in_child: of the same frame in the child, with all joints at 0
    """

    joint: UrdfJoint
    pose_in_child: LinkPose


@record
class Robot:
    """All links and joints of a file, in order.

    loop_joints: those that close loops, of SDF; `joints` has the others
    ignored_tags: how often each tag without mechanical meaning occurs, in the order of the file
    is_complete: whether no link or joint was dropped for an error, so that whatever is missing is missing in the file
    """

    element: XmlElement
    title: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]
    ignored_tags: dict[str, int]
    is_complete: bool
    loop_joints: tuple[LoopJoint, ...] = ()


def read_robot(root: XmlElement, fields: UrdfFields) -> Robot:
    """Read the robot of a file; errors are added to the problems. Raises SpecError if it is no robot at all."""
    _require_readable(root, fields)
    links: dict[str, UrdfLink] = {}
    joints: dict[str, UrdfJoint] = {}
    ignored_tags: Counter[str] = Counter()
    path = f"robot {root.attributes.get('name', '')}".strip()
    left_out_count = 0
    for element in root.children:
        if element.tag == "link":
            link = _read_link(element, fields, ignored_tags)
            if link is not None and _check_is_new(link, links, fields):
                links[link.name] = link
        elif element.tag == "joint":
            joint = _read_joint(element, fields, ignored_tags)
            if joint is not None and _check_is_new(joint, joints, fields):
                joints[joint.name] = joint
        elif leave_out_part(element, path, ("link", "joint"), fields, ignored_tags, ""):
            left_out_count += 1
    is_complete = len(links) + len(joints) + left_out_count == len(root.children)
    if WORLD_LINK not in links and any(joint.parent == WORLD_LINK for joint in joints.values()):
        links[WORLD_LINK] = make_massless_link(WORLD_LINK, root)  # Drake needs no such link
    return Robot(
        root, root.attributes.get("name", "").strip() or "robot", links, joints, dict(ignored_tags), is_complete
    )


def _require_readable(root: XmlElement, fields: UrdfFields) -> None:
    """Raise SpecError for macros that are not expanded, and for files that are too large."""
    prefixes = _find_macro_prefixes(root)
    is_macro_file = any(f"xmlns:{prefix}" in root.attributes for prefix in prefixes)
    for element in root.iter_all():
        if element.tag.partition(":")[0] in prefixes and ":" in element.tag:
            message = f"<{element.tag}> is a xacro macro"
        elif is_macro_file and any("${" in text or "$(" in text for text in element.attributes.values()):
            message = f"an attribute of <{element.tag}> is a xacro expression"
        else:
            continue
        raise SpecError(fields.make_problem("import-xacro", element, "", message, make_xacro_hint(fields.file)))
    links = len(root.find_all("link"))
    if links > MAX_LINKS:
        message = f"{links:,} links; at most {MAX_LINKS:,} are allowed"
        raise SpecError(fields.make_problem("too-large", root, "", message, "split the robot"))


def _find_macro_prefixes(root: XmlElement) -> set[str]:
    """Find the prefixes that stand for xacro: its own, and those that the root declares for its address."""
    declared = {name.partition(":")[2] for name, text in root.attributes.items() if "xacro" in text}
    return {"xacro", *declared} - {""}


def _check_is_new(
    element: UrdfLink | UrdfJoint, earlier: dict[str, UrdfLink] | dict[str, UrdfJoint], fields: UrdfFields
) -> bool:
    previous = earlier.get(element.name)
    if previous is not None:
        message = f"the name is already used, first in line {previous.element.line}"
        fields.report("import-twice", element.element, element.path, message, "give each its own name")
    return previous is None


def _read_link(element: XmlElement, fields: UrdfFields, ignored_tags: Counter[str]) -> UrdfLink | None:
    name = fields.read_word(element, "name", "link")
    if name is None:
        return None
    suggestions = dict(find_misspelt(dict.fromkeys([part.tag for part in element.children]), LINK_PARTS))
    for part in element.children:
        if part.tag in suggestions:
            message = f"<link> has an unknown part <{part.tag}>"
            fields.report("import-part", part, f"link {name}", message, f"did you mean {suggestions[part.tag]}?")
        elif part.tag not in (*LINK_PARTS, *PLACES_IN_LINKS) and find_mechanical_hint(part.tag) is not None:
            leave_out_part(part, f"link {name}", LINK_PARTS, fields, ignored_tags, " in links")
        elif part.tag not in LINK_PARTS:
            ignored_tags[f"{part.tag} in links"] += 1
    inertial = fields.find_child(element, "inertial", f"link {name}")
    return UrdfLink(name, element, None if inertial is None else _read_inertial(inertial, f"link {name}", fields))


def _read_inertial(element: XmlElement, path: str, fields: UrdfFields) -> Inertial | None:
    """Read the inertial element. None if something in it is wrong, which is then a problem."""
    fields.report_unknown_parts(element, path, *INERTIAL_PARTS)
    parts = {tag: fields.find_child(element, tag, path) for tag in ("mass", "inertia")}
    pose = read_pose(element, path, fields)
    has_center = any("xyz" in origin.attributes for origin in element.find_all("origin"))
    mass_part, inertia_part = parts["mass"], parts["inertia"]
    if mass_part is None:
        hint = "give both mass and inertia; leave out <inertial> for a frame without mass"
        fields.report("import-missing", element, path, "<inertial> has no <mass>", hint)
        return None
    fields.report_unknown_attributes(mass_part, path, "value")
    mass = fields.read_number(mass_part, "value", path)
    if inertia_part is None:
        return None if mass is None or pose is None else Inertial(element, mass, pose, None, has_center)
    _report_unequal_halves(inertia_part, path, fields)
    fields.report_unknown_attributes(inertia_part, path, *MOMENTS, *LOWER_MOMENTS)
    moments = [fields.read_moment(inertia_part, name, path) for name in MOMENTS]
    if mass is None or pose is None or None in moments:
        return None
    return Inertial(inertia_part, mass, pose, tuple(value for value in moments if value is not None), has_center)


def _report_unequal_halves(inertia: XmlElement, path: str, fields: UrdfFields) -> None:
    """Report products of inertia that a file gives twice, above and below the diagonal, with two values."""
    for name in LOWER_MOMENTS:
        twin = f"i{name[2]}{name[1]}"
        if not {name, twin} <= inertia.attributes.keys():
            continue
        lower, upper = (fields.read_moment(inertia, one, path) for one in (name, twin))
        if lower is not None and upper is not None and lower != upper:
            message = f"{twin} is {upper:g}, but {name} is {lower:g}: a tensor of inertia is symmetric"
            fields.report("import-inertia", inertia, path, message, f"correct one of them, or delete {name}")


def read_pose(element: XmlElement, path: str, fields: UrdfFields) -> LinkPose | None:
    """Read the pose of the <origin>; None if it is wrong."""
    origin = fields.find_child(element, "origin", path)
    if origin is not None:
        fields.report_unknown_attributes(origin, path, "xyz", "rpy")
    xyz, rpy = (fields.read_vector(origin, name, path, ZERO) for name in ("xyz", "rpy"))
    return None if xyz is None or rpy is None else LinkPose(xyz, fields.read_angles(rpy, path))


def _read_joint(element: XmlElement, fields: UrdfFields, ignored_tags: Counter[str]) -> UrdfJoint | None:
    name = fields.read_word(element, "name", "joint")
    path = f"joint {name}" if name is not None else "joint"
    for part in element.children:
        if part.tag not in (*JOINT_PARTS, OLD_DYNAMICS):
            leave_out_part(part, path, JOINT_PARTS, fields, ignored_tags, " in joints")
    kind = fields.read_word(element, "type", path)
    if kind is not None and kind not in JOINT_TYPES:
        fields.report("import-joint", element, path, f"'{kind}' is not a type of joint in URDF", JOINT_TYPE_HINT)
        kind = None
    ends = [_read_end(element, tag, path, fields) for tag in ("parent", "child")]
    pose = read_pose(element, path, fields)
    axis = _read_axis(element, path, fields, kind)
    mimic = _read_mimic(element, path, fields, kind)
    limits, effort = _read_limits(element, path, fields)
    damping, friction = _read_dynamics(element, path, fields, ignored_tags)
    parent, child = ends
    if name is None or kind is None or parent is None or child is None or pose is None or axis is None:
        return None
    return UrdfJoint(name, element, kind, parent, child, pose, axis, limits, effort, mimic, damping, friction)


def _read_axis(element: XmlElement, path: str, fields: UrdfFields, kind: str | None) -> Vec | None:
    """Read the axis in the joint's frame, turned by its own rpy if it has one; None if it is wrong."""
    part = fields.find_child(element, "axis", path)
    if part is None:
        return X_AXIS
    fields.report_unknown_attributes(part, path, "xyz", "rpy")
    fields.read_word(part, "xyz", path)
    axis, rpy = fields.read_vector(part, "xyz", path, X_AXIS), fields.read_vector(part, "rpy", path, ZERO)
    if axis == ZERO and kind not in (None, "fixed", "floating"):
        fields.report("import-joint", part, path, "the axis is 0 0 0", "give a direction, e.g. 0 0 1")
    if axis is None or rpy is None or rpy == ZERO:
        return axis
    fields.turned_axes[path] = None
    return rotate_vector(rotation_from_roll_pitch_yaw(fields.read_angles(rpy, path)), axis)


def _read_end(element: XmlElement, tag: str, path: str, fields: UrdfFields) -> str | None:
    part = fields.find_child(element, tag, path)
    if part is None:
        fields.report("import-missing", element, path, f"<{tag}> is missing", f'add <{tag} link="..."/>')
        return None
    return fields.read_word(part, "link", path)


def _read_mimic(element: XmlElement, path: str, fields: UrdfFields, kind: str | None) -> Mimic | None:
    part = fields.find_child(element, "mimic", path)
    if part is None:
        return None
    if kind == "fixed":
        message = "the joint is fixed; its <mimic> is left out"
        fields.left_out.append(fields.make_problem(LEFT_OUT_CODE, part, path, message, "delete the <mimic>"))
        return None
    fields.report_unknown_attributes(part, path, "joint", "multiplier", "offset")
    joint = fields.read_word(part, "joint", path)
    multiplier = fields.read_number(part, "multiplier", path, 1.0)
    offset = fields.read_number(part, "offset", path, 0.0)
    return None if joint is None or multiplier is None or offset is None else Mimic(part, joint, multiplier, offset)


def _read_limits(element: XmlElement, path: str, fields: UrdfFields) -> tuple[tuple[float, float] | None, float | None]:
    """Read the lower and upper limit, 0 if only one is left out, and the effort."""
    part = fields.find_child(element, "limit", path)
    if part is None:
        return None, None
    fields.report_misspelt(part, path, "lower", "upper", "effort", "velocity")
    effort = fields.read_number(part, "effort", path) if "effort" in part.attributes else None
    if "lower" not in part.attributes and "upper" not in part.attributes:
        return None, effort
    lower, upper = (fields.read_number(part, name, path, 0.0) for name in ("lower", "upper"))
    if lower is not None and upper is not None and min(-lower, upper) >= NO_LIMIT:
        return None, effort
    return (None if lower is None or upper is None else (lower, upper)), effort


def _read_dynamics(
    element: XmlElement, path: str, fields: UrdfFields, ignored_tags: Counter[str]
) -> tuple[float, float]:
    """Read damping and friction from <dynamics>, or from <joint_properties>, which it was called before."""
    parts = [part for tag in ("dynamics", OLD_DYNAMICS) if (part := fields.find_child(element, tag, path)) is not None]
    values = [_read_damping(part, path, fields) for part in parts]
    if len(values) > 1:
        if values[0] != values[1] and any(values[1]):
            message = f"<{OLD_DYNAMICS}> is the old name of <dynamics>, and both have different numbers"
            fields.report("import-twice", parts[1], path, message, "keep one of them")
        ignored_tags[f"{OLD_DYNAMICS} beside dynamics"] += 1
    return values[0] if values else (0.0, 0.0)


def _read_damping(part: XmlElement, path: str, fields: UrdfFields) -> tuple[float, float]:
    fields.report_misspelt(part, path, "damping", "friction")
    damping, friction = (fields.read_number(part, name, path, 0.0) for name in ("damping", "friction"))
    for name, value in (("damping", damping), ("friction", friction)):
        if value is not None and value < 0.0:
            fields.report("import-joint", part, path, f"{name} is {value:g}", "give a value of 0 or above")
    return damping or 0.0, friction or 0.0
