"""Cams and paths for tests: tables of formulas, and a cam on a carriage that moves and turns freely."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.results.results import Array

PERIOD = "interpolation: cubic, period: 360 deg"
AT = {"slide": "[0.01, 0.1, 0]", "pin": "[0.3, 0.02, 0]"}
FOLLOWERS = {
    "slide": "{type: slide, from: cart.P, to: f.o, axis: [0.1, 1, 0]}",
    "pin": "{type: pin, from: cart.P, to: f.o, axis: [0, 0, 1]}",
}
PIVOTS = {"slide": "[0.01, 0, 0]", "pin": "[-0.3, 0.12, 0]"}
CONTACTS = {"roller": "roller, radius: 0.02", "flat": "flat, normal: [0.15, 1, 0]", "point": "point"}


def table(function: Callable[[Array], Array], first: float, last: float, count: int, end: str = "") -> str:
    """The entry of a cubic table through points of a function; end: its other keys."""
    x = np.linspace(first, last, count + 1)
    return f"{{x: {x.tolist()}, y: {function(x).tolist()}, interpolation: cubic{end}}}"


def lift(function: Callable[[Array], Array], count: int) -> str:
    """The table of a lift over a turn, through `count` points of it."""

    def closed(x: Array) -> Array:
        y = np.array(function(x))
        y[-1] = y[0]
        return y

    return table(closed, 0.0, 2.0 * np.pi, count, ", period: 360 deg")


def carried_cam(joint: str, contact: str) -> str:
    """A cam on a carriage that nothing holds, which flies, turns and is turned by what it carries."""
    of = {"slide": (0.0, 1.0), "pin": (0.1, 4.0)}[joint]
    rise = lift(lambda x: of[0] + of[1] * (0.02 * np.sin(x) + 0.006 * np.cos(2.0 * x)), 48)
    return f"""
heun: 1
gravity: [1, -9.81, 2]
tables: {{lift: {rise}}}
bodies:
  cart:
    mass: 5
    center: [0.1, 0.02, 0.03]
    inertia: [[0.3, 0.01, 0], [0.01, 0.4, 0.02], [0, 0.02, 0.5]]
    angular_velocity: [0.7, -1.1, 1.9]
    velocity: [0.3, 0.1, -0.4]
    points: {{O: [0, 0, 0], P: {PIVOTS[joint]}}}
  disc: {{mass: 2, center: [0.01, 0, 0.01], inertia: [0.01, 0.02, 0.03], points: {{O: [0, 0, 0]}}}}
  f:
    mass: 0.7
    center: [0.05, 0.05, 0.02]
    inertia: [[0.004, 0, 0.001], [0, 0.003, 0], [0.001, 0, 0.005]]
    points: {{o: [0, 0, 0], C: {AT[joint]}}}
joints:
  shaft: {{type: pin, from: cart.O, to: disc.O, axis: [0, 0, 1], initial: {{angle: 0.6, rate: 9}}}}
  follow: {FOLLOWERS[joint]}
couplings:
  cam: {{type: cam, of: [shaft, follow], lift: lift, at: f.C, contact: {CONTACTS[contact]}, two_sided: true}}
analysis: {{duration: 0.05, samples: 4}}
"""


def eccentric(rise: str, contact: str, rate: float = 20.0, more: str = "two_sided: true") -> str:
    """A tappet of 0.5 kg that a disc lifts along y, turning about z at a constant rate from its lowest place."""
    return f"""
heun: 1
gravity: [0, -9.81, 0]
tables: {{lift: {rise}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  disc: {{mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.02], points: {{O: [0, 0, 0]}}}}
  tappet: {{mass: 0.5, center: [0, 0.1, 0], inertia: [1e-3, 1e-3, 1e-3], points: {{P: [0, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: disc.O, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: tappet.P, axis: [0, 1, 0]}}
drives: {{motor: {{joint: shaft, angle: {rate}*t}}}}
couplings:
  cam: {{type: cam, of: [shaft, guide], lift: lift, at: tappet.P, contact: {contact}, {more}}}
analysis: {{duration: {6.0 / rate}, samples: 13}}
"""
