"""Compute stresses in a section of given properties, from its loads about the centroid.

    sigma = N/A + (M1/I1) y2 - (M2/I2) y1,   tau_T = T/W_T,   tau_Q = k |Q|/A,   mises^2 = sigma^2 + 3 tau^2

linear over the section, principal axes e1, e2; k by the section's own shape: tau_Q is the largest of Jourawski's Q S/(I
b), for a ring across its middle. How they combine, and the maxima: section_fields.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from heuncli.base.records import record
from heuncli.loads.kinetostatics import section_fields as fields
from heuncli.results.results import Array, Block

# Wide-flange beams sheared along the web reach 5.1 (HE 260 A), tubes 2, a diamond 9/8: sections that are given by
# their moments are beams mostly. A thinner web has more.
UNKNOWN_SHEAR = 5.5


Number = float | Array  # one, or one a cut
Sizes = Mapping[str, Number]  # a section's measures by name, as the spec gives them


@record
class SectionModuli:
    """Area [m2], second moments about e1 and e2 [m4], half extents c1 along e1 and c2 along e2 [m], W_T [m3].

    shear: the largest shear stress over the mean one
    is_round: whether bending about any axis has the same extent (circle, tube); else the corners count
    largest: function of the maxima over the section
    """

    area: Number
    I1: Number
    I2: Number
    c1: Number
    c2: Number
    W_T: Number
    shear: Number
    is_round: bool
    largest: fields.Largest


def circle_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a solid circle."""
    return ring_moduli(v["radius"], 0.0, fields.circle_maxima)


def tube_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a circular ring."""
    return ring_moduli(v["radius"], v["inner_radius"], fields.tube_maxima)


def ring_moduli(R: Number, r: Number, largest: fields.Largest) -> SectionModuli:
    """Return the moduli of any ring, from a solid circle to a thin tube."""
    I = 0.25 * math.pi * (R**4 - r**4)
    shear = 4.0 / 3.0 * (R * R + R * r + r * r) / (R * R + r * r)
    return SectionModuli(math.pi * (R * R - r * r), I, I, R, R, 2.0 * I / R, shear, True, largest)


def rectangle_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a solid rectangle, width along e1, height along e2; W_T by Saint-Venant's series."""
    b, h = float(v["width"]), float(v["height"])
    I1, I2, W_T = b * h**3 / 12.0, h * b**3 / 12.0, torsion_modulus(b, h)
    return SectionModuli(b * h, I1, I2, 0.5 * b, 0.5 * h, W_T, 1.5, False, fields.make_rectangle_maxima(b, h))


ODD = range(1, 40, 2)
ODD_FIFTH_POWERS = (
    1.0045237627951382  # sum of 1/n^5 over odd n, 31/32 zeta(5): the rest of the series converges exponentially
)


def torsion_modulus(b: float, h: float) -> float:
    """Return T over the largest torsional shear stress of a rectangle.

    Timoshenko, Goodier, Theory of Elasticity, section 109.
    """
    a, c = min(b, h), max(b, h)
    slope = 1.0 - 8.0 / math.pi**2 * sum(1.0 / (n * n * math.cosh(min(0.5 * n * math.pi * c / a, 700.0))) for n in ODD)
    return torsion_constant(b, h) / (a * slope)


def torsion_constant(b: float, h: float) -> float:
    """Return J of a rectangle: T over modulus of rigidity and twist."""
    a, c = min(b, h), max(b, h)
    tanh = ODD_FIFTH_POWERS - sum((1.0 - math.tanh(0.5 * n * math.pi * c / a)) / n**5 for n in ODD)
    return a**3 * c / 3.0 * (1.0 - 192.0 * a / (math.pi**5 * c) * tanh)


def general_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli from given properties; the torsional stress is that of the thickest shape that fits.

    A convex section's is at most 2 rho T/J, rho the radius of the largest circle in it (Payne's bound of the stress
    function's slope), which is at most min(c1, c2); an open profile's is t T/J with walls of t < 2 min(c1, c2).
    """
    c1, c2, shear = v["c1"], v["c2"], v.get("shear_factor", UNKNOWN_SHEAR)
    reach = np.maximum(np.maximum(c1, c2), 2.0 * np.minimum(c1, c2))
    return SectionModuli(v["area"], v["I1"], v["I2"], c1, c2, v["J"] / reach, shear, False, fields.unknown_shape_maxima)


MODULI: dict[str, Callable[[Sizes], SectionModuli]] = {
    "circle": circle_moduli, "tube": tube_moduli, "rectangle": rectangle_moduli, "general": general_moduli,
}  # fmt: skip


def compute_stresses(moduli: SectionModuli, loads: Mapping[str, Array], strength: float | None) -> Block:
    """Return extreme normal stresses, largest and mean shear, von Mises and utilisation, [Pa], shapes as the loads'.

    loads: N, Q1, Q2, T, M1, M2 about the centroid
    """
    m = moduli
    stress_fields = fields.StressFields(
        loads["N"] / m.area,
        (-loads["M2"] * (m.c1 / m.I2), loads["M1"] * (m.c2 / m.I1)),
        (m.shear * loads["Q1"] / m.area, m.shear * loads["Q2"] / m.area),
        loads["T"] / m.W_T,
    )
    bending = (
        np.hypot(*stress_fields.bend) if m.is_round else np.abs(stress_fields.bend[0]) + np.abs(stress_fields.bend[1])
    )
    shear, mises = m.largest(stress_fields)
    block: Block = {
        "normal_max": stress_fields.axial + bending,
        "normal_min": stress_fields.axial - bending,
        "shear_torsion": np.abs(stress_fields.torsion),
        "shear_mean": np.hypot(loads["Q1"], loads["Q2"]) / m.area,
        "shear_max": shear,
        "mises": mises,
    }
    if strength is not None:
        block["utilisation"] = mises / strength
    return block
