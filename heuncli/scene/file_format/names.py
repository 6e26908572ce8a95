"""Collect what a scene names from the plain data, so that references can be checked even if other entries have
errors.

A planar scene is completed to one in space: balls become pins about z, vectors of two components get a third.
"""

from __future__ import annotations

from typing import Any

from heuncli.base.joint_kinds import TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import match_misspelt_keys
from heuncli.scene.expressions.scope import RESERVED
from heuncli.scene.file_format.couplings import ThreadFriction
from heuncli.scene.file_format.entries import Entry, keys_of
from heuncli.scene.file_format.format import BodyEntry, GroundEntry
from heuncli.scene.file_format.loads import Friction
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.semantics import rotor_name

# Names

GROUND = "ground"
NAMED_BLOCKS = (
    "parameters", "bodies", "joints", "drives", "forces", "impulses", "stops", "latches", "couplings", "rolling",
    "sections", "sensors", "tables", "cases",
)  # fmt: skip
ALL_CASES = "all"  # the value of --case that selects all cases
UNTIL = "until"  # name of the condition that ends a motion; events have names of their own
CAUSE_NAMES = frozenset({"gravity", "drives", "motion"})  # causes in the shares report, besides the names of entries
RESERVED_NAMES: dict[str, frozenset[str]] = {
    "parameters": RESERVED,
    "joints": RESERVED,
    "tables": RESERVED,
    "bodies": frozenset({GROUND}),
    "forces": CAUSE_NAMES,
    "impulses": CAUSE_NAMES,
    "stops": CAUSE_NAMES,
    "couplings": CAUSE_NAMES,
    "rolling": CAUSE_NAMES,
    "latches": CAUSE_NAMES,
    "cases": frozenset({ALL_CASES}),
}


class SceneNames(NamedTuple):
    """The names in a scene.

    entries: plain data of the entries of each block, by name
    points: plain data of the points of each body and of the ground, by name
    joints: types of the joints
    keys: cached keys of the results, by the words before them (rules/outcome.py)
    """

    entries: dict[str, dict[str, Any]]
    points: dict[str, dict[str, Any]]
    joints: dict[str, str]
    keys: dict[tuple[str, ...], dict[str, None]]

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> SceneNames:
        """Collect the names in plain data of any shape."""
        entries = {block: as_mapping(data.get(block)) for block in NAMED_BLOCKS}
        analysis = as_mapping(data.get("analysis"))
        end_conditions = {key: analysis[key] for key in (UNTIL,) if key in analysis}
        entries["events"] = end_conditions | as_mapping(analysis.get("events"))
        bodies = entries["bodies"]
        points = {name: get_points(body, BodyEntry) for name, body in bodies.items()}
        points[GROUND] = get_points(data.get(GROUND), GroundEntry)
        joints = {name: str(as_mapping(joint).get("type")) for name, joint in as_mapping(data.get("joints")).items()}
        for name in list_rotor_names(entries["forces"]):
            for block in ("bodies", "joints", "couplings"):
                entries[block] = {name: {}} | entries[block]
            joints.setdefault(name, "pin")
        return cls(entries, points, joints, {})


def list_rotor_names(forces: dict[str, Any]) -> list[str]:
    """List the names of the rotors of motors; each is a body, a joint and a coupling."""
    return [
        rotor_name(name) for name, load in forces.items()
        if as_mapping(load).get("type") == "motor" and as_mapping(load).get("rotor") is not None
    ]  # fmt: skip


def collect_scene_names(spec: Spec) -> SceneNames:
    """Collect the names of a loaded scene."""
    entries: dict[str, dict[str, Any]] = {block: dict(getattr(spec, block)) for block in NAMED_BLOCKS}
    entries["events"] = {condition.name: condition for condition in spec.analysis.conditions}
    points = {name: dict(body.points) for name, body in spec.bodies.items()} | {GROUND: dict(spec.ground.points)}
    return SceneNames(entries, points, {name: joint.kind for name, joint in spec.joints.items()}, {})


def name_sticking_event(name: str) -> str:
    """Return the name of the event that a friction sticks."""
    return f"{name}_sticks"


def list_sticking_names(entries: dict[str, dict[str, Any]]) -> list[str]:
    """List the names of the frictions, of forces and screws, that may stick: those without a speed.

    entries: of a spec, or plain data that may have errors
    """
    names = []
    for name, load in entries["forces"].items():
        is_friction = isinstance(load, Friction) or as_mapping(load).get("type") == "friction"
        if is_friction and get_value(load, "speed") is None:
            names.append(name)
    for name, coupling in entries["couplings"].items():
        friction = get_value(coupling, "friction")
        if (type(friction) is dict or isinstance(friction, ThreadFriction)) and get_value(friction, "speed") is None:
            names.append(name)
    return names


def get_value(entry: Any, key: str) -> Any:
    """Return a value of an entry, of a spec or as plain data; None if it has none."""
    return entry.get(key) if type(entry) is dict else getattr(entry, key, None)


def get_points(owner: Any, model: type[Entry]) -> dict[str, Any]:
    """Return the points of a body or of the ground, also under a misspelt key."""
    data = as_mapping(owner)
    if "points" not in data and any(key not in keys_of(model) for key in data):
        data = match_misspelt_keys(data, keys_of(model))
    return as_mapping(data.get("points"))


def as_mapping(value: Any) -> dict[str, Any]:
    """Return the value if it is a mapping, else an empty one."""
    return value if type(value) is dict else {}


def is_name(text: str) -> bool:
    """Whether a text is a valid name: a letter, then letters, digits, _."""
    return text.isidentifier() and not text.startswith("_")


# Planar

VECTOR_BLOCKS = (
    "gravity", "ground", "bodies", "joints", "couplings", "rolling", "forces", "impulses", "sections", "sensors",
    "foundation",
)  # fmt: skip
ENTRY_LISTS = ("shapes", "through")  # lists whose items hold vectors
VECTOR_KEYS = frozenset({  # keys of vectors that lie in the plane; named points are found under `points`
    "gravity", "center", "position", "from", "to", "at", "velocity", "vector", "to_vector", "axis", "to_axis", "normal",
    "first_axis", "about",
})  # fmt: skip
KEYS_ABOUT_Z = ("orientation", "angular_velocity", "bearings")  # their values are about z, or along it, already


def complete_planar_scene(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with complete vectors; balls become pins about z, and pins without an axis get the z axis."""
    data = {key: complete_vectors(value, key) if key in VECTOR_BLOCKS else value for key, value in data.items()}
    about_z = {"type": "pin", "axis": [0, 0, 1]}
    joints = {
        name: {**about_z, **joint, "type": "pin"} if _is_planar_pin(joint) else joint
        for name, joint in as_mapping(data.get("joints")).items()
    }
    return {**data, "joints": joints} if joints else data


def complete_vectors(value: Any, key: str) -> Any:
    """Return the value of a key; its vectors of two components get 0 as the third."""
    if type(value) is list:
        if len(value) == 2 and key in VECTOR_KEYS:
            return [*value, 0]
        return [complete_vectors(member, "") for member in value] if key in ENTRY_LISTS else value
    if type(value) is not dict or key in KEYS_ABOUT_Z:
        return value
    is_couple = value.get("type") == "couple"
    return {
        name: entry if is_couple and name == "vector" else complete_vectors(entry, "at" if key == "points" else name)
        for name, entry in value.items()
    }


def _is_planar_pin(joint: Any) -> bool:
    if type(joint) is not dict:
        return False
    kind = TYPES.get(str(joint.get("type")))
    if kind is None or kind.planar != "pin":
        return False
    return kind.has_axis or not {"axis", "to_axis"} & joint.keys()
