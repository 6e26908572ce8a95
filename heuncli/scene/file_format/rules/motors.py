"""Rules about motors: given by a curve or by two consistent numbers; their rotors have names of their own."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format.motors import iter_rotor_motors, rotor_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

CURVE_HINT = "give curve: torque over speed; or stall and idle: the torque at standstill and the no-load speed"


@rule("motor")
def check_motor_form(draft: DraftDocument) -> Iterator[Violation]:
    """A motor has one curve, or a torque that falls towards the no-load speed; its sizes are above zero."""
    for name, motor in draft.document.forces.items():
        if not isinstance(motor, fe.MotorEntry):
            continue
        path = ("forces", name)
        line_keys = [key for key in ("stall", "idle") if getattr(motor, key) is not None]
        if motor.curve is not None and line_keys:
            message = f"a motor with both curve and {line_keys[0]}"
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
