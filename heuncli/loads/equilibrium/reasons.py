"""Why a scene has no rest pose, in the words of an error."""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.multibody.mechanism.model import ThreadLoad, path_of_load
from heuncli.results.results import Array

CODE = "no-rest-pose"
MOST_NAMES = 3
HOLDS = "hold it by a joint, a spring or a stop, or leave it out"


def no_rest(message: str, hint: str) -> Problem:
    """A problem of this kind."""
    return Problem(CODE, f"no rest pose: {message}", hint=hint)


def run_away(coordinates: Coordinates, passed: Array, far: Array) -> Problem:
    """The problem of coordinates that go on without end; passed (n,): how far they came; far (n,): against the rest."""
    gravity = coordinates.layout.mechanism.gravity
    sentences: dict[str, None] = {}
    for k in np.flatnonzero(far >= 0.5 * far.max()).tolist():
        name, turns = coordinates.owner(k)
        if turns:
            sentences[f"{name} turns on and on"] = None
        elif name.startswith("bodies."):
            falls = passed[free_shifts(coordinates, k)] @ gravity > 0.0
            sentences[f"{name} {'falls' if falls else 'moves on and on'}"] = None
        else:
            sentences[f"{name} slides on and on"] = None
    told = list(sentences)
    more = f" and {len(told) - MOST_NAMES} more" if len(told) > MOST_NAMES else ""
    rubs = any(isinstance(load, ThreadLoad) for load in coordinates.layout.mechanism.loads)
    hint = f"{HOLDS}; a self-locking thread creeps, and holds nothing at rest" if rubs else HOLDS
    return no_rest(f"{', '.join(told[:MOST_NAMES])}{more}: nothing holds it", hint)


def free_shifts(coordinates: Coordinates, number: int) -> Array:
    """The numbers of the three shifts of a body that nothing carries, one of which this is; else of that one thrice."""
    name, _ = coordinates.owner(number)
    own = [k for k in range(coordinates.count) if coordinates.owner(k)[0] == name and coordinates.shifts[k]]
    return np.array(own if len(own) == 3 else [number] * 3)


def endless(coordinates: Coordinates, at: Pose, steps: int) -> Problem:
    """The problem of a search that does not come to an end: where it was, and the largest force left."""
    layout = coordinates.layout
    states = body_states(layout, at.recovered)
    mass = np.array([body.mass for body in layout.mechanism.bodies])
    left = mass * np.sqrt(np.sum(states.a_centre[0] ** 2, axis=1))
    k = int(np.argmax(left))
    x, y, z = states.centre[0, k]
    name = layout.mechanism.bodies[k].name
    message = (
        f"the search did not end in {steps} steps; it was where the centre of bodies.{name} is at "
        f"({x:.6g}, {y:.6g}, {z:.6g}) m, with {left[k]:.3g} N left there"
    )
    hint = "loads that jump where they should hold (sign, step)? start nearer to the pose, or run a motion with dampers"
    return no_rest(message, hint)


def jumps(coordinates: Coordinates, at: Pose, shape: Array) -> Problem:
    """The problem of loads that push to where they change their sign at a jump; shape (n,): what they move."""
    name, _ = coordinates.owner(int(np.argmax(np.abs(shape) * coordinates.weights)))
    left = float(np.abs(at.accelerations * coordinates.weights).max())
    message = f"{name} is driven to where a load jumps, from both sides; nothing holds it there by itself"
    hint = f"give the jump a width, tanh(x/0.001) in place of sign(x); {left:.3g} 1/s² is left there"
    return no_rest(message, hint)


def singular(coordinates: Coordinates, at: Pose) -> Problem:
    """The problem of a way that ends in a singular pose: what moves there moves on in more than one way."""
    layout, rows = coordinates.layout, at.recovered.rows
    left_out = [r for r in range(len(layout.rows)) if rows["closed"][0, r] > rows["chosen"][0, r]]
    names = dict.fromkeys(layout.mechanism.owner(layout.rows[r]) for r in left_out)
    through = f" through {' and '.join(names)}" if names else ""
    message = f"the way there ends where the closed chain{through} is stretched, folded or flat: a singular pose"
    return no_rest(message, "from there it may go on in more than one way: limit it by a stop before that pose")


def no_value(coordinates: Coordinates, change: Array) -> Problem:
    """The problem of loads without a value, or a slope, where the search has come; change (k, f): beside the pose."""
    what = "value" if not np.isfinite(change).all() else "slope"
    layout = coordinates.layout
    loads = [path_of_load(load) for load in layout.mechanism.loads if any(e.constant is None for e in load.values)]
    which = f" ({', '.join(loads[:MOST_NAMES])})" if loads else ""
    message = f"the search came to where a load{which} has no {what}: a root, a logarithm, points that coincide"
    return no_rest(message, "start nearer to the pose, or give the load a value on both sides")
