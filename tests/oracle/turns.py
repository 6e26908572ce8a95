"""Vectors and rotations for the oracle: written once more, so that nothing is shared with the program under test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def cross(a: Array, b: Array) -> Array:
    """a x b, (3,); several times faster than numpy's for single vectors."""
    (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def unit(a: Sequence[float] | Array) -> Array:
    """The vector at length one."""
    v = np.asarray(a, dtype=float)
    return v / np.linalg.norm(v)


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors that make a right-handed triad (e, f, axis) with the unit vector `axis`."""
    start = np.eye(3)[int(np.argmin(np.abs(axis)))]
    e = unit(cross(axis, start))
    return e, cross(axis, e)


def about(axis: Array, angle: float) -> Array:
    """Rotation by `angle` [rad] about the unit vector `axis`, (3, 3)."""
    return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix())


def turn_vector(R: Array) -> Array:
    """Axis times angle of a rotation, (3,) [rad]."""
    return np.asarray(Rotation.from_matrix(R).as_rotvec())


def random_rotation(rng: np.random.Generator) -> Array:
    """A rotation, uniform over all, (3, 3), orthogonal to rounding."""
    q = unit(rng.standard_normal(4))
    return np.asarray(Rotation.from_quat(q).as_matrix())


def random_unit(rng: np.random.Generator) -> Array:
    """A direction, uniform over the sphere, (3,)."""
    return unit(rng.standard_normal(3))


def attitude(orientation: Mapping[str, Any] | None) -> Array:
    """Rotation of an `orientation` entry (matrix; axis and angle [rad]; quaternion w, x, y, z; rodrigues), (3, 3)."""
    if orientation is None:
        return np.eye(3)
    if "matrix" in orientation:
        return np.array(orientation["matrix"], dtype=float)
    if "axis" in orientation:
        return about(unit(orientation["axis"]), float(orientation["angle"]))
    if "quaternion" in orientation:
        w, x, y, z = orientation["quaternion"]
        return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())
    if "rodrigues" in orientation:
        return np.asarray(Rotation.from_quat([*orientation["rodrigues"], 1.0]).as_matrix())
    raise ValueError(f"orientation not read by the oracle: {sorted(orientation)}")
