"""Read an SDF into a described machine: choose its model, read it as a robot, and translate that as URDF's is.

The file holds one model, or a world with one model that moves. Static models, such as a ground plane, are left out.
"""

from __future__ import annotations

from collections import Counter

from heuncli.base.errors import SpecError
from heuncli.base.records import replace
from heuncli.base.spelling import list_words, suggest
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.description import LEFT_OUT_CODE, DescribedMachine, ImportOptions
from heuncli.scene.importers.sdf.frames import NO_POSE, read_pose
from heuncli.scene.importers.sdf.model import RobotReader
from heuncli.scene.importers.sdf.values import read_child_flag, read_values
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.reader import GRAVITY, translate_robot
from heuncli.scene.importers.xml_elements import XmlElement

WORLD_NOISE = (
    "light", "plugin", "scene", "gui", "physics", "atmosphere", "magnetic_field", "wind", "audio", "road", "actor",
    "spherical_coordinates", "state", "frame",
)  # fmt: skip
WORLD_PARTS = ("model", "gravity", "include", "joint", "population")
FIRST_VERSION = (1, 3)
LAST_WITH_MODEL_AXES = (1, 4)  # axes of joints are along the model's frame up to there, then along the joint's
SCENERY_URIS = ("sun", "ground_plane", "ground plane")  # models that every world has and that do not move


def read_model(_content: bytes, file: str, root: XmlElement, options: ImportOptions, sha256: str) -> DescribedMachine:
    """Read the machine that an SDF describes. Raises SpecError with all problems, in the order of their lines."""
    fields = UrdfFields(file, "right-angles" in options.repair)
    version = _read_version(root, fields)
    model, gravity, ignored_tags = _choose_model(root, options.model, fields)
    takes_shapes = options.density is not None
    reader = RobotReader(fields, takes_shapes, version <= LAST_WITH_MODEL_AXES)
    placed = read_pose(model, f"model {model.attributes.get('name', '')}", fields)
    pose = NO_POSE if placed is None else placed[0]
    if placed is not None and placed[1] not in (None, "world"):
        message = f"the pose of the model is relative to '{placed[1]}'"
        fields.report("import-tree", model, "model", message, "give it relative to the world")
    robot = reader.read_robot(model, pose, options.base_free)
    ignored = +(Counter(ignored_tags) + Counter(robot.ignored_tags))
    is_placed = any(joint.kind == "floating" for joint in robot.joints.values())
    robot = replace(robot, ignored_tags=ignored)
    machine = translate_robot(
        robot, options._replace(base_free=False) if is_placed else options, fields, sha256, form="SDF"
    )
    remarks = {**machine.remarks, "gravity": "the world's" if gravity is not None else "a model has none; z is up"}
    lines = list(machine.header_lines)
    if reader.links_of_default_mass:
        names = list_words(reader.links_of_default_mass)
        lines.append(f"Mass or inertia left out, so SDF's 1 kg and 1 kg m^2 count: {names}.")
    return machine._replace(gravity=gravity or GRAVITY, remarks=remarks, header_lines=tuple(lines))


def _read_version(root: XmlElement, fields: UrdfFields) -> tuple[int, ...]:
    """Read the version of the format, such as (1, 9). Raises SpecError for those before 1.3, which have other poses."""
    text = root.attributes.get("version", "1.12").strip()
    numbers = text.split(".")
    if not all(number.isascii() and number.isdigit() for number in numbers):
        raise SpecError(
            fields.make_problem("import-attribute", root, "", f'version="{text}"', "write 1.9, for example")
        )
    version = tuple(map(int, numbers))
    if version < FIRST_VERSION:
        hint = "convert the file: gz sdf -p OLD.sdf > NEW.sdf"
        raise SpecError(
            fields.make_problem("import-format", root, "", f"SDF {text} is not read, but 1.3 and later", hint)
        )
    return version


def _choose_model(
    root: XmlElement, name: str | None, fields: UrdfFields
) -> tuple[XmlElement, Vec | None, dict[str, int]]:
    """Find the model, the gravity of its world or None, and count what is left out. Raises SpecError if none is left
    or several are.
    """
    worlds, models = root.find_all("world"), root.find_all("model")
    if len(worlds) + bool(models) != 1:
        message = "the file has no world and no model"
        if worlds:
            what = "several worlds" if len(worlds) > 1 else "a world, and a model outside it"
            message = f"the file has {what}"
        raise SpecError(fields.make_problem("import-tree", root, "", message, "give a file with one model"))
    ignored: dict[str, int] = {}
    gravity: Vec | None = None
    if worlds:
        world = worlds[0]
        models = world.find_all("model")
        _read_world_parts(world, fields, ignored)
        numbers = read_gravity(world, fields)
        gravity = None if numbers is None else (numbers[0], numbers[1], numbers[2])
    if name is not None:
        models = _find_named(models, name, root, fields)
    moving = [model for model in models if not read_child_flag(model, "static", "model", fields, False)]
    if len(models) > len(moving):
        ignored["static model" + "s" * (len(models) - len(moving) > 1)] = len(models) - len(moving)
    if len(moving) != 1:
        names = list_words([model.attributes.get("name", "?") for model in moving])
        message = f"the file has {len(moving)} models that move: {names}" if moving else "no model of the file moves"
        element = moving[1] if moving else root
        raise SpecError(fields.make_problem("import-tree", element, "", message, "choose one: --model NAME"))
    return moving[0], gravity, ignored


def read_gravity(world: XmlElement, fields: UrdfFields) -> list[float] | None:
    """Read the gravity of a world [m/s^2]; SDF's default is 0 0 -9.8."""
    part = fields.find_child(world, "gravity", "world")
    return [0.0, 0.0, -9.8] if part is None else read_values(part, "world", fields, 3)


def _find_named(models: list[XmlElement], name: str, root: XmlElement, fields: UrdfFields) -> list[XmlElement]:
    """Return the models of a name. Raises SpecError if there is none."""
    found = [model for model in models if model.attributes.get("name") == name]
    if not found:
        hint = suggest(name, [model.attributes.get("name", "") for model in models], "models")
        raise SpecError(fields.make_problem("import-tree", root, "", f"there is no model '{name}'", hint))
    return found


def _read_world_parts(world: XmlElement, fields: UrdfFields, ignored: dict[str, int]) -> None:
    """Count the parts of a world without mechanical meaning, and report the others."""
    for part in world.children:
        if part.tag in WORLD_NOISE or ":" in part.tag:
            ignored[part.tag] = ignored.get(part.tag, 0) + 1
        elif part.tag == "include":
            uri = next((one.text for one in part.children if one.tag == "uri"), "")
            if uri.rpartition("/")[2] not in SCENERY_URIS:
                message = f"<include> of {uri} is left out"
                hint = "paste the model in its place, or import the file of that model"
                fields.left_out.append(fields.make_problem(LEFT_OUT_CODE, part, "world", message, hint))
            else:
                ignored["include"] = ignored.get("include", 0) + 1
    fields.report_unknown_parts(world, "world", *WORLD_PARTS[:3], *WORLD_NOISE)
