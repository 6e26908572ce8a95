"""Rules about motors: given by a curve or by two consistent numbers; their rotors have names of their own."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format.motors import iter_rotor_motors, rotor_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

CURVE_HINT = "curve: its torque over its speed; or stall and idle, the torque at standstill and the speed without load"


@rule("motor")
def check_motor_form(draft: DraftDocument) -> Iterator[Violation]:
    """A motor has one curve, or a torque that falls towards the no-load speed; its sizes are above zero."""
    for name, motor in draft.document.forces.items():
        if not isinstance(motor, fe.MotorEntry):
            continue
        path = ("forces", name)
        line_keys = [key for key in ("stall", "idle") if getattr(motor, key) is not None]
        if motor.curve is not None and line_keys:
            message = f"a motor by curve and by {line_keys[0]}"
            yield Violation((*path, line_keys[0]), message, "leave one of them out", key=True)
        elif motor.curve is None and len(line_keys) < 2:
            missing = "curve" if not line_keys else next(key for key in ("stall", "idle") if key not in line_keys)
            yield Violation(path, f"'{missing}' is missing", CURVE_HINT, key=True)
        elif motor.stall is not None and motor.idle is not None and not motor.stall * motor.idle > 0.0:
            message = f"a motor that stands with {motor.stall:g} N m and idles at {motor.idle:g} rad/s"
            hint = "neither is zero, and both have one sign: it drives towards the speed at which it idles"
            yield Violation((*path, "idle"), message, hint)
        if motor.ratio == 0.0:
            message = "a motor of ratio 0 turns nothing"
            yield Violation((*path, "ratio"), message, "turns of the motor for one of the joint, as 30")
        if motor.limit == 0.0:
            yield Violation((*path, "limit"), "a motor with a limit of 0 exerts nothing", "of its torque, either way")
        for key in ("mass", "inertia") if motor.rotor is not None else ():
            if not getattr(motor.rotor, key) > 0.0:
                message = f"a rotor of {key} {getattr(motor.rotor, key):g}"
                yield Violation((*path, "rotor", key), message, "above zero; or leave the rotor out")


@rule("motor-rotor")
def check_motor_rotor(draft: DraftDocument) -> Iterator[Violation]:
    """The names of a rotor's body, joint and coupling are not used by anything else."""
    for motor, _ in iter_rotor_motors(draft.document):
        name = rotor_name(motor)
        for block in ("bodies", "joints", "couplings"):
            if name in getattr(draft.document, block):
                message = f"{name} is what the rotor of {motor} is called, which is a body of its own"
                yield Violation((block, name), message, "give one of them another name", key=True)
