"""Find the requested flywheel of a scene."""

from __future__ import annotations

from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.flywheel import find_flywheel, require_position_loads
from heuncli.analyses.balancing.loaded_scene import make_loaded_scene
from heuncli.analyses.balancing.options import FlywheelRequest
from heuncli.analyses.balancing.results import BalanceResults, Flywheel
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.scene.file_format.models import Spec


def add_flywheel(
    results: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, request: FlywheelRequest
) -> BalanceResults:
    """Return the results with the requested flywheel. Raises SolveError [no-flywheel]."""
    wheel = find_requested_flywheel(spec, scene, plan, request)
    notes = (*results.notes, *describe_flywheel(wheel), *wheel.notes)
    return replace(results, flywheel=wheel, notes=tuple(dict.fromkeys(notes)))


def find_requested_flywheel(spec: Spec, scene: PreparedScene, plan: CyclePlan, request: FlywheelRequest) -> Flywheel:
    """Find the flywheel on the cycle's shaft. Raises SolveError [no-flywheel]."""
    if request.joint not in ("", plan.joint):
        message = f"--flywheel {request.joint}: a flywheel is sized only for the shaft of the cycle, {plan.joint}"
        raise SolveError(
            Problem("no-flywheel", message, hint=f"--cycle {request.joint}, or --flywheel {plan.joint}=1%")
        )
    if plan.in_time:
        message = "no flywheel for a model with several drives: they prescribe every speed"
        raise SolveError(Problem("no-flywheel", message, hint="leave out the drives that the flywheel is to replace"))
    if plan.rate is None:
        message = "the mean speed of the machine is not known"
        raise SolveError(Problem("no-flywheel", message, hint="for example --rate 1500rpm"))
    require_position_loads(scene.mechanism)
    loaded_scene = make_loaded_scene(spec, scene, scene.mechanism, replace(plan, rate=1.0), 1.0)
    return find_flywheel(loaded_scene, plan.joint, abs(plan.rate), request.delta)


def describe_flywheel(wheel: Flywheel) -> tuple[str, ...]:
    """Return the notes on a flywheel."""
    notes = []
    if wheel.even:
        notes.append(
            f"the loads do net work over the cycle: the flywheel is sized with a constant torque of "
            f"{wheel.even:.6g} N·m on {wheel.joint} that balances it"
        )
    if wheel.added == 0.0:
        notes.append(f"no flywheel needed: the speed fluctuation is {wheel.present:.4g} without one")
    return tuple(notes)
