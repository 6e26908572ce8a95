"""`analysis: {type: rest}`: the scene at rest becomes the start of a state, with what is told of how it rests."""

from __future__ import annotations

import time

import numpy as np

from heuncli.integration.diagnosis.solvability import Wording, require_solvable
from heuncli.integration.run.runner import Runner
from heuncli.mechanism.model import Mechanism
from heuncli.records import record, replace
from heuncli.rest.digits import beside, softened
from heuncli.rest.pose import bearing
from heuncli.rest.rest_check import require_still
from heuncli.rest.search import RestSearch
from heuncli.rest.stability import Stability, stability
from heuncli.rest.steady_states import going_on, require_constant, require_steady, require_together
from heuncli.results import Array, Status
from heuncli.study.model.counts_and_lists import count, some
from heuncli.tree.prepare import PreparedScene


@record
class Rest:
    """How a rest pose was found: steps and evaluations, seconds; beside: states that rounding does not tell from it;
    told: how it rests, in sentences; warnings."""

    steps: int
    evaluations: int
    seconds: float
    beside: tuple[Array, ...]
    told: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def status(self) -> Status:
        """How the search ended."""
        return {"code": "completed", "message": f"at rest after {count(self.steps, 'step')} from the start"}


def at_rest(scene: PreparedScene, runner: Runner) -> tuple[PreparedScene, Runner, Rest]:
    """The scene with its rest pose as the start. Raises SolveError [no-rest-pose]."""
    begun = time.perf_counter()
    require_constant(scene.mechanism)
    first = runner.recovered(np.zeros(1), runner.layout.y0[None, :])
    require_solvable(scene, first, Wording("accelerations of the start"))
    search = RestSearch(runner, 0.0)
    require_together(runner, search.coordinates, search.begun())
    found = search.found()
    require_steady(runner, found.coordinates, found.pose, found.slopes)
    states, bends = beside(runner, found)
    firm = softened(found, states)
    own = stability(replace(found, slopes=firm), bends | (found.slopes.decided & ~firm.decided))
    layout = replace(scene.layout, y0=found.pose.state)
    again = Runner(layout)
    require_still(again, found.coordinates, bearing(again, found.coordinates, 0.0, layout.y0))
    rest = Rest(
        steps=found.steps, evaluations=found.evaluations, seconds=time.perf_counter() - begun,
        beside=tuple(states), told=tuple(sentences(scene.mechanism, own)),
        warnings=unstable(own),
    )  # fmt: skip
    return replace(scene, layout=layout), again, rest


def sentences(mechanism: Mechanism, own: Stability) -> list[str]:
    """How the scene rests, in sentences: in which frame, stable or not, and along which motions it is indifferent."""
    drives = some([f"drives.{name}" for name in going_on(mechanism)])
    told = [f"at rest in the frame that goes along with {drives}"] if drives else []
    least = f"the least eigenvalue of stiffness over inertia is {own.least:.4g} 1/s² ({own.slowest})"
    if own.growth > 0.0:
        told.append(f"unstable: {own.grows} leaves it by exp({own.growth:.4g} t); {least}")
    elif own.slowest:
        swings = f", the slowest small oscillation has {own.frequency:.4g} Hz" if own.frequency else ""
        told.append(f"stable: {least}{swings}")
    elif not own.indifferent and not own.flat:
        told.append("nothing is free to move")
    if own.indifferent:
        elsewhere = f"{some(list(own.indifferent))} would stay elsewhere as well"
        told.append(f"indifferent: {elsewhere}; where along it is by the way it came")
    if own.flat:
        told.append(f"indifferent to first order: {some(list(own.flat))}, which what bends alone holds or pushes off")
    return told


def unstable(own: Stability) -> tuple[str, ...]:
    """A warning of a pose that the least push ends."""
    if not own.growth:
        return ()
    return (f"the rest pose is unstable: pushed a little, {own.grows} leaves it, by exp({own.growth:.4g} t)",)
