"""Whether loads come back with the cycle: a law of an angle, or of the time, may take more turns than the bodies do."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TypeGuard

import numpy as np

from heuncli import tolerances
from heuncli.balancing.followed import FollowedRun
from heuncli.balancing.nodes import PieceNodes
from heuncli.expressions.programs import Expression
from heuncli.integration.diagnosis.domains import coordinates_at
from heuncli.integration.diagnosis.ways import Moving
from heuncli.integration.evaluator import Recovered
from heuncli.kinetostatics.bodies import body_states
from heuncli.kinetostatics.coordinates import coordinates
from heuncli.mechanism.model import JointLoad, Load, path_of_load
from heuncli.records import record
from heuncli.results import Array, Block

TURN = 2.0 * math.pi


@record
class NextCycle:
    """A run of one cycle, by which laws are told a cycle later; nodes: those that resolve its loads."""

    run: FollowedRun
    nodes: PieceNodes

    @cached_property
    def there(self) -> Recovered:
        """The kernel's answers at the nodes."""
        return self.run.recovered(self.nodes.places)

    @cached_property
    def joints(self) -> Block:
        """The coordinates of the joints at the nodes."""
        return coordinates(self.run.layout, self.there, body_states(self.run.layout, self.there))

    @cached_property
    def others(self) -> list[Moving]:
        """What else laws may name, at the nodes."""
        return [coordinates_at(self.run.layout, self.there, k) for k in range(len(self.nodes.places))]

    @cached_property
    def turned(self) -> dict[str, float]:
        """By how much joints turn in a cycle [rad]: whole turns, for the bodies are back."""
        layout, ends = self.run.layout, self.run.recovered(np.array([0.0, self.run.length]))
        found = coordinates(layout, ends, body_states(layout, ends))
        return {
            name: TURN * round(float(own["angle"][1] - own["angle"][0]) / TURN)
            for name, own in found.items()
            if "angle" in own
        }

    def coordinate(self, name: str, quantity: str) -> Array:
        """A coordinate at the nodes, (n,)."""
        own = self.joints.get(name, {})
        return np.asarray(own[quantity]) if quantity in own else np.array([at[name, quantity][0] for at in self.others])

    def repeats(self, load: Load) -> bool:
        """Whether a load is a cycle later what it was."""
        if is_turn_spring(load) and self.turned.get(self.run.layout.mechanism.joints[load.joint].name, 0.0):
            return False
        return all(self.has_again(value) for value in load.values)

    def has_again(self, value: Expression) -> bool:
        """Whether a law has its values again, in the mean: a node may stand beside a jump to rounding.

        Where it has no value a cycle later, as a table of one turn, nothing contradicts.
        """
        if not value.uses and not value.time_dependent:
            return True
        own = np.array([self.coordinate(*use) for use in value.uses]).reshape(len(value.uses), len(self.nodes.places)).T
        adds = np.array([self.turned.get(name, 0.0) if what == "angle" else 0.0 for name, what in value.uses])
        times = self.nodes.places / abs(self.run.rate)
        first = np.array([value.value(t, at) for t, at in zip(times.tolist(), own.tolist(), strict=True)])
        later = zip((times + self.run.last).tolist(), (own + adds).tolist(), strict=True)
        then = np.array([value.value(t, at) for t, at in later])
        off, size = np.abs(then - first), np.maximum(np.abs(first), np.abs(then))
        known, least = np.isfinite(off), tolerances.SUM_ROUNDING * max(map(abs, value.constants), default=0.0)
        weights = self.nodes.weights[known]
        return bool(weights @ off[known] <= tolerances.SAME_VALUE * float(weights @ size[known]) + least)


def unlike(run: FollowedRun, nodes: PieceNodes) -> tuple[str, ...]:
    """Of each load that is not after the cycle what it was before, that it is so; nodes: those that resolve it.

    The bodies are back there. So is a load that hangs on their poses alone; one that counts turns may not be.
    """
    after = NextCycle(run, nodes)
    cycle, advice = ("a turn", ": --turns 2, if it takes two") if run.turns == 1 else ("two turns", "")
    return tuple(
        f"{path_of_load(load)} is not after {cycle} what it was before; it is told as if it began anew there{advice}"
        for load in run.layout.mechanism.loads
        if not after.repeats(load)
    )


def is_turn_spring(load: Load) -> TypeGuard[JointLoad]:
    """Whether a load counts turns by itself."""
    return isinstance(load, JointLoad) and load.kind == "turn_spring"
