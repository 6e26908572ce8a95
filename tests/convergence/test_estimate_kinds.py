"""accuracy.estimate of each kind against the true error, at the asked instants and at many between; and the horizon.

The true error is that against a run at the least tolerance. Scales: the largest of each kind at the asked instants.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.bars import HEAD, rods
from tests.shared.folders import SPECS
from tests.shared.scenes import solved

NAMES = ("crane", "engine", "double", "chain", "friction", "lift", "four_bar", "spatial_crank", "cardan", "jib", "top")
KINDS = ("reactions", "drives", "foundation", "sections", "energy")
LOOSE = 1e-6
pytestmark = pytest.mark.heavy


@cache
def studied(name: str, tolerance: float) -> tuple[Study, Results]:
    """A spec's run, and what it tells at the asked instants and at 150 between them."""
    study = solve(load(str(SPECS / f"{name}.yaml")), Options(tolerance=tolerance))
    times = study.history.times
    dense = np.unique(np.concatenate([times, np.linspace(times[0], times[-1], 151)]))
    return study, study.compute_reports(dense, frozenset({"joints", "foundation", "sections", "energy"}))


def loads(kind: str, found: Results) -> list[tuple[str, Array]]:
    """What is told of a kind: "N", "N·m" or "J", and vectors or numbers."""
    if kind == "energy":
        return [("J", found.energy[name]) for name in ("kinetic", "potential", "work")]
    if kind == "drives":
        return [("N", block["drive"]) for block in found.joints.values() if "drive" in block]
    blocks: dict[str, Any] = {"foundation": found.foundation} if kind == "foundation" else found.joints
    if kind == "sections":
        blocks = found.sections
    return [(unit, block[key]) for block in blocks.values() for unit, key in (("N", "force"), ("N·m", "moment"))]


def largest(values: list[tuple[str, Array]], unit: str) -> float:
    """The longest vector, or largest number; what is open counts as nought."""
    of = [np.nan_to_num(v) for u, v in values if u == unit]
    return max((float(np.sqrt(np.sum(v * v, axis=-1)).max() if v.ndim > 1 else np.abs(v).max()) for v in of), default=0)


def true_error(kind: str, run: Study, told: Results, exact: Results, size: float) -> float:
    """Relative to the largest told; forces and moments are each other's measure by the scene's size."""
    apart = [(u, a - b) for (u, a), (_, b) in zip(loads(kind, told), loads(kind, exact), strict=True)]
    own = loads(kind, run.results)
    if kind == "energy":
        spans = [float(np.ptp(values)) for _, values in own[1:]]
        return largest(apart, "J") / max(largest(own[:1], "J"), *spans)
    force = max(largest(own, "N"), largest(own, "N·m") / size)
    moment = max(largest(own, "N·m"), largest(own, "N") * size)
    return max(largest(apart, "N") / force, largest(apart, "N·m") / moment) if force > 0.0 else 0.0


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.third
def test_never_below_the_true_error(name: str, kind: str) -> None:
    """At a loose tolerance, so that rounding is far below, and every kind is there somewhere."""
    run, told = studied(name, LOOSE)
    _, exact = studied(name, 1e-13)
    estimate: float = run.results.accuracy["estimate"][kind]  # type: ignore[literal-required]
    if not loads(kind, run.results):
        assert estimate == 0.0
        return
    error = true_error(kind, run, told, exact, run.setup.scene.layout.size)
    assert estimate >= error - 1e-12
    assert run.results.accuracy["horizon"] is None


def test_every_kind_is_there() -> None:
    for kind in KINDS:
        assert any(studied(name, LOOSE)[0].results.accuracy["estimate"][kind] > 1e-10 for name in NAMES)  # type: ignore[literal-required]


def test_the_horizon_between_two_samples() -> None:
    """A double pendulum thrown from high forgets its start, whether anyone looks or not."""
    sparse = solved(rods([2.5, 2.5], [0.0, 0.0], "{times: [0, 300]}")).accuracy["horizon"]
    dense = solved(rods([2.5, 2.5], [0.0, 0.0], "{duration: 300, samples: 6001}")).accuracy["horizon"]
    assert sparse is not None and dense is not None
    assert sparse == pytest.approx(14.5, abs=1.5)  # manual/theory.md, "Chaos"
    assert abs(sparse - dense) <= 0.5


def pendulum(angle: str, joint: str = "pin", duration: float = 20.0) -> str:
    """A point on a light rod, at rest at an angle from hanging."""
    axis = ", axis: [0, 1, 0]" if joint == "pin" else ""
    return (
        HEAD
        + f"""
bodies:
  bar: {{shapes: [{{type: point, at: [0, 0, -1], mass: 2}}, {{type: sphere, center: [0, 0, -1], radius: 0.1, mass: 1}}],
        points: {{top: [0, 0, 0]}}, orientation: {{axis: [0, 1, 0], angle: {angle}}}}}
joints: {{hinge: {{type: {joint}, from: ground.O, to: bar.top{axis}}}}}
analysis: {{times: [0, {duration}]}}
"""
    )


@pytest.mark.parametrize("joint", ["pin", "ball"])
def test_upright_at_rest_is_not_known(joint: str) -> None:
    """From a rounding of 1e-16 a pendulum is 1e-3 away after ln(1e13) of its times, 9.6 s at 1 m."""
    found = solved(pendulum("180 deg", joint))
    horizon = found.accuracy["horizon"]
    assert horizon is not None
    assert 0.8 <= horizon / (math.log(1e-3 / 2.0**-52) * math.sqrt(1.0 / 9.81)) <= 1.2
    assert any("not reached" in warning for warning in found.warnings)


@pytest.mark.parametrize("joint", ["pin", "ball"])
def test_hanging_at_rest_is_known(joint: str) -> None:
    found = solved(pendulum("0 deg", joint))
    assert found.accuracy["horizon"] is None
    assert found.accuracy["estimate"]["motion"] <= 1e-11  # it trembles by what the steps let pass, a part of 1e-9
    assert not found.warnings


def test_resting_free_is_known() -> None:
    """Nothing moves, whatever the pose: what is moved by rounding stays where it was put."""
    found = solved("""
heun: 1
title: rest
bodies: {stone: {mass: 1, center: [0.1, 0, 0], inertia: [1, 2, 3], points: {P: [1, 1, 1]}, position: [3, 0, 0]}}
analysis: {times: [0, 1000]}
""")
    assert found.accuracy["horizon"] is None
    assert found.accuracy["estimate"]["motion"] <= 1e-14
