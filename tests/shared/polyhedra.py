"""Convex polyhedra clipped by planes, the slow way: faces as polygons, mass properties as sums over tetrahedra."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array

Faces = list[Array]  # corners (m, 3) of each face, in order


def prism(start: Array, end: Array, r0: float, r1: float, sides: int) -> Faces:
    """A cylinder or cone with flat sides, corners on the round ones."""
    axis = (end - start) / np.linalg.norm(end - start)
    e = np.linalg.svd(axis[None, :])[2][1]
    f = np.cross(axis, e)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * e + np.sin(angle)[:, None] * f
    bottom, top = start + r0 * ring, end + r1 * ring
    walls = [np.array([bottom[i - 1], bottom[i], top[i], top[i - 1]]) for i in range(sides)]
    return [bottom[::-1], top, *walls]


def box(center: Array, size: Array, axes: Array) -> Faces:
    half = 0.5 * size
    faces = []
    for i in range(3):
        for sign in (-1.0, 1.0):
            j, k = (i + 1) % 3, (i + 2) % 3
            corners = np.zeros((4, 3))
            corners[:, i] = sign * half[i]
            corners[:, j] = half[j] * np.array([-1.0, 1.0, 1.0, -1.0])
            corners[:, k] = half[k] * np.array([-1.0, -1.0, 1.0, 1.0])
            faces.append(center + corners[:: int(sign)] @ axes.T)
    return faces


def clipped(faces: Faces, n: Array, d: float) -> Faces:
    """The part with n.x > d: every face clipped, and the cut closed."""
    kept, cut = [], []
    for face in faces:
        height = face @ n - d
        after = np.roll(height, -1)
        polygon = []
        for x, y, h, g in zip(face, np.roll(face, -1, axis=0), height, after, strict=True):
            if h >= 0.0:
                polygon.append(x)
            if (h >= 0.0) != (g >= 0.0):
                polygon.append(x + (y - x) * (h / (h - g)))
                cut.append(polygon[-1])
        if len(polygon) > 2:
            kept.append(np.array(polygon))
    if len(cut) > 2:
        corners = np.array(cut)
        e = np.linalg.svd(n[None, :])[2][1]
        f = np.cross(n, e)
        arm = corners - corners.mean(axis=0)
        kept.append(corners[np.argsort(-np.arctan2(arm @ f, arm @ e))])
    return kept


def pseudo_inertia(faces: Faces) -> Array:
    """P of a convex polyhedron of density 1 about the origin, fanned from its middle.

    manual/theory.md, "Mass properties".
    """
    P = np.zeros((4, 4))
    if not faces:
        return P
    base = np.mean(np.concatenate(faces), axis=0)
    for face in faces:
        a, b, c = face[0] - base, face[1:-1] - base, face[2:] - base
        v = np.abs(np.cross(b, c) @ a) / 6.0
        s = a + b + c
        T = (np.outer(a, a) * v.sum() + np.einsum("i,ij,ik->jk", v, b, b) + np.einsum("i,ij,ik->jk", v, c, c)
             + np.einsum("i,ij,ik->jk", v, s, s)) / 20.0  # fmt: skip
        P[:3, :3] += T
        P[:3, 3] += v @ s / 4.0
        P[3, 3] += v.sum()
    P[3, :3] = P[:3, 3]
    G = np.eye(4)
    G[:3, 3] = base
    return G @ P @ G.T
