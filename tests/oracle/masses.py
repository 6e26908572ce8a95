"""Mass, centre and inertia of shapes and of shapes cut by a plane, from clouds of mass points.

Every solid becomes quadrature points x with masses w that give Σw, Σw x and Σw x xᵀ to rounding: rods by two Gauss
points, boxes by tetrahedra from their convex hull, round solids by discs across their axis, each disc by chords.
A plane keeps what lies where (x - at)·n > 0. No closed formula of the program under test is used.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from tests.oracle.turns import Array, across, attitude, unit

gauss = cache(np.polynomial.legendre.leggauss)  # nodes and weights on [-1, 1]
Cloud = tuple[Array, Array]  # points (k, 3) and their masses (k,); a hollow has negative ones
IN_PLANE = 1e-12  # relative distance at which a mass point counts as lying in the plane


class Mass(NamedTuple):
    """Mass [kg], centre [m] and inertia about the centre [kg m2], body axes."""

    mass: float
    center: Array
    inertia: Array


class Plane(NamedTuple):
    """A cut: the piece is where (x - at)·normal > 0; `side` tells where a mass point in the plane goes."""

    at: Array
    normal: Array
    side: str | None = None

    def beyond(self, x: Array, size: float = 1.0) -> bool:
        """Whether a point belongs to the piece; one in the plane does if the cut is taken just before it."""
        height = float((x - self.at) @ self.normal)
        if abs(height) > IN_PLANE * size:
            return height > 0.0
        if self.side is None:
            raise ValueError(f"{x} lies in the plane: side: before or beyond")
        return self.side == "before"


def mass_of(body: Mapping[str, Any]) -> Mass:
    """Mass properties of a body's entry, by `shapes` or as given."""
    if "shapes" in body:
        return gathered([cloud(shape) for shape in body["shapes"]])
    inertia = np.array(body["inertia"], dtype=float)
    inertia = np.diag(inertia) if inertia.ndim == 1 else inertia.copy()
    if "deviation" in body:  # D1 = Σ m a2 a3 and so on; tensor element = -D
        for k, D in enumerate(body["deviation"]):
            i, j = (k + 1) % 3, (k + 2) % 3
            inertia[i, j] = inertia[j, i] = -D
    return Mass(float(body["mass"]), np.array(body.get("center", [0, 0, 0]), dtype=float), inertia)


def cut(body: Mapping[str, Any], plane: Plane) -> tuple[Mass, Mass]:
    """(remainder, piece) of a body given by shapes, each cut on its own."""
    other = Plane(plane.at, -plane.normal, {"before": "beyond", "beyond": "before", None: None}[plane.side])
    remainder, piece = (gathered([cloud(shape, p) for shape in body["shapes"]]) for p in (other, plane))
    return remainder, piece


def without(whole: Mass, piece: Mass) -> Mass:
    """What is left of a body when a piece of known mass properties is taken away."""
    m = whole.mass - piece.mass
    center = (whole.mass * whole.center - piece.mass * piece.center) / m
    inertia = moved(whole, center) - moved(piece, center)
    return Mass(m, center, inertia)


def moved(mass: Mass, point: Array) -> Array:
    """Inertia about another point of the body, (3, 3)."""
    d = mass.center - point
    return mass.inertia + mass.mass * (float(d @ d) * np.eye(3) - np.outer(d, d))


def gathered(clouds: Sequence[Cloud]) -> Mass:
    """Mass properties of clouds taken together; an empty piece sits at the origin with no mass."""
    X, w = np.concatenate([c[0] for c in clouds]), np.concatenate([c[1] for c in clouds])
    mass = float(w.sum())
    if mass == 0.0:
        return Mass(0.0, np.zeros(3), np.zeros((3, 3)))
    center = w @ X / mass
    A = X - center
    T = (A * w[:, None]).T @ A
    return Mass(mass, center, np.trace(T) * np.eye(3) - T)


def cloud(shape: Mapping[str, Any], plane: Plane | None = None) -> Cloud:
    """Mass points of a shape, or of its part beyond a plane."""
    kind = shape["type"]
    if kind == "point":
        at = np.array(shape["at"], dtype=float)
        stays = plane is None or plane.beyond(at, 1.0 + float(np.abs(at).max()))
        return at[None, :], np.array([float(shape["mass"]) if stays else 0.0])
    volume = VOLUMES[kind]
    X, w = volume(shape, plane)
    if "mass" in shape:
        return X, w * (float(shape["mass"]) / float(volume(shape, None)[1].sum()))
    return X, w * float(shape["line_density" if kind == "rod" else "density"])


def rod(shape: Mapping[str, Any], plane: Plane | None) -> Cloud:
    """A line; its weights are lengths."""
    a, b = (np.array(shape[k], dtype=float) for k in ("from", "to"))
    lo, hi = 0.0, 1.0
    if plane is not None:
        start, rise = float((a - plane.at) @ plane.normal), float((b - a) @ plane.normal)
        if rise == 0.0:
            hi = hi if start > 0.0 else lo
        else:
            crossing = min(1.0, max(0.0, -start / rise))
            lo, hi = (crossing, hi) if rise > 0.0 else (lo, crossing)
    node, weight = gauss(2)
    s = lo + (hi - lo) * (1.0 + node) / 2
    return a + s[:, None] * (b - a), weight / 2 * (hi - lo) * float(np.linalg.norm(b - a))


def box(shape: Mapping[str, Any], plane: Plane | None) -> Cloud:
    """Corners and cut edges -> convex hull -> tetrahedra from its middle -> four points each (exact to degree 2)."""
    R, center = attitude(shape.get("orientation")), np.array(shape["center"], dtype=float)
    signs = list(itertools.product((-0.5, 0.5), repeat=3))
    corners = {s: center + R @ (np.array(s) * np.array(shape["size"], dtype=float)) for s in signs}
    kept = list(corners.values())
    if plane is not None:
        height = {s: float((x - plane.at) @ plane.normal) for s, x in corners.items()}
        kept = [x for s, x in corners.items() if height[s] >= 0.0]
        for s, r in itertools.combinations(signs, 2):
            if sum(i != j for i, j in zip(s, r, strict=True)) == 1 and height[s] * height[r] < 0.0:
                kept.append(corners[s] + (corners[r] - corners[s]) * (height[s] / (height[s] - height[r])))
        if not any(h > IN_PLANE for h in height.values()):
            return np.zeros((1, 3)), np.zeros(1)
    V = np.array(kept)
    middle = V.mean(axis=0)
    faces = V[ConvexHull(V).simplices]
    tetrahedra = np.concatenate([np.broadcast_to(middle, (len(faces), 1, 3)), faces], axis=1)
    volume = np.abs(np.linalg.det(tetrahedra[:, 1:] - tetrahedra[:, :1])) / 6
    near, far = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20  # Hammer-Marlowe-Stroud rule, degree 2
    share = np.full((4, 4), far) + (near - far) * np.eye(4)
    return np.einsum("qc,fcx->fqx", share, tetrahedra).reshape(-1, 3), np.repeat(volume / 4, 4)


def sphere(shape: Mapping[str, Any], plane: Plane | None) -> Cloud:
    """Discs across the cut's normal, so that every cut is square."""
    center, radius = np.array(shape["center"], dtype=float), float(shape["radius"])
    axis = np.array([0.0, 0.0, 1.0]) if plane is None else plane.normal
    low = -radius if plane is None else min(radius, max(-radius, float((plane.at - center) @ axis)))
    return turned(center, axis, [low, radius], lambda z: np.sqrt(np.maximum(radius**2 - z**2, 0.0)), None)


def cylinder(shape: Mapping[str, Any], plane: Plane | None) -> Cloud:
    """A round bar, or a tube: the bar less its bore."""
    outer = straight(shape, float(shape["radius"]), float(shape["radius"]), plane)
    bore = float(shape.get("inner_radius", 0.0))
    if bore == 0.0:
        return outer
    inner = straight(shape, bore, bore, plane)
    return np.concatenate([outer[0], inner[0]]), np.concatenate([outer[1], -inner[1]])


def cone(shape: Mapping[str, Any], plane: Plane | None) -> Cloud:
    """A cone or its frustum, `radius` at from, `to_radius` at to."""
    return straight(shape, float(shape["radius"]), float(shape["to_radius"]), plane)


def straight(shape: Mapping[str, Any], r0: float, r1: float, plane: Plane | None) -> Cloud:
    """A round solid with a straight side; the ranges along its axis end where the plane touches a disc's rim."""
    a, b = (np.array(shape[k], dtype=float) for k in ("from", "to"))
    length, axis = float(np.linalg.norm(b - a)), unit(b - a)
    slope = (r1 - r0) / length
    stops = [0.0, length]
    if plane is not None:
        nz, d = float(plane.normal @ axis), float((plane.at - a) @ plane.normal)
        h = float(np.sqrt(max(0.0, 1.0 - nz * nz)))
        for sign in (1.0, -1.0):  # d - nz z = ± h r(z)
            if abs(nz + sign * h * slope) > 1e-300:
                stops.append((d - sign * h * r0) / (nz + sign * h * slope))
    stops = sorted({min(length, max(0.0, z)) for z in stops})
    return turned(a, axis, stops, lambda z: r0 + slope * z, plane)


def turned(
    base: Array, axis: Array, stops: Sequence[float], radius: Callable[[Array], Array], plane: Plane | None
) -> Cloud:
    """A solid of revolution over the ranges between `stops`, the part of every disc that lies beyond the plane.

    Along the axis z = middle - half cos θ, Gauss in θ: smooth where a chord appears at the rim. In the disc ξ = r cos ψ
    towards the kept side, 0 ≤ ψ ≤ β, chords of half length r sin ψ.
    """
    node, weight = gauss(48)
    chord, chord_weight = gauss(3)
    e, f = across(axis)
    nz, d, h = 0.0, 0.0, 0.0
    if plane is not None:
        nz, d = float(plane.normal @ axis), float((plane.at - base) @ plane.normal)
        aslant = plane.normal - nz * axis
        h = float(np.linalg.norm(aslant))
        if h > 1e-14:
            e = aslant / h
            f = np.cross(axis, e)
    points, masses = [np.zeros((1, 3))], [np.zeros(1)]
    for low, high in itertools.pairwise(stops):
        theta = np.pi * (1 + node) / 2
        z = (low + high) / 2 - (high - low) / 2 * np.cos(theta)
        dz = (high - low) / 2 * np.sin(theta) * np.pi / 2 * weight
        r = radius(z)
        beta = np.full_like(z, np.pi)
        if plane is not None:
            missing = d - nz * z  # the disc keeps h ξ > missing
            all_or_none = np.copysign(np.inf, missing)
            edge = np.where(h * r > 1e-14 * np.abs(missing), missing / np.maximum(h * r, 1e-300), all_or_none)
            beta = np.arccos(np.clip(edge, -1.0, 1.0))
        psi = beta[:, None] * (1 + node) / 2
        half = r[:, None] * np.sin(psi)
        strip = dz[:, None] * beta[:, None] / 2 * weight * half
        xi = r[:, None] * np.cos(psi)
        shape = (*psi.shape, 3)
        along, wide = np.broadcast_to(z[:, None, None], shape), half[:, :, None] * chord
        deep = np.broadcast_to(xi[:, :, None], shape)
        points.append((base + along[..., None] * axis + deep[..., None] * e + wide[..., None] * f).reshape(-1, 3))
        masses.append((strip[:, :, None] * half[:, :, None] * chord_weight).reshape(-1))
    return np.concatenate(points), np.concatenate(masses)


VOLUMES: dict[str, Callable[[Mapping[str, Any], Plane | None], Cloud]] = {
    "rod": rod,
    "box": box,
    "sphere": sphere,
    "cylinder": cylinder,
    "cone": cone,
}
