"""Couplings whose conditions are told by where bodies stand at the start: ropes."""

from __future__ import annotations

from heuncli.base.records import replace
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import Assembly, Mechanism, RopeLoad
from heuncli.multibody.mechanism.stretching import rope_load
from heuncli.multibody.tree.rope_ways import routed
from heuncli.scene.file_format import couplings as spec


def with_started(mechanism: Mechanism, start: Assembly, t0: float) -> Mechanism:
    """The mechanism with the conditions of such couplings, and the loads of ropes that stretch.

    Raises SolveError where they cannot be as they are asked.
    """
    made = tuple(
        MADE[coupling.given.type](mechanism, start, coupling) if coupling.given.type in MADE else coupling
        for coupling in mechanism.couplings
    )
    loads = tuple(pull(coupling, t0) for coupling in made if coupling.stretched is not None)
    return replace(mechanism, couplings=made, loads=(*mechanism.loads, *loads))


def pull(coupling: Coupling, t0: float) -> RopeLoad:
    """The load of a rope that stretches, whose length without load is as asked, or as assembled."""
    rope, row = coupling.given, coupling.stretched
    assert isinstance(rope, spec.Rope) and row is not None and row.length is not None
    length = row.length if rope.law is None else rope.law.value(t0)
    return rope_load(coupling.name, rope, row, length)


MADE = {"rope": routed}
