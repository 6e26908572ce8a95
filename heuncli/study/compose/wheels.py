"""Warn of wheels at the single instant of a state, and at impulses, which events of a motion do not cover."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses

LIFTS = "the wheel {} would have to be pulled onto its plane: it lifts off"
SLIPS = "the wheel {} would need more friction than available: it slips"


def warn_at_instant(spec: Spec, couplings: Mapping[str, Any]) -> Iterator[str]:
    """Warn of wheels that lift or slip at the single instant; couplings: their block."""
    for name, wheel in spec.rolling.items():
        if name in couplings:
            yield from (sentence.format(name) for sentence in iter_problems(wheel, couplings[name], 0))


def warn_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of wheels that would lift or slip at each impulse."""
    wheels = spec.rolling
    couplings = impulses.all_blocks["couplings"] if wheels else {}
    for k, jump in enumerate(impulses.jumps):
        for name, wheel in wheels.items():
            for sentence in iter_problems(wheel, couplings[name], k):
                yield f"in the impulse at t = {jump.reported_time:.6g} s {sentence.format(name)}"


def iter_problems(wheel: RollingWheel, block: Mapping[str, Any], k: int) -> Iterator[str]:
    """Yield the problems at instant k: a negative normal force, or more friction than the normal force allows."""
    limit = -tolerances.NO_FORCE * np.nan_to_num(block["force"][k])
    if not wheel.held and block["normal"][k] < limit:
        yield LIFTS
    elif wheel.friction is not None and block["grip"][k] < limit:
        yield SLIPS
