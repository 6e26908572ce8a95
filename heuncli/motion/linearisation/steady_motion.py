"""Whether a motion is steady: at rest, or in a frame that its drives turn with it.

The linear equations then have constant coefficients. At rest nothing moves and nothing is pushed. Where something moves
steadily (what is driven, and what spins freely), the same must hold after the motion has gone on for a while, as seen
by what moved along: a weight across a turning shaft turns in the shaft's frame, and nothing settles there.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import displaced
from heuncli.motion.linearisation.indifference import Loose, indifference, loose
from heuncli.motion.linearisation.linearise import Linearised, linearised
from heuncli.motion.linearisation.oscillations import completed, norm
from heuncli.motion.linearisation.reduced_equations import ReducedEquations, balls, on_basis, reduced
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import from_vector

PHASES = (0.7, 2.0, 4.1)  # [rad] of the fastest turn, after which a steady motion is looked at again


@record
class Looked:
    """A scene looked at in one state: its linear equations, whole and reduced, and the loads there."""

    scene: PreparedScene
    runner: Runner
    t: float
    holding: Array
    found: Linearised
    at: Recovered
    system: ReducedEquations
    loose: Loose
    reach: float  # how far rounding moves the pose that rests [rad, or of the size]

    @property
    def layout(self) -> Layout:
        """How it is laid out."""
        return self.scene.layout

    @property
    def weights(self) -> Array:
        """Of the undriven freedoms: 1 of turns, 1 / size of shifts."""
        place = places_of_rates(self.layout)
        return np.asarray(self.layout.weights[place[place >= 0]])


def look(scene: PreparedScene, runner: Runner, t: float, state: Array, holding: Array) -> Looked:
    """Linearise a scene in a state. Raises SolveError [no-modes] where its laws have no slope."""
    found, at = equations(runner, t, state, holding)
    if not (np.isfinite(found.by_place).all() and np.isfinite(found.by_rate).all()):
        message = "a load has no slope there (a root at 0, an angle of a point that lies on the axis)"
        hint = "start a little beside it, or give the load a slope there: sqrt(x**2 + 1e-6) for abs(x)"
        raise SolveError(
            Problem("no-modes", f"{message}: oscillations about it are not linear, however small", hint=hint)
        )
    system = reduced(scene, found, at)
    what = indifference(scene, t, holding, found)
    return Looked(scene, runner, t, holding, found, at, system, loose(system, what), what.reach)


def equations(evaluator: Evaluator, t: float, state: Array, holding: Array) -> tuple[Linearised, Recovered]:
    """The linear equations in a state, and the kernel's answers there."""
    found = linearised(evaluator.layout, t, state, holding)
    return found, evaluator.recovered(np.array([t]), found.state[None, :], holding=holding)


def fastest(here: Looked) -> float:
    """The fastest turn of any body [rad/s], or speed of its centre over the scene's size."""
    turn, shift = (np.sqrt(np.sum(v**2, axis=1)).max(initial=0.0) for v in (here.found.omega, here.found.velocities))
    return float(max(turn, shift / here.layout.size))


def off_balance(here: Looked) -> float:
    """How far the state is from the one that rests, by the linear equations: the largest turn, or shift by the size.

    Infinite where what nothing holds is pushed.
    """
    return rest_displacement(here, here.system.pushed) if here.system.count else 0.0


def rest_displacement(here: Looked, push: Array) -> float:
    """How far a push (f,) moves the pose that rests, by the linear equations: the largest turn, or shift by the size.

    Infinite where it pushes what nothing holds.
    """
    system = here.system
    K = system.stiffness
    _, rest = completed(here.loose.right)
    x = rest @ np.linalg.lstsq(K @ rest, push, rcond=None)[0]
    if norm((push - K @ x)[:, None]) > tolerances.FREELY_PUSHED * system.loads:
        return np.inf
    return float(np.abs(here.weights * (system.tangent @ x)).max(initial=0.0))


def goes_on_as_it_is(here: Looked) -> bool:
    """Whether a steady motion has the same linear equations later on, as seen by what moved along.

    A push may change by a share of the loads, or by what moves the pose that rests by no more than a start may be off:
    with no loads at all every rounding is more than a share of them.
    """
    own = here.system
    size = max(norm(own.stiffness), own.terms)
    rate = size**0.5
    parts = ((own.A11, rate), (own.A21, size), (own.A22, rate), (np.eye(own.count), 1.0))
    for phase in PHASES:
        dt = phase / fastest(here)
        y, turn = carried_on(here, dt)
        found, at = equations(here.runner, here.t + dt, y, here.holding)
        if np.abs(found.state - y).max(initial=0.0) > tolerances.GOES_ON:
            return False  # it did not close
        T = turn @ own.tangent
        later = on_basis(here.layout, found, at, T, turn @ own.drift)
        push = later.pushed - own.pushed
        is_same_push = np.abs(push).max(initial=0.0) <= tolerances.GOES_ON * own.loads
        if not is_same_push and not rest_displacement(here, push) <= tolerances.OFF_BALANCE:
            return False
        again = (later.A11, later.A21, later.A22, T.T @ found.mass @ T)
        for (a, scale), b in zip(parts, again, strict=True):
            if np.abs(a - b).max(initial=0.0) > tolerances.GOES_ON * scale:
                return False
    return True


def carried_on(here: Looked, dt: float) -> tuple[Array, Array]:
    """The state a while later if its motion is steady, and how the freedoms' axes have turned, (n, n).

    A body on a ball first spins on in the frame of what it hangs on, then turns with that.
    """
    layout, place = here.layout, places_of_rates(here.layout)
    rates = here.found.state[place[place >= 0]]
    turn, carried = np.eye(len(rates)), np.zeros(len(rates))
    for first, _, carrier in balls(layout, here.found):
        turn[first : first + 3, first : first + 3] = from_vector(carrier * dt)
        carried[first : first + 3] = carrier * dt
    spun = displaced(layout, here.found.state, rates * dt - carried)
    return displaced(layout, spun, carried, turn @ rates - rates), turn
