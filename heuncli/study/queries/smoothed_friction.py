"""Find numbers of a solved scene at instants at which smoothed friction has not reached its full value."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from heuncli.study.compose.smoothed_friction import (
    PartialFriction,
    depends_on_friction,
    describe_partial,
    has_smoothed_friction,
    list_partial_friction,
)
from heuncli.study.queries.study import Study

NONE: frozenset[str] = frozenset()


def find_partial_friction(study: Study, times: Iterable[float]) -> dict[float, list[PartialFriction]]:
    """Return the friction that is below its full value, by instant; instants without any are left out."""
    mechanism = study.setup.scene.mechanism
    instants = np.array(sorted({t for t in times if math.isfinite(t)}))
    if not len(instants) or not has_smoothed_friction(mechanism) or study.setup.rest is not None:
        return {}
    if study.has_one_instant:
        instants = study.results.time
    return list_partial_friction(mechanism, study.find_recovery(instants, NONE).solutions)


def make_friction_warning(study: Study, path: str, time: float | None) -> str | None:
    """Return the warning on a number that depends on friction below its full value at an instant, or None."""
    if time is None or not depends_on_friction(path):
        return None
    found = find_partial_friction(study, [time])
    partial = next(iter(found.values()), None)
    return f"{path} at t = {time:.6g} s: {describe_partial(partial)}" if partial else None
