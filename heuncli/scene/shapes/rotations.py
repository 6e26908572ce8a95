"""Rotations as 3x3 matrices and unit quaternions (w, x, y, z); R takes components in turned axes to the fixed ones."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

SERIES = 1e-4  # [rad] below it the first term of a series is exact and the closed form cancels


def hat(a: Array) -> Array:
    """Matrix of the cross product, (3, 3): hat(a) @ b = a x b."""
    x, y, z = a.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def about(axis: Array, angle: float) -> Array:
    """Rotation by `angle` [rad] about the unit vector `axis`, (3, 3)."""
    s, c = math.sin(angle), math.cos(angle)
    x, y, z = axis.tolist()
    k, i, o = 1.0 - c, c * 1.0 + s * 0.0, c * 0.0  # in the order in which c 1 + s hat(n) + (1 - c) n n' is added up
    return np.array([
        [i + k * (x * x), o + s * -z + k * (x * y), o + s * y + k * (x * z)],
        [o + s * z + k * (y * x), i + k * (y * y), o + s * -x + k * (y * z)],
        [o + s * -y + k * (z * x), o + s * x + k * (z * y), i + k * (z * z)],
    ])  # fmt: skip


def from_vector(turn: Array) -> Array:
    """Rotation by the vector axis * angle [rad], (3, 3)."""
    angle = math.sqrt(float(turn @ turn))
    return about(turn / angle, angle) if angle > 0.0 else np.eye(3)


def to_vector(R: Array) -> Array:
    """Axis * angle of a rotation, (3,) [rad], angle in [0, pi]."""
    return vector_of_quaternion(to_quaternion(R))


def inverse_jacobian(phi: Array) -> Array:
    """d phi = this @ w dt, for exp(phi) turned on by w (fixed axes), (3, 3)."""
    angle2 = float(phi @ phi)
    angle = math.sqrt(angle2)
    factor = 1.0 / 12.0 if angle < SERIES else (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / angle2
    V = hat(phi)
    return np.eye(3) - 0.5 * V + factor * (V @ V)


def to_quaternion(R: Array) -> Array:
    """Unit quaternion of a rotation, (4,), from its largest component (Shepperd's choice: no cancellation)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = R.tolist()
    t = xx + yy + zz
    squares = (1.0 + t, 1.0 + 2.0 * xx - t, 1.0 + 2.0 * yy - t, 1.0 + 2.0 * zz - t)
    k = max(range(4), key=lambda i: squares[i])
    s = math.sqrt(squares[k])
    f = 0.5 / s
    a, b, c = zy - yz, xz - zx, yx - xy
    d, e, g = yx + xy, zx + xz, zy + yz
    q = (
        (0.5 * s, a * f, b * f, c * f),
        (a * f, 0.5 * s, d * f, e * f),
        (b * f, d * f, 0.5 * s, g * f),
        (c * f, e * f, g * f, 0.5 * s),
    )[k]
    q_ = np.array(q)
    return q_ / math.sqrt(float(q_ @ q_))


def turn_onto(a: Array, b: Array) -> Array:
    """Smallest rotation that takes the unit vector a onto the unit vector b, (3, 3).

    Opposite vectors (to PARALLEL): half a turn about the coordinate axis most nearly perpendicular to them.
    """
    v = cross(a, b)
    c = float(a @ b)
    if c >= 0.0:  # 1 + hat(v) + hat(v)^2 / (1 + c)
        x, y, z = v.tolist()
        f = 1.0 / (1.0 + c)
        return np.array(
            [
                [c + f * x * x, f * x * y - z, f * x * z + y],
                [f * x * y + z, c + f * y * y, f * y * z - x],
                [f * x * z - y, f * y * z + x, c + f * z * z],
            ]
        )
    # Beyond a right angle 1 + c would cancel: half a turn takes a to -a, and -a is near b.
    if float(v @ v) < tolerances.PARALLEL**2:
        v = np.zeros(3)
        v[int(np.argmin(np.abs(a)))] = 1.0
    e = v - (v @ a) * a
    e = e / math.sqrt(float(e @ e))
    return turn_onto(-a, b) @ (2.0 * np.outer(e, e) - np.eye(3))


def perpendicular(n: Array) -> tuple[Array, Array]:
    """Two unit vectors that make (e, f, n) right-handed with the unit vector n; a fixed choice."""
    c = n.tolist()
    k = min(range(3), key=lambda i: abs(c[i]))
    size = math.sqrt(c[(k + 1) % 3] ** 2 + c[(k + 2) % 3] ** 2)  # of the axis k without its part along n, times |n|
    e = -c[k] * n / size
    e[k] += 1.0 / size
    return e, cross(n, e)


def cross(a: Array, b: Array) -> Array:
    """a x b of two single vectors, (3,); np.cross costs twenty times as much."""
    a1, a2, a3 = a.tolist()
    b1, b2, b3 = b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def orthonormal(R: Array) -> Array:
    """The rotation nearest to one that is off by rounding, (3, 3)."""
    return 1.5 * R - 0.5 * (R @ (R.T @ R))


def cross_rows(a: Array, b: Array) -> Array:
    """a x b along the last axes, (..., 3), of arrays that broadcast; to the bit np.cross, at a third of its cost."""
    out = np.empty(np.broadcast(a, b).shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def about_axis(n: Array, angle: Array) -> Array:
    """The quaternions (..., 4) of turns by angles (...) about a unit vector."""
    half = 0.5 * angle[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * n], axis=-1)


def quaternion_from_vector(turn: Array) -> Array:
    """The unit quaternions (..., 4) of rotations by the vectors axis * angle (..., 3) [rad]."""
    half = 0.5 * np.sqrt(np.sum(turn * turn, axis=-1, keepdims=True))
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * turn], axis=-1)


def vector_of_quaternion(q: Array) -> Array:
    """The vector axis * angle (3,) [rad] of the rotation by a unit quaternion (4,), angle in [0, pi]."""
    w, v = (float(q[0]), q[1:]) if q[0] >= 0.0 else (-float(q[0]), -q[1:])
    s = math.sqrt(float(v @ v))
    return np.asarray(v * (2.0 * math.atan2(s, w) / s)) if s > 0.0 else np.zeros(3)


def quaternion_product(p: Array, q: Array) -> Array:
    """The turn q, then p: Hamilton's product along the last axes, (..., 4), of arrays that broadcast."""
    w, v, x, u = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    return np.concatenate([w * x - np.sum(v * u, axis=-1, keepdims=True), w * u + x * v + cross_rows(v, u)], axis=-1)
