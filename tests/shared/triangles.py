"""Closed surfaces of triangles, (m, 3, 3), counter-clockwise from outside, and the files that hold them."""

from __future__ import annotations

import struct

import numpy as np

from heuncli.results.results import Array

FACES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))  # of a box, outward


def box(low: object = (0, 0, 0), high: object = (1, 1, 1)) -> Array:
    """Twelve triangles."""
    ends = np.array([low, high], dtype=float)
    corners = np.array([[ends[(k >> axis) & 1, axis] for axis in range(3)] for k in range(8)])
    return corners[np.array([t for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))])]


def grid(P: Array) -> Array:
    """The triangles of a net of points (n, m, 3) that closes both ways."""
    a, b = P, np.roll(P, -1, axis=0)
    c, d = np.roll(b, -1, axis=1), np.roll(P, -1, axis=1)
    return np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])


def torus(n: int, m: int, R: float = 1.0, r: float = 0.3) -> Array:
    """A ring about z."""
    a, b = np.meshgrid(2.0 * np.pi * np.arange(n) / n, 2.0 * np.pi * np.arange(m) / m, indexing="ij")
    out = R + r * np.cos(b)
    return grid(np.stack([out * np.cos(a), out * np.sin(a), r * np.sin(b)], axis=-1))


def cylinder(n: int, radius: float = 1.0, length: float = 1.0, inner: float = 0.0) -> Array:
    """A cylinder or tube from the origin along z, of n faces around, its corners on the circles."""
    a = 2.0 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(a), np.sin(a), np.zeros(n)], axis=-1)
    top = np.array([0.0, 0.0, length])
    if inner > 0.0:
        profile = [radius * ring, radius * ring + top, inner * ring + top, inner * ring]
        return grid(np.stack(profile, axis=1))
    low, high = radius * ring, radius * ring + top
    b, d = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    parts = [(low, b, d), (low, d, high), (b, low, np.zeros((n, 3))), (high, d, np.broadcast_to(top, (n, 3)))]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def prism(outline: Array, cap: object, length: float) -> Array:
    """Along x from 0, an outline (n, 2) in y and z, counter-clockwise from +x; cap: its triangles by their corners."""
    low, high = (np.column_stack([np.full(len(outline), x), outline]) for x in (0.0, length))
    b, d = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    faces = np.array(cap)
    parts = [np.stack([low, b, d], axis=1), np.stack([low, d, high], axis=1), low[faces[:, ::-1]], high[faces]]
    return np.concatenate(parts)


def profile_I(height: float, width: float, flange: float, web: float, length: float) -> Array:
    """An I section, its height along y, its width along z."""
    y, i, z, w = 0.5 * height, 0.5 * height - flange, 0.5 * width, 0.5 * web
    outline = np.array([
        (y, z), (i, z), (i, w), (-i, w), (-i, z), (-y, z), (-y, -z), (-i, -z), (-i, -w), (i, -w), (i, -z), (y, -z),
    ])  # fmt: skip
    cap = [
        (9, 10, 11), (2, 9, 11), (0, 2, 11), (0, 1, 2), (3, 8, 9), (2, 3, 9), (6, 7, 8),
        (3, 6, 8), (3, 5, 6), (3, 4, 5),
    ]  # fmt: skip
    return prism(outline, cap, length)


def tetrahedron(points: Array) -> Array:
    """The four faces of four points, outward."""
    a, b, c, d = points
    if np.dot(np.cross(b - a, c - a), d - a) < 0.0:
        b, c = c, b
    return np.array([(a, c, b), (a, b, d), (b, c, d), (a, d, c)])


def binary_stl(triangles: Array) -> bytes:
    """A binary STL file."""
    rows = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = triangles
    return bytes(80) + struct.pack("<I", len(triangles)) + rows.tobytes()


def text_stl(triangles: Array, name: str = "body") -> str:
    """The same as text, each coordinate by its shortest form."""
    lines = [f"solid {name}"]
    for triangle in triangles.tolist():
        corners = [f"      vertex {' '.join(f'{x:.9g}' for x in corner)}" for corner in triangle]
        lines += ["  facet normal 0 0 0", "    outer loop", *corners, "    endloop", "  endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""])


def indexed(triangles: Array) -> tuple[Array, Array]:
    """Corners (n, 3), each once, and triangles (m, 3) of their numbers from 0."""
    corners, number = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return corners, number.reshape(-1, 3)


def obj(triangles: Array) -> str:
    """An OBJ file."""
    corners, faces = indexed(triangles)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
    return "\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()), ""])


def ply(triangles: Array, order: str = "") -> bytes:
    """A PLY file: as text, or binary ("<", ">"), its numbers doubles."""
    corners, faces = indexed(triangles)
    form = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = (
        f"ply\nformat {form} 1.0\nelement vertex {len(corners)}\nproperty double x\nproperty double y\n"
        f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if not order:
        rows = [" ".join(map(repr, row)) for row in corners.tolist()]
        return head + "\n".join([*rows, *(f"3 {a} {b} {c}" for a, b, c in faces.tolist()), ""]).encode()
    packed = b"".join(struct.pack(f"{order}B3i", 3, *face) for face in faces.tolist())
    return head + corners.astype(f"{order}f8").tobytes() + packed
