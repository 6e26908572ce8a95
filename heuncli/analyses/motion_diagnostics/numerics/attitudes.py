"""Where representations of an attitude fail: half turns of the global Rodrigues parameters, gimbal lock of Euler
angles.     kappa = v / w                       of the attitude's quaternion (w, v): without bound where w = 0, a half
turn     omega = W(angles) rates,  cond W = cot(delta / 2) delta is the angle, up to 90 degrees, between a body's axis
and the world's z: its own z for zxz, its x for zyx. W has the columns z, the line of nodes n, and the axis c; n is
perpendicular to both, and z and c alone have the singular values sqrt(1 +- cos delta).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows

SEQUENCES = {"zxz": 2, "zyx": 0}  # the body axis that is parallel to the world's z at gimbal lock


def to_quaternions(R: Array) -> Array:
    """Return the quaternions (n_t, 4) of attitudes along a motion, (n_t, 3, 3), with continuous signs."""
    trace = np.trace(R, axis1=1, axis2=2)
    diagonal = np.diagonal(R, axis1=1, axis2=2)
    squares = np.concatenate([1.0 + trace[:, None], 1.0 - trace[:, None] + 2.0 * diagonal], axis=1)  # 4 q_i^2
    K = np.empty((len(R), 4, 4))  # 4 q_i q_j
    K[:, range(4), range(4)] = squares
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        K[:, 0, 1 + i] = K[:, 1 + i, 0] = R[:, k, j] - R[:, j, k]
        K[:, 1 + i, 1 + j] = K[:, 1 + j, 1 + i] = R[:, i, j] + R[:, j, i]
    best = np.argmax(squares, axis=1)
    rows = np.arange(len(R))
    q = K[rows, best] / (2.0 * np.sqrt(squares[rows, best]))[:, None]
    turns = np.sum(q[1:] * q[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(turns, -1.0, 1.0)]))
    return np.asarray(q * sign[:, None])


def project_axis(R: Array, omega: Array, axis: int) -> tuple[Array, Array]:
    """Return the horizontal part (n_t, 2) of a body's axis, and its rate; its length is sin delta."""
    c = R[:, :, axis]
    return c[:, :2], cross_rows(omega, c)[:, :2]


def compute_condition(sine: Array | float) -> Array:
    """Return the condition cot(delta / 2) of the angle matrix, from sin delta."""
    s = np.asarray(sine, dtype=float)
    with np.errstate(divide="ignore"):
        return np.asarray((1.0 + np.sqrt(np.maximum(1.0 - s * s, 0.0))) / s)
