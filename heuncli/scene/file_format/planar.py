"""Complete a planar scene to one in space: balls become pins about z, vectors of two components get a third."""

from __future__ import annotations

from typing import Any

from heuncli.base.joint_kinds import TYPES
from heuncli.scene.file_format.names import as_mapping

VECTOR_BLOCKS = (
    "gravity", "ground", "bodies", "joints", "couplings", "rolling", "forces", "impulses", "sections", "foundation",
)  # fmt: skip
ENTRY_LISTS = ("shapes", "through")  # lists whose items hold vectors
VECTOR_KEYS = frozenset({  # keys of vectors that lie in the plane; named points are found under `points`
    "gravity", "center", "position", "from", "to", "at", "velocity", "vector", "to_vector", "axis", "to_axis", "normal",
    "first_axis", "about",
})  # fmt: skip
KEYS_ABOUT_Z = ("orientation", "angular_velocity")  # their values are about z already


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
