"""Compute the stresses in a cross-section of a member, I, C, L, T or box, from its loads about the centroid.

    sigma = N/A + a u + b v,   [int u^2, int u v; int u v, int v^2] (a, b) = (-M2, M1)

sigma is the normal stress; u and v are the distances from the centroid along the member's own width and height, also
where these are not principal axes. Shear by the flow q along thin walls (scene/shapes/member_section.py), q.Q/t.
Torsion by the moment about the shear centre (u_s, v_s),

    T_s = T - (u_s Q2 - v_s Q1),   in an open wall T_s t/J of opposite signs at its two faces; in a box by Bredt

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

PARTS = 8  # intervals into which a wall is divided
Frame = tuple[float, float, float, float]  # rows e1, e2; columns width and height of the member
UPRIGHT: Frame = (1.0, 0.0, 0.0, 1.0)


@record
class MemberFactors:
    """The stresses of a member per load, along its width and height.

    inverse (2, 2): of its second moments [1/m4]
    corners (n, 2): of the outline, from the centroid [m]
    middle, half (2, m, 6): of the intervals of the factors of normal and shear stress in each part of a wall, for N, a,
    b, Q1, Q2, T_s
    torsion: largest torsional stress over T_s [1/m3]
    """

    section: MemberSection
    inverse: Array
    corners: Array
    middle: Array
    half: Array
    torsion: float


@lru_cache(maxsize=4096)
def make_factors(family: Family, measures: Measures) -> MemberFactors:
    """Make the factors of a member."""
    section = make_member_section(family, measures)
    second = np.array([[section.Iuu, section.Iuv], [section.Iuv, section.Ivv]])
    low, high = np.array([*_iter_parts(section)]).transpose(1, 2, 0, 3)
    corners = np.array([point.place for point in section.points])
    torsion = float(section.torsion_stress.max())
    return MemberFactors(section, np.linalg.inv(second), corners, 0.5 * (low + high), 0.5 * (high - low), torsion)


def _iter_parts(section: MemberSection) -> Iterator[Array]:
    """Yield the least and the largest factors of normal and shear stress in each part of a wall, (2, 2, 6)."""
    x = np.linspace(0.0, 1.0, PARTS + 1)
    for wall, flow, largest in zip(section.walls, section.flows, section.torsion_stress.tolist(), strict=True):
        first = section.nodes[wall.start]
        step = section.nodes[wall.end] - first
        across = np.array([-step[1], step[0]]) / math.hypot(*step)
        t = wall.start_thickness + (wall.end_thickness - wall.start_thickness) * x
        middle = first + x[:, None] * step
        faces = np.stack([middle - 0.5 * t[:, None] * across, middle + 0.5 * t[:, None] * across])
        twists = [(-largest, -largest), (largest, largest)]
        if section.is_closed:  # its walls go round to the left; outside is more than inside
            twists = [(largest - 2.0 * float(t[0]) / section.J, largest)]
        for k in range(PARTS):
            corners = faces[:, k : k + 2].reshape(-1, 2)
            flow_range = np.array([_find_range(flow[:, j], x[k], x[k + 1]) for j in (0, 1)]).T
            shears = flow_range / np.array([t[k], t[k + 1]])[:, None, None]
            rows = np.zeros((2, 2, 6))
            rows[:, 0, 0] = 1.0 / section.area
            rows[0, 0, 1:3], rows[1, 0, 1:3] = corners.min(axis=0), corners.max(axis=0)
            rows[0, 1, 3:5], rows[1, 1, 3:5] = shears.min(axis=(0, 1)), shears.max(axis=(0, 1))
            for twist in twists:
                rows[:, 1, 5] = twist
                yield rows.copy()


def _find_range(c: Array, a: float, b: float) -> tuple[float, float]:
    """Return the least and the largest value of the cubic sum c[i] x^i between a and b."""
    c0, c1, c2, c3 = c.tolist()
    places = [a, b]
    root = c2 * c2 - 3.0 * c3 * c1  # where c1 + 2 c2 x + 3 c3 x^2 = 0
    if root >= 0.0:
        half = -(c2 + math.copysign(math.sqrt(root), c2))
        turning = [half / (3.0 * c3)] if c3 != 0.0 else []
        turning += [c1 / half] if half != 0.0 else []
        places += [place for place in turning if a < place < b]
    values = [c0 + x * (c1 + x * (c2 + x * c3)) for x in places]
    return min(values), max(values)


def compute_member_stresses(
    factors: MemberFactors, loads: Mapping[str, Array], strength: float | None, frame: Frame = UPRIGHT
) -> Block:
    """Return the stresses of a member, [Pa], as `stress.compute_stresses` does.

    loads: about the centroid, along e1 and e2, of one shape
    frame: the member's width and height in these axes
    """
    turn = np.array(frame).reshape(2, 2)
    names = ("N", "Q1", "Q2", "T", "M1", "M2")
    N, Q1, Q2, T, M1, M2 = np.broadcast_arrays(*(np.asarray(loads[name], dtype=np.float64) for name in names))
    shape, section = np.shape(N), factors.section
    Q = np.tensordot(turn.T, np.stack([Q1, Q2]), axes=1)
    bend = np.tensordot(factors.inverse @ turn.T, np.stack([-M2, M1]), axes=1)
    u_s, v_s = section.shear_center.tolist()
    T_s = float(np.sign(np.linalg.det(turn))) * T - (u_s * Q[1] - v_s * Q[0])
    rows = np.stack([N, *bend, *Q, T_s]).reshape(6, -1)
    sigma, tau = (
        np.abs(middle @ rows) + half @ np.abs(rows) for middle, half in zip(factors.middle, factors.half, strict=True)
    )
    at_corners = (rows[0] / section.area + factors.corners @ rows[1:3]).reshape(-1, *shape)
    normal_max, normal_min = at_corners.max(axis=0), at_corners.min(axis=0)
    mises = np.sqrt((sigma * sigma + 3.0 * tau * tau).max(axis=0)).reshape(shape)
    mises = np.maximum(mises, np.maximum(np.abs(normal_max), np.abs(normal_min)))
    block: Block = {
        "normal_max": normal_max, "normal_min": normal_min, "shear_torsion": np.abs(T_s) * factors.torsion,
        "shear_mean": np.hypot(Q1, Q2) / section.area, "shear_max": tau.max(axis=0).reshape(shape), "mises": mises,
    }  # fmt: skip
    points = {point.name: {"normal": normal} for point, normal in zip(section.points, at_corners, strict=True)}
    web_normal = (rows[0] / section.area + section.web @ rows[1:3]).reshape(shape)
    block["points"] = points | {"web": {"normal": web_normal, "shear": (section.web_flow @ rows[3:5]).reshape(shape)}}
    if strength is not None:
        block["utilisation"] = mises / strength
    return block


def find_given_factors(family: str, values: Mapping[str, float]) -> MemberFactors:
    """Find the factors of a member whose measures are given as properties, width along e1, height along e2."""
    kind = next(known for known in FAMILIES if known == family)
    return make_factors(kind, Measures(**values))
