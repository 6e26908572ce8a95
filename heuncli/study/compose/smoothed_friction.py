"""At which instants smoothed friction is not yet at its value: near rest it is next to nothing.

Friction is its size times tanh(rate / speed). Where the rate is below a few times `speed`, loads and accelerations are
those of a machine that rubs less than it does: a start from rest shows the acceleration without friction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import JointLoad, Mechanism, ThreadLoad
from heuncli.results.results import Array

MOST_NAMED = 3
# what hangs on friction at an instant: loads and accelerations, and no place, velocity or energy
KINDS = frozenset({"joints", "foundation", "sections", "stops", "couplings", "system_vector"})
ACCELERATIONS = ("acceleration",)


class PartialFriction(NamedTuple):
    """Friction that is not at its value at an instant: its name, its rate and its `speed`, and the share it has."""

    name: str
    rate: float
    speed: float

    @property
    def share(self) -> float:
        """Of its value, 0 to 1."""
        return math.tanh(abs(self.rate) / self.speed)


def full_from() -> float:
    """The rate from which on friction is full, times its `speed`."""
    return math.atanh(1.0 - tolerances.FRICTION_LACKS)


def has_smoothed_friction(mechanism: Mechanism) -> bool:
    """Whether anything rubs in a scene."""
    return any(_is_smoothed(load) for load in mechanism.loads)


def _is_smoothed(load: object) -> bool:
    return isinstance(load, ThreadLoad) or (isinstance(load, JointLoad) and load.kind == "friction")


def hangs_on_friction(path: str) -> bool:
    """Whether a number, by its path, hangs on the friction of the same instant."""
    words = path.split(".")
    if words[0] in KINDS:
        return words[-1] not in ("point", "normal", "first_axis", "s", "side") and words[:2] != ["foundation", "axis"]
    return any(word.endswith(ACCELERATIONS) for word in words[1:])


def partial_friction_at(mechanism: Mechanism, recovered: Recovered) -> dict[float, list[PartialFriction]]:
    """The friction that is not at its value, by instant; of those instants alone at which there is some."""
    found: dict[float, list[PartialFriction]] = {}
    for load, own in mechanism.load_rows():
        if not isinstance(load, JointLoad | ThreadLoad) or not _is_smoothed(load):
            continue
        rates: Array = np.abs(recovered.loads[:, own]["rate"]).max(axis=1)
        for k in np.flatnonzero(rates < full_from() * load.speed).tolist():
            partial = PartialFriction(load.name, float(rates[k]), load.speed)
            found.setdefault(float(recovered.times[k]), []).append(partial)
    return found


def samples_with_partial(mechanism: Mechanism, recovered: Recovered) -> list[str]:
    """A sentence on the instants of results at which smoothed friction is not at its value."""
    found = partial_friction_at(mechanism, recovered) if has_smoothed_friction(mechanism) else {}
    if not found:
        return []
    first = min(found)
    which = f"{len(found)} of {len(recovered.times)} instants, the first t = {first:.6g} s"
    return [f"loads and accelerations at {which}, are not those of full friction: {describe_partial(found[first])}"]


def describe_partial(partial: Sequence[PartialFriction]) -> str:
    """Which friction is not at its value, and how far from it."""
    told = [f"{own.name} is at {100.0 * own.share:.3g} % of its value" for own in partial[:MOST_NAMED]]
    more = f" and {len(partial) - MOST_NAMED} more" if len(partial) > MOST_NAMED else ""
    return f"smoothed friction {', '.join(told)}{more}: the rate is below {full_from():.3g} times its `speed`"


def note_of_partial(found: dict[float, list[PartialFriction]]) -> str:
    """What the mark beside numbers means, with the names of what rubs."""
    names = dict.fromkeys(own.name for partial in found.values() for own in partial)
    some = ", ".join(list(names)[:MOST_NAMED]) + (" ..." if len(names) > MOST_NAMED else "")
    return f"smoothed friction ({some}) is not at its value there: rate below {full_from():.3g} times its `speed`"
