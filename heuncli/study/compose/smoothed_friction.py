"""Find the instants at which smoothed friction is below its full value: near rest it is almost zero.

Friction is its size times tanh(rate / speed). Where the rate is below a few times `speed`, loads and accelerations are
those of a machine with less friction: a start from rest shows the acceleration without friction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import JointLoad, Mechanism, ThreadLoad
from heuncli.results.results import Array

MAX_NAMED = 3
# blocks that depend on friction at an instant: loads and accelerations, but no position, velocity or energy
KINDS = frozenset({"joints", "foundation", "sections", "stops", "couplings", "system_vector"})
ACCELERATIONS = ("acceleration",)


class PartialFriction(NamedTuple):
    """Friction below its full value at an instant: its name, its rate and its `speed`."""

    name: str
    rate: float
    speed: float

    @property
    def share(self) -> float:
        """The share of its full value, 0 to 1."""
        return math.tanh(abs(self.rate) / self.speed)


def full_friction_rate() -> float:
    """The rate from which on friction is full, in multiples of its `speed`."""
    return math.atanh(1.0 - tolerances.FRICTION_LACKS)


def has_smoothed_friction(mechanism: Mechanism) -> bool:
    """Whether a scene has friction that is smoothed."""
    return any(load.row.is_friction for load in mechanism.loads)


def depends_on_friction(path: str) -> bool:
    """Whether a number, by its path, depends on the friction at the same instant."""
    words = path.split(".")
    if words[0] in KINDS:
        return words[-1] not in ("point", "normal", "first_axis", "s", "side") and words[:2] != ["foundation", "axis"]
    return any(word.endswith(ACCELERATIONS) for word in words[1:])


def list_partial_friction(mechanism: Mechanism, solutions: Evaluation) -> dict[float, list[PartialFriction]]:
    """Return the friction that is below its full value, by instant; instants without any are left out."""
    found: dict[float, list[PartialFriction]] = {}
    for load, own in mechanism.iter_load_rows():
        if not isinstance(load, JointLoad | ThreadLoad) or not load.row.is_friction:
            continue
        rates: Array = np.abs(solutions.loads[:, own]["rate"]).max(axis=1)
        for k in np.flatnonzero(rates < full_friction_rate() * load.speed).tolist():
            partial = PartialFriction(load.name, float(rates[k]), load.speed)
            found.setdefault(float(solutions.times[k]), []).append(partial)
    return found


def describe_partial_samples(mechanism: Mechanism, solutions: Evaluation) -> list[str]:
    """Return a sentence on the instants of results at which smoothed friction is below its full value."""
    found = list_partial_friction(mechanism, solutions) if has_smoothed_friction(mechanism) else {}
    if not found:
        return []
    first = min(found)
    which = f"{len(found)} of {len(solutions.times)} samples, first at t = {first:.6g} s"
    return [f"loads and accelerations at {which}, do not include full friction: {describe_partial(found[first])}"]


def describe_partial(partial: Sequence[PartialFriction]) -> str:
    """Say which friction is below its full value, and by how much."""
    texts = [f"{own.name} is at {100.0 * own.share:.3g} % of its full value" for own in partial[:MAX_NAMED]]
    more = f" and {len(partial) - MAX_NAMED} more" if len(partial) > MAX_NAMED else ""
    return f"smoothed friction {', '.join(texts)}{more}: the rate is below {full_friction_rate():.3g} times its `speed`"


def make_partial_note(partial_by_time: dict[float, list[PartialFriction]]) -> str:
    """Explain the mark beside numbers, with the names of the friction."""
    names = dict.fromkeys(own.name for partial in partial_by_time.values() for own in partial)
    some = ", ".join(list(names)[:MAX_NAMED]) + (" ..." if len(names) > MAX_NAMED else "")
    rate = f"{full_friction_rate():.3g}"
    return f"smoothed friction ({some}) is below its full value here: rate below {rate} times its `speed`"
