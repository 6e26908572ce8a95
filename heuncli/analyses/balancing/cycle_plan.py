"""Choose the angle, the number of turns and the rate of a cycle: from the options, or else from the scene."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.base.spelling import suggest
from heuncli.loads.equilibrium.steady_states import has_constant_rate
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import compute_joint_start
from heuncli.scene.expressions.programs import Expression

SAMPLE_ANGLES = (0.1, 0.9, 1.7, 2.6, 3.3, 4.4, 5.2, 6.1)  # rad: angles within a turn at which laws are compared


@record
class CyclePlan:
    """The definition of a cycle: the joint whose angle counts it, the angle at its start [rad], its number of turns.

    rate [rad/s]: rate of the angle; None if neither the scene nor the options give one
    in_time: whether several drives move the scene as they are, this joint at `rate`
    """

    joint: str
    begin: float
    turns: int
    rate: float | None
    in_time: bool

    @property
    def coordinate(self) -> str:
        """The name of the angle."""
        return f"{self.joint}.angle"


def plan_cycle(scene: PreparedScene, joint_name: str | None, turns: int | None, rate: float | None) -> CyclePlan:
    """Return the requested cycle, or the one that the scene has. Raises SolveError [no-cycle] if there is none."""
    mechanism = scene.mechanism
    require_no_contacts(mechanism)
    joint = find_named_joint(mechanism, joint_name) if joint_name is not None else find_cycle_joint(mechanism)
    drives = [j for j in mechanism.joints if j.drive is not None]
    in_time = len(drives) > 1
    scene_rate = find_scene_rate(mechanism, scene, joint)
    if in_time:
        require_steady(joint)
        assert scene_rate is not None
    begin = compute_joint_start(mechanism, scene.start, joint).angle
    turn_count = turns if turns is not None else count_turns(mechanism, joint)
    return CyclePlan(joint.name, begin, turn_count, scene_rate if rate is None or in_time else rate, in_time)


def require_no_contacts(mechanism: Mechanism) -> None:
    """Raise SolveError [opens-and-closes] for contacts that may open: a pose does not determine whether they are
    closed.
    """
    names = [stop.path for stop in mechanism.stops]
    names += [f"joints.{joint.name}" for joint in mechanism.joints if joint.can_open]
    names += [f"couplings.{coupling.name}" for coupling in mechanism.couplings if can_open(coupling)]
    hint = "leave it out; or use --period for the orders of a periodic motion"
    if names:
        raise SolveError(*(
            Problem("opens-and-closes", f"{name} may open and close: the cycle angle does not determine when",
                    hint=hint, entry_path=name)
            for name in names
        ))  # fmt: skip


def can_open(coupling: Coupling) -> bool:
    """Return whether a coupling may open; False for cams, which are treated as always in contact
    (describe_cam_assumptions).
    """
    return any(
        row.restitution is not None or (row.tension_only and coupling.entry.type != "cam") for row in coupling.rows
    )


def describe_cam_assumptions(mechanism: Mechanism) -> tuple[str, ...]:
    """Return notes on cams that only press: the cycle is computed as if their followers never lifted off."""
    return tuple(
        f"the follower of cam {coupling.name} is assumed to stay on its cam; "
        "`heun run` shows where contact would be lost"
        for coupling in mechanism.couplings
        if coupling.entry.type == "cam" and any(row.tension_only for row in coupling.rows)
    )


def find_angle_joints(mechanism: Mechanism) -> list[Joint]:
    """Return the joints that have an angle which a drive may turn."""
    return [joint for joint in mechanism.joints if "angle" in JOINTS[joint.kind].drives]


def find_named_joint(mechanism: Mechanism, text: str) -> Joint:
    """Return the joint named by `main` or `main.angle`. Raises SolveError [no-cycle]."""
    name = text.removesuffix(".angle")
    known = [joint.name for joint in find_angle_joints(mechanism)]
    if name not in known:
        hint = suggest(name, known, "angles") if known else "the model has no pin"
        raise SolveError(Problem("no-cycle", f"--cycle {text}: no joint with an angle has this name", hint=hint or ""))
    return next(joint for joint in mechanism.joints if joint.name == name)


def find_cycle_joint(mechanism: Mechanism) -> Joint:
    """Return the joint of the only driven angle. Without drives: of the only angle that starts turning, or else that
    turns against the ground.

    Raises SolveError [no-cycle] if none or several qualify.
    """
    driven = [joint for joint in mechanism.joints if joint.drive is not None]
    candidates = [joint for joint in driven if joint.drive is not None and joint.drive.quantity == "angle"]
    if not driven:
        angles = find_angle_joints(mechanism)
        candidates = [j for j in angles if j.rate] or [j for j in angles if GROUND in (j.a, j.b)]
    if len(candidates) == 1:
        return candidates[0]
    names = [joint.name for joint in candidates or find_angle_joints(mechanism)]
    what = "several angles are possible" if names else "no joint has an angle"
    hint = f"--cycle {'|'.join(names)}" if names else "a cycle is measured by the angle of a pin"
    raise SolveError(Problem("no-cycle", f"the cycle is not known: {what}", hint=hint))


def require_steady(joint: Joint) -> None:
    """Raise SolveError [no-cycle] if several drives move the scene and the cycle's own drive is missing or not
    uniform.
    """
    where = f"joints.{joint.name}"
    if joint.drive is None:
        message = f"{where} has no drive but several other joints have: its angle does not determine their motion"
        hint = "name a driven joint with --cycle"
        raise SolveError(Problem("no-cycle", message, hint=hint, entry_path=where))
    value = joint.drive.value
    if not value.time_dependent or not has_constant_rate(value):
        message = f"drives.{joint.drive.name} does not have a constant rate while other drives vary with time"
        hint = "give it a constant rate, such as angle: 100*t"
        raise SolveError(Problem("no-cycle", message, hint=hint, entry_path=f"drives.{joint.drive.name}"))


def find_scene_rate(mechanism: Mechanism, scene: PreparedScene, joint: Joint) -> float | None:
    """Return the rate of the angle at the start [rad/s], from its drive or the assembled start; None if it is at
    rest.
    """
    if joint.drive is not None and joint.drive.quantity == "angle":
        rate = joint.drive.value.derivatives(0.0)[1]
    else:
        rate = compute_joint_start(mechanism, scene.start, joint).rate
    return rate if math.isfinite(rate) and abs(rate) > tolerances.AT_REST else None


def count_turns(mechanism: Mechanism, joint: Joint) -> int:
    """Return 2 if a law in the cycle's angle repeats after two turns and not after one, else 1."""
    values = [value for load in mechanism.loads for value in load.values if not value.time_dependent]
    angle_laws = [value for value in values if value.uses and all(name == joint.name for name, _ in value.uses)]
    return 2 if any(has_two_turn_period(value) for value in angle_laws) else 1


def has_two_turn_period(value: Expression) -> bool:
    """Return whether an expression of one joint's angle, and of its rate at a constant value, has a period of two
    turns.
    """
    turn = 2.0 * math.pi
    angles: Sequence[float] = [x + turn * k for x in SAMPLE_ANGLES for k in range(3)]
    uses = [quantity for _, quantity in value.uses]
    arguments = ([x if quantity == "angle" else 1.0 for quantity in uses] for x in angles)
    samples = np.array([value.value(0.0, each) for each in arguments]).reshape(-1, 3)
    size = float(np.abs(samples).max())
    same = tolerances.SAME_VALUE * size
    return bool(np.abs(samples[:, 2] - samples[:, 0]).max() <= same < np.abs(samples[:, 1] - samples[:, 0]).max())
