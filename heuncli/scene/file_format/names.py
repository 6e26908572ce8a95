"""What is named in a scene, read off the plain data: so references can be judged beside entries that are in error."""

from __future__ import annotations

from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import misspelt
from heuncli.scene.expressions.grammar import RESERVED
from heuncli.scene.file_format.entries import Entry, keys_of
from heuncli.scene.file_format.format import BodyEntry, GroundEntry
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.motors import rotor_of

GROUND = "ground"
NAMED = (
    "parameters", "bodies", "joints", "drives", "forces", "impulses", "stops", "latches", "couplings", "rolling",
    "sections", "tables", "cases",
)  # fmt: skip
ALL_CASES = "all"  # what --case takes for every one of them
UNTIL = "until"  # the condition that ends a motion, beside the events that have names
CAUSES = frozenset({"gravity", "drives", "motion"})  # of shares, beside the entries' own names
RESERVED_FOR: dict[str, frozenset[str]] = {
    "parameters": RESERVED,
    "joints": RESERVED,
    "tables": RESERVED,
    "bodies": frozenset({GROUND}),
    "forces": CAUSES,
    "impulses": CAUSES,
    "stops": CAUSES,
    "couplings": CAUSES,
    "rolling": CAUSES,
    "latches": CAUSES,
    "cases": frozenset({ALL_CASES}),
}


class Names(NamedTuple):
    """Entries of each block and points of each body and of the ground, as plain data by name; types of the joints.

    keys: of the results, by the words before them, as far as they were asked for (rules/outcome.py).
    """

    entries: dict[str, dict[str, Any]]
    points: dict[str, dict[str, Any]]
    joints: dict[str, str]
    keys: dict[tuple[str, ...], dict[str, None]]

    @classmethod
    def of(cls, data: dict[str, Any]) -> Names:
        """Of plain data of any shape."""
        entries = {block: mapping(data.get(block)) for block in NAMED}
        analysis = mapping(data.get("analysis"))
        ends = {key: analysis[key] for key in (UNTIL,) if key in analysis}
        entries["events"] = ends | mapping(analysis.get("events"))
        bodies = entries["bodies"]
        points = {name: points_of(body, BodyEntry) for name, body in bodies.items()}
        points[GROUND] = points_of(data.get(GROUND), GroundEntry)
        joints = {name: str(mapping(joint).get("type")) for name, joint in mapping(data.get("joints")).items()}
        for name in rotors_in(entries["forces"]):
            for block in ("bodies", "joints", "couplings"):
                entries[block] = {name: {}} | entries[block]
            joints.setdefault(name, "pin")
        return cls(entries, points, joints, {})


def rotors_in(forces: dict[str, Any]) -> list[str]:
    """The names of the rotors of motors, which are bodies, joints and couplings."""
    return [
        rotor_of(name) for name, load in forces.items()
        if mapping(load).get("type") == "motor" and mapping(load).get("rotor") is not None
    ]  # fmt: skip


def names_in(spec: Spec) -> Names:
    """The names of a scene that was loaded."""
    entries: dict[str, dict[str, Any]] = {block: dict(getattr(spec, block)) for block in NAMED}
    entries["events"] = {condition.name: condition for condition in spec.analysis.conditions}
    points = {name: dict(body.points) for name, body in spec.bodies.items()} | {GROUND: dict(spec.ground.points)}
    return Names(entries, points, {name: joint.kind for name, joint in spec.joints.items()}, {})


def points_of(owner: Any, model: type[Entry]) -> dict[str, Any]:
    """The points of a body or of the ground, also under a misspelt key."""
    given = mapping(owner)
    if "points" not in given and any(key not in keys_of(model) for key in given):
        given = misspelt(given, keys_of(model))
    return mapping(given.get("points"))


def mapping(value: Any) -> dict[str, Any]:
    """The value if it is a mapping, else an empty one."""
    return value if type(value) is dict else {}


def is_name(text: str) -> bool:
    """A letter, then letters, digits, _."""
    return text.isidentifier() and not text.startswith("_")
