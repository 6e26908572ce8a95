"""Read a model of an SDF, with the models nested in it, into links, joints and frames, and join them to a robot.

The links and joints are those that URDF has (urdf/document.py), so that one robot gives the same spec from both
formats. Three things differ and are translated here:

    poses       relative to any frame (frames.py); a joint's may differ from that of its child. Then a link without
                mass stands at the joint, and the child is fixed to it.
    defaults    a link without <inertial> has 1 kg and 1 kg m^2; <mass> and <inertia> left out count the same
    world       a model that is placed in the world hangs on a link of that name
"""

from __future__ import annotations

from collections import Counter

from heuncli.base.spelling import suggest
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.sdf.frames import (
    MODEL,
    NO_POSE,
    WORLD,
    Frame,
    FrameTree,
    read_pose,
)
from heuncli.scene.importers.sdf.joint_tree import make_joints
from heuncli.scene.importers.sdf.joints import SdfJoint, read_joint
from heuncli.scene.importers.sdf.values import (
    as_attribute,
    read_attribute_flag,
    read_child_flag,
    read_child_number,
    read_moments,
)
from heuncli.scene.importers.urdf.document import (
    MOMENTS,
    Inertial,
    LinkPose,
    LoopJoint,
    Robot,
    UrdfJoint,
    UrdfLink,
    make_massless_link,
)
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

# parts without mechanical meaning
MODEL_NOISE = (
    "plugin", "self_collide", "allow_auto_disable", "enable_wind", "gripper", "static", "model_metadata",
)  # fmt: skip
LINK_NOISE = (
    "sensor", "light", "audio_source", "audio_sink", "battery", "particle_emitter", "projector", "plugin",
    "enable_wind", "self_collide", "must_be_base_link", "material",
)  # fmt: skip
LINK_PARTS = ("pose", "inertial", "collision", "visual", "gravity", "kinematic", "velocity_decay")
MODEL_PARTS = ("link", "joint", "frame", "model", "pose", "include")
INERTIAL_PARTS = ("pose", "mass", "inertia", "density", "fluid_added_mass")
INCLUDE_HINT = "paste that model in its place: gz sdf -p FILE writes it out"
SHAPE_PARTS = ("size", "radius", "length", "uri", "scale", "submesh")


class RobotReader:
    """Reads one model. `links` and `joints` are by scoped names, such as `arm::wrist`."""

    def __init__(self, fields: UrdfFields, takes_shapes: bool, has_model_axes: bool) -> None:
        """takes_shapes: whether links without <inertial> get the mass of their shapes, not the default of SDF
        has_model_axes: whether the axes of joints are along the model's frame, as up to SDF 1.4
        """
        self.fields, self.takes_shapes, self.has_model_axes = fields, takes_shapes, has_model_axes
        self.frames = FrameTree(fields)
        self.links: dict[str, UrdfLink] = {}
        self.joints: list[SdfJoint] = []
        self.ignored_tags: Counter[str] = Counter()
        self.links_of_default_mass: list[str] = []

    def read_robot(self, model: XmlElement, world_pose: LinkPose, is_free: bool) -> Robot:
        """Read the robot of a model; errors are added to the problems.

        world_pose: of the model in the world
        is_free: whether nothing holds its root where the file does not say so
        """
        name = self.fields.read_word(model, "name", "model") or "model"
        self.frames.add(Frame(WORLD, model, None, NO_POSE, WORLD), f"model {name}")
        self.frames.add(Frame(MODEL, model, WORLD, world_pose, find_canonical_link(model, "")), f"model {name}")
        self._read_model(model, "", f"model {name}")
        problem_count = len(self.fields.problems)
        self.frames.report_wrong_bases(self.links)
        links = dict(self.links)
        joints: dict[str, UrdfJoint] = {}
        loop_joints: tuple[LoopJoint, ...] = ()
        if len(self.fields.problems) == problem_count == 0:
            joints, loop_joints = make_joints(self.joints, links, self.frames, model)
            _place_in_world(links, joints, self.frames, model, is_free)
        is_complete = not self.fields.problems
        return Robot(model, name, links, joints, dict(self.ignored_tags), is_complete, loop_joints)

    def _read_model(self, model: XmlElement, scope: str, path: str) -> None:
        """Read the parts of a model. scope: what stands before the names in it, such as `arm::`."""
        if read_child_flag(model, "static", path, self.fields, False):
            message = "the model is static, so nothing in it moves"
            self.fields.report("import-tree", model, path, message, "delete <static>, or give the model that moves")
        if "placement_frame" in model.attributes:
            message = "placement_frame is not supported"
            self.fields.report("import-attribute", model, path, message, "give the pose of the model itself")
        for part in model.children:
            match part.tag:
                case "link":
                    self._add_link(part, scope)
                case "joint":
                    joint = read_joint(part, scope, self.has_model_axes, self.fields, self.ignored_tags)
                    if joint is not None and self._add_frame(part, scope, "joint", joint.child, joint.child):
                        self.joints.append(joint)
                case "frame":
                    attached = part.attributes.get("attached_to", "").strip() or MODEL
                    self._add_frame(part, scope, "frame", make_scoped(attached, scope), make_scoped(attached, scope))
                case "model":
                    self._add_nested_model(part, scope)
                case "include":
                    message = "<include> names another file, which is not read"
                    self.fields.report("import-part", part, path, message, INCLUDE_HINT)
                case "pose":
                    pass  # read where the model is placed
                case tag if tag in MODEL_NOISE or ":" in tag:
                    self.ignored_tags[tag] += tag != "static"
                case tag:
                    message = f"<model> has an unknown part <{tag}>"
                    hint = suggest(tag, (*MODEL_PARTS, *MODEL_NOISE), "parts")
                    self.fields.report("import-part", part, path, message, hint)

    def _add_nested_model(self, part: XmlElement, scope: str) -> None:
        name = self.fields.read_word(part, "name", "model")
        if name is None:
            return
        path = f"model {scope}{name}"
        placed = read_pose(part, path, self.fields)
        if placed is None:
            return
        base = make_scoped(placed[1] or MODEL, scope)
        inner = f"{scope}{name}::"
        link = find_canonical_link(part, inner)
        if self.frames.add(Frame(f"{scope}{name}", part, base, placed[0], link), path):
            self.frames.add(Frame(f"{inner}{MODEL}", part, f"{scope}{name}", NO_POSE, f"{scope}{name}"), path)
            self._read_model(part, inner, path)

    def _add_frame(self, part: XmlElement, scope: str, kind: str, base: str, attached_to: str | None) -> bool:
        """Add the frame of an element. base: the frame of its pose where the pose names none."""
        name = self.fields.read_word(part, "name", kind)
        if name is None:
            return False
        path = f"{kind} {scope}{name}"
        placed = read_pose(part, path, self.fields)
        if placed is None:
            return False
        base = base if placed[1] is None else make_scoped(placed[1], scope)
        return self.frames.add(Frame(f"{scope}{name}", part, base, placed[0], attached_to), path)

    def _add_link(self, part: XmlElement, scope: str) -> None:
        if part.attributes.get("name") == WORLD and not scope:
            message, hint = "a link may not be named world", "delete it: joints with the parent world hold to the world"
            self.fields.report("import-tree", part, "link world", message, hint)
            return
        if not self._add_frame(part, scope, "link", make_scoped(MODEL, scope), None):
            return
        name = f"{scope}{part.attributes['name']}"
        path = f"link {name}"
        for inner in part.children:
            if inner.tag in LINK_NOISE or ":" in inner.tag:
                self.ignored_tags[f"{inner.tag} in links"] += 1
            elif inner.tag not in LINK_PARTS:
                hint = suggest(inner.tag, (*LINK_PARTS, *LINK_NOISE), "parts")
                message = f"<link> has an unknown part <{inner.tag}>"
                self.fields.report("import-part", inner, path, message, hint)
        self._leave_out_features(part, path)
        inertial = self.fields.find_child(part, "inertial", path)
        shapes = [shape for tag in ("collision", "visual") for shape in part.find_all(tag)]
        element = XmlElement(
            part.tag, part.attributes, self._translate_shapes(shapes, part, path), part.line, part.column
        )
        self.links[name] = UrdfLink(name, element, self._read_inertial(inertial, element, name, path))

    def _leave_out_features(self, part: XmlElement, path: str) -> None:
        """Warn of what a link has that a spec cannot hold."""
        found: list[tuple[str, str]] = []
        if not read_child_flag(part, "gravity", path, self.fields, True):
            found.append(("gravity", "the link has no gravity in the file; add a force against its weight"))
        if read_child_flag(part, "kinematic", path, self.fields, False):
            found.append(("kinematic", "the file moves the link; hold it by a drive"))
        decay = part.find_all("velocity_decay")
        if any(read_float(one.text) != 0.0 for top in decay for one in top.children):
            found.append(("velocity_decay", "it is numerical damping; add a damper where there is one"))
        for tag, hint in found:
            element = part.find_all(tag)[0]
            problem = self.fields.make_problem(LEFT_OUT_CODE, element, path, f"<{tag}> is left out", hint)
            self.fields.left_out.append(problem)

    def _read_inertial(self, element: XmlElement | None, link: XmlElement, name: str, path: str) -> Inertial | None:
        """Read the mass of a link, or SDF's default where the file leaves it out."""
        if element is None:
            if self.takes_shapes and link.children:
                return None
            self.links_of_default_mass.append(name)
            return Inertial(link, 1.0, NO_POSE, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0), True)
        self.fields.report_unknown_parts(element, path, *INERTIAL_PARTS)
        if read_attribute_flag(element, "auto", path, self.fields):
            if not self.takes_shapes:
                message = 'auto="true": the mass is to be that of the shapes'
                self.fields.report("import-missing", element, path, message, "give its density: --density 1000")
            return None
        for part in element.find_all("fluid_added_mass"):
            problem = self.fields.make_problem(LEFT_OUT_CODE, part, path, "<fluid_added_mass> is left out", "")
            self.fields.left_out.append(problem._replace(hint="a spec has no fluid around its bodies"))
        mass = read_child_number(element, "mass", path, self.fields, 1.0)
        inertia = self.fields.find_child(element, "inertia", path)
        if not element.find_all("mass") or inertia is None:
            self.links_of_default_mass.append(name)
        if inertia is not None:
            self.fields.report_unknown_parts(inertia, path, *MOMENTS)
        moments = read_moments(inertia or XmlElement("inertia", {}, [], 0, 0), MOMENTS, path, self.fields)
        pose = self._read_pose_in_link(element, link, path)
        if mass is None or pose is None or None in moments:
            return None
        known = tuple(moment for moment in moments if moment is not None)
        return Inertial(inertia or element, mass, pose, known, True)

    def _read_pose_in_link(self, element: XmlElement, link: XmlElement, path: str) -> LinkPose | None:
        """Read the pose of a part of a link; None, and a problem, if it is relative to something else."""
        placed = read_pose(element, path, self.fields)
        if placed is None:
            return None
        if placed[1] not in (None, link.attributes.get("name")):
            message = f"the pose of <{element.tag}> is relative to '{placed[1]}', not to its link"
            self.fields.report("import-tree", element, path, message, "delete relative_to")
            return None
        return placed[0]

    def _translate_shapes(self, shapes: list[XmlElement], link: XmlElement, path: str) -> list[XmlElement]:
        """Write collisions and visuals as URDF does, if their masses are asked for."""
        if not self.takes_shapes:
            return []
        translated: list[XmlElement] = []
        for shape in shapes:
            pose = self._read_pose_in_link(shape, link, path)
            if pose is None:
                continue
            texts = {"xyz": _join_numbers(pose.xyz), "rpy": _join_numbers(pose.rpy)}
            origin = XmlElement("origin", texts, [], shape.line, shape.column)
            forms = [
                _translate_form(form, self.fields, path) for top in shape.find_all("geometry") for form in top.children
            ]
            geometry = XmlElement("geometry", {}, forms, shape.line, shape.column)
            translated.append(XmlElement(shape.tag, {}, [origin, geometry], shape.line, shape.column))
        return translated


def find_canonical_link(model: XmlElement, scope: str) -> str | None:
    """Return the scoped name of the link to which the frame of a model is fixed: the one that the model names, else
    its first, else the first of the models in it; None if there is none. scope: that of the names in the model.
    """
    if canonical := model.attributes.get("canonical_link", "").strip():
        return f"{scope}{canonical}"
    for link in model.find_all("link"):
        return f"{scope}{link.attributes.get('name', '')}"
    inner = (find_canonical_link(one, f"{scope}{one.attributes.get('name', '')}::") for one in model.find_all("model"))
    return next((link for link in inner if link is not None), None)


def make_scoped(name: str, scope: str) -> str:
    """Return the scoped name of a frame that is named in a scope."""
    return WORLD if name == WORLD else f"{scope}{name}"


def read_float(text: str) -> float | None:
    """Return the number of a text; None if it is none."""
    try:
        return float(text)
    except ValueError:
        return None


def _join_numbers(numbers: tuple[float, float, float]) -> str:
    return " ".join(map(repr, numbers))


def _translate_form(form: XmlElement, fields: UrdfFields, path: str) -> XmlElement:
    """Write the form of a geometry with its measures as attributes."""
    values = {part.tag: as_attribute(part).attributes[part.tag] for part in form.children if part.tag in SHAPE_PARTS}
    if form.tag == "mesh":
        if "submesh" in values:
            fields.report("import-shape", form, path, "a <submesh> is not read alone", "save it as a file of its own")
        uri = values.pop("uri", "")
        prefix, colon, rest = uri.partition("://")
        values["filename"] = f"package://{rest}" if colon and prefix in ("model", "package") else uri
    return XmlElement(form.tag, values, [], form.line, form.column)


def _place_in_world(
    links: dict[str, UrdfLink], joints: dict[str, UrdfJoint], frames: FrameTree, model: XmlElement, is_free: bool
) -> None:
    """Join the roots to the world where the model does not stand at its origin, or hangs on it by a joint."""
    children = {joint.child for joint in joints.values()}
    roots = [name for name in links if name not in children and name != WORLD]
    if len(roots) != 1 or WORLD in links:
        return
    pose = frames.compute_pose(roots[0], WORLD)
    if pose == NO_POSE:
        return
    links[WORLD] = make_massless_link(WORLD, model)
    name = frames.choose_name(f"{roots[0]}_on_ground")
    joints[name] = UrdfJoint(name, model, "floating" if is_free else "fixed", WORLD, roots[0], pose, (1.0, 0.0, 0.0))
