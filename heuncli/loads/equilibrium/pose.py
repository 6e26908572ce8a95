"""A pose at which all coordinates rest, with what would accelerate them there, and the contacts that bear."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates, resting
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.results.results import Array

if TYPE_CHECKING:
    from heuncli.multibody.tree.layout import Contact


@record
class Pose:
    """A settled state (n_state,) at rest, the kernel's answers there, accelerations (n,), closed contacts (n_c,)."""

    t: float
    state: Array
    recovered: Recovered
    accelerations: Array
    holding: Array

    @property
    def is_sound(self) -> bool:
        """Whether there are accelerations, of coordinates that close."""
        return bool(np.isfinite(self.accelerations).all() and np.isfinite(self.recovered.gap).all())


def pose_at(evaluator: Evaluator, coordinates: Coordinates, t: float, state: Array, holding: Array) -> Pose:
    """The pose of a state whose rates are let go; holding: the contacts that are closed."""
    at = resting(evaluator, t, state[None, :], holding)
    return Pose(t, at.states[0], at, coordinates.accelerations(at)[0], holding)


def bearing(evaluator: Evaluator, coordinates: Coordinates, t: float, state: Array) -> Pose:
    """The pose at a state, its contacts closed where they touch and bear, open elsewhere.

    What others keep closed bears nothing: of two ropes that hold a mast between them one does, by where it is pushed.
    """
    none = evaluator.layout.all_open
    if not len(none):
        return pose_at(evaluator, coordinates, t, state, none)
    from heuncli.motion.integration.contacts.contact_events import held_at  # few scenes have them
    from heuncli.motion.integration.contacts.touching import LEANS

    still = pose_at(evaluator, coordinates, t, state, none).state
    holding, own = held_at(evaluator, t, still), slice(len(evaluator.layout.contacts))
    holding[own][holding[own] == LEANS] = 0.0
    return pose_at(evaluator, coordinates, t, state, holding)


def opening(contact: Contact, at: Pose) -> float:
    """How far a contact is open [m or rad]."""
    return -contact.sense * float(at.recovered.rows["gap"][0, contact.row])


def carried(contact: Contact, at: Pose) -> float:
    """What a closed contact puts on what it keeps from passing [N or N m]; one that would have to pull: negative."""
    return -contact.sense * float(at.recovered.rows["multiplier"][0, contact.row])


def dependent(at: Pose) -> int:
    """How many of the closed rows depend on the others."""
    rows = at.recovered.rows
    return int(np.count_nonzero(rows["closed"][0])) - int(np.count_nonzero(rows["chosen"][0]))
