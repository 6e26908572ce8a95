"""Closures are held at rounding level, and the energy within the tolerance, over long runs."""

from __future__ import annotations

import pytest

from tests.oracle.published import bricard
from tests.oracle.rows import gaps, rates
from tests.shared.loops import loop_scene
from tests.shared.mechanisms import crank_rocker
from tests.shared.scenes import instants, moving, near, solved


@pytest.mark.heavy
@pytest.mark.parametrize(("gravity", "rate"), [(0.0, 6.0), (-9.81, 6.0), (-9.81, 12.0)])
@pytest.mark.third
def test_four_bar_for_a_hundred_seconds(gravity: float, rate: float) -> None:
    """At a tolerance of 1e-10: gap below 1e-12 of its size, energy within 1e-9; the oracle's gaps agree."""
    scene = crank_rocker(0.5, rate) | {"gravity": [0, gravity, 0]}
    found = solved(moving(scene, [float(t) for t in range(101)], 1e-10))
    assert found.accuracy["constraint_gap"] <= 1e-12 * 1.0
    assert found.accuracy["energy_drift"] <= 1e-9
    for _, t, state in instants(found):
        near(max(abs(g).max() for g in gaps(scene, state, t).values()), 0.0, 1.0, 1e-13)
        near(max(abs(g).max() for g in rates(scene, state, t).values()), 0.0, 15.0, 1e-13)
    turns = found.coordinates["A"]["angle"][-1]
    assert abs(turns) < 7 if rate == 6.0 and gravity else turns > 100


@pytest.mark.heavy
def test_bricard_for_twenty_seconds() -> None:
    found = solved(moving(bricard(), [0.5 * k for k in range(41)], 1e-10))
    assert found.accuracy["constraint_gap"] <= 1e-13
    assert found.accuracy["energy_drift"] <= 1e-9


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [1, 6, 9, 13, 21, 25, 41, 61])
@pytest.mark.third
def test_random_loops_for_three_seconds(seed: int) -> None:
    """All closures of all joints, by the oracle, at every instant."""
    scene, _ = loop_scene(seed)
    found = solved(moving(scene, [0.0, 1.0, 2.0, 3.0], 1e-9))
    assert found.accuracy["energy_drift"] <= 1e-7
    size = max(1.0, max(float(abs(b["center"]).max()) for b in found.bodies.values()))
    speed = max(1.0, max(float(abs(b["angular_velocity"]).max()) for b in found.bodies.values()))
    for _, t, state in instants(found):
        near(max(float(abs(g).max()) for g in gaps(scene, state, t).values() if len(g)), 0.0, size, 1e-13)
        near(max(float(abs(g).max()) for g in rates(scene, state, t).values() if len(g)), 0.0, size * speed, 1e-12)
