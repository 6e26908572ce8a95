"""The scene that is integrated: the given one, or a smaller one of the same motion (multibody/reduction/model.py)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.reduction.model import Reduced
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


@record
class IntegratedScene:
    """The scene whose motion is integrated, its work arrays, and the maps between its states and the scene's own.

    embed: instants (n_t,) and its states (n_t, n') to the scene's (n_t, n); restrict: an instant and a state (n,) back.
    """

    layout: Layout
    workspace: Workspace
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]

    def state(self, t: float, state: Array) -> Array:
        """The scene's own state of one of the smaller scene's."""
        own: Array = self.embed(np.array([t]), state[None, :])[0]
        return own

    def contact(self, row: int) -> int:
        """Which of the contacts a closure row of the smaller scene is."""
        return next(i for i, contact in enumerate(self.layout.contacts) if contact.row == row)

    def rope(self, row: int) -> str:
        """The rope that a closure row of the smaller scene is."""
        return self.layout.mechanism.owner(self.layout.rows[row]).partition(".")[2]


def itself(scene: Evaluator) -> IntegratedScene:
    """The scene as it is."""
    return IntegratedScene(scene.layout, scene.workspace, lambda times, states: states, lambda t, state: state)


def smaller(scene: Evaluator, reduced: Reduced) -> IntegratedScene:
    """A smaller scene, ready to run, in the place of the one it was made from."""
    return IntegratedScene(scene.layout, scene.workspace, reduced.embed, reduced.restrict)
