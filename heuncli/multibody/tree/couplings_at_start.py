"""Couplings whose conditions depend on the poses at the start: ropes."""

from __future__ import annotations

from heuncli.base.records import replace
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import Assembly, Mechanism, RopeLoad
from heuncli.multibody.mechanism.stretching import rope_load
from heuncli.multibody.tree.rope_routes import route_rope
from heuncli.scene.file_format import couplings as spec


def add_start_couplings(mechanism: Mechanism, start: Assembly, t0: float) -> Mechanism:
    """Add the conditions of such couplings, and the loads of elastic ropes, to the mechanism.

    Raises SolveError where they are impossible.
    """
    couplings = tuple(
        BUILDERS[coupling.entry.type](mechanism, start, coupling) if coupling.entry.type in BUILDERS else coupling
        for coupling in mechanism.couplings
    )
    loads = tuple(make_rope_load(coupling, t0) for coupling in couplings if coupling.stretched_row is not None)
    return replace(mechanism, couplings=couplings, loads=(*mechanism.loads, *loads))


def make_rope_load(coupling: Coupling, t0: float) -> RopeLoad:
    """Make the load of an elastic rope, with its unloaded length as given, or as assembled."""
    rope, row = coupling.entry, coupling.stretched_row
    assert isinstance(rope, spec.Rope) and row is not None and row.length is not None
    length = row.length if rope.law is None else rope.law.value(t0)
    return rope_load(coupling.name, rope, row, length)


BUILDERS = {"rope": route_rope}
