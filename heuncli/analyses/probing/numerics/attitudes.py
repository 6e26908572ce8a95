"""Where charts of an attitude fail: half turns of the global Rodrigues chart, gimbal lock of Euler angles.

    kappa = v / w                       of the attitude's quaternion (w, v): without bound where w = 0, a half turn
    omega = W(angles) rates,  cond W = cot(delta / 2)
delta is the angle, up to 90 degrees, by which a body's axis is off the world's z: its own z for zxz, its x for zyx.
W has the columns z, the line of nodes n, and the axis c; n is square to both, and z and c alone have the singular
values sqrt(1 +- cos delta).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows

SEQUENCES = {"zxz": 2, "zyx": 0}  # which axis of the body comes along the world's z


def quaternions(R: Array) -> Array:
    """Quaternions (n_t, 4) of attitudes along a motion, (n_t, 3, 3): each next to the one before it."""
    trace = np.trace(R, axis1=1, axis2=2)
    diagonal = np.diagonal(R, axis1=1, axis2=2)
    squares = np.concatenate([1.0 + trace[:, None], 1.0 - trace[:, None] + 2.0 * diagonal], axis=1)  # 4 q_i^2
    K = np.empty((len(R), 4, 4))  # 4 q_i q_j
    K[:, range(4), range(4)] = squares
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        K[:, 0, 1 + i] = K[:, 1 + i, 0] = R[:, k, j] - R[:, j, k]
        K[:, 1 + i, 1 + j] = K[:, 1 + j, 1 + i] = R[:, i, j] + R[:, j, i]
    best = np.argmax(squares, axis=1)
    at = np.arange(len(R))
    q = K[at, best] / (2.0 * np.sqrt(squares[at, best]))[:, None]
    turns = np.sum(q[1:] * q[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(turns, -1.0, 1.0)]))
    return np.asarray(q * sign[:, None])


def off_upright(R: Array, omega: Array, axis: int) -> tuple[Array, Array]:
    """What a body's axis has across the world's z, (n_t, 2), and its rate; its length is sin delta."""
    c = R[:, :, axis]
    return c[:, :2], cross_rows(omega, c)[:, :2]


def condition(sine: Array | float) -> Array:
    """cot(delta / 2) of the angle matrix, from sin delta."""
    s = np.asarray(sine, dtype=float)
    with np.errstate(divide="ignore"):
        return np.asarray((1.0 + np.sqrt(np.maximum(1.0 - s * s, 0.0))) / s)
