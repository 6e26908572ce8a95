"""Warnings of threads with friction: in a blow nothing rubs, which no event tells."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses

STRUCK = (
    "the blow at t = {:.6g} s goes through the thread {} as if nothing rubbed in it: a self-locking one would hold it, "
    "and any other takes a part of it"
)


def rub(spec: Spec) -> list[str]:
    """The threads of a scene that have friction."""
    return [name for name, own in spec.couplings.items() if isinstance(own, Screw) and own.friction is not None]


def in_blows(spec: Spec, struck: Impulses) -> Iterator[str]:
    """The threads that take part in blows."""
    couplings, least = struck.shown["couplings"], tolerances.NO_FORCE * struck.by_unit["N·s"]
    for k, jump in enumerate(struck.jumps):
        for name in rub(spec):
            if abs(couplings[name]["force"][k]) > least:
                yield STRUCK.format(jump.told_time, name)
