"""A scene declared planar, read as one in space: balls as pins about z, vectors of two components with a third."""

from __future__ import annotations

from typing import Any

from heuncli.base.joint_kinds import TYPES
from heuncli.scene.file_format.names import mapping

BLOCKS = (
    "gravity", "ground", "bodies", "joints", "couplings", "rolling", "forces", "impulses", "sections", "foundation",
)  # fmt: skip
OF_ENTRIES = ("shapes", "through")  # lists whose members hold vectors
VECTORS = frozenset({  # keys of vectors that lie in the plane; named points are found under `points`
    "gravity", "center", "position", "from", "to", "at", "velocity", "vector", "to_vector", "axis", "to_axis", "normal",
    "first_axis", "about",
})  # fmt: skip
NOT_IN_PLANE = ("orientation", "angular_velocity")  # what they hold turns about z


def in_the_plane(data: dict[str, Any]) -> dict[str, Any]:
    """A planar scene's balls read as pins about z, its pins with that axis if they give none; vectors complete."""
    data = {key: completed(value, key) if key in BLOCKS else value for key, value in data.items()}
    about_z = {"type": "pin", "axis": [0, 0, 1]}
    joints = {
        name: {**about_z, **joint, "type": "pin"} if _turns_in_the_plane(joint) else joint
        for name, joint in mapping(data.get("joints")).items()
    }
    return {**data, "joints": joints} if joints else data


def completed(value: Any, key: str) -> Any:
    """What stands under a key, its vectors of two components with 0 for the third."""
    if type(value) is list:
        if len(value) == 2 and key in VECTORS:
            return [*value, 0]
        return [completed(member, "") for member in value] if key in OF_ENTRIES else value
    if type(value) is not dict or key in NOT_IN_PLANE:
        return value
    couple = value.get("type") == "couple"
    return {
        name: entry if couple and name == "vector" else completed(entry, "at" if key == "points" else name)
        for name, entry in value.items()
    }


def _turns_in_the_plane(joint: Any) -> bool:
    if type(joint) is not dict:
        return False
    kind = TYPES.get(str(joint.get("type")))
    if kind is None or kind.planar != "pin":
        return False
    return kind.has_axis or not {"axis", "to_axis"} & joint.keys()
