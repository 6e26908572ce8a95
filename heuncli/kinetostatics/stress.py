"""Stresses in a section of given properties, from its loads about the centroid.

    sigma = N/A + (M1/I1) y2 - (M2/I2) y1,   tau_T = T/W_T,   tau_Q = |Q|/A
    mises = sqrt(sigma^2 + 3 (tau_T + tau_Q)^2)
linear over the section, principal axes e1, e2; tau_Q is the mean shear, added to the torsional one as the safe side.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from heuncli.records import record
from heuncli.results import Array, Block


@record
class SectionModuli:
    """Area [m2], second moments about e1 and e2 [m4], half extents c1 along e1 and c2 along e2 [m], W_T [m3].

    round: whether bending about any axis meets the same extent (circle, tube), else the corners count.
    """

    area: float
    I1: float
    I2: float
    c1: float
    c2: float
    W_T: float
    round: bool


def circle(v: Mapping[str, float]) -> SectionModuli:
    """Solid circle."""
    return tube({"radius": v["radius"], "inner_radius": 0.0})


def tube(v: Mapping[str, float]) -> SectionModuli:
    """Circular ring."""
    R, r = v["radius"], v["inner_radius"]
    I = 0.25 * math.pi * (R**4 - r**4)
    return SectionModuli(math.pi * (R * R - r * r), I, I, R, R, 2.0 * I / R, True)


def rectangle(v: Mapping[str, float]) -> SectionModuli:
    """Solid rectangle, width along e1, height along e2; W_T by Saint-Venant's series."""
    b, h = v["width"], v["height"]
    return SectionModuli(b * h, b * h**3 / 12.0, h * b**3 / 12.0, 0.5 * b, 0.5 * h, torsion_modulus(b, h), False)


FIFTH = 1.0045237627951382  # sum of 1/n^5 over odd n, 31/32 zeta(5): the rest of the series converges exponentially


def torsion_modulus(b: float, h: float) -> float:
    """T over the largest torsional shear stress of a rectangle.

    Timoshenko, Goodier, Theory of Elasticity, section 109.
    """
    a, c = min(b, h), max(b, h)
    odd = range(1, 40, 2)
    tanh = FIFTH - sum((1.0 - math.tanh(0.5 * n * math.pi * c / a)) / n**5 for n in odd)
    J = a**3 * c / 3.0 * (1.0 - 192.0 * a / (math.pi**5 * c) * tanh)
    slope = 1.0 - 8.0 / math.pi**2 * sum(1.0 / (n * n * math.cosh(min(0.5 * n * math.pi * c / a, 700.0))) for n in odd)
    return J / (a * slope)


def general(v: Mapping[str, float]) -> SectionModuli:
    """Properties as given; the torsional stress at the farther of the two extents."""
    return SectionModuli(v["area"], v["I1"], v["I2"], v["c1"], v["c2"], v["J"] / max(v["c1"], v["c2"]), False)


MODULI: dict[str, Callable[[Mapping[str, float]], SectionModuli]] = {
    "circle": circle, "tube": tube, "rectangle": rectangle, "general": general,
}  # fmt: skip


def stresses(moduli: SectionModuli, loads: Mapping[str, Array], strength: float | None) -> Block:
    """Extreme normal, torsional and mean shear stress, von Mises and utilisation, [Pa], shapes as the loads'.

    loads: N, Q1, Q2, T, M1, M2 about the centroid.
    """
    axial = loads["N"] / moduli.area
    if moduli.round:
        bending = np.hypot(loads["M1"], loads["M2"]) * moduli.c1 / moduli.I1
    else:
        bending = np.abs(loads["M1"]) * moduli.c2 / moduli.I1 + np.abs(loads["M2"]) * moduli.c1 / moduli.I2
    torsion = np.abs(loads["T"]) / moduli.W_T
    shear = np.hypot(loads["Q1"], loads["Q2"]) / moduli.area
    largest = np.abs(axial) + bending
    block: Block = {
        "normal_max": axial + bending, "normal_min": axial - bending, "shear_torsion": torsion, "shear_mean": shear,
        "mises": np.sqrt(largest**2 + 3.0 * (torsion + shear) ** 2),
    }  # fmt: skip
    if strength is not None:
        block["utilisation"] = block["mises"] / strength
    return block
