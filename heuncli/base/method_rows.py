"""The integration methods, one row each: all other code reads the rows.

`auto` is not a method but a choice among them. The spec depends on this module, so it does not import NumPy; the
coefficients are in heuncli/motion/integration/methods, a family to a file.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple


class MethodRow(NamedTuple):
    """A method: name, order, family, step control, how it represents attitudes within a step, and its purpose.

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
SMOOTH_ONLY = "method: auto does, and every method that is not SciPy's"  # a hint, where these are refused a scene
METHODS = (
    MethodRow(
        "Euler", 1, "explicit", "fixed", "quaternion",
        "a warning: a digit more takes ten times the steps", "explicit.EULER",
    ),
    MethodRow(
        "Heun2", 2, "explicit", "fixed", "quaternion",
        "Heun's mean of two slopes, 1900: to teach, to compare", "explicit.HEUN2",
    ),
    MethodRow("Heun3", 3, "explicit", "fixed", "quaternion", "Heun's third order, 1900: the same", "explicit.HEUN3"),
    MethodRow(
        "RK4", 4, "explicit", "fixed", "quaternion",
        "the classical one: in real time, and to compare", "explicit.RK4",
    ),
    MethodRow(
        "DOPRI5", 5, "explicit", "adaptive", "quaternion",
        "coarse tolerances, 1e-3 to 1e-5, and loads that jump often", "explicit.DOPRI5",
    ),
    MethodRow(
        "DOP853", 8, "explicit", "adaptive", "quaternion",
        "the default: smooth motions to six digits and more", "dop853.DOP853",
    ),
    MethodRow(
        "Verner98", 9, "explicit", "adaptive", "quaternion",
        "smooth motions to 1e-12 and below", "verner.VERNER98",
    ),
    MethodRow(
        "DOP853-rodrigues", 8, "explicit", "adaptive", "rodrigues",
        "Heun's no. 20: attitudes from the drawn one; ends at half turns", "rodrigues.DOP853_GLOBAL",
    ),
    MethodRow(
        "DOP853-recentred", 8, "explicit", "adaptive", "recentred",
        "attitudes from each step's start: as good as quaternions", "rodrigues.DOP853_RECENTRED",
    ),
    MethodRow(
        "Gauss4", 4, "implicit", "fixed", "quaternion",
        "long runs without damping: symmetric, no drift of the energy", "collocation.GAUSS4",
    ),
    MethodRow(
        "Gauss6", 6, "implicit", "fixed", "quaternion",
        "the same to more digits", "collocation.GAUSS6",
    ),
    MethodRow(
        "Radau5", 5, "implicit", "adaptive", "quaternion",
        "stiff motions to a few digits: hard springs, dry friction", "collocation.RADAU5",
    ),
    MethodRow(
        "Radau9", 9, "implicit", "adaptive", "quaternion",
        "stiff motions to six digits and more", "collocation.RADAU9",
    ),
    MethodRow(
        "SciPy-Radau", 5, "SciPy", "adaptive", "quaternion",
        "an independent check of stiff motions", "scipy_methods.RADAU",
    ),
    MethodRow("SciPy-BDF", 5, "SciPy", "adaptive", "quaternion", "the same, of orders 1 to 5", "scipy_methods.BDF"),
    MethodRow(
        "SciPy-LSODA", 12, "SciPy", "adaptive", "quaternion", "the same, of orders 1 to 12; takes what it finds",
        "scipy_methods.LSODA",
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
