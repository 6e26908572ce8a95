"""What is named in a scene, read off the plain data: so references can be judged beside entries that are in error."""

from __future__ import annotations

from typing import Any, NamedTuple

from heuncli.spec.grammar import RESERVED

GROUND = "ground"
NAMED = ("parameters", "bodies", "joints", "drives", "forces", "impulses", "sections", "tables")
RESERVED_FOR: dict[str, frozenset[str]] = {
    "parameters": RESERVED,
    "joints": RESERVED,
    "tables": RESERVED,
    "bodies": frozenset({GROUND}),
    "forces": frozenset({"gravity", "drives", "motion"}),
}


class Names(NamedTuple):
    """Entries of each block and points of each body and of the ground, as plain data by name; types of the joints."""

    entries: dict[str, dict[str, Any]]
    points: dict[str, dict[str, Any]]
    joints: dict[str, str]

    @classmethod
    def of(cls, data: dict[str, Any]) -> Names:
        """Of plain data of any shape."""
        entries = {block: mapping(data.get(block)) for block in NAMED}
        bodies = entries["bodies"]
        points = {name: mapping(mapping(body).get("points")) for name, body in bodies.items()}
        points[GROUND] = mapping(mapping(data.get(GROUND)).get("points"))
        joints = {name: str(mapping(joint).get("type")) for name, joint in mapping(data.get("joints")).items()}
        return cls(entries, points, joints)


def mapping(value: Any) -> dict[str, Any]:
    """The value if it is a mapping, else an empty one."""
    return value if type(value) is dict else {}


def is_name(text: str) -> bool:
    """A letter, then letters, digits, _."""
    return text.isidentifier() and not text.startswith("_")
