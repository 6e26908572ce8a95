"""Compute stresses in a section of given properties, from its loads about the centroid.

    sigma = N/A + (M1/I1) y2 - (M2/I2) y1,   tau_T = T/W_T,   tau_Q = k |Q|/A,   mises^2 = sigma^2 + 3 tau^2

sigma is here the normal stress (in sections.py the angular velocity). It is linear over the section; e1, e2 are the
principal axes. k is that of the section's shape: tau_Q is the largest of Jourawski's Q S/(I b), for a ring across its
middle. How the stresses combine, and their maxima: at the functions below.

The largest shear and von Mises stress over a shape follow from the distribution of both:

    sigma = axial + bend . u,   mises^2 = sigma^2 + 3 |tau|^2,   u the place, in half extents of the section

Shear by Jourawski, tau = Q S/(I b), torsion by Saint-Venant. The result is never below the largest of these fields.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Block

# Section fields

NEWTON_STEPS = 8  # Newton's rounds from a start within a factor 1.5 of the solution: doubling digits, four would do
CELLS = 10  # cells per half extent: the error of a cell is a few per cent of the largest stress
TERMS = 1000  # terms of the torsion's series: the rest is some 1e-6 along the short sides, and less elsewhere
CHUNK = 512  # places in time and along a run treated together: the cells' arrays stay in the cache


@record
class StressFields:
    """The stresses of the loads in a section, [Pa], arrays of one shape, signs as the loads'.

    bend: normal stress at the ends of its half extents along e1, e2
    shear: largest from Q1, Q2 alone
    torsion: largest from T alone
    """

    axial: Array
    bend: tuple[Array, Array]
    shear: tuple[Array, Array]
    torsion: Array

    @property
    def shear_magnitude(self) -> Array:
        """Largest stress from the shear force alone where its components add up as vectors."""
        return np.asarray(np.hypot(*self.shear))


Largest = Callable[[StressFields], tuple[Array, Array]]  # shear and von Mises


def find_circle_maxima(stress: StressFields) -> tuple[Array, Array]:
    """Return the maxima of a solid circle: both on its edge, where tau = torsion + shear x u runs along it.

    Inside, tau = torsion (n x u) + q - (q.u) u (the textbooks' directions: at the ends of chords along the edge):
    linear along a chord normal to Q, as sigma is. So mises^2 is convex along it, and largest at an end.
    """
    return np.abs(stress.torsion) + stress.shear_magnitude, np.sqrt(find_max_on_edge(stress))


def find_tube_maxima(stress: StressFields) -> tuple[Array, Array]:
    """Return the maxima of a ring: on its edge, as for a thin one; inside thick walls shear does not reduce the
    torsion.

    Along a chord the shear by Jourawski is constant: convex again, and below shear * (cos of the place)^2.
    """
    unrelieved = (np.abs(stress.axial) + np.hypot(*stress.bend)) ** 2 + 3.0 * stress.torsion**2
    return np.abs(stress.torsion) + stress.shear_magnitude, np.sqrt(np.maximum(find_max_on_edge(stress), unrelieved))


def find_max_on_edge(stress: StressFields) -> Array:
    """Return the largest (axial + bend.u)^2 + 3 (torsion + (shear2, -shear1).u)^2 on the circle |u| = 1.

    u.H u + 2 g.u + c is nowhere above c + l + g.(l - H)^-1 g for any l above the eigenvalues of H. The smallest of
    these bounds is attained (a trust region's dual): |(l - H)^-1 g| = 1, by Newton's steps on its inverse, from below.
    """
    scale = np.abs(stress.axial) + np.abs(stress.torsion) + np.hypot(*stress.bend) + stress.shear_magnitude
    safe_scale = np.where(scale > 0.0, scale, 1.0)
    a, t, b1, b2, q1, q2 = (
        v / safe_scale
        for v in (
            stress.axial,
            math.sqrt(3.0) * stress.torsion,
            *stress.bend,
            *(math.sqrt(3.0) * q for q in stress.shear),
        )
    )
    difference, mixed = 0.5 * (b1 * b1 + q2 * q2 - b2 * b2 - q1 * q1), b1 * b2 - q1 * q2
    radius = np.hypot(difference, mixed)
    turn = 0.5 * np.arctan2(mixed, difference)
    x, y = a * b1 + t * q2, a * b2 - t * q1
    g1, g2 = np.abs(x * np.cos(turn) + y * np.sin(turn)), np.abs(y * np.cos(turn) - x * np.sin(turn))
    gap = 2.0 * radius
    # l = the larger eigenvalue + above
    excess = np.maximum(np.maximum(g1, g2 - gap), tolerances.EPS * tolerances.EPS)
    for _ in range(NEWTON_STEPS):
        u1, u2 = g1 / excess, g2 / (excess + gap)
        square = u1 * u1 + u2 * u2
        slope = u1 * u1 / excess + u2 * u2 / (excess + gap)
        is_below = np.sqrt(square) > 1.0
        excess = excess + np.where(is_below, square * (np.sqrt(square) - 1.0) / np.where(is_below, slope, 1.0), 0.0)
    largest = (
        0.5 * (b1 * b1 + b2 * b2 + q1 * q1 + q2 * q2) + radius + excess + g1 * g1 / excess + g2 * g2 / (excess + gap)
    )
    return np.asarray((largest + a * a + t * t) * scale * scale)


def bound_unknown_shape_maxima(stress: StressFields) -> tuple[Array, Array]:
    """Return bounds for a section of unknown shape: as if all largest stresses acted at one place."""
    shear = np.abs(stress.torsion) + stress.shear_magnitude
    return shear, np.sqrt(
        (np.abs(stress.axial) + np.abs(stress.bend[0]) + np.abs(stress.bend[1])) ** 2 + 3.0 * shear**2
    )


def make_rectangle_maxima(width: float, height: float) -> Largest:
    """Make the function of the maxima of a solid rectangle, width along e1: the largest of bounds over its cells.

    All stresses are linear in the loads, with factors that lie in an interval over a cell.
    """
    middle, half = find_rectangle_factors(width, height)

    def find_rectangle_maxima(fields: StressFields) -> tuple[Array, Array]:
        loads = np.stack(np.broadcast_arrays(fields.axial, *fields.bend, *fields.shear, fields.torsion)).reshape(6, -1)
        shear, mises = np.empty((2, loads.shape[1]))
        for first in range(0, loads.shape[1], CHUNK):
            part = loads[:, first : first + CHUNK]
            sigma, tau1, tau2 = (np.abs(middle @ part) + half @ np.abs(part)).reshape(3, -1, part.shape[1])
            square = tau1 * tau1 + tau2 * tau2
            shear[first : first + CHUNK] = np.sqrt(square.max(axis=0))
            mises[first : first + CHUNK] = np.sqrt((sigma * sigma + 3.0 * square).max(axis=0))
        return shear.reshape(np.shape(fields.axial)), mises.reshape(np.shape(fields.axial))

    return find_rectangle_maxima


@lru_cache(maxsize=32)
def find_rectangle_factors(width: float, height: float) -> tuple[Array, Array]:
    """Return midpoints and half widths of the intervals: rows sigma, tau1, tau2 of all cells, columns the loads of
    `StressFields`.
    """
    u = np.linspace(0.0, 1.0, CELLS + 1)
    parabola = 1.0 - u * u
    twist1, twist2 = compute_torsion_stresses(width, height, u)
    # both fall with one coordinate and grow with the other: phi_xy has one sign in a quadrant
    low1, high1, low2, high2 = twist1[1:, :-1], twist1[:-1, 1:], twist2[:-1, 1:], twist2[1:, :-1]
    i, j = np.meshgrid(np.arange(CELLS), np.arange(CELLS), indexing="ij")
    zero = np.zeros((CELLS, CELLS))
    zero_interval, one_interval = (zero, zero), (zero + 1.0, zero + 1.0)
    fall1, fall2 = (parabola[i], parabola[i + 1]), (parabola[j], parabola[j + 1])
    rows: list[list[list[tuple[Array, Array]]]] = [[], [], []]
    for s1, s2 in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        rise1, rise2 = (s1 * u[i], s1 * u[i + 1]), (s2 * u[j], s2 * u[j + 1])
        rows[0].append([one_interval, rise1, rise2, zero_interval, zero_interval, zero_interval])
        rows[1].append([zero_interval, zero_interval, zero_interval, fall1, zero_interval, (-s2 * low1, -s2 * high1)])
        rows[2].append([zero_interval, zero_interval, zero_interval, zero_interval, fall2, (s1 * low2, s1 * high2)])
    ends = np.array(rows).reshape(3, 4, 6, 2, -1).transpose(3, 0, 1, 4, 2).reshape(2, -1, 6)
    return 0.5 * (ends[0] + ends[1]), 0.5 * np.abs(ends[1] - ends[0])


def compute_torsion_stresses(width: float, height: float, u: Array) -> tuple[Array, Array]:
    """Return magnitudes of the torsional stresses along e1 and e2 at (u[i], u[j]), u in half sides, relative to the
    largest.

    Saint-Venant's series, Timoshenko, Goodier, Theory of Elasticity, section 109; the long side is its second.
    """
    if width > height:
        along2, along1 = compute_torsion_stresses(height, width, u)
        return along1.T, along2.T
    ratio = height / width
    n = np.arange(1, 2 * TERMS, 2)[:, None, None]
    x, y = 0.5 * math.pi * n * u[:, None], 0.5 * math.pi * n * ratio * u
    sign = np.where(n % 4 == 1, 1.0, -1.0) / n**2
    decay = np.exp(-math.pi * n * ratio)
    edge = np.exp(y - 0.5 * math.pi * n * ratio) / (1.0 + decay)
    cosh, sinh = edge * (1.0 + np.exp(-2.0 * y)), edge * (1.0 - np.exp(-2.0 * y))
    c = 8.0 / math.pi**2
    along1 = c * (sign * sinh * np.cos(x)).sum(axis=0)
    along2 = u[:, None] - c * (sign * cosh * np.sin(x)).sum(axis=0)
    along2[:, -1] = 0.0  # along the short side itself
    along1[-1], along1[:, 0], along2[0] = 0.0, 0.0, 0.0
    return np.maximum(along1, 0.0) / along2[-1, 0], np.maximum(along2, 0.0) / along2[-1, 0]


# Stress

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
    largest: Largest


def compute_circle_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a solid circle."""
    return compute_ring_moduli(v["radius"], 0.0, find_circle_maxima)


def compute_tube_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a circular ring."""
    return compute_ring_moduli(v["radius"], v["inner_radius"], find_tube_maxima)


def compute_ring_moduli(R: Number, r: Number, largest: Largest) -> SectionModuli:
    """Return the moduli of any ring, from a solid circle to a thin tube."""
    I = 0.25 * math.pi * (R**4 - r**4)
    shear = 4.0 / 3.0 * (R * R + R * r + r * r) / (R * R + r * r)
    return SectionModuli(math.pi * (R * R - r * r), I, I, R, R, 2.0 * I / R, shear, True, largest)


def compute_rectangle_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli of a solid rectangle, width along e1, height along e2; W_T by Saint-Venant's series."""
    b, h = float(v["width"]), float(v["height"])
    I1, I2, W_T = b * h**3 / 12.0, h * b**3 / 12.0, compute_torsion_modulus(b, h)
    return SectionModuli(b * h, I1, I2, 0.5 * b, 0.5 * h, W_T, 1.5, False, make_rectangle_maxima(b, h))


ODD = range(1, 40, 2)
# sum of 1/n^5 over odd n, 31/32 zeta(5): the rest of the series converges exponentially
ODD_FIFTH_POWERS = 1.0045237627951382


def compute_torsion_modulus(b: float, h: float) -> float:
    """Return T over the largest torsional shear stress of a rectangle.

    Timoshenko, Goodier, Theory of Elasticity, section 109.
    """
    a, c = min(b, h), max(b, h)
    slope = 1.0 - 8.0 / math.pi**2 * sum(1.0 / (n * n * math.cosh(min(0.5 * n * math.pi * c / a, 700.0))) for n in ODD)
    return compute_torsion_constant(b, h) / (a * slope)


def compute_torsion_constant(b: float, h: float) -> float:
    """Return J of a rectangle: T over modulus of rigidity and twist."""
    a, c = min(b, h), max(b, h)
    tanh = ODD_FIFTH_POWERS - sum((1.0 - math.tanh(0.5 * n * math.pi * c / a)) / n**5 for n in ODD)
    return a**3 * c / 3.0 * (1.0 - 192.0 * a / (math.pi**5 * c) * tanh)


def compute_general_moduli(v: Sizes) -> SectionModuli:
    """Return the moduli from given properties; the torsional stress is that of the thickest shape that fits.

    A convex section's is at most 2 rho T/J, rho the radius of the largest circle in it (Payne's bound of the stress
    function's slope), which is at most min(c1, c2); an open profile's is t T/J with walls of t < 2 min(c1, c2).
    """
    c1, c2, shear = v["c1"], v["c2"], v.get("shear_factor", UNKNOWN_SHEAR)
    reach = np.maximum(np.maximum(c1, c2), 2.0 * np.minimum(c1, c2))
    return SectionModuli(v["area"], v["I1"], v["I2"], c1, c2, v["J"] / reach, shear, False, bound_unknown_shape_maxima)


MODULI: dict[str, Callable[[Sizes], SectionModuli]] = {
    "circle": compute_circle_moduli, "tube": compute_tube_moduli,
    "rectangle": compute_rectangle_moduli, "general": compute_general_moduli,
}  # fmt: skip


def compute_stresses(moduli: SectionModuli, loads: Mapping[str, Array], strength: float | None) -> Block:
    """Return extreme normal stresses, largest and mean shear, von Mises and utilisation, [Pa], shapes as the loads'.

    loads: N, Q1, Q2, T, M1, M2 about the centroid
    """
    m = moduli
    stress_fields = StressFields(
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
