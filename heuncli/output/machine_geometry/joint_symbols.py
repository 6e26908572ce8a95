"""The symbols of drives and of loads in joints, which stand in the rows of the kinds of loads."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.joint_kinds import JOINTS, TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import JointForce, Spec

DRIVE = "drive"  # drawn as the torque that it is


class JointSymbol(NamedTuple):
    """The symbol of a joint's drive, or of a load in a joint.

    load_kind: DRIVE, or a kind of load
    symbols: seen with the joint's axis towards the eye, and away from it
    slides: whether the symbol acts along the joint's axis and not about it
    """

    name: str
    load_kind: str
    joint: str
    symbols: tuple[str, str]
    slides: bool


def find_scene_joint_kind(spec: Spec, type_: str) -> JointKind:
    """Find the kind of a joint of a given type; in a scene declared planar, its planar kind."""
    kind = TYPES[type_]
    return JOINTS[kind.planar] if spec.space == "planar" and kind.planar is not None else kind


def iter_joint_symbols(spec: Spec) -> Iterator[JointSymbol]:
    """Yield the symbols of all drives and loads in joints. A load along a rod or rope is drawn with that rod or
    rope.
    """
    joint_loads = [(drive.joint, drive.name, DRIVE) for drive in spec.drives.values()]
    for name, force in spec.forces.items():
        if isinstance(force, JointForce):
            joint_loads.append((force.joint, name, force.type))
    for joint, name, load_kind in joint_loads:
        kind = find_scene_joint_kind(spec, spec.joints[joint].kind)
        if not kind.keeps_distance:
            slides = kind.follows_path or (bool(kind.shifts) and kind.turn.condition == "all")
            to_eye, away_from_eye, sliding = LOAD_KINDS["torque" if load_kind == DRIVE else load_kind].symbols
            yield JointSymbol(name, load_kind, joint, (sliding, sliding) if slides else (to_eye, away_from_eye), slides)
