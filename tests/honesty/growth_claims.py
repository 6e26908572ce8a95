"""The growth of disturbances that a probe tells of random chains of bars, against their variational equations.

    python -m tests.honesty.growth_claims --cases 100 [--seed FIRST]

The reference writes the equations of the absolute angles, differentiates them by complex steps and integrates them with
SciPy; nothing of heun is in it.
"""

from __future__ import annotations

import math
import random
import sys
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from heuncli.analyses.motion_diagnostics.results import GrowthResults
from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from tests.shared.hunts import asked_of

Array = np.ndarray[Any, np.dtype[Any]]
G, SAMPLES, EVENLY = 9.81, 41, 200
EPS, CLAIMED = 2.0**-52, 1e-3
TINY = 1e-30  # of a complex step
SAME = 1e-3  # of ln G: shadows 1e-8 away, set back where they are 1e-4 away, err by 1e-4 of themselves and little more
BETWEEN = 0.05  # that ln G, told at some hundred instants, may be off between these
STEPS = (50, 200_000)  # that an adaptive run of these motions may take


class Chain(NamedTuple):
    """Bars one on the other, of masses m with their centres at c, lengths l, own inertias J, springs and dampers."""

    m: Array
    l: Array
    c: Array
    J: Array
    k: Array
    d: Array
    q: Array  # relative angles at the start
    u: Array
    duration: float


def drawn(seed: int) -> Chain:
    """One to three bars that swing or turn over for some seconds."""
    draw = random.Random(seed)
    n = draw.randint(1, 3)

    def each(low: float, high: float) -> Array:
        return np.array([draw.uniform(low, high) for _ in range(n)])

    soft = draw.random() < 0.5
    l = each(0.3, 1.2)
    return Chain(
        each(0.2, 3.0), l, l * each(0.3, 1.0), each(0.005, 0.1),
        each(0.0, 4.0) * soft, each(0.0, 0.05) * soft, each(-3.0, 3.0), each(-5.0, 5.0), draw.uniform(2.0, 8.0),
    )  # fmt: skip


def scene(of: Chain) -> str:
    """Its spec: bars hang along -z, pins about y turn them towards -x."""
    bodies, joints, forces, before = [], [], [], "ground.O"
    for i in range(len(of.m)):
        inertia = [float(of.J[i])] * 3
        bodies.append(
            f"  b{i}: {{mass: {float(of.m[i])!r}, center: [0, 0, {-float(of.c[i])!r}], inertia: {inertia}, "
            f"points: {{a: [0, 0, 0], b: [0, 0, {-float(of.l[i])!r}]}}}}"
        )
        joints.append(
            f"  p{i}: {{type: pin, axis: [0, 1, 0], from: {before}, to: b{i}.a, "
            f"initial: {{angle: {float(of.q[i])!r}, rate: {float(of.u[i])!r}}}}}"
        )
        k, d = float(of.k[i]), float(of.d[i])
        forces.append(f"  f{i}: {{type: torque, joint: p{i}, value: -{k!r}*p{i}.angle - {d!r}*p{i}.rate}}")
        before = f"b{i}.b"
    blocks = [("bodies", bodies), ("joints", joints), ("forces", forces)]
    text = f"heun: 1\ngravity: [0, 0, -{G}]\nground: {{points: {{O: [0, 0, 0]}}}}\n"
    text += "".join(f"{name}:\n" + "\n".join(rows) + "\n" for name, rows in blocks)
    return text + f"analysis: {{duration: {of.duration!r}, samples: {SAMPLES}}}\n"


def slope(of: Chain, y: Array) -> Array:
    """y' of each y = (q, u) (..., 2n), from the equations of the absolute angles; complex numbers go through."""
    n = len(of.m)
    q, u = y[..., :n], y[..., n:]
    theta, omega = np.cumsum(q, axis=-1), np.cumsum(u, axis=-1)
    arm = np.where(np.tri(n, n, -1) > 0, of.l[None, :], 0.0) + np.diag(of.c)  # of mass k along bar i
    weight = arm.T @ (of.m[:, None] * arm)
    apart = theta[..., :, None] - theta[..., None, :]
    M = weight * np.cos(apart) + np.diag(of.J)
    load = -of.k * q - of.d * u
    load[..., :-1] -= load[..., 1:].copy()
    load -= G * (of.m @ arm) * np.sin(theta)
    load -= ((weight * np.sin(apart)) @ (omega**2)[..., None])[..., 0]
    turn = np.linalg.solve(M, load[..., None])[..., 0]
    turn[..., 1:] -= turn[..., :-1].copy()
    return np.concatenate([u, turn], axis=-1)


def slope_and_tangent(of: Chain, y: Array) -> tuple[Array, Array]:
    """The slope at y (2n,) and its derivatives (2n, 2n), a column for each of y."""
    moved = slope(of, y + 1j * TINY * np.eye(len(y)))
    return moved[0].real, moved.imag.T / TINY


class Right(NamedTuple):
    """ln G at instants (m,) of the motion."""

    times: Array
    logarithm: Array


def right(of: Chain) -> Right | None:
    """G(t) = |P Phi(t, 0)|, angles as they are, rates by the largest; None where no rate passes that of a fall."""
    n = len(of.m)
    N = 2 * n

    def both(_: float, z: Array) -> Array:
        by_time, by_state = slope_and_tangent(of, z[:N])
        return np.concatenate([by_time, (by_state @ z[N:].reshape(N, N)).ravel()])

    at = np.linspace(0.0, of.duration, SAMPLES)
    fine = np.unique(np.concatenate([at, np.linspace(0.0, of.duration, 10 * EVENLY + 1)]))
    start = np.concatenate([of.q, of.u, np.eye(N).ravel()])
    found = solve_ivp(both, (0.0, of.duration), start, "DOP853", fine, rtol=1e-11, atol=1e-11)
    rate = float(np.abs(found.y[n:N, np.isin(fine, at)]).max())
    if rate < 2.0 * math.sqrt(G / float(of.l.min())):
        return None
    by = np.concatenate([np.ones(n), np.full(n, 1.0 / rate)])
    Phi = found.y[N:].T.reshape(-1, N, N)
    scaled = Phi * by[None, :, None] / by[None, None, :]
    return Right(fine, np.log(np.linalg.norm(scaled[:, :n], 2, axis=(1, 2))))


def told(of: Chain) -> tuple[GrowthResults | None, str]:
    found = probe(load("chain.yaml", scene(of)), Options())
    return found.growth, found.reasons.get("growth", "")


def faults(of: Chain, by: Right, growth: GrowthResults) -> list[str]:
    """What of a growth that is told is not so."""
    found = []
    last = float(by.logarithm[-1])
    if abs(growth.logarithm - last) > SAME * max(abs(last), 1.0):
        found.append(f"ln G {growth.logarithm:.8g}, right {last:.8g}")
    rate = slope_of(of.duration, *by)
    if abs(growth.rate - rate) * of.duration > 6.0 * BETWEEN:  # over a half, by least squares
        found.append(f"rate {growth.rate:.6g}, right {rate:.6g}")
    least, most = (math.log(EPS) + 0.5 * math.log(count) + by.logarithm for count in STEPS)
    earliest, latest = (first(by.times, error) for error in (most, least))
    if not earliest <= (math.inf if growth.horizon is None else growth.horizon) <= latest:
        found.append(f"horizon {growth.horizon}, right {earliest:.6g} to {latest:.6g}")
    return found


def slope_of(duration: float, times: Array, logarithm: Array) -> float:
    """The mean slope of ln G over the second half."""
    half = np.linspace(0.5 * duration, duration, EVENLY)
    return float(np.polyfit(half - half.mean(), np.interp(half, times, logarithm), 1)[0])


def first(times: Array, error: Array) -> float:
    """The first instant at which an error passes what is claimed; infinite where none does."""
    beyond = np.flatnonzero(error > math.log(CLAIMED))
    return float(times[beyond[0]]) if len(beyond) else math.inf


def main() -> None:
    asked = asked_of("tests.honesty.growth_claims", __doc__)
    count = wrong = left = 0
    largest = 0.0
    for seed in range(asked.seed, asked.seed + asked.cases):
        of = drawn(seed)
        by = right(of)
        growth, reason = told(of) if by is not None else (None, "")
        if by is None or growth is None:
            left += 1
            if reason:
                print(f"{seed}: not told: {reason}")
            continue
        count += 1
        last = float(by.logarithm[-1])
        largest = max(largest, abs(growth.logarithm - last) / max(abs(last), 1.0))
        for fault in faults(of, by, growth):
            wrong += 1
            print(f"{seed}: {fault}")
    sys.stdout.write(f"{count} motions, {left} left out, {wrong} numbers wrong; ln G off by {largest:.2g} at most\n")


if __name__ == "__main__":
    main()
