"""A02, windows of equal bars, by normal equations in the plane: n + 1 bars, then n couplers, (x, y, angle) each."""

from __future__ import annotations

import math

import numpy as np

from heuncli.results.results import Array

GRAVITY = 9.81


def upright(n: int, tilt: float = 0.0) -> Array:
    """Places, then rates, of bars `tilt` from upright that roll over to +x at 1 rad/s."""
    sin, cos = math.sin(tilt), math.cos(tilt)
    bars = [[i + sin / 2, cos / 2, math.pi / 2 - tilt] for i in range(n + 1)]
    couplers = [[i + 0.5 + sin, cos, 0.0] for i in range(n)]
    rates = [[cos / 2, -sin / 2, -1.0]] * (n + 1) + [[cos, -sin, 0.0]] * n
    return np.concatenate([np.ravel(bars + couplers), np.ravel(rates)])


def pins(n: int) -> list[tuple[tuple[int, float], tuple[int, float] | None]]:
    """Of each pin the body and the place along it, -1/2 or 1/2, twice; None is the ground."""
    found: list[tuple[tuple[int, float], tuple[int, float] | None]] = [((i, -0.5), None) for i in range(n + 1)]
    for i in range(n):
        found += [((i, 0.5), (n + 1 + i, -0.5)), ((i + 1, 0.5), (n + 1 + i, 0.5))]
    return found


def normal_equations(q: Array, v: Array, n: int) -> tuple[Array, Array, Array]:
    """A = J M^-1 J^T, the accelerations, the multipliers: forces on the first body of each pin, x and y by turns."""
    held = pins(n)
    J, bias = np.zeros((2 * len(held), len(q))), np.zeros(2 * len(held))
    for k, ends in enumerate(held):
        for sign, end in zip((1.0, -1.0), ends, strict=True):
            if end is not None:
                body, s = end
                c, d = s * math.cos(q[3 * body + 2]), s * math.sin(q[3 * body + 2])
                J[2 * k : 2 * k + 2, 3 * body : 3 * body + 3] = sign * np.array([[1, 0, -d], [0, 1, c]])
                bias[2 * k : 2 * k + 2] -= sign * v[3 * body + 2] ** 2 * np.array([c, d])
    light = np.tile([1.0, 1.0, 12.0], len(q) // 3)  # 1/m and 1/I of a rod of 1 kg and 1 m
    weight = np.tile([0.0, -GRAVITY, 0.0], len(q) // 3)
    A = (J * light) @ J.T
    try:
        pull = np.linalg.solve(A, -bias - J @ weight)
    except np.linalg.LinAlgError:
        pull = np.full(len(A), np.nan)
    return A, weight + light * (J.T @ pull), pull


def accelerated(q: Array, v: Array, n: int) -> Array:
    return normal_equations(q, v, n)[1]
