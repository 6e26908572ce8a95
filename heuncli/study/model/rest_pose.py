"""`analysis: {type: rest}`: the scene at rest becomes the start of a state, with what is told of how it rests."""

from __future__ import annotations

import time

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.digits import beside
from heuncli.loads.equilibrium.finer import CheckedPose, checked, left_by_the_way
from heuncli.loads.equilibrium.pose import bearing
from heuncli.loads.equilibrium.rest_check import require_still
from heuncli.loads.equilibrium.search import RestSearch
from heuncli.loads.equilibrium.slopes import decided_by
from heuncli.loads.equilibrium.stability import Motion, Stability, stability
from heuncli.loads.equilibrium.steady_states import going_on, require_constant, require_steady, require_together
from heuncli.motion.integration.diagnosis.solvability import Wording, require_solvable
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import displacement
from heuncli.motion.linearisation.indifference import indifference
from heuncli.motion.linearisation.smoothness import examine_laws, find_roots
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Status
from heuncli.study.model.counts_and_lists import MOST_NAMES, count, some
from heuncli.study.model.other_pose import other_pose


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
    search = RestSearch(scene, runner, 0.0, tolerances.REST_BENT)
    require_together(runner, search.coordinates, search.begun())
    both = checked(scene, runner, 0.0)
    found = both.found
    if holds_speed(runner.layout).any():
        require_no_way(runner.layout, found.pose.state)
    require_steady(runner, found.coordinates, found.pose, found.slopes)
    law = found.slopes.law
    what = indifference(scene, 0.0, found.pose.holding, law)
    found = replace(found, slopes=decided_by(found.slopes, what))
    states, bends = beside(runner, found, what)
    own = stability(scene, found.coordinates, law, found.pose.recovered, what, bends)
    layout = replace(scene.layout, y0=found.pose.state)
    without_slope = list(find_roots(examine_laws(layout, 0.0, layout.y0)))
    warnings = ridge(layout, both) if without_slope else (*unstable(own), *ridge(layout, both))
    again = Runner(layout)
    require_still(again, found.coordinates, bearing(again, found.coordinates, 0.0, layout.y0))
    rest = Rest(
        steps=both.steps, evaluations=both.evaluations, seconds=time.perf_counter() - begun,
        beside=(*states, *left_by_the_way(runner, found, both.way)),
        told=tuple(sentences(scene.mechanism, own, without_slope)), warnings=tuple(warnings),
    )  # fmt: skip
    return replace(scene, layout=layout), again, rest


def require_no_way(layout: Layout, state: Array) -> None:
    """Raise SolveError [no-rest-pose] where wheels would have to roll to a rest pose: which one hangs on the way."""
    place = places_of_rates(layout)
    moved = layout.weights[place[place >= 0]] * displacement(layout, layout.y0, state)
    if np.abs(moved).max(initial=0.0) <= tolerances.OFF_BALANCE:
        return
    message = "no rest pose: the start does not rest, and where wheels roll to hangs on the way there"
    hint = "a motion with dampers rolls there: analysis: {duration: ...}; or draw the scene where it rests"
    raise SolveError(Problem("no-rest-pose", message, hint=hint))


def sentences(mechanism: Mechanism, own: Stability, without_slope: list[str]) -> list[str]:
    """How the scene rests, in sentences: in which frame, stable or not, and along which motions it is indifferent.

    without_slope: sentences on loads that have no slope in the pose: its stability is not that of any stiffness.
    """
    drives = some(list(going_on(mechanism)))
    told = [f"at rest in the frame that goes along with {drives}"] if drives else []
    if without_slope:
        return [*told, f"whether the pose is stable is not decided: {'; '.join(without_slope)}"]
    least = f"the least eigenvalue of stiffness over inertia is {own.least:.4g} 1/s² ({own.slowest})"
    loose = own.indifferent + own.flat + own.edge
    if own.growth > 0.0:
        told.append(f"unstable: {own.grows} leaves it by exp({own.growth:.4g} t); {least}")
    elif own.slowest:
        swings = f", the slowest small oscillation has {own.frequency:.4g} Hz" if own.frequency else ""
        told.append(f"stable{' but for what is indifferent' if loose else ''}: {least}{swings}")
    elif not loose:
        told.append("nothing is free to move")
    if own.indifferent:
        what = f"{listed(own.indifferent)}, which nothing holds or pushes{by_itself(own)}"
        told.append(f"indifferent: {what}; where along it is by the way it came")
    if own.edge:
        told.append(
            f"at the edge of stability: {listed(own.edge)}, which moved aside sets going what nothing brings back"
        )
    if own.flat:
        told.append(f"indifferent to first order: {listed(own.flat)}, which what bends alone holds or pushes off")
    return told


def listed(motions: tuple[Motion, ...]) -> str:
    """Motions by what moves in them: one alone, or several in step."""
    return some(list(dict.fromkeys(in_step(motion) for motion in motions)))


def in_step(motion: Motion) -> str:
    """A motion by what moves in it, and by how much against the first."""
    if len(motion.names) == 1:
        return motion.names[0]
    units = motion.units if len(set(motion.units)) > 1 else ("",) * len(motion.units)
    shares = [f"{share:.3g} {unit}".strip() for share, unit in zip(motion.shares, units, strict=True)]
    more = len(motion.names) - MOST_NAMES
    names = " and ".join(motion.names[:MOST_NAMES]) + (f" and {more} more" if more > 0 else "")
    return f"{names} moved together as {' : '.join(shares[:MOST_NAMES])}"


def by_itself(own: Stability) -> str:
    """That what is held, or pushed off, moves in what nothing holds, too, but not by itself."""
    together = {name for motion in own.indifferent if len(motion.names) > 1 for name in motion.names}
    if own.slowest not in together:
        return ""
    return f" ({own.slowest} by itself is {'held' if own.least > 0.0 else 'pushed off'})"


def unstable(own: Stability) -> tuple[str, ...]:
    """A warning of a pose that the least push ends."""
    if not own.growth:
        return ()
    return (f"the rest pose is unstable: pushed a little, {own.grows} leaves it, by exp({own.growth:.4g} t)",)


def ridge(layout: Layout, both: CheckedPose) -> tuple[str, ...]:
    """A warning of a way that may end in another pose as well, with that one."""
    if both.elsewhere is None:
        return ()
    told = "the damped motion to the rest pose passes so near a ridge that its last digits decide where it ends"
    return (f"{told}: perhaps with {other_pose(layout, both.found.pose, both.elsewhere.pose)}",)
