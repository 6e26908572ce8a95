"""Set what moves the joints: a drive by a parameter for each joint; for couplings, drives by the leading joint's
parameter.

If a joint has a `ref`, MuJoCo's coordinate is not 0 where the machine is drawn, but that of a spec is. Parameters have
MuJoCo's values, and the laws of the drives subtract the difference: angle = elbow - ref. A keyframe's rate is part of
the law, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.description import (
    DescribedEntry,
    DescribedParameter,
    ImportOptions,
    explain_motion,
    format_original_name,
)
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.loop_closures import JointEquality, format_polynomial, make_left_out_problem
from heuncli.scene.importers.mjcf.starts import HeldJoints
from heuncli.scene.importers.mjcf.tree import COORDINATE_KEYS, RATE_KEYS, JointTree, TreeJoint
from heuncli.scene.importers.spec_text import format_decimal, format_number

UNHELD_HINT = "drives hold independent joints; neither joint of this coupling is independent"


class JointLaws(NamedTuple):
    """What moves the joints.

    initial: start values of free joints by name
    driven_joints: numbers of the joints with a drive
    """

    parameters: tuple[DescribedParameter, ...]
    drives: tuple[DescribedEntry, ...]
    initial: dict[str, dict[str, str]]
    driven_joints: frozenset[int]
    header_lines: tuple[str, ...]
    couplings: tuple[DescribedEntry, ...]
    left_out: tuple[Problem, ...]


class _LawBuilder:
    """Builds the laws of one model; `laws` are those of MuJoCo's joints, in its coordinates."""

    def __init__(
        self,
        compiled: CompiledModel,
        tree: JointTree,
        leaderless: tuple[JointEquality, ...],
        q: Any,
        qd: Any,
        options: ImportOptions,
    ) -> None:
        self.compiled, self.steps, self.q, self.qd, self.options = compiled, tree.step_by_joint, q, qd, options
        self.leaderless = leaderless
        self.parameters: list[DescribedParameter] = []
        self.drives: list[DescribedEntry] = []
        self.initial: dict[str, dict[str, str]] = {}
        self.laws: dict[int, str] = {}
        self.couplings: dict[int, DescribedEntry] = {}  # by the number of the follower
        self.driven_joints: set[int] = set()
        self.left_out: list[Problem] = []

    def hold_joint(self, joint: int) -> None:
        """Make a joint stand, or start, at the value of its parameter."""
        compiled, step = self.compiled, self.steps[joint]
        rate = float(self.qd[compiled.model.jnt_dofadr[joint]])
        value = self.start_value(joint)
        self.parameters.append(
            DescribedParameter(step.name, format_coordinate(step, value), _format_limits(compiled, joint, step))
        )
        position = _subtract(step.name, get_drawn_coordinate(compiled, joint))
        if self.options.free:
            self.initial[step.name] = {COORDINATE_KEYS[step.kind]: position}
            if self.qd.any():  # without a rate the body would rest in the world, not on its parent
                self.initial[step.name][RATE_KEYS[step.kind]] = format_number(rate)
            return
        moving = f" {'-' if rate < 0.0 else '+'} {format_decimal(abs(rate))}*t" if rate else ""
        self.laws[joint] = step.name + moving
        self.add_drive(joint, position + moving)

    def start_value(self, joint: int) -> float:
        """Return MuJoCo's coordinate at the start, moved to the nearest limit if stops are imported and it lies
        outside.
        """
        model, value = self.compiled.model, float(self.q[self.compiled.model.jnt_qposadr[joint]])
        if not (self.options.limits and model.jnt_limited[joint]):
            return value
        low, high = (float(limit) for limit in model.jnt_range[joint])
        return min(max(value, low), high)

    def follow_leader(self, coupling: JointEquality) -> None:
        """Make a joint follow another by the law of that one."""
        compiled, step = self.compiled, self.steps[coupling.follower]
        if self.options.free and coupling.leader is not None:
            self.couple_free_joint(coupling)
            return
        argument = None if coupling in self.leaderless else self.format_argument(coupling)
        if argument is None or coupling.follower in self.driven_joints:
            unheld = "a joint that nothing else drives"
            reason = (
                f"{step.name} follows {unheld if argument is None else 'two joints: another equality drives it, too'}"
            )
            self.left_out.append(make_left_out_problem(compiled, "equality", coupling.equality, reason, UNHELD_HINT))
            return
        law = format_polynomial(coupling.polynomial if argument else coupling.polynomial[:1], argument)
        self.laws[coupling.follower] = _subtract(law, -get_drawn_coordinate(compiled, coupling.follower))
        law_note = (
            ""
            if coupling.leader is None
            else f"; for a motion, use the function of {self.steps[coupling.leader].name} here as well"
        )
        self.add_drive(coupling.follower, law, f"{compiled.describe_part('equality', coupling.equality)}{law_note}")

    def couple_free_joint(self, coupling: JointEquality) -> None:
        """Make a free joint follow another in a fixed ratio. Raises SpecError [import-mimic] for any other
        polynomial.
        """
        compiled, step = self.compiled, self.steps[coupling.follower]
        start, slope, *higher_terms = (*coupling.polynomial, 0.0, 0.0)
        assert coupling.leader is not None
        if slope == 0.0 or any(higher_terms) or coupling.follower in self.couplings:
            message = (
                f"joint {step.name} follows another by more than a fixed ratio, which is not possible with free joints"
            )
            place = compiled.location("equality", coupling.equality)
            raise SpecError(Problem("import-mimic", message, place, "leave out --free: drives then keep the relation"))
        # the spec counts coordinates from the drawn pose, so MuJoCo's are taken minus their drawn values
        leader = self.steps[coupling.leader].name
        keys = {"type": "ratio", "of": (step.name, leader), "factors": (1.0, -slope), "is": start}
        told = compiled.describe_part("equality", coupling.equality)
        self.couplings[coupling.follower] = DescribedEntry(f"follow_{step.name}", keys, told)

    def add_drive(self, joint: int, law: str, remark: str = "") -> None:
        step = self.steps[joint]
        self.driven_joints.add(joint)
        motors = ", ".join(_iter_motors(self.compiled, joint))
        remark = "; ".join(filter(None, (remark, motors)))
        self.drives.append(
            DescribedEntry(f"hold_{step.name}", {"joint": step.name, COORDINATE_KEYS[step.kind]: law}, remark)
        )

    def format_argument(self, coupling: JointEquality) -> str | None:
        """Format the argument of a coupling's polynomial: its leader's displacement from zero. Empty if there is no
        leader, None if the leader's law is unknown.
        """
        if coupling.leader is None:
            return ""
        law = self.laws.get(coupling.leader)
        if law is None:
            return None
        law = _subtract(law, get_drawn_coordinate(self.compiled, coupling.leader))
        return law if law.isidentifier() else f"({law})"

    def make_header_lines(self) -> tuple[str, ...]:
        """Explain how the joints are moved."""
        if not self.parameters:
            return ()
        first = self.parameters[0]
        example_value = "10 mm" if str(first.value).endswith(" m") else "30 deg"
        return explain_motion(first.name, example_value, free=self.options.free, at_rest=False)


def build_joint_laws(
    compiled: CompiledModel,
    tree: JointTree,
    held_joints: HeldJoints,
    couplings: tuple[JointEquality, ...],
    q: Any,
    qd: Any,
    options: ImportOptions,
) -> JointLaws:
    """Build the parameters and drives. q, qd: MuJoCo's coordinates and rates at the start. Raises SpecError."""
    leaderless = tuple(coupling for coupling in couplings if coupling not in held_joints.couplings)
    builder = _LawBuilder(compiled, tree, leaderless, q, qd, options)
    for joint in held_joints.joints:
        builder.hold_joint(joint)
    for coupling in (*_sort_by_leader(held_joints.couplings), *leaderless):
        builder.follow_leader(coupling)
    return JointLaws(
        tuple(builder.parameters),
        tuple(builder.drives),
        builder.initial,
        frozenset(builder.driven_joints),
        builder.make_header_lines(),
        tuple(builder.couplings.values()),
        tuple(builder.left_out),
    )


def get_drawn_coordinate(compiled: CompiledModel, joint: int) -> float:
    """Return MuJoCo's coordinate of a joint in the pose in which the machine is drawn."""
    return float(compiled.model.qpos0[compiled.model.jnt_qposadr[joint]])


def format_coordinate(step: TreeJoint, value: float) -> str:
    """Format a coordinate with its unit; an angle in degrees if that is exact and short, as people write it."""
    if step.kind != "pin":
        return f"{format_number(value)} m"
    degrees = float(f"{math.degrees(value):.6g}")
    exact = math.isclose(math.radians(degrees), value, rel_tol=4e-16, abs_tol=0.0)
    return f"{format_number(degrees)} deg" if exact else f"{format_number(value)} rad"


def _sort_by_leader(couplings: tuple[JointEquality, ...]) -> list[JointEquality]:
    """Sort couplings so that leaders precede followers; those in a cycle come last."""
    remaining, order = list(couplings), []
    followers = {coupling.follower for coupling in remaining}
    while remaining:
        ready = [coupling for coupling in remaining if coupling.leader not in followers]
        order += ready or remaining
        remaining = [coupling for coupling in remaining if coupling not in ready] if ready else []
        followers = {coupling.follower for coupling in remaining}
    return order


def _subtract(law: str, value: float) -> str:
    """Append the subtraction of a number to a law."""
    return law if value == 0.0 else f"{law} {'-' if value > 0.0 else '+'} {format_decimal(abs(value))}"


def _format_limits(compiled: CompiledModel, joint: int, step: TreeJoint) -> str:
    """Make the remark of a joint: its name in MuJoCo, if it differs, and its range."""
    remarks = [format_original_name("joint", step.name, compiled.name("joint", joint) or step.name)]
    if compiled.model.jnt_limited[joint]:
        low, high = (format_number(float(limit)) for limit in compiled.model.jnt_range[joint])
        remarks.append(f"limits {low} to {high} {'rad' if step.kind == 'pin' else 'm'}")
    return "; ".join(filter(None, remarks))


def _iter_motors(compiled: CompiledModel, joint: int) -> Iterator[str]:
    """Describe the actuators on a joint."""
    kinds = {int(compiled.mujoco.mjtTrn.__members__[word]) for word in ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")}
    for number in range(int(compiled.model.nu)):
        if (
            int(compiled.model.actuator_trntype[number]) in kinds
            and int(compiled.model.actuator_trnid[number][0]) == joint
        ):
            gear = format_number(float(compiled.model.actuator_gear[number][0]))
            yield f"{compiled.describe_part('actuator', number)}, gear {gear}"
