"""Rules about joints and drives: between two bodies, along valid directions, with possible bearings, driven
without contradiction.

Rules about motors: given by a curve or by two consistent numbers; their rotors have names of their own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import RATES, TYPES, format_kind_names
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.scene.expressions.discontinuities import find_first_not_positive, find_jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import (
    DRIVE_FORMS,
    DrivenCoordinate,
    find_driven_coordinate,
    find_point,
    iter_rotor_motors,
    list_drive_keys,
    rotor_name,
    run_duration,
)

# Joints

ONE_DRIVE_HINT = "one drive per joint: add the two in one expression"


def iter_directions(draft: DraftDocument) -> Iterator[tuple[Path_, tuple[float, float, float]]]:
    """Yield every direction in the document."""
    document = draft.document
    for name, joint in document.joints.items():
        for key in ("axis", "to_axis", "normal"):
            if getattr(joint, key, None) is not None:
                yield ("joints", name, key), getattr(joint, key)
    for name, wheel in document.rolling.items():
        for key in ("axis", "normal"):
            if getattr(wheel, key) is not None:
                yield ("rolling", name, key), getattr(wheel, key)
    for name, section in document.sections.items():
        for key in ("normal", "first_axis"):
            if getattr(section, key) is not None:
                yield ("sections", name, key), getattr(section, key)


@rule("zero-direction")
def check_zero_direction(draft: DraftDocument) -> Iterator[Violation]:
    """A direction is not [0, 0, 0]."""
    for path, direction in iter_directions(draft):
        if direction == (0.0, 0.0, 0.0):
            yield Violation(path, f"{path[-1]} is [0, 0, 0], which has no direction", "[0, 0, 1] is the z axis")


@rule("same-body")
def check_same_body(draft: DraftDocument) -> Iterator[Violation]:
    """A joint connects two different bodies."""
    for name, joint in draft.document.joints.items():
        if joint.from_.body == joint.to.body:
            message, hint = f"from and to are both on {joint.to.body}", "a joint connects two different bodies"
            yield Violation(("joints", name, "to"), message, hint)


@rule("same-point")
def check_same_point(draft: DraftDocument) -> Iterator[Violation]:
    """A load along a line acts between two points, not both on the ground; a distributed load has a length.

    A spring within one body moves nothing, but the sections between its points carry its force.
    """
    for name, load in draft.document.forces.items():
        if isinstance(load, fl.DistributedEntry):
            owner = draft.document.bodies.get(load.on)
            start = None if owner is None else find_point(owner, load.from_)
            if owner is not None and start is not None and start == find_point(owner, load.to):
                message = "from and to are the same point"
                yield Violation(("forces", name, "to"), message, "for a force at one point use type: force, in N")
        if not isinstance(load, fl.PairEntry) or load.from_.body != load.to.body:
            continue
        if LOAD_KINDS[load.type].place == "bodies":
            hint = f"a {load.type} acts between two different bodies"
            yield Violation(("forces", name, "to"), f"from and to are both on {load.to.body}", hint)
            continue
        path, body = ("forces", name, "to"), draft.document.bodies.get(load.to.body)
        if load.to.body == "ground":
            yield Violation(path, "from and to are both on ground", "a load within the ground has no effect")
        elif (
            body is not None
            and (end_point := find_point(body, load.to.at))
            and end_point == find_point(body, load.from_.at)
        ):
            yield Violation(path, "from and to are the same point", "give two points: the force acts along their line")


def make_end_key(end: EndEntry) -> tuple[str, object]:
    return end.body, end.at


@rule("bearings-form")
def check_bearing_pairs(draft: DraftDocument) -> Iterator[Violation]:
    """Two bearings are apart, on a joint that holds its axis; one of them carries the axial load if the joint does."""
    for name, joint in draft.document.joints.items():
        pair, kind, path = joint.bearings, TYPES[joint.type], ("joints", name, "bearings")
        if pair is None:
            continue
        first, second = pair.at
        if not kind.carries_tilting:
            known = format_kind_names([kind for kind in TYPES.values() if kind.carries_tilting], "or")
            message = f"a {joint.type} carries no tilting moment about an axis, so it cannot stand for two bearings"
            yield Violation(path, message, f"two bearings make a {known}", key=True)
        elif pair.axial is not None and kind.shifts:
            message = f"a {joint.type} slides along its axis, so no bearing carries an axial load"
            yield Violation((*path, "axial"), message, "leave it out", key=True)
        if abs(second - first) <= tolerances.SAME_VALUE * max(abs(first), abs(second)):
            message = f"both bearings are at {first:g} m, where they cannot carry a tilting moment"
            yield Violation((*path, "at"), message, "give two places along the axis, from the `to` point")


@rule("duplicate-joint", is_warning=True)
def check_duplicate_joint(draft: DraftDocument) -> Iterator[Violation]:
    """The same joint twice adds no constraint and makes its reactions indeterminate."""
    seen: dict[object, str] = {}
    for name, joint in draft.document.joints.items():
        ends = frozenset((make_end_key(joint.from_), make_end_key(joint.to)))
        key = joint.type, ends, getattr(joint, "axis", None), getattr(joint, "normal", None)
        if key in seen:
            message = f"identical to joint {seen[key]}: their reactions are open (indeterminate)"
            yield Violation(("joints", name), message, "keep one of them", key=True)
        seen.setdefault(key, name)


@rule("drive-form")
def check_drive_form(draft: DraftDocument) -> Iterator[Violation]:
    """A drive prescribes one coordinate that its joint has, as a function of time alone, and no other drive does."""
    driven: dict[str, str] = {}
    for name, drive in draft.document.drives.items():
        path = ("drives", name)
        quantities = [key for key in DRIVE_FORMS if getattr(drive, key) is not None]
        kind = TYPES.get(draft.names.joints.get(drive.joint, ""))
        allowed_keys = list_drive_keys(kind) if kind is not None else ()
        if len(quantities) != 1:
            description = " and ".join(quantities) if quantities else "nothing"
            hint = (
                drive_keys_hint(kind.name, allowed_keys)
                if kind is not None and allowed_keys
                else f"give one of {', '.join(DRIVE_FORMS)}"
            )
            yield Violation(path, f"the drive prescribes {description}", hint, key=True)
            continue
        quantity = quantities[0]
        if kind is not None:
            if quantity not in (*allowed_keys, *(["segments"] if allowed_keys else ())):
                driven_kinds = format_kind_names([kind for kind in TYPES.values() if kind.drives], "and")
                hint = drive_keys_hint(kind.name, allowed_keys) if allowed_keys else f"drives act on {driven_kinds}"
                yield Violation((*path, quantity), f"a {kind.name} has no {quantity} to drive", hint, key=True)
            elif kind.keeps_distance and drive.zero is not None:
                yield Violation((*path, "zero"), "zero is not for a length", "zero is for angle and travel")
        value = getattr(drive, quantity)
        if isinstance(value, Expression) and value.uses:
            joint, coordinate = value.uses[0]
            yield Violation(
                (*path, quantity), f"a drive may depend on time alone, not on {joint}.{coordinate}", "use t"
            )
        if drive.joint in driven:
            message = f"the joint {drive.joint} is already driven by {driven[drive.joint]}"
            yield Violation((*path, "joint"), message, ONE_DRIVE_HINT)
        driven.setdefault(drive.joint, name)


def drive_keys_hint(kind: str, keys: tuple[str, ...]) -> str:
    """Return a hint on the keys by which a joint of this kind may be driven."""
    return f"a {kind} has {' or '.join(keys)}"


def iter_drives(draft: DraftDocument) -> Iterator[tuple[str, str, DrivenCoordinate]]:
    """Yield the drives of one coordinate in time: name, joint, and what they prescribe."""
    for name, drive in draft.document.drives.items():
        driven = find_driven_coordinate(drive, draft.names.joints.get(drive.joint))
        if driven is not None and not driven.value.uses:
            yield name, drive.joint, driven


@rule("drive-contradicts")
def check_drive_contradiction(draft: DraftDocument) -> Iterator[Violation]:
    """A prescribed start value agrees with the drive at t = 0."""
    for name, joint_name, driven in iter_drives(draft):
        joint = draft.document.joints.get(joint_name)
        initial = getattr(joint, "initial", None)
        if initial is None:
            continue
        start, rate, _ = driven.value.derivatives(0.0)
        quantity = driven.quantity
        relative = draft.document.drives[name].zero == "assembled" or getattr(joint, "to_axis", None) is not None
        for key, expected in (
            (quantity, None if relative or driven.by_rate else start),
            (RATES.get(quantity, ""), start if driven.by_rate else rate),
        ):
            start_value = getattr(initial, key, None)
            if start_value is None or expected is None:
                continue
            if abs(start_value - expected) > tolerances.SAME_VALUE * max(abs(start_value), abs(expected), 1.0):
                message = f"{key} starts at {start_value:g}, but drive {name} prescribes {expected:g} at t = 0"
                yield Violation(("joints", joint_name, "initial", key), message, "leave it out: the drive sets it")


def iter_prescribed_values(draft: DraftDocument) -> Iterator[tuple[Path_, Expression, bool, str]]:
    """Yield what drives and ropes prescribe in time: path, value, whether it is a rate, and its owner."""
    for name, joint, driven in iter_drives(draft):
        yield ("drives", name, driven.key), driven.value, driven.by_rate, f"rod {joint}"
    for name, rope in draft.document.couplings.items():
        if isinstance(rope, fc.RopeEntry) and rope.length is not None and not rope.length.uses:
            yield ("couplings", name, "length"), rope.length, False, f"rope {name}"


@rule("drive-jumps")
def check_drive_jumps(draft: DraftDocument) -> Iterator[Violation]:
    """A driven coordinate or length does not jump, though its rate may; it has a value at the start."""
    duration = run_duration(draft.document.analysis)
    for path, value, by_rate, _ in iter_prescribed_values(draft):
        key = "drive" if path[0] == "drives" else path[-1]
        if math.isnan(value.value(0.0)):
            yield Violation(path, f"the {key} has no value at t = 0", "check the ranges of its functions and tables")
            continue
        for _, t, before, after in find_jumps(value, duration)[:1] if not by_rate else ():
            message = f"the {key} jumps from {before:g} to {after:g} at t = {t:g} s"
            yield Violation(path, message, "a step would need an infinite force: change the value over a short time")


@rule("drive-length")
def check_drive_length(draft: DraftDocument) -> Iterator[Violation]:
    """A driven rod or rope keeps a positive length, because at length 0 its direction is undefined."""
    duration = run_duration(draft.document.analysis)
    for path, value, _, owner in iter_prescribed_values(draft):
        if path[-1] != "length" or (path[0] == "couplings" and value.constant is not None):
            continue  # a constant length is checked in rules/couplings.py
        if path[0] == "drives" and draft.document.drives[str(path[1])].zero == "assembled":
            continue
        vanishing_time = find_first_not_positive(value, duration)
        if vanishing_time is not None:
            message = f"the length of {owner} reaches 0 at t = {vanishing_time:.4g} s"
            yield Violation(path, message, "end the run earlier, or keep the length above 0")


# Motors

CURVE_HINT = "give curve: torque over speed; or stall and idle: the torque at standstill and the no-load speed"


@rule("motor")
def check_motor_form(draft: DraftDocument) -> Iterator[Violation]:
    """A motor has one curve, or a torque that falls towards the no-load speed; its sizes are above zero."""
    for name, motor in draft.document.forces.items():
        if not isinstance(motor, fl.MotorEntry):
            continue
        path = ("forces", name)
        line_keys = [key for key in ("stall", "idle") if getattr(motor, key) is not None]
        if motor.curve is not None and line_keys:
            message = f"the motor has both curve and {line_keys[0]}"
            yield Violation((*path, line_keys[0]), message, "leave one of them out", key=True)
        elif motor.curve is None and len(line_keys) < 2:
            missing = "curve" if not line_keys else next(key for key in ("stall", "idle") if key not in line_keys)
            yield Violation(path, f"'{missing}' is missing", CURVE_HINT, key=True)
        elif motor.stall is not None and motor.idle is not None and not motor.stall * motor.idle > 0.0:
            message = f"stall {motor.stall:g} N m and idle {motor.idle:g} rad/s do not fit together"
            hint = "both must have the same sign and not be 0: the motor drives towards its no-load speed"
            yield Violation((*path, "idle"), message, hint)
        if motor.ratio == 0.0:
            message = "ratio must not be 0"
            yield Violation((*path, "ratio"), message, "motor revolutions per revolution of the joint, for example 30")
        if motor.limit == 0.0:
            yield Violation((*path, "limit"), "limit must not be 0", "give the limit of its torque in both directions")
        for key in ("mass", "inertia") if motor.rotor is not None else ():
            if not getattr(motor.rotor, key) > 0.0:
                message = f"{key} of the rotor must be greater than 0, but is {getattr(motor.rotor, key):g}"
                yield Violation((*path, "rotor", key), message, "give a positive value, or leave the rotor out")


@rule("motor-rotor")
def check_motor_rotor(draft: DraftDocument) -> Iterator[Violation]:
    """The names of a rotor's body, joint and coupling are not used by anything else."""
    for motor, _ in iter_rotor_motors(draft.document):
        name = rotor_name(motor)
        for block in ("bodies", "joints", "couplings"):
            if name in getattr(draft.document, block):
                message = f"'{name}' is reserved for the rotor of forces.{motor}"
                yield Violation((block, name), message, "give one of them another name", key=True)
