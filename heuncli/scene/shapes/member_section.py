"""Properties of a member's cross-section: area, moments, shear centre, torsion constant, walls, stress points.

Area, centroid and second moments are exact for the outline with its fillets (member_outline.py). The rest is the theory
of thin walls: straight ones along the middle lines, without fillets, of a thickness t that is linear along them. In a
wall with s along it, from the end that the flow q of a shear force Q comes from,

    q(s) = q0 - int g.p t ds,   g = I^-1 Q,   p from the centroid,   I the second moments (2, 2) of the middle lines
q of the walls that end at a node goes into the one that begins there; in a box a constant makes int q/t ds = 0. The
shear centre is where Q has the moment of q.

The torsion constant of I and T is that of EN 10365's tables, by Trayer and March (1930): strips, and circles of
diameter D in the junctions of web and flanges,

    J = 2/3 (b - 0.63 f) f^3 + (h - 2 f) t^3/3 + 2 (t/f) (0.145 + 0.1 r/f) D^4,
    D = ((r + t/2)^2 + (r + f)^2 - r^2)/(2 r + f)
with f/t in place of t/f where the web is the thicker one, for which it was not made; of L and C that of El Darwish and
Johnston (1965), with D of the circle in the corner and

    alpha = -0.0908 + 0.2621 w + 0.1231 q - 0.0752 w q - 0.0945 w^2,   w = t/f, q = r/f
and of a box that of EN 10210-2: J = t^3 h/3 + 4 A_h^2 t/h, with the middle line's length h and the area A_h in it. All
of them are within 6 % of the solution of Saint-Venant's equation (tests/closed_forms/test_member_torsion.py).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.file_format.profiles import Family, Measures
from heuncli.scene.shapes.member_outline import make_outline


class Wall(NamedTuple):
    """A straight wall: numbers of its nodes, from the one that the flow comes from, and its thicknesses there [m]."""

    start: int
    end: int
    start_thickness: float
    end_thickness: float


class StressPoint(NamedTuple):
    """A corner of the outline, unrounded, by its name: (u, v) from the centroid [m]."""

    name: str
    place: tuple[float, float]


@record
class MemberSection:
    """The properties of a member's cross-section; u to the right, v up, from the centroid.

    area [m2], Iuu = int u^2, Iuv = int u v, Ivv = int v^2 [m4]: exact for the outline
    centroid (2,): from the outline's own origin [m]
    J: torsion constant [m4]
    shear_center (2,): from the centroid [m]
    nodes (n, 2), walls: middle lines, from the centroid
    wall_moments (2, 2): second moments of the middle lines about their own centroid
    flows (m, 4, 2): of each wall, q = sum flows[i] x^i for unit shear forces along u and v, x from 0 to 1 [1/m]
    torsion_stress (m,): largest stress in each wall over the torque [1/m3]
    is_closed: whether the torsional stress has one sign across a wall
    points: where normal stresses are extreme
    web (2,), web_flow (2,): the middle of the web, and the shear stress there of unit forces along u and v [1/m2]
    """

    area: float
    Iuu: float
    Iuv: float
    Ivv: float
    centroid: Array
    J: float
    shear_center: Array
    nodes: Array
    walls: tuple[Wall, ...]
    wall_moments: Array
    flows: Array
    torsion_stress: Array
    is_closed: bool
    points: tuple[StressPoint, ...]
    web: Array
    web_flow: Array

    @property
    def principal(self) -> tuple[float, float, float]:
        """The larger and the smaller principal moment [m4], and the angle from u to the axis of the larger [rad]."""
        mean, half = 0.5 * (self.Ivv + self.Iuu), 0.5 * (self.Ivv - self.Iuu)
        radius = math.hypot(half, self.Iuv)
        return mean + radius, mean - radius, 0.5 * math.atan2(-self.Iuv, half)

    @property
    def moduli(self) -> tuple[float, float]:
        """Section moduli for bending about u and about v: moment over the largest distance [m3]."""
        u, v = np.abs(np.array([point.place for point in self.points])).max(axis=0).tolist()
        return self.Ivv / v, self.Iuu / u


@lru_cache(maxsize=4096)
def make_member_section(family: Family, m: Measures) -> MemberSection:
    """Make the properties of a member's cross-section."""
    outline = make_outline(family, m)
    moments = sum((part.compute_moments() for part in outline), np.zeros(6))
    area, centroid = float(moments[0]), moments[1:3] / moments[0]
    second = moments[3:] - area * np.array([centroid[0] ** 2, centroid[0] * centroid[1], centroid[1] ** 2])
    Iuu, Iuv, Ivv = second.tolist()
    nodes, walls = _make_walls(family, m)
    nodes = nodes - centroid
    wall_moments, flows, shear_center = _find_shear_flow(nodes, walls, family == "box")
    thickness = np.array([max(wall.start_thickness, wall.end_thickness) for wall in walls])
    if family == "box":
        J, torsion_stress = _find_box_torsion(m)
        stresses = np.full(4, torsion_stress)
    else:
        J = TORSION_CONSTANTS[family](m)
        stresses = thickness / J
    web = walls[1] if family in ("C", "L", "box") else walls[2]
    web_flow = 0.5 ** np.arange(4) @ flows[walls.index(web)] / web.start_thickness
    return MemberSection(
        area=area, Iuu=Iuu, Iuv=Iuv, Ivv=Ivv, centroid=centroid, J=J, shear_center=shear_center, nodes=nodes,
        walls=walls, wall_moments=wall_moments, flows=flows, torsion_stress=stresses, is_closed=family == "box",
        points=tuple(
            StressPoint(name, (u - float(centroid[0]), v - float(centroid[1])))
            for name, (u, v) in _name_points(family, m).items()
        ),
        web=0.5 * (nodes[web.start] + nodes[web.end]), web_flow=web_flow,
    )  # fmt: skip


def _name_points(family: Family, m: Measures) -> Mapping[str, tuple[float, float]]:
    """Name the corners of the outline's hull."""
    b, h, t, f = m.width, m.height, m.web, m.flange
    if family == "L":
        return {
            "heel": (0.0, 0.0), "right_tip": (b, 0.0), "right_tip_inside": (b, f), "top_tip_inside": (t, h),
            "top_tip": (0.0, h),
        }  # fmt: skip
    left = 0.0 if family == "C" else -0.5 * b
    bottom = -0.5 * h if family == "box" else 0.0
    top_points = {"top_right": (left + b, bottom + h), "top_left": (left, bottom + h)}
    if family == "T":
        tips = {"right_tip": (0.5 * b, h - f), "left_tip": (-0.5 * b, h - f)}
        return {"bottom_left": (-0.5 * t, 0.0), "bottom_right": (0.5 * t, 0.0)} | top_points | tips
    return {"bottom_left": (left, bottom), "bottom_right": (left + b, bottom)} | top_points


# Walls and shear


def _make_walls(family: Family, m: Measures) -> tuple[Array, tuple[Wall, ...]]:
    """Make the middle lines: nodes (n, 2) in the outline's coordinates, and walls, each after those that end where it
    starts.
    """
    b, h, t, f = m.width, m.height, m.web, m.flange
    low, high = 0.5 * f, h - 0.5 * f
    rows: list[tuple[float, float]]
    if family == "L":
        rows, ends = [(b, low), (0.5 * t, low), (0.5 * t, h)], [(0, 1, f), (1, 2, t)]
    elif family == "C":
        tip, root = f - 0.5 * m.slope * b, f + 0.5 * m.slope * (b - t)
        rows = [(b, 0.5 * tip), (0.5 * t, 0.5 * root), (0.5 * t, h - 0.5 * root), (b, h - 0.5 * tip)]
        return np.array(rows), (Wall(0, 1, tip, root), Wall(1, 2, t, t), Wall(2, 3, root, tip))
    elif family == "T":
        rows = [(-0.5 * b, high), (0.5 * b, high), (0.0, high), (0.0, 0.0)]
        ends = [(0, 2, f), (1, 2, f), (2, 3, t)]
    elif family == "I":
        rows = [(-0.5 * b, low), (0.5 * b, low), (0.0, low), (0.0, high), (-0.5 * b, high), (0.5 * b, high)]
        ends = [(0, 2, f), (1, 2, f), (2, 3, t), (4, 3, f), (5, 3, f)]
    else:
        u, v = 0.5 * (b - t), 0.5 * (h - f)
        rows = [(-u, -v), (u, -v), (u, v), (-u, v)]
        ends = [(0, 1, f), (1, 2, t), (2, 3, f), (3, 0, t)]
    return np.array(rows), tuple(Wall(start, end, wall, wall) for start, end, wall in ends)


def _find_shear_flow(nodes: Array, walls: tuple[Wall, ...], is_closed: bool) -> tuple[Array, Array, Array]:
    """Find the second moments of the middle lines, the shear flow of unit forces along u and v, and the shear
    centre.
    """
    start = np.array([nodes[wall.start] for wall in walls])
    step = np.array([nodes[wall.end] for wall in walls]) - start
    length = np.hypot(*step.T)
    t = np.array([wall.start_thickness for wall in walls])
    rise = np.array([wall.end_thickness for wall in walls]) - t
    # integrals of t, t x, t x^2 over the walls, x from 0 to 1
    one, first, second = (length * (t / n + rise / (n + 1)) for n in (1, 2, 3))
    center = (one @ start + first @ step) / one.sum()
    start = start - center
    mixed = np.einsum("w,wi,wj->ij", first, start, step)
    I = np.einsum("w,wi,wj->ij", one, start, start) + mixed + mixed.T + np.einsum("w,wi,wj->ij", second, step, step)
    linear, square, cube = (
        -length[:, None] * terms @ np.linalg.inv(I)
        for terms in (t[:, None] * start, 0.5 * (rise[:, None] * start + t[:, None] * step), rise[:, None] * step / 3.0)
    )
    offset, inflow = np.zeros_like(linear), np.zeros((len(nodes), 2))
    for i, wall in enumerate(walls):
        offset[i] = inflow[wall.start]
        inflow[wall.end] += offset[i] + linear[i] + square[i] + cube[i]
    flows = np.stack([offset, linear, square, cube], axis=1)
    powers = 1.0 / np.arange(1, 5)
    if is_closed:
        flows[:, 0] -= ((length / t) @ (powers @ flows)) / (length / t).sum()
    lever = start[:, 0] * step[:, 1] - start[:, 1] * step[:, 0]
    moment = lever @ (powers @ flows)
    shear_center = np.array([moment[1], -moment[0]]) + center
    return I, flows, np.where(np.abs(shear_center) > tolerances.IN_PLANE * length.max(), shear_center, 0.0)


# Torsion


def _find_i_torsion(m: Measures) -> float:
    return _t_part(m) * 2.0 + (m.height - 2.0 * m.flange) * m.web**3 / 3.0


def _find_t_torsion(m: Measures) -> float:
    return _t_part(m) + (m.height - m.flange - 0.315 * m.web) * m.web**3 / 3.0


def _t_part(m: Measures) -> float:
    """Return the torsion constant of a flange and its junction with a web in its middle."""
    t, f, r = m.web, m.flange, m.radius
    D = ((r + 0.5 * t) ** 2 + (r + f) ** 2 - r * r) / (2.0 * r + f)
    return (m.width - 0.63 * f) * f**3 / 3.0 + min(t / f, f / t) * (0.145 + 0.1 * r / f) * D**4


def _find_c_torsion(m: Measures) -> float:
    t, f, r = m.web, m.flange, m.radius
    w, q = t / f, r / f
    alpha = -0.0908 + 0.2621 * w + 0.1231 * q - 0.0752 * w * q - 0.0945 * w * w
    D = 2.0 * ((3.0 * r + t + f) - math.sqrt(2.0 * (2.0 * r + t) * (2.0 * r + f)))
    return 2.0 * m.width * f**3 / 3.0 + (m.height - 2.0 * f) * t**3 / 3.0 + 2.0 * alpha * D**4 - 0.42 * f**4


def _find_l_torsion(m: Measures) -> float:
    thick, thin = max(m.web, m.flange), min(m.web, m.flange)
    long, short = (m.width, m.height) if m.flange >= m.web else (m.height, m.width)
    r = m.radius
    w, q = thin / thick, r / thick
    alpha = -0.0908 + 0.2621 * w + 0.1231 * q - 0.0752 * w * q - 0.0945 * w * w
    D = 2.0 * ((3.0 * r + thin + thick) - math.sqrt(2.0 * (2.0 * r + thin) * (2.0 * r + thick)))
    strips = long * thick**3 / 3.0 + (short - thick) * thin**3 / 3.0
    return strips + alpha * D**4 - 0.105 * (thick**4 + thin**4)


TORSION_CONSTANTS = {"I": _find_i_torsion, "T": _find_t_torsion, "C": _find_c_torsion, "L": _find_l_torsion}


def _find_box_torsion(m: Measures) -> tuple[float, float]:
    """Return the torsion constant of a box of one wall thickness, and its largest stress over the torque."""
    t, corner = m.web, 0.5 * (m.radius + m.toe_radius)
    h = 2.0 * (m.width + m.height - 2.0 * t) - 2.0 * corner * (4.0 - math.pi)
    enclosed = (m.width - t) * (m.height - t) - corner**2 * (4.0 - math.pi)
    K = 2.0 * enclosed * t / h
    J = t**3 * h / 3.0 + 2.0 * K * enclosed
    return J, (t + K / t) / J
