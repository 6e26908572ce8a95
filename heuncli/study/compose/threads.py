"""Warn of threads with friction at impulses: there friction is neglected, which no event covers."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.impulses import Impulses

FRICTIONLESS_AT_IMPULSE = (
    "the impulse at t = {:.6g} s passes the thread {} without friction: a self-locking thread would hold it, "
    "any other would take part of it"
)


def find_friction_threads(spec: Spec) -> list[str]:
    """Return the threads of a scene that have friction."""
    return [name for name, own in spec.couplings.items() if isinstance(own, Screw) and own.friction is not None]


def warn_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the threads that take part in impulses."""
    couplings, limit = impulses.all_blocks["couplings"], tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_friction_threads(spec):
            if abs(couplings[name]["force"][k]) > limit:
                yield FRICTIONLESS_AT_IMPULSE.format(jump.reported_time, name)
