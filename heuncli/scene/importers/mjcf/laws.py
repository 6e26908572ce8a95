"""What moves the joints: drives at a parameter each, couplings as drives by the parameter of the joint that leads.

A coordinate of MuJoCo's is not 0 where the machine is drawn if its joint has a `ref`; that of a spec is. Parameters
have MuJoCo's values, and the laws of the drives take the difference off: angle = elbow - ref. A keyframe's rate goes
in, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import DescribedEntry, DescribedParameter
from heuncli.scene.importers.mjcf.closings import JointEquality, left_out, moved
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.holding import HeldJoints
from heuncli.scene.importers.mjcf.tree import COORDINATE, RATE, JointTree, TreeStep
from heuncli.scene.importers.names import called
from heuncli.scene.importers.spec_text import number_text, pointed
from heuncli.scene.importers.told_moving import told_moving

HELD_HINT = "drives hold what moves by itself; of this coupling neither joint does"


class JointLaws(NamedTuple):
    """What moves the joints. initial: start values of free joints by name; driven: numbers of those with a drive."""

    parameters: tuple[DescribedParameter, ...]
    drives: tuple[DescribedEntry, ...]
    initial: dict[str, dict[str, str]]
    driven: frozenset[int]
    told: tuple[str, ...]
    couplings: tuple[DescribedEntry, ...]
    left_out: tuple[Problem, ...]


class _Making:
    """The laws of one model while they are made; laws: of the joints of MuJoCo's, in its coordinates."""

    def __init__(
        self, c: Compiled, tree: JointTree, idle: tuple[JointEquality, ...], q: Any, qd: Any, asked: ImportAsked
    ) -> None:
        self.c, self.steps, self.q, self.qd, self.asked = c, tree.of_joint, q, qd, asked
        self.idle = idle
        self.parameters: list[DescribedParameter] = []
        self.drives: list[DescribedEntry] = []
        self.initial: dict[str, dict[str, str]] = {}
        self.laws: dict[int, str] = {}
        self.couplings: dict[int, DescribedEntry] = {}  # by the joint that follows
        self.driven: set[int] = set()
        self.left_out: list[Problem] = []

    def hold(self, joint: int) -> None:
        """A joint that stands, or starts, where its parameter says."""
        c, step = self.c, self.steps[joint]
        rate = float(self.qd[c.model.jnt_dofadr[joint]])
        value = self.start(joint)
        self.parameters.append(DescribedParameter(step.name, value_text(step, value), _limits(c, joint, step)))
        place = _less(step.name, zero(c, joint))
        if self.asked.free:
            self.initial[step.name] = {COORDINATE[step.kind]: place}
            if self.qd.any():  # without a rate of its own a body would rather rest in the world than on its parent
                self.initial[step.name][RATE[step.kind]] = number_text(rate)
            return
        moving = f" {'-' if rate < 0.0 else '+'} {pointed(abs(rate))}*t" if rate else ""
        self.laws[joint] = step.name + moving
        self.drive(joint, place + moving)

    def start(self, joint: int) -> float:
        """MuJoCo's coordinate at the start; where stops are to hold it, and it lies beyond them, the nearest."""
        model, value = self.c.model, float(self.q[self.c.model.jnt_qposadr[joint]])
        if not (self.asked.limits and model.jnt_limited[joint]):
            return value
        low, high = (float(limit) for limit in model.jnt_range[joint])
        return min(max(value, low), high)

    def follow(self, coupling: JointEquality) -> None:
        """A joint that follows another, by the law of that one."""
        c, step = self.c, self.steps[coupling.slave]
        if self.asked.free:
            self.couple(coupling)
            return
        argument = None if coupling in self.idle else self.argument(coupling)
        if argument is None or coupling.slave in self.driven:
            none = "a joint that nothing else holds"
            why = f"{step.name} follows {none if argument is None else 'twice, by another equality, too'}"
            self.left_out.append(left_out(c, "equality", coupling.equality, why, HELD_HINT))
            return
        law = moved(coupling.polynomial if argument else coupling.polynomial[:1], argument)
        self.laws[coupling.slave] = _less(law, -zero(c, coupling.slave))
        leads = (
            ""
            if coupling.master is None
            else f"; of a motion its law is {self.steps[coupling.master].name}'s, by this rule"
        )
        self.drive(coupling.slave, law, f"{c.told('equality', coupling.equality)}{leads}")

    def couple(self, coupling: JointEquality) -> None:
        """A free joint that follows another in a fixed ratio. Raises SpecError for any other polynomial."""
        c, step = self.c, self.steps[coupling.slave]
        start, slope, *more = (*coupling.polynomial, 0.0, 0.0)
        if coupling.master is None or slope == 0.0 or any(more) or coupling.slave in self.couplings:
            message = f"joint {step.name} follows another by more than a ratio, which free joints do not"
            place = c.location("equality", coupling.equality)
            raise SpecError(
                Problem("import-mimic", message, place, "leave --free out: drives hold them in their ratio")
            )
        # of MuJoCo's coordinates, each less that of the drawing, which the spec's are counted from
        leader = self.steps[coupling.master].name
        keys = {"type": "ratio", "of": (step.name, leader), "factors": (1.0, -slope), "is": start}
        told = c.told("equality", coupling.equality)
        self.couplings[coupling.slave] = DescribedEntry(f"follow_{step.name}", keys, told)

    def drive(self, joint: int, law: str, remark: str = "") -> None:
        step = self.steps[joint]
        self.driven.add(joint)
        motors = ", ".join(_motors(self.c, joint))
        remark = "; ".join(filter(None, (remark, motors)))
        self.drives.append(
            DescribedEntry(f"hold_{step.name}", {"joint": step.name, COORDINATE[step.kind]: law}, remark)
        )

    def argument(self, coupling: JointEquality) -> str | None:
        """What a coupling is a polynomial of, its leader's way from the zero; empty: of nothing; None: unknown."""
        if coupling.master is None:
            return ""
        law = self.laws.get(coupling.master)
        if law is None:
            return None
        law = _less(law, zero(self.c, coupling.master))
        return law if law.isidentifier() else f"({law})"

    def told(self) -> tuple[str, ...]:
        """How the joints are moved."""
        if not self.parameters:
            return ()
        first = self.parameters[0]
        another = "10 mm" if str(first.value).endswith(" m") else "30 deg"
        return told_moving(first.name, another, free=self.asked.free, at_rest=False)


def laws_of(
    c: Compiled,
    tree: JointTree,
    held: HeldJoints,
    couplings: tuple[JointEquality, ...],
    q: Any,
    qd: Any,
    asked: ImportAsked,
) -> JointLaws:
    """The parameters and drives: q, qd are MuJoCo's coordinates and rates at the start. Raises SpecError."""
    idle = tuple(coupling for coupling in couplings if coupling not in held.followed)
    making = _Making(c, tree, idle, q, qd, asked)
    for joint in held.joints:
        making.hold(joint)
    for coupling in (*_in_order(held.followed), *idle):
        making.follow(coupling)
    return JointLaws(
        tuple(making.parameters),
        tuple(making.drives),
        making.initial,
        frozenset(making.driven),
        making.told(),
        tuple(making.couplings.values()),
        tuple(making.left_out),
    )


def zero(c: Compiled, joint: int) -> float:
    """MuJoCo's coordinate of a joint where the machine is drawn."""
    return float(c.model.qpos0[c.model.jnt_qposadr[joint]])


def value_text(step: TreeStep, value: float) -> str:
    """A coordinate with its unit; in degrees where that is a short number, as people write them."""
    if step.kind != "pin":
        return f"{number_text(value)} m"
    degrees = float(f"{math.degrees(value):.6g}")
    exact = math.isclose(math.radians(degrees), value, rel_tol=4e-16, abs_tol=0.0)
    return f"{number_text(degrees)} deg" if exact else f"{number_text(value)} rad"


def _in_order(couplings: tuple[JointEquality, ...]) -> list[JointEquality]:
    """Those that are followed before those that follow; of a circle those that are left over come last."""
    waiting, order = list(couplings), []
    slaves = {coupling.slave for coupling in waiting}
    while waiting:
        ready = [coupling for coupling in waiting if coupling.master not in slaves]
        order += ready or waiting
        waiting = [coupling for coupling in waiting if coupling not in ready] if ready else []
        slaves = {coupling.slave for coupling in waiting}
    return order


def _less(law: str, value: float) -> str:
    """A law less a number."""
    return law if value == 0.0 else f"{law} {'-' if value > 0.0 else '+'} {pointed(abs(value))}"


def _limits(c: Compiled, joint: int, step: TreeStep) -> str:
    """The joint of MuJoCo's, where the name is not its own; its range."""
    remarks = [called("joint", step.name, c.name("joint", joint) or step.name)]
    if c.model.jnt_limited[joint]:
        low, high = (number_text(float(limit)) for limit in c.model.jnt_range[joint])
        remarks.append(f"limits {low} to {high} {'rad' if step.kind == 'pin' else 'm'}")
    return "; ".join(filter(None, remarks))


def _motors(c: Compiled, joint: int) -> Iterator[str]:
    """The actuators on a joint."""
    kinds = {int(c.mujoco.mjtTrn.__members__[word]) for word in ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")}
    for number in range(int(c.model.nu)):
        if int(c.model.actuator_trntype[number]) in kinds and int(c.model.actuator_trnid[number][0]) == joint:
            yield f"{c.told('actuator', number)}, gear {number_text(float(c.model.actuator_gear[number][0]))}"
