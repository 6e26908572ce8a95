"""Rotations as 3x3 matrices and unit quaternions (w, x, y, z). R takes components in rotated axes to the fixed axes.

Vectors of bodies at many instants are computed component by component: few long sums in place of many short ones.
They are (n, 3, n_t) and matrices (n, 3, 3, n_t) for n bodies, while elsewhere instants come first. A sum over three
components is then three loops over all instants. Products are summed in a fixed order, that of NumPy's einsum for (n_t,
n, 3).
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.kernel.choose import components
from heuncli.results.results import Array

# Rotations

SERIES_THRESHOLD = 1e-4  # [rad] below this the first term of the series is exact, and the closed form loses digits


def cross_matrix(a: Array) -> Array:
    """Return the matrix of the cross product, (3, 3): cross_matrix(a) @ b = a x b."""
    x, y, z = a.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation_matrix_about(axis: Array, angle: float) -> Array:
    """Return the rotation by `angle` [rad] about the unit vector `axis`, (3, 3)."""
    s, c = math.sin(angle), math.cos(angle)
    x, y, z = axis.tolist()
    k, i, o = 1.0 - c, c * 1.0 + s * 0.0, c * 0.0  # summed in the order of c 1 + s cross_matrix(n) + (1 - c) n n'
    return np.array([
        [i + k * (x * x), o + s * -z + k * (x * y), o + s * y + k * (x * z)],
        [o + s * z + k * (y * x), i + k * (y * y), o + s * -x + k * (y * z)],
        [o + s * -y + k * (z * x), o + s * x + k * (z * y), i + k * (z * z)],
    ])  # fmt: skip


def rotation_from_vector(turn: Array) -> Array:
    """Return the rotation by the vector axis * angle [rad], (3, 3)."""
    angle = math.sqrt(float(turn @ turn))
    return rotation_matrix_about(turn / angle, angle) if angle > 0.0 else np.eye(3)


def vector_from_rotation(R: Array) -> Array:
    """Return axis * angle of a rotation, (3,) [rad], angle in [0, pi]."""
    return vector_from_quaternion(quaternion_from_matrix(R))


def inverse_jacobian(phi: Array) -> Array:
    """Return the matrix (3, 3) in d phi = matrix @ w dt, for a rotation exp(phi) with angular velocity w (fixed
    axes).
    """
    angle2 = float(phi @ phi)
    angle = math.sqrt(angle2)
    factor = 1.0 / 12.0 if angle < SERIES_THRESHOLD else (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / angle2
    V = cross_matrix(phi)
    return np.eye(3) - 0.5 * V + factor * (V @ V)


def quaternion_from_matrix(R: Array) -> Array:
    """Return the unit quaternion of a rotation, (4,), from its largest component (Shepperd's choice: no
    cancellation).
    """
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


def rotation_between(a: Array, b: Array) -> Array:
    """Return the smallest rotation that takes the unit vector a to the unit vector b, (3, 3).

    For opposite vectors (to PARALLEL): half a turn about the coordinate axis most nearly perpendicular to them.
    """
    v = cross_vectors(a, b)
    c = float(a @ b)
    if c >= 0.0:  # 1 + V + V^2 / (1 + c), V = cross_matrix(v)
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
    return rotation_between(-a, b) @ (2.0 * np.outer(e, e) - np.eye(3))


def perpendicular_pair(n: Array) -> tuple[Array, Array]:
    """Return two unit vectors that make (e, f, n) right-handed with the unit vector n; a fixed choice."""
    c = n.tolist()
    k = min(range(3), key=lambda i: abs(c[i]))
    size = math.sqrt(c[(k + 1) % 3] ** 2 + c[(k + 2) % 3] ** 2)  # length of axis k without its part along n, times |n|
    e = -c[k] * n / size
    e[k] += 1.0 / size
    return e, cross_vectors(n, e)


def cross_vectors(a: Array, b: Array) -> Array:
    """Return a x b of two single vectors, (3,); np.cross costs twenty times as much."""
    a1, a2, a3 = a.tolist()
    b1, b2, b3 = b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def orthonormalize(R: Array) -> Array:
    """Return the rotation nearest to a matrix that deviates from one by rounding, (3, 3)."""
    return 1.5 * R - 0.5 * (R @ (R.T @ R))


def cross_rows(a: Array, b: Array) -> Array:
    """Return a x b along the last axes, (..., 3), of arrays that broadcast; bit-identical to np.cross, at a third of
    its cost.
    """
    out = np.empty(np.broadcast(a, b).shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def quaternions_about(n: Array, angle: Array) -> Array:
    """Return the quaternions (..., 4) of rotations by angles (...) [rad] about a unit vector."""
    half = 0.5 * angle[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * n], axis=-1)


def quaternion_from_vector(turn: Array) -> Array:
    """Return the unit quaternions (..., 4) of rotations by the vectors axis * angle (..., 3) [rad]."""
    half = 0.5 * np.sqrt(np.sum(turn * turn, axis=-1, keepdims=True))
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * turn], axis=-1)


def vector_from_quaternion(q: Array) -> Array:
    """Return the vector axis * angle (3,) [rad] of the rotation by a unit quaternion (4,), angle in [0, pi]."""
    w, v = (float(q[0]), q[1:]) if q[0] >= 0.0 else (-float(q[0]), -q[1:])
    s = math.sqrt(float(v @ v))
    return np.asarray(v * (2.0 * math.atan2(s, w) / s)) if s > 0.0 else np.zeros(3)


def quaternion_product(p: Array, q: Array) -> Array:
    """Return the rotation q followed by p: Hamilton's product along the last axes, (..., 4), of arrays that
    broadcast.
    """
    w, v, x, u = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    return np.concatenate([w * x - np.sum(v * u, axis=-1, keepdims=True), w * u + x * v + cross_rows(v, u)], axis=-1)


# By component


def instants_last(values: Array) -> Array:
    """Return values (n_t, ...) with the instants last and contiguous, (..., n_t)."""
    return np.ascontiguousarray(values.transpose(*range(1, values.ndim), 0))


def instants_first(values: Array) -> Array:
    """Return values (..., n_t) with the instants first, (n_t, ...)."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(last, *range(last)))


def bodies_contiguous(values: Array) -> Array:
    """Return values (n, ..., n_t) as (n_t, n, ...), stored in memory one body after another."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(0, last, *range(1, last))).swapaxes(0, 1)


def cross_components(a: Array, b: Array) -> Array:
    """Compute a x b, (n, 3, n_t)."""
    result = np.empty(a.shape)
    if result.size:
        components.cross_bodies(as_flat(a), as_flat(b), len(a), result.reshape(-1))
    return result


def as_flat(values: Array) -> Array:
    """Return values as one row that the kernel may take for its own."""
    flat = values.reshape(-1)
    return flat if flat.flags.writeable else flat.copy()


def cross_first_axis(a: Array, b: Array) -> Array:
    """Compute a x b, (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rotate_components(R: Array, vectors: Array, *, back: bool = False) -> Array:
    """Compute R v, (n, 3, n_t), summed over the first, the last, then the second component; back: R^T v, summed in
    order.

    One of the two may be the same at all instants: (n, 3, 3, 1) or (n, 3, 1).
    """
    result = np.empty((len(R), 3, max(R.shape[-1], vectors.shape[-1])))
    if result.size:
        components.rotate_bodies(as_flat(R), as_flat(vectors), len(R), back, result.reshape(-1))
    return result


def quadratic_form(x: Array, J: Array) -> Array:
    """Compute x . J x of vectors (n, 3, n_t) and matrices (n, 3, 3), (n, n_t)."""
    result = np.empty((len(x), x.shape[-1]))
    if result.size:
        components.square_bodies(as_flat(x), as_flat(J), len(x), result.reshape(-1))
    return result


def squared_lengths(vectors: Array) -> Array:
    """Compute v . v, (n, n_t)."""
    products = vectors * vectors
    return np.asarray(products[:, 0] + products[:, 1] + products[:, 2])


def largest_magnitude(values: Array) -> Array:
    """Return the largest magnitude of values (..., n_t) at each instant, (n_t,)."""
    return np.asarray(np.abs(values).reshape(-1, values.shape[-1]).max(axis=0, initial=0.0))
