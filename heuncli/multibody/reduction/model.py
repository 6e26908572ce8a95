"""A smaller scene that moves as a larger one does, and is integrated in its place.

    y = embed(t, y'),   y' = restrict(t, y)        states of the larger and of the smaller scene

The smaller scene has the same loads, drives, impulses, stops and contacts, in the same order, so that the branches of
expressions and the closed contacts mean the same in both; a load whose body is part of the ground acts on the ground.
It has the same size, so that tolerances mean the same. Results at an instant are computed from the larger scene, at y.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.base.records import record
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array


@record
class Reduction:
    """One step to a smaller scene.

    embed: maps instants (n_t,) and states (n_t, n') of the smaller scene to those of the larger, (n_t, n)
    restrict: maps an instant and a state (n,) of the larger scene to that of the smaller, (n',)
    explanations: sentences on what was left out, and why that changes nothing
    limitations: sentences on what the smaller scene cannot show
    exceptions: sentences on what might have been left out, and was not
    """

    scene: PreparedScene
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]
    explanations: tuple[str, ...]
    limitations: tuple[str, ...] = ()
    exceptions: tuple[str, ...] = ()


@record
class ReducedScene:
    """The smallest scene that was found, as the steps that lead to it from the given scene.

    exceptions: sentences why parts that a reader might expect to be left out were not
    """

    steps: tuple[Reduction, ...]
    exceptions: tuple[str, ...]

    @property
    def explanations(self) -> tuple[str, ...]:
        """Sentences on what was left out, and why that changes nothing."""
        return tuple(sentence for step in self.steps for sentence in step.explanations)

    @property
    def limitations(self) -> tuple[str, ...]:
        """Sentences on what the smaller scene cannot show."""
        return tuple(sentence for step in self.steps for sentence in step.limitations)

    def embed(self, times: Array, states: Array) -> Array:
        """Map states of the smallest scene to those of the given scene, (n_t, n)."""
        for step in reversed(self.steps):
            states = step.embed(times, states)
        return states

    def restrict(self, t: float, state: Array) -> Array:
        """Map a state of the given scene to one of the smallest."""
        for step in self.steps:
            state = step.restrict(t, state)
        return state
