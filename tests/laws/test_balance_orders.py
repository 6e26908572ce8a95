"""Laws of a balance over a cycle: orders sum back, powers add up, the world may turn, rates and points may change."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.oracle.turns import random_rotation
from tests.shared.cycling import Cylinder, amplitude, balance_of, engine, four_bar
from tests.shared.scenes import moving, solved

pytestmark = pytest.mark.heavy  # a cycle of many instants; the plain kernel balances in tests/cli/test_balance.py

SEEDS = range(4)
ROUNDING = 1e-12  # of the largest: some hundred roundings, and what closed chains are settled to
SETTLED = 1e-10  # of the largest: where a run's poses enter, closed to OPEN_GAP


def linkage(seed: int) -> dict[str, Any]:
    return four_bar(np.random.default_rng(seed))


def parts(scene: dict[str, Any], **asked: Any) -> dict[str, Array]:
    """Force and both moments over the cycle, at the rate, ON the foundation."""
    found = balance_of(scene, **asked)
    scale = -((found.rate or 1.0) ** 2)
    own = found.effects
    return {
        "force": scale * own.force.sum(axis=1), "moment": scale * own.moment.sum(axis=1), "angles": own.angles,
    }  # fmt: skip


@pytest.mark.parametrize("seed", SEEDS)
def test_orders_sum_back_to_the_samples_and_their_powers_add_up(seed: int) -> None:
    found, values = balance_of(linkage(seed)), parts(linkage(seed))
    for name in ("force", "moment"):
        own = values[name]
        k = np.arange(len(own) // 2 + 1)
        amplitudes = found.effects.nodes.compute_amplitudes(own, k)
        largest = np.abs(own).max()
        summed = np.real(np.exp(1j * np.outer(values["angles"], k)) @ amplitudes)
        assert np.abs(summed - own).max() < ROUNDING * largest
        told = sum(np.sum(row.amplitude**2) for row in found.orders[name]) / 2.0 + np.sum(found.mean[name] ** 2)
        assert math.sqrt(told) == pytest.approx(found.residual[name].rms, rel=1e-11)
        assert np.abs(found.mean[name]).max() < ROUNDING * largest  # a momentum that comes back has no mean rate


@pytest.mark.parametrize("seed", SEEDS)
def test_orders_are_those_of_a_run(seed: int) -> None:
    """Fourier's sums over the foundation of `heun run`, sampled over one turn from where it starts."""
    scene, count, rate = linkage(seed), 128, 20.0
    found = balance_of(scene)
    begin = found.effects.angles[0]
    times = np.arange(count) / count * 2.0 * math.pi / rate
    own = -solved(moving(scene, times)).foundation["mass_effect"]["force"]
    for k in range(1, 9):
        wanted = 2.0 * np.mean(own * np.exp(1j * k * (begin + rate * times))[:, None], axis=0)
        assert np.abs(amplitude(found, "force", k) - wanted).max() < SETTLED * np.abs(own).max()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_world_that_is_turned_turns_the_vectors(seed: int) -> None:
    R = random_rotation(np.random.default_rng(seed))
    cylinders = [Cylinder(0.0, -0.1), Cylinder(100.0, 0.15, bank=50.0)]
    here, there = balance_of(engine(cylinders)), balance_of(engine(cylinders, R=R))
    for name in ("force", "moment"):
        for k in (1, 2, 4):
            a, b = amplitude(here, name, k), amplitude(there, name, k)
            assert np.abs(R @ a - b).max() < SETTLED * here.residual[name].peak
        for row, turned in zip(here.orders[name][:4], there.orders[name][:4], strict=True):
            assert turned.with_turn == pytest.approx(row.with_turn, rel=1e-9, abs=1e-9 * here.residual[name].peak)
            assert turned.against_turn == pytest.approx(row.against_turn, rel=1e-9, abs=1e-9 * here.residual[name].peak)


@pytest.mark.parametrize("seed", SEEDS)
def test_loads_grow_with_the_square_of_the_rate(seed: int) -> None:
    slow, fast = parts(linkage(seed), rate=7.0), parts(linkage(seed), rate=21.0)
    for name in ("force", "moment"):
        assert np.abs(9.0 * slow[name] - fast[name]).max() < ROUNDING * np.abs(fast[name]).max()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_moment_about_another_point(seed: int) -> None:
    point = np.random.default_rng(seed).normal(size=3)
    here, there = parts(linkage(seed)), parts(linkage(seed), about=point)
    wanted = here["moment"] - np.cross(point, here["force"])
    assert np.abs(there["moment"] - wanted).max() < ROUNDING * np.abs(wanted).max()


@pytest.mark.parametrize("seed", SEEDS)
def test_parts_by_rate_make_any_motion(seed: int) -> None:
    """F2 ω² + F1 ω̇, and of moments and the torque likewise, against states of `heun run` at several ω and ω̇."""
    scene = linkage(seed)
    found = balance_of(scene)
    own = found.effects
    for w, a in ((11.0, 0.0), (-3.0, 40.0), (0.0, 5.0)):
        motor = {"joint": "main", "angle": f"{float(own.angles[0])!r} + {w!r}*t + {a!r}*t**2/2"}
        run = solved(scene | {"drives": {"motor": motor}, "analysis": {"type": "state"}})
        effect = run.foundation["mass_effect"]
        for name, second, first in (
            ("force", own.force, own.first_force), ("moment_orbital", own.orbital, own.first_orbital),
            ("moment_spin", own.spin, own.first_spin),
        ):  # fmt: skip
            wanted = second[0].sum(axis=0) * w * w + first[0].sum(axis=0) * a
            scale = np.abs(second).max() * w * w + np.abs(first).max() * abs(a)
            assert np.abs(effect[name][0] - wanted).max() < SETTLED * scale
        torque = own.half_slope[0].sum() * w * w + own.eps[0].sum() * a
        scale = np.abs(own.half_slope).max() * w * w + own.eps.sum(axis=1).max() * abs(a)
        assert abs(run.joints["main"]["drive"][0] - torque) < SETTLED * scale
