"""Turning what a file gives in the axes of its parts into axes that stand along the world's.

    v' = R v,  I' = R I R^T     R takes components in the part's axes to components along the world's

A turn by right angles only permutes numbers and their signs, and is kept exact: the digits stay the file's. Of other
turns fifteen digits are kept, and what is no more than the rounding of the sums is 0.
"""

from __future__ import annotations

import math

from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.file_format.turns import product

EPS = 2.220446049250313e-16
ROUNDED = 4.0 * EPS  # of the largest term: what sums of three products of rounded numbers are off by
RIGHT = 1e-15  # rad: a double of pi/2 and its multiples is off by no more, up to a few turns
DIGITS = 15  # that any double keeps


def about(axis: int, angle: float) -> Matrix:
    """The turn about x, y or z (0, 1, 2) by an angle; exact where the angle is the double nearest to right ones."""
    s, c = math.sin(angle), math.cos(angle)
    if min(abs(s), abs(c)) < RIGHT:
        s, c = float(round(s)), float(round(c))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = [[0.0] * 3 for _ in range(3)]
    R[axis][axis] = 1.0
    R[i][i] = R[j][j] = c
    R[i][j], R[j][i] = -s, s
    return tuple(map(tuple, R))  # type: ignore[return-value]


def of_roll_pitch_yaw(angles: Vec) -> Matrix:
    """The attitude after a roll about x, then a pitch about y, then a yaw about z, all of them fixed axes."""
    roll, pitch, yaw = (about(axis, angle) for axis, angle in enumerate(angles))
    return after(yaw, after(pitch, roll))


def after(R: Matrix, S: Matrix) -> Matrix:
    """The turn R behind the turn S; rounding beside a turn by right angles is taken off."""
    made = product(R, S)
    whole = tuple(tuple(float(round(x)) for x in row) for row in made)
    off = max(abs(x - n) for row, rounded in zip(made, whole, strict=True) for x, n in zip(row, rounded, strict=True))
    return whole if off <= ROUNDED else made  # type: ignore[return-value]


def is_right(R: Matrix) -> bool:
    """Whether a turn is one by right angles: numbers keep their digits."""
    return all(x in (-1.0, 0.0, 1.0) for row in R for x in row)


def turned(R: Matrix, v: Vec) -> Vec:
    """A vector, components along the world's axes."""
    x, y, z = (sum(R[i][k] * v[k] for k in range(3)) for i in range(3))
    return (x + 0.0, y + 0.0, z + 0.0) if is_right(R) else kept((x, y, z))


def shifted(p: Vec, v: Vec) -> Vec:
    """The sum of two vectors in the same axes."""
    size = max(map(abs, (*p, *v)))
    x, y, z = (a + b if a == 0.0 or b == 0.0 else digits(a + b, size) for a, b in zip(p, v, strict=True))
    return x, y, z


def turned_tensor(R: Matrix, inertia: Matrix) -> Matrix:
    """A symmetric tensor, components along the world's axes; symmetric to the bit."""
    turned_rows = product(product(R, inertia), tuple(zip(*R, strict=True)))  # type: ignore[arg-type]
    size = max(abs(x) for row in inertia for x in row)
    exact = is_right(R)
    made = [[0.0] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i + 1):
            made[i][j] = made[j][i] = turned_rows[i][j] + 0.0 if exact else digits(turned_rows[i][j], size)
    return tuple(map(tuple, made))  # type: ignore[return-value]


def kept(v: Vec) -> Vec:
    """A computed vector to fifteen digits, its roundings taken off."""
    size = max(map(abs, v))
    x, y, z = (digits(a, size) for a in v)
    return x, y, z


def digits(value: float, size: float) -> float:
    """A computed number to fifteen digits; 0 where it is no more than the rounding of terms of that size."""
    return 0.0 if abs(value) <= ROUNDED * size else float(f"{value:.{DIGITS}g}")
