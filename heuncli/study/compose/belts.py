"""Warnings of belts: at the one instant of a state, and in blows, which events of a motion do not tell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import Belt
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.resolve_couplings import PUSHES, at_least
from heuncli.study.compose.impulses import Impulses

STRUCK = (
    "in the blow at t = {:.6g} s the belt {} would have to push: no pretension stands up to a blow, and what the belt "
    "then pulls its pulleys together with is not told"
)


def at_the_instant(spec: Spec, couplings: Mapping[str, Any], largest: float) -> Iterator[str]:
    """The belts that push at the only instant there is; couplings: their block, largest: force of all [N]."""
    for name, belt in belts(spec).items():
        slack = float(couplings[name]["slack"][0]) if name in couplings else 0.0
        if slack < -tolerances.NO_FORCE * largest:
            yield PUSHES.format(name, at_least(belt.pretension - slack))


def in_blows(spec: Spec, struck: Impulses) -> Iterator[str]:
    """The belts that take part in blows, which nothing that is taut before stands up to."""
    couplings, least = struck.shown["couplings"], -tolerances.NO_FORCE * struck.by_unit["N·s"]
    for k, jump in enumerate(struck.jumps):
        for name in belts(spec):
            if couplings[name]["slack"][k] < least:
                yield STRUCK.format(jump.told_time, name)


def belts(spec: Spec) -> dict[str, Belt]:
    """The belts of a scene."""
    return {name: own for name, own in spec.couplings.items() if isinstance(own, Belt)}
