"""Warn of belts at the single instant of a state, and at impulses, which events of a motion do not cover."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import Belt
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.resolve_couplings import SLACK_BELT_MESSAGE, format_rounded_up
from heuncli.study.compose.impulses import Impulses

PUSHED_AT_IMPULSE = (
    "in the impulse at t = {:.6g} s the belt {} would have to push: no pretension withstands an impulse, and the force "
    "with which the belt then pulls its pulleys together is not computed"
)


def warn_at_instant(spec: Spec, couplings: Mapping[str, Any], largest: float) -> Iterator[str]:
    """Warn of the belts that push at the single instant of a state; couplings: their block, largest: force of all
    [N].
    """
    for name, belt in find_belts(spec).items():
        slack = float(couplings[name]["slack"][0]) if name in couplings else 0.0
        if slack < -tolerances.NO_FORCE * largest:
            yield SLACK_BELT_MESSAGE.format(name, format_rounded_up(belt.pretension - slack))


def warn_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the belts that take part in impulses, which no pretension withstands."""
    couplings, limit = impulses.all_blocks["couplings"], -tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_belts(spec):
            if couplings[name]["slack"][k] < limit:
                yield PUSHED_AT_IMPULSE.format(jump.reported_time, name)


def find_belts(spec: Spec) -> dict[str, Belt]:
    """Return the belts of a scene."""
    return {name: own for name, own in spec.couplings.items() if isinstance(own, Belt)}
