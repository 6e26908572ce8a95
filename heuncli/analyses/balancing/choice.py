"""Which angle a cycle is counted in, over how many turns, and how fast it turns: as asked, else as the scene has it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.nearest import did_you_mean
from heuncli.base.records import record
from heuncli.loads.equilibrium.steady_states import is_steady
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import GROUND, Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import joint_start
from heuncli.scene.expressions.programs import Expression

LOOKED_AT = (0.1, 0.9, 1.7, 2.6, 3.3, 4.4, 5.2, 6.1)  # rad, within a turn


@record
class CyclePlan:
    """What a cycle is: the joint whose angle it is counted in, the angle at its start [rad], its turns.

    rate [rad/s]: of the angle, None where neither the scene nor anybody tells one. in_time: the scene's several drives
    move it as they stand, this one at `rate`.
    """

    joint: str
    begin: float
    turns: int
    rate: float | None
    in_time: bool

    @property
    def coordinate(self) -> str:
        """The angle's name."""
        return f"{self.joint}.angle"


def planned(scene: PreparedScene, named: str | None, turns: int | None, rate: float | None) -> CyclePlan:
    """The cycle that is asked for, or the one that the scene has. Raises SolveError where there is none."""
    mechanism = scene.mechanism
    require_no_contacts(mechanism)
    joint = named_joint(mechanism, named) if named is not None else own_joint(mechanism)
    drives = [j for j in mechanism.joints if j.drive is not None]
    in_time = len(drives) > 1
    own = own_rate(mechanism, scene, joint)
    if in_time:
        require_steady(joint)
        assert own is not None
    begin = joint_start(mechanism, scene.start, joint).angle
    found = turns if turns is not None else turns_of(mechanism, joint)
    return CyclePlan(joint.name, begin, found, own if rate is None or in_time else rate, in_time)


def require_no_contacts(mechanism: Mechanism) -> None:
    """Raise SolveError for what may open and close: no pose tells whether it is closed."""
    names = [stop.path for stop in mechanism.stops]
    names += [f"joints.{joint.name}" for joint in mechanism.joints if joint.opens]
    names += [f"couplings.{own.name}" for own in mechanism.couplings if opens(own)]
    hint = "leave it out; or --period tells orders of time, of a motion that comes back"
    if names:
        raise SolveError(*(
            Problem("opens-and-closes", f"{name} may open and close: a cycle by the angle does not tell when",
                    hint=hint, about=name)
            for name in names
        ))  # fmt: skip


def opens(coupling: Coupling) -> bool:
    """Whether a coupling may open; not a cam that a run ends with: it is followed while it presses (pressed_alone)."""
    return any(
        row.restitution is not None or (row.tension_only and coupling.given.type != "cam") for row in coupling.rows
    )


def pressed_alone(mechanism: Mechanism) -> tuple[str, ...]:
    """Notes on cams that only press: of those the cycle is told as though nothing lifted off."""
    return tuple(
        f"the follower of cam {own.name} is taken to stay on its cam: `heun run` tells where the contact would be lost"
        for own in mechanism.couplings
        if own.given.type == "cam" and any(row.tension_only for row in own.rows)
    )


def angles_of(mechanism: Mechanism) -> list[Joint]:
    """The joints that have an angle which a drive may turn."""
    return [joint for joint in mechanism.joints if "angle" in JOINTS[joint.kind].drives]


def named_joint(mechanism: Mechanism, words: str) -> Joint:
    """The joint that is meant by `main` or `main.angle`."""
    name = words.removesuffix(".angle")
    known = [joint.name for joint in angles_of(mechanism)]
    if name not in known:
        hint = did_you_mean(name, known, "angles") if known else "the scene has no pin"
        raise SolveError(Problem("no-cycle", f"--cycle {words}: no joint with an angle has this name", hint=hint or ""))
    return next(joint for joint in mechanism.joints if joint.name == name)


def own_joint(mechanism: Mechanism) -> Joint:
    """The one driven angle; where nothing is driven the one that turns against the ground, or starts turning."""
    driven = [joint for joint in mechanism.joints if joint.drive is not None]
    found = [joint for joint in driven if joint.drive is not None and joint.drive.quantity == "angle"]
    if not driven:
        angles = angles_of(mechanism)
        found = [j for j in angles if j.rate] or [j for j in angles if GROUND in (j.a, j.b)]
    if len(found) == 1:
        return found[0]
    names = [joint.name for joint in found or angles_of(mechanism)]
    what = "several angles may be meant" if names else "no joint has an angle"
    hint = f"--cycle {'|'.join(names)}" if names else "a cycle is counted in the angle of a pin"
    raise SolveError(Problem("no-cycle", f"the cycle is not known: {what}", hint=hint))


def require_steady(joint: Joint) -> None:
    """Raise SolveError where several drives are to move the scene and the cycle's own does not turn evenly."""
    where = f"joints.{joint.name}"
    if joint.drive is None:
        message = f"{where} has no drive, and several others have: their motion is not told by its angle"
        hint = "--cycle names one that is driven"
        raise SolveError(Problem("no-cycle", message, hint=hint, about=where))
    value = joint.drive.value
    if not value.time_dependent or not is_steady(value):
        message = f"drives.{joint.drive.name} does not turn at a constant rate, and other drives move in time beside it"
        hint = "give it a constant rate, such as angle: 100*t"
        raise SolveError(Problem("no-cycle", message, hint=hint, about=f"drives.{joint.drive.name}"))


def own_rate(mechanism: Mechanism, scene: PreparedScene, joint: Joint) -> float | None:
    """The rate of the angle at the start [rad/s], by its drive or as it is assembled; None where it stands."""
    if joint.drive is not None and joint.drive.quantity == "angle":
        rate = joint.drive.value.derivatives(0.0)[1]
    else:
        rate = joint_start(mechanism, scene.start, joint).rate
    return rate if math.isfinite(rate) and abs(rate) > tolerances.AT_REST else None


def turns_of(mechanism: Mechanism, joint: Joint) -> int:
    """Two where a law in the cycle's angle comes back after two turns and not after one, else one."""
    values = [value for load in mechanism.loads for value in load.values if not value.time_dependent]
    own = [value for value in values if value.uses and all(name == joint.name for name, _ in value.uses)]
    return 2 if any(takes_two(value) for value in own) else 1


def takes_two(value: Expression) -> bool:
    """Whether an expression of one joint's angle, and of its rate, which is held, has the period of two turns."""
    turn = 2.0 * math.pi
    angles: Sequence[float] = [x + turn * k for x in LOOKED_AT for k in range(3)]
    uses = [quantity for _, quantity in value.uses]
    at = ([x if quantity == "angle" else 1.0 for quantity in uses] for x in angles)
    found = np.array([value.value(0.0, each) for each in at]).reshape(-1, 3)
    size = float(np.abs(found).max())
    same = tolerances.SAME_VALUE * size
    return bool(np.abs(found[:, 2] - found[:, 0]).max() <= same < np.abs(found[:, 1] - found[:, 0]).max())
