"""Chains of pendulums with dry friction in their pins, against Moreau's time stepping in coordinates of their own.

M (u+ - u) = h F + sum of W p,   -h T <= p <= h T,   p against the rate in each pin, or that rate is 0

at the end of each step of length h: the impulses p by projected Gauss-Seidel iterations (Moreau 1988). It knows no
event, no state of a pin and no closure. Its error is of the first order in h, so two lengths are extrapolated.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.shared.scenes import solved

G, DURATION, SAMPLES = 9.81, 1.0, 21
ITERATIONS = 12


class Chains(NamedTuple):
    """Chains of n point masses on massless bars, (chains, n) each; `push` sin(frequency t) [N m] in the first."""

    mass: Array
    length: Array
    friction: Array
    angle: Array  # of each bar to the vertical
    rate: Array
    push: Array
    frequency: Array

    def select(self, k: int) -> Chains:
        """Return chain k alone."""
        return Chains(*(values[k : k + 1] for values in self))


def random_chains(seed: int, count: int, n: int) -> Chains:
    rng = np.random.default_rng(seed)
    shape = (count, n)
    rate = rng.uniform(-2, 2, shape) * (rng.random((count, 1)) < 0.6)
    return Chains(
        rng.uniform(0.5, 2, shape), rng.uniform(0.5, 1.5, shape), rng.uniform(1, 12, shape),
        rng.uniform(-1, 1, shape), rate, rng.uniform(0, 20, count), rng.uniform(3, 9, count),
    )  # fmt: skip


def step_chains(c: Chains, h: float) -> Array:
    """Return the angles of all bars at the samples, (samples, chains, n)."""
    n = c.mass.shape[1]
    carried = np.cumsum(c.mass[:, ::-1], axis=1)[:, ::-1]
    pairs = carried[:, np.maximum.outer(np.arange(n), np.arange(n))] * c.length[:, :, None] * c.length[:, None, :]
    W = np.eye(n) - np.eye(n, k=1)  # column i: rate of bar i less that of the bar before
    every = round(DURATION / h / (SAMPLES - 1))
    angle, rate, out = c.angle.copy(), c.rate.copy(), [c.angle.copy()]
    limit = h * c.friction
    p = np.zeros_like(limit)
    for k in range(every * (SAMPLES - 1)):
        t = (k + 0.5) * h
        angle = angle + 0.5 * h * rate
        difference = angle[:, :, None] - angle[:, None, :]
        inverse = np.linalg.inv(pairs * np.cos(difference))
        F = -np.einsum("cij,cj->ci", pairs * np.sin(difference), rate**2) - G * carried * c.length * np.sin(angle)
        F[:, 0] += c.push * np.sin(c.frequency * t)
        free = rate + h * np.einsum("cij,cj->ci", inverse, F)
        A = np.einsum("ji,cjk,kl->cil", W, inverse, W)
        b = free @ W
        for _ in range(ITERATIONS):
            for i in range(n):
                w = b[:, i] + np.einsum("cj,cj->c", A[:, i], p)
                p[:, i] = np.clip(p[:, i] - w / A[:, i, i], -limit[:, i], limit[:, i])
        rate = free + np.einsum("cij,cj->ci", inverse, p @ W.T)
        angle = angle + 0.5 * h * rate
        if (k + 1) % every == 0:
            out.append(angle.copy())
    return np.array(out)


def extrapolate_steps(c: Chains, h: float) -> tuple[Array, Array]:
    """Return the angles of steps of h/2, and those extrapolated to steps of no length."""
    coarse, fine = step_chains(c, h), step_chains(c, 0.5 * h)
    return fine, 2.0 * fine - coarse


def tell(c: Chains, k: int) -> str:
    """Write chain k as a spec."""
    bodies, joints, forces = [], [], []
    for i in range(c.mass.shape[1]):
        before, point = ("ground", "O") if i == 0 else (f"b{i - 1}", "tip")
        l, m = c.length[k, i], c.mass[k, i]
        points = f"{{top: [0, 0, 0], tip: [0, {-l}, 0]}}"
        bodies.append(f"  b{i}: {{mass: {m}, center: [0, {-l}, 0], inertia: [0, 0, 0], points: {points}}}")
        first = 0.0 if i == 0 else c.angle[k, i - 1]
        first_rate = 0.0 if i == 0 else c.rate[k, i - 1]
        start = f"angle: {c.angle[k, i] - first}, rate: {c.rate[k, i] - first_rate}"
        joints.append(
            f"  p{i}: {{type: pin, from: {before}.{point}, to: b{i}.top, axis: [0, 0, 1], initial: {{{start}}}}}"
        )
        forces.append(f"  f{i}: {{type: friction, joint: p{i}, torque: {c.friction[k, i]}}}")
    forces.append(f"  push: {{type: torque, joint: p0, value: {c.push[k]}*sin({c.frequency[k]}*t)}}")
    blocks = ["heun: 1", f"gravity: [0, {-G}, 0]", "ground: {points: {O: [0, 0, 0]}}"]
    blocks += ["bodies:", *bodies, "joints:", *joints, "forces:", *forces]
    return "\n".join([*blocks, f"analysis: {{duration: {DURATION}, samples: {SAMPLES}}}"])


@pytest.mark.heavy
@pytest.mark.parametrize(("n", "count"), [(1, 10), (2, 25), (3, 15)])
@pytest.mark.third
def test_chains_move_as_moreaus_steps_take_them(n: int, count: int, request: pytest.FixtureRequest) -> None:
    if request.config.getoption("--all-cases"):
        count *= 20
    chains = random_chains(100 * n, count, n)
    fine, wanted = extrapolate_steps(chains, 1e-3)
    seen = 0
    for k in range(count):
        r = solved(tell(chains, k))
        angles = np.cumsum([r.coordinates[f"p{i}"]["angle"] for i in range(n)], axis=0).T
        if np.abs(angles - wanted[:, k]).max() > 2e-3:  # events near the ends of steps: a smaller step decides
            assert angles == pytest.approx(extrapolate_steps(chains.select(k), 1e-4)[1][:, 0], abs=5e-4), k
        assert np.abs(angles - fine[:, k]).max() < 2e-2, k
        seen += sum(bool((r.forces[f"f{i}"]["reserve"] > 0.0).any()) for i in range(n))
        energy = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
        assert energy == pytest.approx(np.full(SAMPLES, energy[0]), abs=1e-6)
    assert seen > 0.3 * n * count
