"""A pose at which all coordinates rest, with its remaining accelerations and the contacts that bear."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.results.results import Array

if TYPE_CHECKING:
    from heuncli.multibody.tree.layout import Contact


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
    from heuncli.motion.integration.contacts.touching import CLOSED_BY_OTHERS

    open_state = make_pose(evaluator, coordinates, t, state, all_open).state
    holding, contacts = find_held_contacts(evaluator, t, open_state), slice(len(evaluator.layout.contacts))
    holding[contacts][holding[contacts] == CLOSED_BY_OTHERS] = 0.0
    return make_pose(evaluator, coordinates, t, state, holding)


def contact_opening(contact: Contact, pose: Pose) -> float:
    """Return how far a contact is open [m or rad]."""
    return -contact.sense * float(pose.evaluation.rows["gap"][0, contact.row])


def contact_force(contact: Contact, pose: Pose) -> float:
    """Return the load of a closed contact [N or N m]; negative if it would have to pull."""
    return -contact.sense * float(pose.evaluation.rows["multiplier"][0, contact.row])


def count_dependent_rows(pose: Pose) -> int:
    """Count the closed rows that depend on others."""
    rows = pose.evaluation.rows
    return int(np.count_nonzero(rows["closed"][0])) - int(np.count_nonzero(rows["chosen"][0]))
