"""The symbols of drives and of loads in joints, which stand in the rows of the kinds of loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.joint_kinds import JOINTS, TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import JointForce, PairForce, Spec
from heuncli.scene.file_format.names import GROUND

DRIVE = "drive"  # drawn as the torque that it is
AXIS_KINDS = ("pin", "line", "cylinder")  # of bearings: the kinds whose axis is that of the shaft
BEARING_KINDS = (*AXIS_KINDS, "ball")
ON_AXIS = 1e-6  # share of the distance of bearings: those farther from the axis are not on it


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


def find_guided_actuators(spec: Spec) -> frozenset[str]:
    """Find the actuators between two bodies that slide on each other, such as the gas on a piston.

    They have no rod and barrel of their own: what acts is drawn on both bodies.
    """
    slides = {frozenset((j.a, j.b)) for j in spec.joints.values() if find_scene_joint_kind(spec, j.kind).shifts}
    return frozenset(
        name
        for name, force in spec.forces.items()
        if isinstance(force, PairForce)
        and force.type == "actuator"
        and frozenset((force.from_.body, force.to.body)) in slides
    )


def find_shaft_bearings(spec: Spec) -> dict[str, bool]:
    """Find the bearings of shafts: joints on the ground with a body that has two or more of them on one axis.

    Returns their names, each with whether it holds the shaft along the axis (a fixed bearing).
    """
    bearings: dict[str, bool] = {}
    for body in spec.bodies:
        supports = [(n, j) for n, j in spec.joints.items() if {j.a, j.b} == {GROUND, body} and j.kind in BEARING_KINDS]
        axes = [j for _, j in supports if j.kind in AXIS_KINDS]
        if not axes:
            continue
        axis = np.array(axes[0].axis) / np.linalg.norm(axes[0].axis)
        places = {n: np.array(j.p if j.a == GROUND else j.q) for n, j in supports}
        offsets = {n: place - places[supports[0][0]] for n, place in places.items()}
        extent = max(float(np.linalg.norm(offset)) for offset in offsets.values())
        on_axis = [n for n, offset in offsets.items() if np.linalg.norm(np.cross(offset, axis)) <= ON_AXIS * extent]
        if extent > 0.0 and len(on_axis) > 1:
            bearings |= {n: not TYPES[spec.joints[n].kind].shifts for n in on_axis}
    return bearings
