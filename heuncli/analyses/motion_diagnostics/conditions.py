"""The largest condition numbers along a motion, and the poses where a matrix loses rank."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch
from heuncli.analyses.motion_diagnostics.numerics.condition import ConditionNumbers, compute_conditions
from heuncli.analyses.motion_diagnostics.results import NO_MASS, SINGULAR, Event, LargestCondition
from heuncli.loads.equilibrium.coordinates import Coordinates, make_coordinates

MAX_FREEDOMS = 400  # largest size of matrices that are formed
MAX_NUMBERS = 20_000_000  # numbers in these matrices at a time
MAX_INSTANTS = 400  # at most, at which the conditions are computed


def find_largest_conditions(motion: MotionSearch) -> tuple[LargestCondition | None, LargestCondition | None, str]:
    """Return the largest conditions of the mass matrix and of the closures, or the reason why they are missing."""
    layout = motion.layout
    layout_coordinates, n = make_coordinates(layout), layout.velocity_count
    if not layout_coordinates.count:
        return None, None, "0 degrees of freedom"
    if n > MAX_FREEDOMS:
        return None, None, f"{n} degrees of freedom, more than {MAX_FREEDOMS}: full matrices are not formed"
    instant_limit = max(1, MAX_NUMBERS // (6 * n * len(layout.place) + n * n + n * len(layout.rows)))
    times = motion.times[:: -(-len(motion.times) // min(MAX_INSTANTS, max(instant_limit, 4)))]
    recovered = motion.recover(times)
    numbers = compute_conditions(layout, layout_coordinates, recovered)
    if not numbers.lightest_motion.any():
        return None, None, "0 degrees of freedom"
    k, m = int(np.argmax(numbers.mass)), int(np.argmax(numbers.closure))
    mass = LargestCondition(float(numbers.mass[k]), float(times[k]), find_lightest(layout_coordinates, numbers, k))
    closure = LargestCondition(float(numbers.closure[m]), float(times[m])) if layout.rows else None
    return mass, closure, ""


def find_lightest(layout_coordinates: Coordinates, numbers: ConditionNumbers, k: int) -> str:
    """Return the joint or body that moves most in the motion with the least inertia."""
    return layout_coordinates.find_owner(int(np.argmax(np.abs(numbers.lightest_motion[k]))))[0]


def find_singular_events(motion: MotionSearch) -> list[Event]:
    """Return singular poses that the motion passes or begins in, and bodies without inertia about an axis."""
    study = motion.study
    loops = study.setup.scene.mechanism.owner_path(motion.layout.rows[0]) if motion.layout.rows else ""
    singular_text = (
        "closed loops are stretched, folded or flat: their constraints lose rank, several motions are possible"
    )
    events = [Event(t, SINGULAR, loops, singular_text) for t in study.history.singular]
    events += [
        Event(float(motion.times[0]), SINGULAR, loops, note)
        for note in study.setup.model["notes"]
        if note.startswith("the start is a singular position")
    ]
    for spin in study.setup.scene.idle_spins:
        name = study.setup.scene.mechanism.bodies[spin.body].name
        message = f"{name} has no inertia about its own axis: the full mass matrix is singular"
        events.append(Event(float(motion.times[0]), NO_MASS, f"bodies.{name}", message))
    return events
