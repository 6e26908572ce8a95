"""What moves the joints: drives at a parameter each, couplings as drives by the parameter of the joint that they follow.

A coordinate of MuJoCo's is not 0 where the machine is drawn if its joint has a `ref`; that of a spec is. Parameters have
MuJoCo's values, and the laws of the drives take the difference off: angle = elbow - ref. A keyframe's rate goes in, too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from heuncli.conversion.described import DescribedEntry, DescribedParameter
from heuncli.conversion.mjcf.closings import Coupling, left_out, moved
from heuncli.conversion.mjcf.compiled import Compiled
from heuncli.conversion.mjcf.tree import COORDINATE, Step, Tree
from heuncli.conversion.spec_text import number_text
from heuncli.errors import Problem
from heuncli.named_tuples import NamedTuple

FREE_COUPLINGS = "without --free the joint that it follows is held, and it is driven by that one's parameter"


class Laws(NamedTuple):
    """What moves the joints. driven: the numbers of the joints that have a drive."""

    parameters: tuple[DescribedParameter, ...]
    drives: tuple[DescribedEntry, ...]
    driven: frozenset[int]
    left_out: tuple[Problem, ...]


def laws_of(
    c: Compiled, tree: Tree, held: tuple[int, ...], couplings: tuple[Coupling, ...], q: Any, qd: Any, free: bool
) -> Laws:
    """The parameters and drives: q, qd are MuJoCo's coordinates and rates at the start."""
    model, steps = c.model, tree.of_joint
    parameters, drives, driven, problems = [], [], set(), []
    laws: dict[int, str] = {}
    for joint in () if free else held:
        step, value = steps[joint], float(q[model.jnt_qposadr[joint]])
        rate = float(qd[model.jnt_dofadr[joint]])
        parameters.append(DescribedParameter(step.name, value_text(step, value), _called(c, joint, step)))
        laws[joint] = step.name + (f" {'-' if rate < 0.0 else '+'} {number_text(abs(rate))}*t" if rate else "")
        driven.add(joint)
        drives.append(_drive(step, _less(laws[joint], zero(c, joint))))
    for coupling in _in_order(couplings):
        step = steps.get(coupling.slave)
        if step is None or step.kind not in COORDINATE:
            continue
        argument = _argument(c, laws, coupling)
        if argument is None:
            what = "the coupling of two joints" if coupling.master is not None else "a joint that is held by an equality"
            why = f"{what} is in a spec where drives hold them, and nothing holds the other one"
            problems.append(left_out(c, "equality", coupling.equality, why, FREE_COUPLINGS))
            continue
        law = moved(coupling.polynomial if argument else coupling.polynomial[:1], argument)
        laws[coupling.slave] = _less(law, -zero(c, coupling.slave))
        driven.add(coupling.slave)
        drives.append(_drive(step, law, f"follows, as {c.told('equality', coupling.equality)} says"))
    return Laws(tuple(parameters), tuple(drives), frozenset(driven), tuple(problems))


def zero(c: Compiled, joint: int) -> float:
    """MuJoCo's coordinate of a joint where the machine is drawn."""
    return float(c.model.qpos0[c.model.jnt_qposadr[joint]])


def value_text(step: Step, value: float) -> str:
    """A coordinate with its unit; in degrees where that is a short number, as people write them."""
    if step.kind != "pin":
        return f"{number_text(value)} m"
    degrees = float(f"{math.degrees(value):.6g}")
    exact = math.isclose(math.radians(degrees), value, rel_tol=4e-16, abs_tol=0.0)
    return f"{number_text(degrees)} deg" if exact else f"{number_text(value)} rad"


def _argument(c: Compiled, laws: Mapping[int, str], coupling: Coupling) -> str | None:
    """What a coupling is a polynomial of: the leading joint's way from its zero; empty: of nothing; None: nothing tells it."""
    if coupling.master is None:
        return ""
    law = laws.get(coupling.master)
    if law is None:
        return None
    law = _less(law, zero(c, coupling.master))
    return law if law.isidentifier() else f"({law})"


def _in_order(couplings: tuple[Coupling, ...]) -> list[Coupling]:
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
    return law if value == 0.0 else f"{law} {'-' if value > 0.0 else '+'} {number_text(abs(value))}"


def _drive(step: Step, law: str, remark: str = "") -> DescribedEntry:
    return DescribedEntry(f"hold_{step.name}", {"joint": step.name, COORDINATE[step.kind]: law}, remark)


def _called(c: Compiled, joint: int, step: Step) -> str:
    """MuJoCo's joint, where the name is not its own."""
    name = c.name("joint", joint)
    return "" if name == step.name else f"{c.told('joint', joint)}"
