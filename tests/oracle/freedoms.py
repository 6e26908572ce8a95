"""Mechanisms of one or two freedoms at random: their text, and their equations by hand.

Slides and shafts along and about z; pendulums in the xy plane, angles from the x axis, weight along -y.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import NamedTuple

import numpy as np

from tests.oracle.switched import Accelerations, Vector

G = 9.81


class Machine(NamedTuple):
    """names: of each joint, its coordinate and its rate; inertia: about what resists each coordinate.

    springs: forces along the coordinates that always act, as text, and as a function of them.
    """

    name: str
    text: str
    names: tuple[tuple[str, str, str], ...]
    start: tuple[Vector, Vector]
    accelerations: Accelerations
    inertia: Vector
    springs: tuple[str, ...] = ()
    forces: Callable[[Vector], Vector] = lambda x: np.zeros(len(x))


def head(gravity: float = 0.0) -> str:
    return f"heun: 1\ngravity: [0, {-gravity!r}, 0]\nground: {{points: {{O: [0, 0, 0]}}}}\n"


def wheel(r: Random) -> Machine:
    """A wheel on a shaft."""
    inertia, x, u = 10 ** r.uniform(-1, 2), r.uniform(-1, 1), r.choice([-1, 1]) * 10 ** r.uniform(-0.5, 1)
    text = (
        head()
        + f"""bodies:
  b0: {{mass: 1, center: [0, 0, 0], inertia: [{inertia!r}, {inertia!r}, {inertia!r}], points: {{o: [0, 0, 0]}}}}
joints:
  j0: {{type: pin, from: ground.O, to: b0.o, axis: [0, 0, 1], initial: {{angle: {x!r}, rate: {u!r}}}}}
"""
    )
    return Machine("wheel", text, (("j0", "angle", "rate"),), (np.array([x]), np.array([u])),
                   lambda t, x, u, Q: Q / inertia, np.array([inertia]))  # fmt: skip


def blocks(r: Random, count: int) -> Machine:
    """Blocks side by side on guides of their own, two of them with a spring along these."""
    m = np.array([10 ** r.uniform(-1, 1.5) for _ in range(count)])
    x = np.array([r.uniform(-0.3, 0.3) for _ in range(count)])
    u = np.array([r.choice([-1, 1]) * 10 ** r.uniform(-0.5, 1) for _ in range(count)])
    bodies = joints = ""
    for k, (mass, travel, speed) in enumerate(zip(m.tolist(), x.tolist(), u.tolist(), strict=True)):
        bodies += f"  b{k}: {{mass: {mass!r}, center: [0, {k}, 0], inertia: [1, 1, 1], points: {{o: [0, {k}, 0]}}}}\n"
        joints += (f"  j{k}: {{type: slide, from: {{body: ground, at: [0, {k}, 0]}}, to: b{k}.o, axis: [0, 0, 1], "
                   f"initial: {{travel: {travel!r}, speed: {speed!r}}}}}\n")  # fmt: skip
    text = f"{head()}bodies:\n{bodies}joints:\n{joints}"
    plain = Machine("block", text, tuple((f"j{k}", "travel", "speed") for k in range(count)), (x, u),
                    lambda t, x, u, Q: Q / m, m)  # fmt: skip
    if count == 1:
        return plain
    k = 10 ** r.uniform(0, 2)
    springs = (f"{k!r}*(j1.travel - j0.travel)", f"{k!r}*(j0.travel - j1.travel)")
    return plain._replace(name="two blocks", springs=springs, forces=lambda x: k * np.array([x[1] - x[0], x[0] - x[1]]))


class Bar(NamedTuple):
    """Its mass, the way to its centre, to the next pin, and its inertia about the centre."""

    m: float
    c: float
    l: float
    inertia: float

    @property
    def about(self) -> float:
        """The inertia about its pin."""
        return self.inertia + self.m * self.c**2


def pendulum(r: Random, count: int) -> Machine:
    """One bar on a pin, or two."""
    bars = [Bar(r.uniform(0.5, 3), r.uniform(0.2, 0.6), r.uniform(0.5, 1.2), r.uniform(0.02, 0.3)) for _ in range(2)]
    x = np.array([r.uniform(-2.5, 0.5), r.uniform(-1, 1)][:count])
    u = np.array([r.uniform(-3, 3), r.uniform(-3, 3)][:count])
    bodies = joints = ""
    for k, b in enumerate(bars[:count]):
        bodies += (f"  b{k}: {{mass: {b.m!r}, center: [{b.c!r}, 0, 0], inertia: [{b.inertia!r}, {b.inertia!r}, "
                   f"{b.inertia!r}], points: {{o: [0, 0, 0], e: [{b.l!r}, 0, 0]}}}}\n")  # fmt: skip
        joints += (f"  j{k}: {{type: pin, from: {'b0.e' if k else 'ground.O'}, to: b{k}.o, axis: [0, 0, 1], "
                   f"initial: {{angle: {float(x[k])!r}, rate: {float(u[k])!r}}}}}\n")  # fmt: skip
    text = f"{head(G)}bodies:\n{bodies}joints:\n{joints}"
    names = tuple((f"j{k}", "angle", "rate") for k in range(count))
    upper, lower = bars
    if count == 1:
        return Machine("pendulum", text, names, (x, u), lambda t, x, u, Q: swing(upper, x, Q), np.array([upper.about]))
    inertia = np.array([upper.about + lower.m * upper.l**2, lower.about])
    return Machine("double pendulum", text, names, (x, u), lambda t, x, u, Q: swing_two(bars, x, u, Q), inertia)


def swing(bar: Bar, x: Vector, Q: Vector) -> Vector:
    return np.asarray((Q - bar.m * G * bar.c * math.cos(x[0])) / bar.about)


def swing_two(bars: list[Bar], x: Vector, u: Vector, Q: Vector) -> Vector:
    """Lagrange's equations in the upper angle and the lower one against it."""
    a, b = bars
    both, turning = (b.m * a.l * b.c * f(x[1]) for f in (math.cos, math.sin))
    weight = b.m * b.c * G * math.cos(x[0] + x[1])
    q0 = Q[0] + turning * (2 * u[0] * u[1] + u[1] ** 2) - (a.m * a.c + b.m * a.l) * G * math.cos(x[0]) - weight
    q1 = Q[1] - turning * u[0] ** 2 - weight
    M00, M01, M11 = a.about + b.m * a.l**2 + b.about + 2 * both, b.about + both, b.about
    return np.array([M11 * q0 - M01 * q1, M00 * q1 - M01 * q0]) / (M00 * M11 - M01 * M01)


MACHINES: list[Callable[[Random], Machine]] = [
    lambda r: blocks(r, 1),
    wheel,
    lambda r: pendulum(r, 1),
    lambda r: blocks(r, 2),
    lambda r: pendulum(r, 2),
]
