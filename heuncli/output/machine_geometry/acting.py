"""What drives joints, and what acts in them, by its symbols: a row of SHOWN a kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from heuncli.base.joint_kinds import JOINTS, TYPES, Kind
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Spec

DRIVE = "drive"
# a kind: symbols about an axis that points to the eye, about one that points away from it, along one
SHOWN: Mapping[str, tuple[str, str, str]] = {
    DRIVE: ("turning", "turning back", "sliding"),
    "torque": ("turning", "turning back", "sliding"),
    "motor": ("turning", "turning back", "sliding"),
    "turn_spring": ("coil", "coil", "coil"),
    "friction": ("brake", "brake", "brake along"),
    "damper": ("damping", "damping", "damping"),
}


class ActingLook(NamedTuple):
    """A drive of a joint, or a load in it: its name and kind; its symbols towards the eye and away from it.

    slides: along the joint's axis rather than about it.
    """

    name: str
    what: str
    joint: str
    symbols: tuple[str, str]
    slides: bool


def kind_in(spec: Spec, type_: str) -> Kind:
    """What a joint of a type is, in a scene declared planar, too."""
    kind = TYPES[type_]
    return JOINTS[kind.planar] if spec.space == "planar" and kind.planar is not None else kind


def acting_of(spec: Spec) -> Iterator[ActingLook]:
    """All that acts in joints; what pulls along a rod or rope is drawn with that."""
    acting = [(drive.joint, drive.name, DRIVE) for drive in spec.drives.values()]
    for name, force in spec.forces.items():
        if force.type in ("torque", "turn_spring", "motor", "friction", "damper"):
            acting.append((force.joint, name, force.type))
    for joint, name, what in acting:
        kind = kind_in(spec, spec.joints[joint].kind)
        if not kind.keeps_distance:
            slides = kind.follows_path or (bool(kind.shifts) and kind.turn.asks == "all")
            towards, away, along = SHOWN[what]
            yield ActingLook(name, what, joint, (along, along) if slides else (towards, away), slides)
