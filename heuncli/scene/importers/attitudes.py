"""Rotate quantities from the axes of a part of the file into axes parallel to the world's.

    v' = R v,  I' = R I R^T     R takes components in the part's axes to components along the world's

A rotation by right angles only permutes numbers and their signs, so it stays exact and the digits of the file survive.
After other rotations, numbers are rounded to fifteen digits, and values within the rounding error of the sums become 0.
"""

from __future__ import annotations

import math

from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec
from heuncli.scene.file_format.rotations import matrix_product

EPS = 2.220446049250313e-16
ROUNDING_ERROR = 4.0 * EPS  # relative to the largest term: error of a sum of three products of rounded numbers
RIGHT_ANGLE_ERROR = 1e-15  # [rad] largest error of a double near a multiple of pi/2, up to a few turns
LOCK_LIMIT = 1e-7  # cos(pitch) below this: roll and yaw turn about one axis, and yaw is taken as 0
DOUBLE_DIGITS = 15  # any number of 15 digits survives as a double


def rotation_about_axis(axis: int, angle: float) -> Matrix:
    """Make the rotation matrix about x, y or z (axis 0, 1, 2). It is exact for the doubles nearest to right angles."""
    s, c = math.sin(angle), math.cos(angle)
    if min(abs(s), abs(c)) < RIGHT_ANGLE_ERROR:
        s, c = float(round(s)), float(round(c))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = [[0.0] * 3 for _ in range(3)]
    R[axis][axis] = 1.0
    R[i][i] = R[j][j] = c
    R[i][j], R[j][i] = -s, s
    return tuple(map(tuple, R))  # type: ignore[return-value]


def rotation_from_roll_pitch_yaw(angles: Vec) -> Matrix:
    """Make the rotation matrix of a roll about x, then a pitch about y, then a yaw about z, all about fixed axes
    [rad].
    """
    roll, pitch, yaw = (rotation_about_axis(axis, angle) for axis, angle in enumerate(angles))
    return compose_rotations(yaw, compose_rotations(pitch, roll))


def compute_roll_pitch_yaw(R: Matrix) -> Vec:
    """Return the roll, pitch and yaw of a rotation [rad]; the yaw is 0 where the pitch is a right angle."""
    cosine = math.hypot(R[0][0], R[1][0])
    pitch = math.atan2(-R[2][0], cosine)
    if cosine < LOCK_LIMIT:
        return math.atan2(-R[1][2], R[1][1]), pitch, 0.0
    return math.atan2(R[2][1], R[2][2]), pitch, math.atan2(R[1][0], R[0][0])


def compose_rotations(R: Matrix, S: Matrix) -> Matrix:
    """Return R S, the rotation S followed by R. If the product is a rotation by right angles up to rounding, it is made
    exact.
    """
    composed = matrix_product(R, S)
    right_angled = tuple(tuple(float(round(x)) for x in row) for row in composed)
    deviation = max(
        abs(x - n)
        for row, rounded in zip(composed, right_angled, strict=True)
        for x, n in zip(row, rounded, strict=True)
    )
    return right_angled if deviation <= ROUNDING_ERROR else composed  # type: ignore[return-value]


def is_right_angled(R: Matrix) -> bool:
    """Return whether R rotates by right angles only, so that numbers keep their digits."""
    return all(x in (-1.0, 0.0, 1.0) for row in R for x in row)


def rotate_vector(R: Matrix, v: Vec) -> Vec:
    """Return R v, with components along the world's axes."""
    x, y, z = (sum(R[i][k] * v[k] for k in range(3)) for i in range(3))
    return (x + 0.0, y + 0.0, z + 0.0) if is_right_angled(R) else round_vector((x, y, z))


def add_vectors(p: Vec, v: Vec) -> Vec:
    """Add two vectors given in the same axes, rounded to fifteen digits."""
    size = max(map(abs, (*p, *v)))
    x, y, z = (a + b if a == 0.0 or b == 0.0 else round_number(a + b, size) for a, b in zip(p, v, strict=True))
    return x, y, z


def rotate_tensor(R: Matrix, inertia: Matrix) -> Matrix:
    """Return R I R^T of a symmetric tensor; the result is exactly symmetric."""
    turned_rows = matrix_product(matrix_product(R, inertia), tuple(zip(*R, strict=True)))  # type: ignore[arg-type]
    size = max(abs(x) for row in inertia for x in row)
    exact = is_right_angled(R)
    rotated = [[0.0] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i + 1):
            rotated[i][j] = rotated[j][i] = turned_rows[i][j] + 0.0 if exact else round_number(turned_rows[i][j], size)
    return tuple(map(tuple, rotated))  # type: ignore[return-value]


def round_vector(v: Vec) -> Vec:
    """Round a computed vector to fifteen digits, relative to its largest component."""
    size = max(map(abs, v))
    x, y, z = (round_number(a, size) for a in v)
    return x, y, z


def round_number(value: float, size: float) -> float:
    """Round a computed number to fifteen digits. It becomes 0 if it is within the rounding error of terms of that
    size.
    """
    return 0.0 if abs(value) <= ROUNDING_ERROR * size else float(f"{value:.{DOUBLE_DIGITS}g}")
