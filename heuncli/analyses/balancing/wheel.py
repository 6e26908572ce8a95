"""The flywheel of a scene as asked for."""

from __future__ import annotations

from heuncli.analyses.balancing.asked import AskedWheel
from heuncli.analyses.balancing.choice import CyclePlan
from heuncli.analyses.balancing.flywheel import flywheel, require_placed
from heuncli.analyses.balancing.loaded import loaded
from heuncli.analyses.balancing.results import BalanceResults, Flywheel
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.scene.file_format.models import Spec


def with_wheel(
    found: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, asked: AskedWheel
) -> BalanceResults:
    """The results with the flywheel that is asked for. Raises SolveError where there is none."""
    wheel = wheel_of(spec, scene, plan, asked)
    notes = (*found.notes, *notes_on(wheel), *wheel.notes)
    return replace(found, flywheel=wheel, notes=tuple(dict.fromkeys(notes)))


def wheel_of(spec: Spec, scene: PreparedScene, plan: CyclePlan, asked: AskedWheel) -> Flywheel:
    """The wheel on the cycle's shaft."""
    if asked.joint not in ("", plan.joint):
        message = f"--flywheel {asked.joint}: a wheel is found for the shaft that the cycle is counted on, {plan.joint}"
        raise SolveError(Problem("no-flywheel", message, hint=f"--cycle {asked.joint}, or --flywheel {plan.joint}=1%"))
    if plan.in_time:
        message = "a scene of several drives does not run by itself: their motors hold every rate"
        raise SolveError(Problem("no-flywheel", message, hint="leave the drives out that the wheel is to replace"))
    if plan.rate is None:
        message = "how fast the machine runs in the mean is not known"
        raise SolveError(Problem("no-flywheel", message, hint="--rate 1500rpm, say"))
    require_placed(scene.mechanism)
    own = loaded(spec, scene, scene.mechanism, replace(plan, rate=1.0), 1.0)
    return flywheel(own, plan.joint, abs(plan.rate), asked.delta)


def notes_on(wheel: Flywheel) -> tuple[str, ...]:
    """What is to be told of it beside its numbers."""
    found = []
    if wheel.even:
        found.append(
            f"the loads do work over the cycle: for the flywheel an even torque of {wheel.even:.6g} N·m "
            f"on {wheel.joint} takes or gives it"
        )
    if wheel.added == 0.0:
        found.append(f"no flywheel is needed: the machine runs with an unevenness of {wheel.present:.4g} as it is")
    return tuple(found)
