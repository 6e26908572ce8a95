"""Rotations and small tensors in plain floats: what loading a spec needs, without NumPy.

A rotation R takes components in the turned (body) axes to the fixed (world) axes.
"""

from __future__ import annotations

import math

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def vector_length(v: Vec) -> float:
    """Return the length of a vector, without overflow."""
    return math.hypot(*v)


def unit_vector(v: Vec) -> Vec:
    """Return the direction of a vector that is not zero."""
    scale = max(map(abs, v))
    x, y, z = v[0] / scale, v[1] / scale, v[2] / scale
    n = math.sqrt(x * x + y * y + z * z)
    return x / n, y / n, z / n


def cross_product(a: Vec, b: Vec) -> Vec:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def are_parallel(a: Vec, b: Vec) -> bool:
    """Return whether two directions, neither of them 0, are parallel or opposite."""
    return vector_length(cross_product(unit_vector(a), unit_vector(b))) < tolerances.PARALLEL


def matrix_product(a: Matrix, b: Matrix) -> Matrix:
    rows = [tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3)]
    return rows[0], rows[1], rows[2]  # type: ignore[return-value]


def rotation_about(axis: Vec, angle: float) -> Matrix:
    """Return the rotation by an angle about a direction that is not zero (Rodrigues)."""
    x, y, z = unit_vector(axis)
    s, c = math.sin(angle), math.cos(angle)
    d = 1.0 - c
    return (
        (c + d * x * x, d * x * y - s * z, d * x * z + s * y),
        (d * x * y + s * z, c + d * y * y, d * y * z - s * x),
        (d * x * z - s * y, d * y * z + s * x, c + d * z * z),
    )


def rotation_from_quaternion(q: tuple[float, float, float, float]) -> Matrix:
    """Return the rotation of a quaternion (w, x, y, z), which is normalised here."""
    n = math.hypot(*q)
    w, x, y, z = (c / n for c in q)
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def rotation_from_unit_quaternion(q: tuple[float, float, float, float]) -> Matrix:
    """Return the rotation of a quaternion that should have unit length. Raises Finding [orientation] if it has not."""
    n = math.hypot(*q)
    if abs(n - 1.0) > tolerances.UNIT_TYPED:
        raise Finding("orientation", f"the quaternion has length {n:.6g} instead of 1", "its order is w, x, y, z")
    return rotation_from_quaternion(q)


def rotation_from_rodrigues(k: Vec) -> Matrix:
    """Return the rotation of the Rodrigues vector axis * tan(angle/2) (Heun no. 20)."""
    return rotation_from_quaternion((1.0, *k))


def rotation_from_euler(angles: Vec, sequence: str) -> Matrix:
    """Return the rotation of turns about moving axes: zyx is about z, then the new y, then the new x. Raises
    Finding.
    """
    if (
        len(sequence) != 3
        or not set(sequence) <= set("xyz")
        or sequence[0] == sequence[1]
        or sequence[1] == sequence[2]
    ):
        hint = "three of the letters x, y, z, no two neighbours equal: zyx (yaw, pitch, roll), zxz, ..."
        raise Finding("orientation", f"'{sequence}' is not a sequence of axes", hint)
    R = IDENTITY
    for letter, angle in zip(sequence, angles, strict=True):
        R = matrix_product(R, rotation_about(IDENTITY["xyz".index(letter)], angle))
    return R


def rotation_from_matrix(m: Matrix) -> Matrix:
    """Return the rotation that a matrix written with a few digits means. Raises Finding."""
    columns = tuple(zip(*m, strict=True))
    deviation = max(
        abs(sum(columns[i][k] * columns[j][k] for k in range(3)) - (1.0 if i == j else 0.0))
        for i in range(3)
        for j in range(3)
    )
    determinant = sum(a * b for a, b in zip(cross_product(m[0], m[1]), m[2], strict=True))
    if deviation > tolerances.UNIT_TYPED or determinant < 0.0:
        is_skewed = deviation > tolerances.UNIT_TYPED
        reason = "its columns are not perpendicular and of length 1" if is_skewed else "it is a reflection"
        raise Finding(
            "orientation", f"the matrix is not a rotation: {reason}", "columns are the body's axes in world axes"
        )
    return m if deviation <= tolerances.UNIT_EXACT else rotation_from_quaternion(quaternion_from_rotation(m))


def quaternion_from_rotation(R: Matrix) -> tuple[float, float, float, float]:
    """Return the quaternion of a rotation from its largest component (Shepperd); tolerates a matrix that is nearly a
    rotation.
    """
    t = R[0][0] + R[1][1] + R[2][2]
    squares = (1.0 + t, 1.0 + 2.0 * R[0][0] - t, 1.0 + 2.0 * R[1][1] - t, 1.0 + 2.0 * R[2][2] - t)
    k = squares.index(max(squares))
    s = math.sqrt(squares[k])
    f = 0.5 / s
    a, b, c = (R[2][1] - R[1][2]) * f, (R[0][2] - R[2][0]) * f, (R[1][0] - R[0][1]) * f
    d, e, g = (R[1][0] + R[0][1]) * f, (R[2][0] + R[0][2]) * f, (R[2][1] + R[1][2]) * f
    h = 0.5 * s
    return ((h, a, b, c), (a, h, d, e), (b, d, h, g), (c, e, g, h))[k]


def symmetric_eigenvalues(m: Matrix) -> Vec:
    """Return the eigenvalues of a symmetric matrix, ascending (Jacobi rotations, which keep small ones accurate)."""
    a = [list(row) for row in m]
    for _ in range(30):
        if a[0][1] == a[0][2] == a[1][2] == 0.0:
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if a[p][q] == 0.0:
                continue
            theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q]
            t = math.copysign(1.0, theta) / (abs(theta) + math.hypot(theta, 1.0))
            c = 1.0 / math.sqrt(t * t + 1.0)
            s = t * c
            r = 3 - p - q
            apq, arp, arq = a[p][q], a[r][p], a[r][q]
            a[p][p] -= t * apq
            a[q][q] += t * apq
            a[p][q] = a[q][p] = 0.0
            a[r][p] = a[p][r] = c * arp - s * arq
            a[r][q] = a[q][r] = s * arp + c * arq
    x, y, z = sorted((a[0][0], a[1][1], a[2][2]))
    return x, y, z
