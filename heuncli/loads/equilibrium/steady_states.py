"""Whether a scene may rest at all, and what turns or shifts at constant rates rests in its own frame: steady states.

What hangs on a driven body turns along. Loads that do not turn along, as weight across the axis, or parts that closed
chains move against the frame, keep it from resting: it is looked at once more when the drives have gone on.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.loads.equilibrium.coordinates import Coordinates, at_rest, driven_turns, resting
from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.equilibrium.reasons import no_rest
from heuncli.loads.equilibrium.slopes import Slopes
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.mechanism.model import Mechanism, path_of_load
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.shapes.rotations import about, quaternion_product, to_quaternion

LOOKED_AT = (0.0, 1e-3, 0.0317, 0.618, 1.0, 2.718, 14.14, 99.7)  # s; a smooth rate that is the same at all is constant
ACROSS = "weight across the axis, a spring to the ground? run a motion"
LATER = (0.37, 1.13, 2.71)  # how far drives have gone on when it is looked at again: rad, or of the size


def require_constant(mechanism: Mechanism) -> None:
    """Raise SolveError [no-rest-pose] where loads depend on the time, or the rates of drives do."""
    problems = [
        no_rest(f"{path_of_load(load)} depends on t", "give its value at rest, or run a motion with dampers")
        for load in mechanism.loads
        if any(value.time_dependent for value in load.values)
    ]
    for law in mechanism.laws:
        if not is_steady(law.value):
            hint = "a constant, or a constant rate: nothing rests beside what speeds up"
            problems.append(no_rest(f"{law.path} does not go on at a constant rate", hint))
    if problems:
        raise SolveError(*problems)


def is_steady(value: Expression) -> bool:
    """Whether a drive's value grows at a constant rate."""
    if not value.time_dependent:
        return True
    if value.switches or value.tables:
        return False
    rates, seconds = np.array([value.derivatives(t)[1:] for t in LOOKED_AT]).T
    size = float(np.abs(rates).max())
    return bool(np.ptp(rates) <= tolerances.SAME_VALUE * size and np.abs(seconds).max() <= tolerances.SAME_VALUE * size)


def going_on(mechanism: Mechanism) -> dict[str, float]:
    """How fast the drives that go on do so, by where they stand in the spec [rad/s or m/s]."""
    rates = {law.path: law.value.derivatives(0.0)[1] for law in mechanism.laws if law.value.time_dependent}
    return {path: rate for path, rate in rates.items() if rate != 0.0}


def require_together(evaluator: Evaluator, coordinates: Coordinates, at: Pose) -> None:
    """Raise SolveError [no-rest-pose] where closed chains move parts against what drives turn or shift."""
    rates = going_on(evaluator.layout.mechanism)
    if not rates:
        return
    asked = at_rest(evaluator, at.t, at.state[None, :], at.holding)[0]
    change = np.abs(at.state - asked)[coordinates.rates] * coordinates.weights
    largest = max(abs(rate) for rate in rates.values()) / max(1.0, evaluator.size)
    if change.max(initial=0.0) > tolerances.STEADY * largest:
        name, _ = coordinates.owner(int(np.argmax(change)))
        drives = " and ".join(rates)
        hint = "a rest needs drives that stand still, or that turn all that hangs on them as one; run a motion"
        raise SolveError(no_rest(f"{drives} {'keeps' if len(rates) == 1 else 'keep'} {name} moving", hint))


def require_steady(evaluator: Evaluator, coordinates: Coordinates, at: Pose, own: Slopes) -> None:
    """Raise SolveError [no-rest-pose] where a pose does not stay at rest in the frame of what goes on."""
    rates = going_on(evaluator.layout.mechanism)
    if not rates:
        return
    require_together(evaluator, coordinates, at)
    fastest = max(abs(rate) for rate in rates.values())
    terms = coordinates.terms(resting(evaluator, at.t, at.state[None, :], at.holding, causes=True))
    small = own.noise + tolerances.STEADY * (np.abs(own.inverse) @ (np.abs(own.back) @ terms))
    drives = " and ".join(rates)
    for way in LATER:
        t = at.t + way / fastest
        later = resting(evaluator, t, turned_on(evaluator.layout, at, t)[None, :], at.holding)
        left = np.abs(own.along(coordinates.accelerations(later)[0])) - small
        if (left > 0.0).any():
            worst = int(np.argmax(np.abs(own.T @ own.V[:, int(np.argmax(left))])))
            message = f"{coordinates.owner(worst)[0]} does not stay at rest in the frame that {drives} moves"
            raise SolveError(no_rest(f"{message}: loads do not go along with it", ACROSS))
        place = changes(at.recovered, later, evaluator.size)
        if place >= 0:
            layout = evaluator.layout
            name = layout.mechanism.bodies[layout.spanning.hangs[place].body].name
            message = f"what bodies.{name} carries changes as {drives} goes on: loads do not go along with it"
            raise SolveError(no_rest(message, ACROSS))


def changes(before: Recovered, later: Recovered, size: float) -> int:
    """A body whose joint carries something else than before, seen from the body; -1 where none does."""
    force, moment = (
        [np.einsum("nji,nj->ni", at.bodies["R"][0], at.bodies[name][0]) for at in (before, later)]
        for name in ("joint_force", "joint_moment")
    )
    largest = max(float(np.abs(force).max()), float(np.abs(moment).max()) / size)
    change = np.maximum(np.abs(force[1] - force[0]), np.abs(moment[1] - moment[0]) / size).max(axis=1)
    place = int(np.argmax(change))
    return place if change[place] > tolerances.STEADY * largest else -1


def turned_on(layout: Layout, at: Pose, t: float) -> Array:
    """The state at a later instant in which everything hangs on what drives turn as it does at a pose, (n_state,)."""
    state, R = at.state.copy(), at.recovered.bodies["R"][0]
    turned = np.repeat(np.eye(3)[None], len(R) + 1, axis=0)  # of each body since then; the last is the ground
    for place, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        turned[place] = turned[parent]
        for k, axis in driven_turns(layout, place):
            value = drive_of(layout, k)
            s = axis if parent < 0 else R[parent] @ axis
            turned[place] = turned[place] @ about(s, value.value(t) - value.value(at.t))
        if body["ball"]:
            own = slice(int(body["attitude_at"]), int(body["attitude_at"]) + 4)
            state[own] = quaternion_product(to_quaternion(turned[place]), state[own])
    return state


def drive_of(layout: Layout, freedom: int) -> Expression:
    """The value of the drive of a freedom of the tree."""
    drive = layout.mechanism.joints[layout.freedoms[freedom].joint].drive
    assert drive is not None
    return drive.value
