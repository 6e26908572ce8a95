"""Functions of time that joints are driven by, with their derivatives, and scenes driven so: a nut, a winch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from heuncli.results.results import Array, Results
from tests.shared.scenes import near, solved

G = 9.81
TIMES = np.linspace(0.0, 1.2, 13)
MOVED = 1e-10  # where a free coordinate was integrated at a tolerance of 1e-11


@dataclass(frozen=True)
class Law:
    """A function of t, its text, and its derivatives."""

    source: str
    value: Callable[[Array], Array]
    first: Callable[[Array], Array]
    second: Callable[[Array], Array]


LAWS = {
    "steady": Law("0.3 + 100*t", lambda t: 0.3 + 100 * t, lambda t: 100 + 0 * t, lambda t: 0 * t),
    "polynomial": Law("0.2 - t + 3*t**2 - 0.5*t**3", lambda t: 0.2 - t + 3 * t**2 - 0.5 * t**3,
                      lambda t: -1 + 6 * t - 1.5 * t**2, lambda t: 6 - 3 * t),
    "harmonic": Law("0.5 + 0.3*sin(7*t + 0.2)", lambda t: 0.5 + 0.3 * np.sin(7 * t + 0.2),
                    lambda t: 2.1 * np.cos(7 * t + 0.2), lambda t: -14.7 * np.sin(7 * t + 0.2)),
    "composed": Law("1 + 0.5*exp(-t**2)*cos(3*t)", lambda t: 1 + 0.5 * np.exp(-(t**2)) * np.cos(3 * t),
                    lambda t: 0.5 * np.exp(-(t**2)) * (-2 * t * np.cos(3 * t) - 3 * np.sin(3 * t)),
                    lambda t: 0.5 * np.exp(-(t**2)) * ((4 * t**2 - 11) * np.cos(3 * t) + 12 * t * np.sin(3 * t))),
    "rising from rest": Law(  # two kinks of the second derivative
        "0.4 + (0 if t < 0.35 else ((t - 0.35)**2 if t < 0.75 else 0.16 + 0.8*(t - 0.75)))",
        lambda t: 0.4 + np.where(t < 0.35, 0, np.where(t < 0.75, (t - 0.35)**2, 0.16 + 0.8 * (t - 0.75))),
        lambda t: np.where(t < 0.35, 0, np.where(t < 0.75, 2 * (t - 0.35), 0.8)),
        lambda t: np.where((t >= 0.35) & (t < 0.75), 2.0, 0.0)),
}  # fmt: skip


def run(bodies: str, joints: str, drive: str, more: str = "", tolerance: float = 1e-11) -> Results:
    times = ", ".join(repr(float(t)) for t in TIMES)
    head = f"heun: 1\ngravity: [0, -{G}, 0]\nground: {{points: {{O: [0, 0, 0]}}}}\n"
    analysis = f"analysis: {{times: [{times}], tolerance: {tolerance}}}\n"
    return solved(f"{head}bodies:\n{bodies}joints:\n{joints}drives:\n  motor: {drive}\n{more}{analysis}")


def energy_is_kept(found: Results) -> None:
    """Kinetic + potential less the drive's work: within the tolerance of the work that is integrated."""
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], max(1.0, float(np.abs(found.energy["kinetic"]).max())), MOVED)


@cache
def nut() -> Results:
    """A nut pushed along its upright spindle while it spins freely, braked by a damper."""
    body = "mass: 2, center: [0, 0, 0], inertia: [0.3, 0.4, 0.3], points: {P: [0, 0, 0]}, angular_velocity: [0, 5, 0]"
    return run(f"  nut: {{{body}}}\n",
               "  spindle: {type: cylinder, from: ground.O, to: nut.P, axis: [0, 1, 0]}\n",
               f"{{joint: spindle, travel: '{LAWS['harmonic'].source}'}}",
               "forces: {brake: {type: damper, joint: spindle, coefficient: 0.8, sliding: 3}}\n")  # fmt: skip


LOAD = "  load: {{mass: 5, center: [0, 0, 0], points: {{P: [0, 0, 0]}}, {more}}}\n"
ROPE = "  rope: {type: rod, from: ground.O, to: load.P}\n"


@cache
def winch(law: Law) -> Results:
    """A load hauled straight up."""
    return run(LOAD.format(more="inertia: [1, 1, 1], near: {position: [0, -3, 0]}"),
               ROPE, f"{{joint: rope, length: '{law.source}'}}")  # fmt: skip
