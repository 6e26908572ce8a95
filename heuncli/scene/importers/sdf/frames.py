"""Resolve the poses of an SDF: each link, joint, frame and nested model has one, relative to another of them.

    X_AB = X_AC X_CB        X_AB the pose of B in A; C any frame between

The relations form a tree with the model at its root. A pose between two frames is composed along the path that joins
them, so that a joint placed in its parent keeps the digits of the file.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words, suggest
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import IDENTITY
from heuncli.scene.importers.attitudes import (
    RIGHT_ANGLE_ERROR,
    add_vectors,
    compose_rotations,
    compute_roll_pitch_yaw,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
)
from heuncli.scene.importers.sdf.values import read_attribute_flag, read_values
from heuncli.scene.importers.urdf.document import LinkPose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

NO_POSE = LinkPose()
MODEL = "__model__"  # the frame of the model that contains an element
WORLD = "world"


class Frame(NamedTuple):
    """A frame with its pose in another.

    base: the scoped name of the frame in which its pose is given; None for the root
    attached_to: the scoped name of the link or frame to which it is fixed; of a joint its child, of a model its
    canonical link; None for links
    """

    name: str
    element: XmlElement
    base: str | None
    pose: LinkPose
    attached_to: str | None = None


class FrameTree:
    """All frames of one model by their scoped names, such as `arm::wrist`."""

    def __init__(self, fields: UrdfFields) -> None:
        self.fields = fields
        self.frames: dict[str, Frame] = {}
        self.used_names: set[str] = set()  # of links and joints that the file does not have

    def add(self, frame: Frame, path: str) -> bool:
        """Add a frame; False, and a problem, if its name is used already."""
        earlier = self.frames.setdefault(frame.name, frame)
        if earlier is not frame:
            message = f"the name is already used, first in line {earlier.element.line}"
            self.fields.report("import-twice", frame.element, path, message, "give each its own name")
        return earlier is frame

    def choose_name(self, name: str) -> str:
        """Choose a name like this one that no link, joint or frame has, and keep it for its new owner."""
        while name in self.used_names or name in self.frames:
            name += "_"
        self.used_names.add(name)
        return name

    def report_wrong_bases(self, links: Collection[str]) -> None:
        """Report frames that are relative or attached to what is not there, and those that depend on themselves.

        links: the scoped names of all links
        """
        for frame in self.frames.values():
            name = "model" if frame.name == MODEL else frame.name
            is_model = frame.element.tag == "model" and frame.name != WORLD and not frame.name.endswith(f"::{MODEL}")
            if is_model and frame.attached_to is not None and frame.attached_to not in links:
                message = f"its canonical link '{frame.attached_to}' is not there"
                hint = suggest(frame.attached_to, links, "links")
                self.fields.report("import-tree", frame.element, name, message, hint)
            relations = {frame.base: "its pose is relative to"}
            if frame.element.tag == "frame":
                relations[frame.attached_to] = "it is attached to"
            for base, relation in relations.items():
                if base is not None and base not in self.frames:
                    hint = suggest(base, self.frames, "frames")
                    message = f"{relation} '{base}', which is not there"
                    self.fields.report("import-tree", frame.element, name, message, hint)
        if not self.fields.problems:
            bases = {name: frame.base for name, frame in self.frames.items()}
            self._report_circle(bases, "poses depend on each other", "give one of them relative to the model")
        if not self.fields.problems:
            attached = {name: frame.attached_to for name, frame in self.frames.items() if name != WORLD}
            self._report_circle(attached, "frames are attached to each other", "attach one of them to a link")

    def _report_circle(self, bases: Mapping[str, str | None], message: str, hint: str) -> None:
        """Report the first frame that depends on itself. bases: what each frame depends on, or None."""
        sound: set[str] = set()
        for name in bases:
            chain: dict[str, None] = {}
            current: str | None = name
            while current is not None and current not in sound and current not in chain:
                chain[current] = None
                current = bases.get(current)
            if current is not None and current in chain:
                text = f"{message}: {list_words([*chain])}"
                self.fields.report("import-tree", self.frames[name].element, name, text, hint)
                return
            sound.update(chain)

    def find_link(self, name: str, links: set[str]) -> str | None:
        """Find the link to which a frame is fixed; None if it is none."""
        seen: set[str] = set()
        current: str | None = name
        while current is not None and current not in links and current not in seen:
            seen.add(current)
            frame = self.frames.get(current)
            current = None if frame is None else frame.attached_to
        return current if current in links else None

    def compute_pose(self, frame: str, base: str) -> LinkPose:
        """Compute the pose of a frame in another, `base`, with all joints at 0."""
        outward, inward = self._list_bases(frame), self._list_bases(base)
        while outward and inward and outward[-1] == inward[-1]:
            outward.pop()
            inward.pop()
        pose = NO_POSE
        for name in inward:
            pose = compose_poses(pose, invert_pose(self.frames[name].pose))
        for name in reversed(outward):
            pose = compose_poses(pose, self.frames[name].pose)
        return pose

    def _list_bases(self, name: str) -> list[str]:
        """List a frame and those in which its pose is given, up to the root."""
        names: list[str] = []
        current: str | None = name
        while current is not None:
            names.append(current)
            current = self.frames[current].base
        return names


def compose_poses(first: LinkPose, second: LinkPose) -> LinkPose:
    """Return the pose of a frame C in A from that of B in A and that of C in B."""
    if first == NO_POSE or second == NO_POSE:
        return second if first == NO_POSE else first
    R = rotation_from_roll_pitch_yaw(first.rpy)
    place = add_vectors(first.xyz, rotate_vector(R, second.xyz))
    if ZERO in (first.rpy, second.rpy):
        return LinkPose(place, second.rpy if first.rpy == ZERO else first.rpy)
    return LinkPose(place, compute_roll_pitch_yaw(compose_rotations(R, rotation_from_roll_pitch_yaw(second.rpy))))


def invert_pose(pose: LinkPose) -> LinkPose:
    """Return the pose of A in B from that of B in A."""
    if pose.rpy == ZERO:
        x, y, z = pose.xyz
        return LinkPose((0.0 - x, 0.0 - y, 0.0 - z))
    inverse = transpose(rotation_from_roll_pitch_yaw(pose.rpy))
    x, y, z = rotate_vector(inverse, pose.xyz)
    return LinkPose((0.0 - x, 0.0 - y, 0.0 - z), compute_roll_pitch_yaw(inverse))


def transpose(R: Matrix) -> Matrix:
    """Return the inverse of a rotation."""
    a, b, c = zip(*R, strict=True)
    return a, b, c


def read_pose(element: XmlElement, path: str, fields: UrdfFields) -> tuple[LinkPose, str | None] | None:
    """Read the <pose> of an element: the pose, and the frame it is relative to, or None; None if it is wrong."""
    part = fields.find_child(element, "pose", path)
    if part is None:
        return NO_POSE, None
    fields.report_unknown_attributes(part, path, "relative_to", "rotation_format", "degrees", "frame")
    base = part.attributes.get("relative_to", "").strip() or None
    if part.attributes.get("frame", "").strip():
        message = f'frame="{part.attributes["frame"]}" of <pose> is of SDF 1.5 and 1.6'
        fields.report("import-attribute", part, path, message, "convert the file: gz sdf -p OLD.sdf > NEW.sdf")
        return None
    if not part.text:
        return NO_POSE, base
    form = part.attributes.get("rotation_format", "euler_rpy")
    if form not in ("euler_rpy", "quat_xyzw"):
        fields.report("import-attribute", part, path, f'rotation_format="{form}"', "write euler_rpy or quat_xyzw")
        return None
    numbers = read_values(part, path, fields, 6 if form == "euler_rpy" else 7, is_length=True)
    if numbers is None:
        return None
    x, y, z, *rest = numbers
    if form == "quat_xyzw":
        return _from_quaternion((x, y, z), rest, part, path, fields, base)
    in_degrees = read_attribute_flag(part, "degrees", path, fields)
    roll, pitch, yaw = (math.radians(angle) if in_degrees else angle for angle in rest)
    return LinkPose((x, y, z), fields.read_angles((roll, pitch, yaw), path)), base


def _from_quaternion(
    place: Vec, numbers: list[float], part: XmlElement, path: str, fields: UrdfFields, base: str | None
) -> tuple[LinkPose, str | None] | None:
    """Make the pose of a place and a quaternion x, y, z, w of any length."""
    size = math.hypot(*numbers)
    if size == 0.0:
        fields.report("import-number", part, path, "the quaternion is 0 0 0 0", "write 0 0 0 1 for no rotation")
        return None
    x, y, z, w = (number / size for number in numbers)
    R: Matrix = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
        (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)),
        (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)),
    )
    angles = compute_roll_pitch_yaw(compose_rotations(IDENTITY, R))
    roll, pitch, yaw = (0.0 if abs(angle) < RIGHT_ANGLE_ERROR else angle for angle in angles)
    return LinkPose(place, (roll, pitch, yaw)), base
