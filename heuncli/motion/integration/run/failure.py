"""Why a run cannot go on where the kernel's loop has ended. Imported only on the way to an error."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.diagnosis.domains import FARTHEST, coordinates_at, without_value
from heuncli.motion.integration.diagnosis.growth import growing, largest_load
from heuncli.motion.integration.diagnosis.jamming import jammed_beyond
from heuncli.motion.integration.diagnosis.ways import Moving, ways_left
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.run.errors import TROUBLE, ClosuresLost
from heuncli.motion.integration.run.kernel_loop import CHATTERING, HALF_TURN
from heuncli.motion.integration.run.progress import Progress
from heuncli.multibody.mechanism.model import BushingLoad
from heuncli.scene.expressions.programs import Expression


class Ended:
    """Where a run has ended, answered once for all that ask."""

    def __init__(self, progress: Progress) -> None:
        self.progress, self.t, self.scene = progress, progress.t, progress.scene
        self.mechanism = progress.scene.layout.mechanism

    @cached_property
    def recovered(self) -> Recovered:
        """The answers there."""
        return self.scene.recovered(np.array([self.t]), self.progress.state[None, :])

    @cached_property
    def coordinates(self) -> Moving:
        """What expressions use, there."""
        return coordinates_at(self.scene.layout, self.recovered, 0)


def failure(progress: Progress, code: int) -> SolveError:
    """The error of a run that the kernel's loop ended with a code."""
    t, scene, loop = progress.t, progress.scene, progress.kernel.loop
    if code == CHATTERING:
        return SolveError(chattering(t, *scene.layout.pack.branches[loop.turning]))
    if code == HALF_TURN:
        from heuncli.motion.integration.diagnosis.half_turns import half_turn  # the global chart alone has them

        itself = progress.moving.layout is scene.layout
        return half_turn(progress.moving, loop.half_turn, t, progress.integrated_state, itself=itself)
    name, message, hint = TROUBLE[code]
    ended = Ended(progress)
    if name == "closure-lost":
        if known := ways_ended(ended) or turned_bushings(ended) or loads_ended(ended):
            return SolveError(*known)
        problem = Problem(name, f"at t = {t:.9g} s: {message}", hint=hint)
        return ClosuresLost(problem, passed=progress.passed, failed=t, last=progress.last)
    return without_acceleration(ended, name, message, hint)


def ways_ended(ended: Ended) -> list[Problem]:
    """The problems of points that have run off their paths there, and of cams that have turned off their lifts.

    No closed chain has to be looked at for them, though one that hangs on them is lost with them.
    """
    mechanism = ended.mechanism
    on_cams = any(coupling.given.type == "cam" for coupling in mechanism.couplings)
    if not on_cams and all(joint.path is None for joint in mechanism.joints):
        return []
    return ways_left(mechanism, ended.t, ended.progress.last * 2.0**-FARTHEST, ended.coordinates)


def loads_ended(ended: Ended) -> list[Problem]:
    """The problems of loads that lose their values there while couplings are held: their rows cannot answer them."""
    if not ended.mechanism.couplings:
        return []
    return without_value(ended.mechanism, ended.t, ended.progress.last, ended.coordinates)


def without_acceleration(ended: Ended, name: str, message: str, hint: str) -> SolveError:
    """An expression without a value there, else one that grows without bound, else what the kernel's code means."""
    progress, t, scene, mechanism = ended.progress, ended.t, ended.scene, ended.mechanism
    problems = without_value(mechanism, t, progress.last, ended.coordinates)
    if not problems and mechanism.rubbing:
        problems = jammed_beyond(mechanism, progress.moving.workspace, t)
    problems = problems or turned_bushings(ended)
    problems = problems or growing(scene, t, progress.state, progress.passed)
    if problems:
        return SolveError(*problems)
    hint = "; ".join(filter(None, [hint, largest_load(mechanism, ended.recovered)]))
    hangs = scene.layout.spanning.hangs
    light = sorted({f"bodies.{mechanism.bodies[hangs[i].body].name}" for i in scene.layout.tables["lents"]["body"]})
    if light and name == "step-collapsed":
        hint += f", as where closed loops cease to hold the turn of what has no inertia: {', '.join(light)}"
    return SolveError(Problem(name, f"at t = {t:.9g} s: {message}", hint=hint))


def turned_bushings(ended: Ended) -> list[Problem]:
    """Those by which a run ends, of whatever it is that fails there: by their moment, which jumps."""
    if not any(isinstance(load, BushingLoad) for load in ended.mechanism.loads):
        return []
    from heuncli.motion.integration.diagnosis.turned_bushings import at_half_turn

    return at_half_turn(ended.mechanism, ended.recovered, 0)


def chattering(t: float, expression: Expression, branch: int) -> Problem:
    """The problem of a branch that turns back as soon as it turned: the motion would have to stay between."""
    message = (
        f"at t = {t:.9g} s '{expression.held[branch]}' in '{expression.source.strip()}' chatters: "
        "it changes back as soon as it has changed, for on either side the motion is driven to the other"
    )
    hint = "what sticks needs a smooth law: tanh(rate/0.001) in place of sign(rate), or a force of type friction"
    return Problem("chattering", message, expression.location, hint)
