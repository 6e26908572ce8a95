"""Couplings whose conditions are told by where bodies stand at the start: ropes, and shafts that turn alike."""

from __future__ import annotations

import numpy as np

from heuncli.mechanism.couplings import CoupledRow, Coupling, CouplingPart
from heuncli.mechanism.model import Assembly, Mechanism, RopeLoad
from heuncli.mechanism.stretching import rope_load
from heuncli.records import replace
from heuncli.results import Array
from heuncli.shapes.rotations import perpendicular, turn_onto
from heuncli.spec import couplings as spec
from heuncli.tree.rope_ways import routed, unit
from heuncli.tree.starts import pose


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


def turning_alike(mechanism: Mechanism, start: Assembly, coupling: Coupling) -> Coupling:
    """e1 . g2 - e2 . g1 = 0: e1, e2 across the axis in `from`; g1, g2 those in `to` to which the bend turns them.

    That is 0 where `to` is turned against `from` by a bend alone, about a line across both axes: each axis then turns
    as fast as the other at any bend, and the couple stands on the plane that halves it.
    """
    given = coupling.given
    assert isinstance(given, spec.ConstantVelocity)
    joint = next(own for own in mechanism.joints if own.name == given.joint)
    a, b = unit(np.array(given.axis)), unit(np.array(given.to_axis))
    (_, R_a, *_), (_, R_b, *_) = pose(start, joint.a), pose(start, joint.b)
    across: tuple[Array, Array] = perpendicular(a)
    bend = turn_onto(R_a @ a, R_b @ b)
    e1, e2 = across
    g1, g2 = (R_b.T @ bend @ R_a @ e for e in across)
    parts = tuple(
        CouplingPart("dot", joint.a, joint.b, joint.p, joint.q, e, g, factor)
        for e, g, factor in ((e1, g2, -0.5), (e2, g1, 0.5))
    )
    return replace(coupling, rows=(CoupledRow(parts, None, 0.0),))


MADE = {"rope": routed, "cv": turning_alike}
