"""A pose at which all coordinates rest, with its remaining accelerations and contacts; or why a scene has none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.errors import Problem
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.mechanism.loads import ThreadLoad
from heuncli.results.results import Array

if TYPE_CHECKING:
    from heuncli.multibody.tree.layout import Contact


# Pose


@record
class Pose:
    """A projected state (n_state,) at rest, the results there, accelerations (n,), closed contacts (n_c,)."""

    t: float
    state: Array
    evaluation: Evaluation
    accelerations: Array
    holding: Array

    @property
    def is_finite(self) -> bool:
        """Whether the accelerations and the closure gaps are finite."""
        return bool(np.isfinite(self.accelerations).all() and np.isfinite(self.evaluation.gap).all())


def make_pose(evaluator: Evaluator, coordinates: Coordinates, t: float, state: Array, holding: Array) -> Pose:
    """Make the pose of a state without its rates; holding: the closed contacts."""
    evaluation = evaluate_at_rest(evaluator, t, state[None, :], holding)
    return Pose(t, evaluation.states[0], evaluation, coordinates.accelerations(evaluation)[0], holding)


def make_bearing_pose(evaluator: Evaluator, coordinates: Coordinates, t: float, state: Array) -> Pose:
    """Make the pose at a state with contacts closed where they touch and bear, open elsewhere.

    A contact that others keep closed bears nothing: of two ropes that hold a mast between them, one bears, depending on
    where the mast is pushed.
    """
    all_open = evaluator.layout.open_contacts
    if not len(all_open):
        return make_pose(evaluator, coordinates, t, state, all_open)
    from heuncli.motion.integration.contacts.contact_events import find_held_contacts  # few scenes have them
    from heuncli.multibody.tree.layout import CLOSED_BY_OTHERS

    open_state = make_pose(evaluator, coordinates, t, state, all_open).state
    holding, contacts = find_held_contacts(evaluator, t, open_state), slice(len(evaluator.layout.contacts))
    holding[contacts][holding[contacts] == CLOSED_BY_OTHERS] = 0.0
    return make_pose(evaluator, coordinates, t, state, holding)


def find_contact_opening(contact: Contact, pose: Pose) -> float:
    """Return how far a contact is open [m or rad]."""
    return -contact.sense * float(pose.evaluation.rows["gap"][0, contact.row])


def find_contact_force(contact: Contact, pose: Pose) -> float:
    """Return the load of a closed contact [N or N m]; negative if it would have to pull."""
    return -contact.sense * float(pose.evaluation.rows["multiplier"][0, contact.row])


def count_dependent_rows(pose: Pose) -> int:
    """Count the closed rows that depend on others."""
    rows = pose.evaluation.rows
    return int(np.count_nonzero(rows["closed"][0])) - int(np.count_nonzero(rows["chosen"][0]))


# Reasons

CODE = "no-rest-pose"
MAX_NAMES = 3
HOLD_HINT = "constrain it by a joint, a spring or a stop, or leave it out"


def make_no_rest_problem(message: str, hint: str) -> Problem:
    """Make a problem of this kind."""
    return Problem(CODE, f"no rest position: {message}", hint=hint)


def make_runaway_problem(coordinates: Coordinates, displacement: Array, distances: Array) -> Problem:
    """Make the problem of coordinates that move without end.

    displacement (n,): how far they came
    distances (n,): relative to the limits
    """
    gravity = coordinates.layout.mechanism.gravity
    sentences: dict[str, None] = {}
    for k in np.flatnonzero(distances >= 0.5 * distances.max()).tolist():
        name, turns = coordinates.find_owner(k)
        if turns:
            sentences[f"{name} keeps rotating"] = None
        elif name.startswith("bodies."):
            falls = displacement[find_free_shifts(coordinates, k)] @ gravity > 0.0
            sentences[f"{name} {'falls' if falls else 'keeps moving'}"] = None
        else:
            sentences[f"{name} keeps sliding"] = None
    clauses = list(sentences)
    more = f" and {len(clauses) - MAX_NAMES} more" if len(clauses) > MAX_NAMES else ""
    has_thread_friction = any(
        isinstance(load, ThreadLoad) and load.static == 0.0 for load in coordinates.layout.mechanism.loads
    )
    hint = (
        f"{HOLD_HINT}; smoothed friction of a self-locking thread creeps, so it holds nothing at rest: leave out speed"
        if has_thread_friction
        else HOLD_HINT
    )
    return make_no_rest_problem(f"{', '.join(clauses[:MAX_NAMES])}{more}: nothing stops it", hint)


def find_free_shifts(coordinates: Coordinates, number: int) -> Array:
    """Return the numbers of the three shifts of a free body, one of which this is; otherwise three times the given
    one.
    """
    name, _ = coordinates.find_owner(number)
    body_shifts = [
        k for k in range(coordinates.count) if coordinates.find_owner(k)[0] == name and coordinates.shifts[k]
    ]
    return np.array(body_shifts if len(body_shifts) == 3 else [number] * 3)


def make_endless_search_problem(coordinates: Coordinates, pose: Pose, steps: int) -> Problem:
    """Make the problem of a search that does not end: where it was, and the largest remaining force."""
    layout = coordinates.layout
    states = make_body_states(layout, pose.evaluation)
    mass = np.array([body.mass for body in layout.mechanism.bodies])
    remaining_forces = mass * np.sqrt(np.sum(states.a_centre[0] ** 2, axis=1))
    k = int(np.argmax(remaining_forces))
    x, y, z = states.centre[0, k]
    name = layout.mechanism.bodies[k].name
    message = (
        f"the search did not converge in {steps} steps; at the last one the mass centre of bodies.{name} is at "
        f"({x:.6g}, {y:.6g}, {z:.6g}) m, with an unbalanced force of {remaining_forces[k]:.3g} N"
    )
    hint = "do loads jump (sign, step)? smooth them, start nearer to the rest position, or run a motion with dampers"
    return make_no_rest_problem(message, hint)


def make_jumping_load_problem(coordinates: Coordinates, pose: Pose, shape: Array) -> Problem:
    """Make the problem of loads that push towards a jump where they change sign; shape (n,): the motion that they
    drive.
    """
    name, _ = coordinates.find_owner(int(np.argmax(np.abs(shape) * coordinates.weights)))
    remaining = float(np.abs(pose.accelerations * coordinates.weights).max())
    message = f"{name} is driven from both sides to a jump of a load; it is in equilibrium on neither side"
    hint = f"smooth the jump: tanh(x/0.001) instead of sign(x); unbalanced acceleration {remaining:.3g} 1/s²"
    return make_no_rest_problem(message, hint)


def make_singular_pose_problem(coordinates: Coordinates, pose: Pose) -> Problem:
    """Make the problem of a path that ends in a singular position, from which several motions are possible."""
    layout, rows = coordinates.layout, pose.evaluation.rows
    left_out = [r for r in range(len(layout.rows)) if rows["closed"][0, r] > rows["chosen"][0, r]]
    names = dict.fromkeys(layout.mechanism.owner_path(layout.rows[r]) for r in left_out)
    through = f" through {' and '.join(names)}" if names else ""
    message = f"the search ends at a singular position: the closed loop{through} is stretched, folded or flat"
    return make_no_rest_problem(message, "more than one motion is possible from there: add a stop before that position")


def make_no_value_problem(coordinates: Coordinates, change: Array) -> Problem:
    """Make the problem of loads without a value, or a slope, where the search is; change (k, f): near the pose."""
    what = "value" if not np.isfinite(change).all() else "derivative"
    layout = coordinates.layout
    loads = [load.path for load in layout.mechanism.loads if any(e.constant is None for e in load.values)]
    which = f" ({', '.join(loads[:MAX_NAMES])})" if loads else ""
    message = f"the search reached a position where a load{which} has no {what}: a root, a logarithm, coincident points"
    return make_no_rest_problem(message, "start nearer to the rest position, or give the load a value on both sides")
