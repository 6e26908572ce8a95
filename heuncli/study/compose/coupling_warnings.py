"""Warn of wheels that lift or slip, belts that would push, and threads without friction.

Events of a motion watch them; those cover neither the single instant of a state nor impulses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base import tolerances
from heuncli.scene.file_format.couplings import Belt, RollingWheel, Screw
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.resolve_couplings import SLACK_BELT_MESSAGE, format_rounded_up

if TYPE_CHECKING:  # a state has no impulses
    from heuncli.study.compose.impulses import Impulses


def iter_coupling_warnings(
    spec: Spec, couplings: Mapping[str, Any], largest_force: float | None, impulses: Impulses | None
) -> Iterator[str]:
    """Yield the warnings of wheels, belts and threads.

    couplings: their block in the results
    largest_force: of all at the single instant of a state [N]; None of a motion
    """
    if largest_force is not None:
        yield from warn_of_wheels_at_instant(spec, couplings)
    if impulses is not None:
        yield from warn_of_wheels_at_impulses(spec, impulses)
    if largest_force is not None:
        yield from warn_of_belts_at_instant(spec, couplings, largest_force)
    if impulses is not None:
        yield from warn_of_belts_at_impulses(spec, impulses)
        yield from warn_of_threads_at_impulses(spec, impulses)


PUSHED_AT_IMPULSE = (
    "in the impulse at t = {:.6g} s the belt {} would have to push: no pretension withstands an impulse, and the force "
    "with which the belt then pulls its pulleys together is not computed"
)


def warn_of_belts_at_instant(spec: Spec, couplings: Mapping[str, Any], largest: float) -> Iterator[str]:
    """Warn of the belts that push at the single instant of a state; largest: force of all [N]."""
    for name, belt in find_belts(spec).items():
        slack = float(couplings[name]["slack"][0]) if name in couplings else 0.0
        if slack < -tolerances.NO_FORCE * largest:
            yield SLACK_BELT_MESSAGE.format(name, format_rounded_up(belt.pretension - slack))


def warn_of_belts_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the belts that take part in impulses, which no pretension withstands."""
    couplings, limit = impulses.all_blocks["couplings"], -tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_belts(spec):
            if couplings[name]["slack"][k] < limit:
                yield PUSHED_AT_IMPULSE.format(jump.reported_time, name)


def find_belts(spec: Spec) -> dict[str, Belt]:
    """Return the belts of a scene."""
    return {name: own for name, own in spec.couplings.items() if isinstance(own, Belt)}


LIFTS = "the wheel {} would have to be pulled onto its plane: it lifts off"
SLIPS = "the wheel {} would need more friction than available: it slips"


def warn_of_wheels_at_instant(spec: Spec, couplings: Mapping[str, Any]) -> Iterator[str]:
    """Warn of wheels that lift or slip at the single instant; couplings: their block."""
    for name, wheel in spec.rolling.items():
        if name in couplings:
            yield from (sentence.format(name) for sentence in iter_problems(wheel, couplings[name], 0))


def warn_of_wheels_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
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


FRICTIONLESS_AT_IMPULSE = (
    "the impulse at t = {:.6g} s passes the thread {} without friction: a self-locking thread would hold it, "
    "any other would take part of it"
)


def find_friction_threads(spec: Spec) -> list[str]:
    """Return the threads of a scene that have friction."""
    return [name for name, own in spec.couplings.items() if isinstance(own, Screw) and own.friction is not None]


def warn_of_threads_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the threads that take part in impulses."""
    couplings, limit = impulses.all_blocks["couplings"], tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_friction_threads(spec):
            if abs(couplings[name]["force"][k]) > limit:
                yield FRICTIONLESS_AT_IMPULSE.format(jump.reported_time, name)
