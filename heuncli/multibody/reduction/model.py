"""A smaller scene that moves as a larger one does: what is integrated in its place.

    y = embed(t, y'),   y' = restrict(t, y)        states of the larger and of the smaller scene
The smaller scene has the same loads, drives, blows, stops and contacts, in the same order, so that the branches of
expressions and what is held mean the same in both; a load whose body is part of the ground acts on the ground. It has
the same size, so that tolerances mean the same. What is told of an instant comes from the larger scene, at y.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.base.records import record
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array


@record
class Reduction:
    """One step to a smaller scene.

    embed: instants (n_t,) and states (n_t, n') of the smaller scene to those of the larger, (n_t, n); restrict: an
    instant and a state (n,) of the larger one to that of the smaller, (n',). told: what was left out, why that changes
    nothing; hidden: what cannot be told from the smaller scene; kept: what might have been left out, and was not;
    sentences.
    """

    scene: PreparedScene
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]
    told: tuple[str, ...]
    hidden: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()


@record
class Reduced:
    """The smallest scene that was found, and what stands between its states and those of the scene as it is given.

    kept: why what a reader might expect to be left out was not; sentences.
    """

    steps: tuple[Reduction, ...]
    kept: tuple[str, ...]

    @property
    def told(self) -> tuple[str, ...]:
        """What was left out, and why that changes nothing."""
        return tuple(sentence for step in self.steps for sentence in step.told)

    @property
    def hidden(self) -> tuple[str, ...]:
        """What cannot be told from the smaller scene."""
        return tuple(sentence for step in self.steps for sentence in step.hidden)

    def embed(self, times: Array, states: Array) -> Array:
        """States of the scene as it is given, (n_t, n), from those of the smallest."""
        for step in reversed(self.steps):
            states = step.embed(times, states)
        return states

    def restrict(self, t: float, state: Array) -> Array:
        """A state of the smallest scene from one of the scene as it is given."""
        for step in self.steps:
            state = step.restrict(t, state)
        return state
