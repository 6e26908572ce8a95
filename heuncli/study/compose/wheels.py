"""Warnings of wheels: at the one instant of a state, and in blows, which events of a motion do not tell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses

LIFTS = "the wheel {} would have to be pulled onto its plane: it lifts"
SLIPS = "the wheel {} would take more friction than there is: it slips"


def at_the_instant(spec: Spec, couplings: Mapping[str, Any]) -> Iterator[str]:
    """What lifts or slips at the only instant there is; couplings: their block."""
    for name, wheel in spec.rolling.items():
        if name in couplings:
            yield from (sentence.format(name) for sentence in told(wheel, couplings[name], 0))


def in_blows(spec: Spec, struck: Impulses) -> Iterator[str]:
    """What would lift or slip in each blow, by its impulses."""
    wheels = spec.rolling
    couplings = struck.shown["couplings"] if wheels else {}
    for k, jump in enumerate(struck.jumps):
        for name, wheel in wheels.items():
            for sentence in told(wheel, couplings[name], k):
                yield f"in the blow at t = {jump.told_time:.6g} s {sentence.format(name)}"


def told(wheel: RollingWheel, block: Mapping[str, Any], k: int) -> Iterator[str]:
    """Of one of several instants: a normal force below zero, and more friction than what presses lets it have."""
    least = -tolerances.NO_FORCE * np.nan_to_num(block["force"][k])
    if not wheel.held and block["normal"][k] < least:
        yield LIFTS
    elif wheel.friction is not None and block["grip"][k] < least:
        yield SLIPS
