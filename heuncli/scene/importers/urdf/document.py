"""The elements of a URDF -> its links and joints, as the file has them: names, poses, masses, not yet judged."""

from __future__ import annotations

from collections import Counter

from heuncli.base.errors import SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.base.records import record
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.importers.described import LEFT_OUT
from heuncli.scene.importers.urdf.fields import UrdfFields, alike
from heuncli.scene.importers.xml_elements import XACRO, XmlElement

MOST_LINKS = 100_000
KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
TURNS, SLIDES = ("revolute", "continuous"), ("prismatic",)
X_AXIS: Vec = (1.0, 0.0, 0.0)
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
# of a robot, a link, a joint: what says nothing of its mechanics
SILENT = ("material", "gazebo", "transmission", "sensor", "plugin", "ros2_control", "safety_controller")
LINK_PARTS = ("inertial", "visual", "collision")
INERTIAL_PARTS = ("origin", "mass", "inertia")
JOINT_PARTS = ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration")
OTHER_KINDS = "known: " + ", ".join(KINDS) + "; a ball joint is three revolute ones with links between"


class LinkPose(NamedTuple):
    """Where one frame stands in another: x, y, z [m]; roll, pitch, yaw [rad] about its fixed axes."""

    xyz: Vec = ZERO
    rpy: Vec = ZERO


class Inertial(NamedTuple):
    """Mass [kg]; pose of the axes of the inertia, whose origin is the centre of mass; ixx, iyy, izz, ixy, ixz, iyz."""

    element: XmlElement
    mass: float
    pose: LinkPose
    moments: tuple[float, ...]


@record
class UrdfLink:
    """A link; geometries: its visual and collision elements."""

    name: str
    element: XmlElement
    inertial: Inertial | None

    @property
    def path(self) -> str:
        return f"link {self.name}"


class Mimic(NamedTuple):
    """position = multiplier * position of the joint + offset."""

    element: XmlElement
    joint: str
    multiplier: float
    offset: float


@record
class UrdfJoint:
    """A joint: pose of the child's frame in the parent's at position 0; axis in the child's frame, of any length.

    limits: lower and upper, as far as given; damping: N m s/rad or N s/m.
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

    @property
    def path(self) -> str:
        return f"joint {self.name}"

    @property
    def movable(self) -> bool:
        return self.kind != "fixed"

    @property
    def single(self) -> bool:
        """Whether it has one coordinate."""
        return self.kind in (*TURNS, *SLIDES)


@record
class Robot:
    """All of a file, its links and joints in their order; silent: how often what says nothing of the mechanics.

    whole: none of them was left out for what is wrong with it, so that what is missing is missing in the file.
    """

    element: XmlElement
    title: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]
    silent: dict[str, int]
    whole: bool


def robot_of(root: XmlElement, fields: UrdfFields) -> Robot:
    """The robot of a file; what is wrong is added to the problems. Raises SpecError for what is no robot at all."""
    _require_plain(root, fields)
    links: dict[str, UrdfLink] = {}
    joints: dict[str, UrdfJoint] = {}
    silent: Counter[str] = Counter()
    for element in root.inner:
        if element.tag == "link":
            link = _link(element, fields, silent)
            if link is not None and _is_new(link, links, fields):
                links[link.name] = link
        elif element.tag == "joint":
            joint = _joint(element, fields)
            if joint is not None and _is_new(joint, joints, fields):
                joints[joint.name] = joint
        elif element.tag in SILENT:
            silent[element.tag] += 1
        else:
            message = f"<{element.tag}> is no part of a robot that is read"
            hint = did_you_mean(element.tag, ("link", "joint", *sorted(SILENT)), "parts")
            fields.report("import-part", element, f"robot {root.attributes.get('name', '')}".strip(), message, hint)
    whole = len(links) + len(joints) + sum(silent[tag] for tag in SILENT) == len(root.inner)
    return Robot(root, root.attributes.get("name", "").strip() or "robot", links, joints, dict(silent), whole)


def _require_plain(root: XmlElement, fields: UrdfFields) -> None:
    """Raise SpecError for macros that are not expanded, and for what is too large."""
    macro = next((element for element in root.inner if element.tag.startswith("xacro:")), None)
    if macro is not None:
        raise SpecError(fields.problem("import-xacro", macro, "", f"<{macro.tag}> is a macro of xacro", XACRO))
    links = len(root.all("link"))
    if links > MOST_LINKS:
        message = f"{links:,} links; at most {MOST_LINKS:,} are read"
        raise SpecError(fields.problem("too-large", root, "", message, "split the robot"))


def _is_new(found: UrdfLink | UrdfJoint, known: dict[str, UrdfLink] | dict[str, UrdfJoint], fields: UrdfFields) -> bool:
    first = known.get(found.name)
    if first is not None:
        message = f"the name is taken, first in line {first.element.line}"
        fields.report("import-twice", found.element, found.path, message, "give the two names of their own")
    return first is None


def _link(element: XmlElement, fields: UrdfFields, silent: Counter[str]) -> UrdfLink | None:
    name = fields.word(element, "name", "link")
    if name is None:
        return None
    others = [part.tag for part in element.inner if part.tag not in LINK_PARTS]
    meant = dict(alike(dict.fromkeys([part.tag for part in element.inner]), LINK_PARTS))
    for part in element.inner:
        if part.tag in meant:
            message = f"<link> has a part <{part.tag}>, which is not read"
            fields.report("import-part", part, f"link {name}", message, f"did you mean {meant[part.tag]}?")
    silent.update(f"{tag} in links" for tag in others if tag not in meant)
    inertial = fields.one(element, "inertial", f"link {name}")
    return UrdfLink(name, element, None if inertial is None else _inertial(inertial, f"link {name}", fields))


def _inertial(element: XmlElement, path: str, fields: UrdfFields) -> Inertial | None:
    """None where something of it is wrong, which is then a problem."""
    fields.known_parts(element, path, *INERTIAL_PARTS)
    parts = {tag: fields.one(element, tag, path) for tag in ("mass", "inertia")}
    for tag, part in parts.items():
        if part is None:
            hint = "mass and inertia stand in it; a frame without mass has no <inertial>"
            fields.report("import-missing", element, path, f"<inertial> has no <{tag}>", hint)
    pose = pose_of(element, path, fields)
    mass_part, inertia_part = parts["mass"], parts["inertia"]
    if mass_part is None or inertia_part is None:
        return None
    fields.known(mass_part, path, "value")
    fields.known(inertia_part, path, *MOMENTS)
    mass = fields.number(mass_part, "value", path)
    moments = [fields.number(inertia_part, name, path) for name in MOMENTS]
    if mass is None or pose is None or None in moments:
        return None
    return Inertial(inertia_part, mass, pose, tuple(value for value in moments if value is not None))


def pose_of(element: XmlElement, path: str, fields: UrdfFields) -> LinkPose | None:
    """The pose of its <origin>; None where it is wrong."""
    origin = fields.one(element, "origin", path)
    if origin is not None:
        fields.known(origin, path, "xyz", "rpy")
    xyz, rpy = (fields.vector(origin, name, path, ZERO) for name in ("xyz", "rpy"))
    return None if xyz is None or rpy is None else LinkPose(xyz, fields.angles(rpy, path))


def _joint(element: XmlElement, fields: UrdfFields) -> UrdfJoint | None:
    name = fields.word(element, "name", "joint")
    path = f"joint {name}" if name is not None else "joint"
    fields.known_parts(element, path, *JOINT_PARTS, *SILENT)
    kind = fields.word(element, "type", path)
    if kind is not None and kind not in KINDS:
        fields.report("import-joint", element, path, f"'{kind}' is not a type of joint in URDF", OTHER_KINDS)
        kind = None
    ends = [_end(element, tag, path, fields) for tag in ("parent", "child")]
    pose = pose_of(element, path, fields)
    axis_part = fields.one(element, "axis", path)
    if axis_part is not None:
        fields.known(axis_part, path, "xyz")
        fields.word(axis_part, "xyz", path)
    axis = fields.vector(axis_part, "xyz", path, X_AXIS)
    if axis == ZERO and kind not in (None, "fixed", "floating"):
        fields.report("import-joint", axis_part or element, path, "the axis is 0 0 0", "it needs a direction: 0 0 1")
    mimic = _mimic(element, path, fields, kind)
    limits, effort = _limits(element, path, fields)
    damping, friction = _dynamics(element, path, fields)
    parent, child = ends
    if name is None or kind is None or parent is None or child is None or pose is None or axis is None:
        return None
    return UrdfJoint(name, element, kind, parent, child, pose, axis, limits, effort, mimic, damping, friction)


def _end(element: XmlElement, tag: str, path: str, fields: UrdfFields) -> str | None:
    part = fields.one(element, tag, path)
    if part is None:
        fields.report("import-missing", element, path, f"<{tag}> is missing", f'as <{tag} link="..."/>')
        return None
    return fields.word(part, "link", path)


def _mimic(element: XmlElement, path: str, fields: UrdfFields, kind: str | None) -> Mimic | None:
    part = fields.one(element, "mimic", path)
    if part is None:
        return None
    if kind == "fixed":
        message = "it is fixed, and what it is to follow is left out"
        fields.left_out.append(fields.problem(LEFT_OUT, part, path, message, "delete the <mimic>"))
        return None
    fields.known(part, path, "joint", "multiplier", "offset")
    joint = fields.word(part, "joint", path)
    multiplier = fields.number(part, "multiplier", path, 1.0)
    offset = fields.number(part, "offset", path, 0.0)
    return None if joint is None or multiplier is None or offset is None else Mimic(part, joint, multiplier, offset)


def _limits(element: XmlElement, path: str, fields: UrdfFields) -> tuple[tuple[float, float] | None, float | None]:
    """Lower and upper limit, 0 where one alone is left out, and the effort."""
    part = fields.one(element, "limit", path)
    if part is None:
        return None, None
    fields.misspelt(part, path, "lower", "upper", "effort", "velocity")
    effort = fields.number(part, "effort", path) if "effort" in part.attributes else None
    if "lower" not in part.attributes and "upper" not in part.attributes:
        return None, effort
    lower, upper = (fields.number(part, name, path, 0.0) for name in ("lower", "upper"))
    return (None if lower is None or upper is None else (lower, upper)), effort


def _dynamics(element: XmlElement, path: str, fields: UrdfFields) -> tuple[float, float]:
    part = fields.one(element, "dynamics", path)
    if part is None:
        return 0.0, 0.0
    fields.misspelt(part, path, "damping", "friction")
    damping, friction = (fields.number(part, name, path, 0.0) for name in ("damping", "friction"))
    for name, value in (("damping", damping), ("friction", friction)):
        if value is not None and value < 0.0:
            fields.report("import-joint", part, path, f"{name} is {value:g}", "it resists with a number above 0")
    return damping or 0.0, friction or 0.0
