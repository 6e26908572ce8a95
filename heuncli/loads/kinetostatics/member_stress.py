"""Compute the stresses in a cross-section of a member, I, C, L, T or box, from its loads about the centroid.

    sigma = N/A + a u + b v,   [int u^2, int u v; int u v, int v^2] (a, b) = (-M2, M1)
exact by beam theory also where e1 and e2 are not principal axes; u, v from the centroid along e1, e2. Shear by the flow
along thin walls (scene/shapes/member_section.py), q.Q/t; torsion by the moment about the shear centre (u_s, v_s),

    T_s = T - (u_s Q2 - v_s Q1),   in a wall T_s t/J of either sign at its two faces; in a box T_s by Bredt and its wall
All are linear in N, a, b, Q1, Q2, T_s, with factors that lie in an interval over a part of a wall: the largest stresses
are bounds over these parts. The normal stress is also taken at the named corners of the outline, unrounded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.profiles import FAMILIES, Family, Measures
from heuncli.scene.shapes.member_section import MemberSection, make_member_section

PARTS = 8  # of a wall: a shear stress is then above its true maximum by at most 2 %
Frame = tuple[float, float, float, float]  # rows e1, e2; columns width and height of the member
UPRIGHT: Frame = (1.0, 0.0, 0.0, 1.0)


@record
class MemberFactors:
    """What the stresses of a member are, per load.

    area [m2], inverse (2, 2): of the second moments about e1, e2 [1/m4]
    shear_center (2,): from the centroid along e1, e2 [m]
    corners (n, 2): of the outline, from the centroid along e1, e2 [m]
    middle, half (2, m, 6): of the intervals of the factors of normal and shear stress in each part of a wall, for N, a,
    b, Q1, Q2, T_s
    torsion: largest torsional stress over T_s [1/m3]
    """

    area: float
    inverse: Array
    shear_center: Array
    corners: Array
    middle: Array
    half: Array
    torsion: float


@lru_cache(maxsize=4096)
def make_factors(family: Family, measures: Measures, frame: Frame = UPRIGHT) -> MemberFactors:
    """Make the factors of a member whose width and height have these components along e1 and e2."""
    section = make_member_section(family, measures)
    turn = np.array(frame).reshape(2, 2)
    second = turn @ np.array([[section.Iuu, section.Iuv], [section.Iuv, section.Ivv]]) @ turn.T
    low, high = np.array([*_iter_parts(section, turn)]).transpose(1, 2, 0, 3)
    return MemberFactors(
        section.area, np.linalg.inv(second), turn @ section.shear_center,
        np.array([point.place for point in section.points]) @ turn.T, 0.5 * (low + high), 0.5 * (high - low),
        float(section.torsion_stress.max()),
    )  # fmt: skip


def _iter_parts(section: MemberSection, turn: Array) -> Iterator[Array]:
    """Yield the least and the largest factors of normal and shear stress in each part of a wall, (2, 2, 6)."""
    x = np.linspace(0.0, 1.0, PARTS + 1)
    sense = float(np.sign(np.linalg.det(turn)))
    for i, wall in enumerate(section.walls):
        first = section.nodes[wall.start]
        step = section.nodes[wall.end] - first
        across = np.array([-step[1], step[0]]) / math.hypot(*step)
        t = wall.start_thickness + (wall.end_thickness - wall.start_thickness) * x
        middle = first + x[:, None] * step
        faces = np.stack([middle - 0.5 * t[:, None] * across, middle + 0.5 * t[:, None] * across]) @ turn.T
        flow = section.flows[i] @ turn.T
        largest = float(section.torsion_stress[i])
        # a box has two unlike faces; the faces of an open wall have opposite stresses
        twists = [(-largest, -largest), (largest, largest)]
        if section.is_closed:
            twists = [tuple(sorted((sense * (largest - 2.0 * t[0] / section.J), sense * largest)))]  # type: ignore[list-item]
        for k in range(PARTS):
            corners = faces[:, k : k + 2].reshape(-1, 2)
            flow_range = np.array([_find_range(flow[:, j], x[k], x[k + 1]) for j in (0, 1)]).T
            shears = flow_range / np.array([t[k], t[k + 1]])[:, None, None]
            for twist in twists:
                rows = np.zeros((2, 2, 6))
                rows[:, 0, 0] = 1.0 / section.area
                rows[0, 0, 1:3], rows[1, 0, 1:3] = corners.min(axis=0), corners.max(axis=0)
                rows[0, 1, 3:5], rows[1, 1, 3:5] = shears.min(axis=(0, 1)), shears.max(axis=(0, 1))
                rows[:, 1, 5] = twist
                yield rows


def _find_range(c: Array, a: float, b: float) -> tuple[float, float]:
    """Return the least and the largest value of the cubic sum c[i] x^i between a and b."""
    x = [a, b]
    quadratic, linear, constant = 3.0 * float(c[3]), 2.0 * float(c[2]), float(c[1])
    root = linear * linear - 4.0 * quadratic * constant
    if root >= 0.0:
        half = -0.5 * (linear + math.copysign(math.sqrt(root), linear))
        turning = [half / quadratic] if quadratic != 0.0 else []
        turning += [constant / half] if half != 0.0 else []
        x += [place for place in turning if a < place < b]
    values = [float(c[0] + place * (c[1] + place * (c[2] + place * c[3]))) for place in x]
    return min(values), max(values)


def compute_member_stresses(factors: MemberFactors, loads: Mapping[str, Array], strength: float | None) -> Block:
    """Return the stresses of `stress.compute_stresses` for a member, [Pa]; loads about the centroid, of one shape."""
    names = ("N", "Q1", "Q2", "T", "M1", "M2")
    N, Q1, Q2, T, M1, M2 = np.broadcast_arrays(*(np.asarray(loads[name], dtype=np.float64) for name in names))
    a, b = np.tensordot(factors.inverse, np.stack([-M2, M1]), axes=1)
    T_s = T - (factors.shear_center[0] * Q2 - factors.shear_center[1] * Q1)
    rows = np.stack([N, a, b, Q1, Q2, T_s]).reshape(6, -1)
    sigma, tau = (
        np.abs(middle @ rows) + half @ np.abs(rows)
        for middle, half in zip(factors.middle, factors.half, strict=True)
    )
    at_corners = (rows[0] / factors.area + factors.corners @ rows[1:3]).reshape(-1, *np.shape(N))
    normal_max, normal_min = at_corners.max(axis=0), at_corners.min(axis=0)
    mises = np.sqrt((sigma * sigma + 3.0 * tau * tau).max(axis=0)).reshape(np.shape(N))
    mises = np.maximum(mises, np.maximum(np.abs(normal_max), np.abs(normal_min)))
    block: Block = {
        "normal_max": normal_max, "normal_min": normal_min, "shear_torsion": np.abs(T_s) * factors.torsion,
        "shear_mean": np.hypot(Q1, Q2) / factors.area, "shear_max": tau.max(axis=0).reshape(np.shape(N)),
        "mises": mises,
    }  # fmt: skip
    if strength is not None:
        block["utilisation"] = mises / strength
    return block


def find_given_factors(family: str, values: Mapping[str, float]) -> MemberFactors:
    """Find the factors of a member whose measures are given as properties, width along e1, height along e2."""
    kind = next(known for known in FAMILIES if known == family)
    return make_factors(kind, Measures(**values))
