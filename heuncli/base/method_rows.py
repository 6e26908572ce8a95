"""The integration methods, one row each: all other code reads the rows.

`auto` is not a method but a choice among them. The spec depends on this module, so it does not import NumPy; the
coefficients are in heuncli/motion/integration/methods, a family to a file.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple


class MethodRow(NamedTuple):
    """An integration method.

    kind: the family of its code; steps: whether it controls its step by its error
    attitude: how rotations are integrated within a step
    purpose: what it is for, in `heun methods`
    coefficients: the module in heuncli/motion/integration/methods, and the name in it
    """

    name: str
    order: int
    kind: Literal["explicit", "implicit", "SciPy"]
    steps: Literal["fixed", "adaptive"]
    attitude: Literal["quaternion", "rodrigues", "recentred"]
    purpose: str
    coefficients: str


AUTO, DEFAULT = "auto", "DOP853"
SMOOTH_ONLY = "use method: auto, or any method other than SciPy's"  # the hint where SciPy's methods are refused
METHODS = (
    MethodRow(
        "Euler", 1, "explicit", "fixed", "quaternion",
        "cautionary example: one more digit takes ten times the steps", "explicit.EULER",
    ),
    MethodRow(
        "Heun2", 2, "explicit", "fixed", "quaternion",
        "mean of two slopes (Heun, 1900): for teaching and comparison", "explicit.HEUN2",
    ),
    MethodRow(
        "Heun3", 3, "explicit", "fixed", "quaternion",
        "Heun's third-order method, 1900: for teaching and comparison", "explicit.HEUN3",
    ),
    MethodRow(
        "RK4", 4, "explicit", "fixed", "quaternion",
        "classical Runge-Kutta method: for real time and comparison", "explicit.RK4",
    ),
    MethodRow(
        "DOPRI5", 5, "explicit", "adaptive", "quaternion",
        "coarse tolerances, 1e-3 to 1e-5, and frequent load jumps", "explicit.DOPRI5",
    ),
    MethodRow(
        "DOP853", 8, "explicit", "adaptive", "quaternion",
        "the default: smooth motions, six or more digits", "explicit.DOP853",
    ),
    MethodRow(
        "Verner98", 9, "explicit", "adaptive", "quaternion",
        "smooth motions, tolerance 1e-12 and below", "verner.VERNER98",
    ),
    MethodRow(
        "DOP853-rodrigues", 8, "explicit", "adaptive", "rodrigues",
        "Heun's section 20: rotation from the start; fails at 180 deg", "explicit.DOP853_GLOBAL",
    ),
    MethodRow(
        "DOP853-recentred", 8, "explicit", "adaptive", "recentred",
        "rotation from the step's start: as accurate as quaternions", "explicit.DOP853_RECENTRED",
    ),
    MethodRow(
        "Gauss4", 4, "implicit", "fixed", "quaternion",
        "long runs without damping: symmetric, no energy drift", "collocation.GAUSS4",
    ),
    MethodRow(
        "Gauss6", 6, "implicit", "fixed", "quaternion",
        "long runs without damping, higher accuracy", "collocation.GAUSS6",
    ),
    MethodRow(
        "Radau5", 5, "implicit", "adaptive", "quaternion",
        "stiff systems, a few digits: stiff springs, dry friction", "collocation.RADAU5",
    ),
    MethodRow(
        "Radau9", 9, "implicit", "adaptive", "quaternion",
        "stiff systems, six or more digits", "collocation.RADAU9",
    ),
    MethodRow(
        "SciPy-Radau", 5, "SciPy", "adaptive", "quaternion",
        "independent check of stiff systems", "collocation.RADAU",
    ),
    MethodRow(
        "SciPy-BDF", 5, "SciPy", "adaptive", "quaternion",
        "independent check, orders 1 to 5", "collocation.BDF",
    ),
    MethodRow(
        "SciPy-LSODA", 12, "SciPy", "adaptive", "quaternion",
        "independent check, orders 1 to 12; detects stiffness itself", "collocation.LSODA",
    ),
)  # fmt: skip
BY_NAME = {row.name.lower(): row for row in METHODS}
NAMES = (AUTO, *(row.name for row in METHODS))


def canonical_name(name: str) -> str:
    """Return the name of a method as its row spells it; other words are returned unchanged."""
    row = find_method(name)
    return row.name if row is not None else name.lower() if name.lower() == AUTO else name


def find_method(name: str) -> MethodRow | None:
    """Return the row of a method by its name, in any case; None for any other word, and for `auto`."""
    return BY_NAME.get(name.lower())
