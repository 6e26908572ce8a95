"""Shapes and planes for the tests, and what two pseudo-inertias differ by, counted by mass and size."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.shapes.composite_solid import CompositeSolid, make_composite_solid


def vec(x: Array) -> Vec:
    return float(x[0]), float(x[1]), float(x[2])


def rotation(rng: np.random.Generator) -> Array:
    """A rotation, all equally likely enough."""
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return Q * np.sign(np.linalg.det(Q))


def unit(x: Array) -> Array:
    return x / np.sqrt(x @ x)


A, B, C = (0.1, 0.2, -0.3), (0.9, -0.2, 0.4), (-0.2, 0.3, 0.1)
TURNED = tuple(vec(row) for row in rotation(np.random.default_rng(5)))
SOLIDS = {
    "rod": Shape("rod", from_=A, to=B, line_density=2.0),
    "cylinder": Shape("cylinder", from_=A, to=B, radius=0.3, density=1.5),
    "disc": Shape("cylinder", from_=A, to=(0.1, 0.2, -0.27), radius=0.7, density=1.5),
    "tube": Shape("cylinder", from_=A, to=B, radius=0.3, inner_radius=0.21, density=1.5),
    "thin tube": Shape("cylinder", from_=A, to=B, radius=0.3, inner_radius=0.29999, density=1.5),
    "cone": Shape("cone", from_=A, to=B, radius=0.4, to_radius=0.0, density=1.5),
    "frustum": Shape("cone", from_=A, to=B, radius=0.2, to_radius=0.7, density=1.5),
    "box": Shape("box", center=C, size=(0.3, 0.8, 1.1), density=1.5),
    "turned box": Shape("box", center=C, size=(0.3, 0.8, 1.1), rotation=TURNED, density=1.5),  # type: ignore[arg-type]
    "sphere": Shape("sphere", center=C, radius=0.6, density=1.5),
}
ROUND = ("cylinder", "disc", "tube", "thin tube", "cone", "frustum")


def axis_of(shape: Shape) -> Array:
    """The shape's own axis, or one of the box's or the world's."""
    if shape.from_ is not None and shape.to is not None:
        return unit(np.array(shape.to) - np.array(shape.from_))
    return np.eye(3)[2] if shape.rotation is None else np.array(shape.rotation)[:, 2]


def planes(shape: Shape, rng: np.random.Generator, count: int) -> list[tuple[Array, Array]]:
    """Normals, any and nearly along or across the shape's axis, each with offsets from end to end."""
    axis, found = axis_of(shape), []
    for k in range(count):
        n = unit(rng.normal(size=3))
        across = unit(np.cross(axis, n))
        off = 10.0 ** rng.uniform(-16.0, 0.0)
        n = unit((n, axis + off * across, across + off * axis)[k % 3])
        low, high = make_composite_solid([shape]).extent(n)
        near = (high - low) * 10.0 ** rng.uniform(-12.0, -1.0, 2)
        found.append((n, np.concatenate([rng.uniform(low, high, 3), low + near, high - near])))
    return found


def difference(P: Array, Q: Array, whole: Array) -> float:
    """Largest difference of two pseudo-inertias, in parts of the mass and size of the whole."""
    size = np.sqrt(np.trace(whole[:3, :3]) / whole[3, 3])
    scale = np.diag([1.0 / size] * 3 + [1.0])
    return float(np.abs(scale @ (P - Q) @ scale).max() / whole[3, 3])


def beyond(f: CompositeSolid, n: Array, d: Array) -> Array:
    return f.piece_inertias(n, d, np.zeros(len(d)))


def blur(f: CompositeSolid, n: Array, d: Array) -> list[float]:
    """By how much pieces change when their planes shift by rounding: much for one along a rod or in a thin disc."""
    low, high = f.extent(n)
    shift = 2e-15 * (1.0 + max(abs(low), abs(high)))
    return [
        difference(one, other, f.whole_inertia())
        for one, other in zip(beyond(f, n, d - shift), beyond(f, n, d + shift), strict=True)
    ]


def moved(shape: Shape, R: Array, p: Array) -> Shape:
    """The same shape turned by R, then shifted by p."""
    given = {key: getattr(shape, key) for key in ("from_", "to", "at", "center")}
    places = {key: vec(R @ np.array(value) + p) for key, value in given.items() if value is not None}
    if shape.type == "box":
        axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation)
        return shape._replace(**places, rotation=tuple(vec(row) for row in R @ axes))  # type: ignore[arg-type]
    return shape._replace(**places)  # type: ignore[arg-type]


def stretched(shape: Shape, factor: float) -> Shape:
    """The same shape with all lengths times the factor."""
    places = {key: getattr(shape, key) for key in ("from_", "to", "at", "center", "size")}
    radii = {key: getattr(shape, key) for key in ("radius", "inner_radius", "to_radius")}
    longer = {key: vec(factor * np.array(value)) for key, value in places.items() if value is not None}
    wider = {key: factor * value for key, value in radii.items() if value is not None}
    return shape._replace(**longer, **wider)  # type: ignore[arg-type]


def carried(P: Array, R: Array, p: Array) -> Array:
    """The pseudo-inertia of the same matter after x -> R x + p: G P G^T, G = [[R, p], [0, 1]]."""
    G = np.eye(4)
    G[:3, :3], G[:3, 3] = R, p
    return np.asarray(G @ P @ G.T)
