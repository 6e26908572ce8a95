"""Numbers that stand where smoothed friction is not yet at its value, of a solved scene."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from heuncli.study.ask.study import Study
from heuncli.study.compose.smoothed_friction import (
    PartialFriction,
    describe_partial,
    hangs_on_friction,
    has_smoothed_friction,
    partial_friction_at,
)

NONE: frozenset[str] = frozenset()


def partial_friction(study: Study, times: Iterable[float]) -> dict[float, list[PartialFriction]]:
    """The friction that is not at its value, by instant; of those instants alone at which there is some."""
    mechanism = study.setup.scene.mechanism
    instants = np.array(sorted({t for t in times if math.isfinite(t)}))
    if not len(instants) or not has_smoothed_friction(mechanism) or study.setup.rest is not None:
        return {}
    if study.of_one_instant:
        instants = study.results.time
    return partial_friction_at(mechanism, study.recovery_at(instants, NONE).recovered)


def friction_warning(study: Study, path: str, at: float | None) -> str | None:
    """What to say of a number at an instant where friction that it hangs on is not at its value; None: nothing."""
    if at is None or not hangs_on_friction(path):
        return None
    found = partial_friction(study, [at])
    partial = next(iter(found.values()), None)
    return f"{path} at t = {at:.6g} s: {describe_partial(partial)}" if partial else None
