"""The largest condition numbers along a motion, and the poses at which a rank is lost."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.probing.instants import SearchedMotion
from heuncli.analyses.probing.numerics.condition import ConditionNumbers, conditions
from heuncli.analyses.probing.results import NO_MASS, SINGULAR, Event, LargestCondition
from heuncli.loads.equilibrium.coordinates import Coordinates, coordinates_of

MOST_FREEDOMS = 400  # of matrices that are looked at as a whole
ROOM = 20_000_000  # numbers of these at a time
INSTANTS = 400  # at which they are looked at


def conditions_of(along: SearchedMotion) -> tuple[LargestCondition | None, LargestCondition | None, str]:
    """The largest condition of the mass matrix and of the closures; why they are not told."""
    layout = along.layout
    own, n = coordinates_of(layout), layout.answer_count
    if not own.count:
        return None, None, "nothing is free to move"
    if n > MOST_FREEDOMS:
        return None, None, f"{n} freedoms, more than {MOST_FREEDOMS}: whole matrices are not formed"
    many = max(1, ROOM // (6 * n * len(layout.place) + n * n + n * len(layout.rows)))
    times = along.times[:: -(-len(along.times) // min(INSTANTS, max(many, 4)))]
    at = along.at(times)
    found = conditions(layout, own, at)
    if not found.light.any():
        return None, None, "drives and joints leave nothing free to move"
    k, m = int(np.argmax(found.mass)), int(np.argmax(found.closure))
    mass = LargestCondition(float(found.mass[k]), float(times[k]), lightest(own, found, k))
    closure = LargestCondition(float(found.closure[m]), float(times[m])) if layout.rows else None
    return mass, closure, ""


def lightest(own: Coordinates, found: ConditionNumbers, k: int) -> str:
    """The joint or body that moves most in the motion with the least inertia."""
    return own.owner(int(np.argmax(np.abs(found.light[k]))))[0]


def singular_events(along: SearchedMotion) -> list[Event]:
    """Singular poses that the motion passes or begins in, and bodies without inertia about an axis."""
    study = along.study
    loops = study.setup.scene.mechanism.owner(along.layout.rows[0]) if along.layout.rows else ""
    through = "closed chains are stretched, folded or flat: they lose rank, and may go on in more than one way"
    events = [Event(t, SINGULAR, loops, through) for t in study.history.singular]
    events += [
        Event(float(along.times[0]), SINGULAR, loops, note)
        for note in study.setup.model["notes"]
        if note.startswith("the start is a singular pose")
    ]
    for spin in study.setup.scene.idle:
        name = study.setup.scene.mechanism.bodies[spin.body].name
        what = f"{name} has no inertia about its own axis: a mass matrix of the whole is singular"
        events.append(Event(float(along.times[0]), NO_MASS, f"bodies.{name}", what))
    return events
