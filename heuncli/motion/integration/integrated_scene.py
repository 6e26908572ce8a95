"""The scene that is integrated: the given one, or a reduced one with the same motion (multibody/reduction/model.py)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.reduction.model import ReducedScene
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


@record
class IntegratedScene:
    """The scene whose motion is integrated, its work arrays, and the maps between its states and those of the full
    scene.

    embed: maps instants (n_t,) and reduced states (n_t, n') to full states (n_t, n)
    restrict: maps an instant and a full state (n,) to a reduced state
    """

    layout: Layout
    workspace: Workspace
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]

    def embed_state(self, t: float, state: Array) -> Array:
        """Return the full state of one reduced state."""
        full_state: Array = self.embed(np.array([t]), state[None, :])[0]
        return full_state

    def find_contact(self, row: int) -> int:
        """Return the number of the contact that a closure row of the integrated scene belongs to."""
        return next(i for i, contact in enumerate(self.layout.contacts) if contact.row == row)

    def find_rope(self, row: int) -> str:
        """Return the name of the rope that a closure row of the integrated scene belongs to."""
        return self.layout.mechanism.owner_path(self.layout.rows[row]).partition(".")[2]


def integrate_itself(scene: Evaluator) -> IntegratedScene:
    """Integrate the scene without any reduction."""
    return IntegratedScene(scene.layout, scene.workspace, lambda times, states: states, lambda t, state: state)


def integrate_reduced(scene: Evaluator, reduction: ReducedScene) -> IntegratedScene:
    """Integrate a reduced scene, ready to run, in place of the one it was made from."""
    return IntegratedScene(scene.layout, scene.workspace, reduction.embed, reduction.restrict)
