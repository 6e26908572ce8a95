"""Three-dimensional vectors and matrices as values: operations return new values and change nothing.

Compiled, these are structs and inlined functions, which cost no calls. Components are in world axes unless a matrix has
rotated them.
"""

from __future__ import annotations

from math import cos, sin, sqrt

from heuncli.kernel.structs import Value


class Vec3(Value):
    """A vector."""

    x: float
    y: float
    z: float


class Mat3(Value):
    """A 3x3 matrix; the first letter of a component is the row, the second the column."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float


class Sym3(Value):
    """A symmetric 3x3 matrix."""

    xx: float
    xy: float
    xz: float
    yy: float
    yz: float
    zz: float


class Ldl3(Value):
    """Factors A = L D L' of a symmetric matrix: L below its unit diagonal, and the inverse of D."""

    yx: float
    zx: float
    zy: float
    xx: float
    yy: float
    zz: float


class Quaternion(Value):
    """An attitude as a quaternion, which need not have unit length."""

    w: float
    x: float
    y: float
    z: float


# --- vectors


def add(a: Vec3, b: Vec3) -> Vec3:
    """a + b."""
    return Vec3(a.x + b.x, a.y + b.y, a.z + b.z)


def sub(a: Vec3, b: Vec3) -> Vec3:
    """a - b."""
    return Vec3(a.x - b.x, a.y - b.y, a.z - b.z)


def scale_vector(s: float, a: Vec3) -> Vec3:
    """s a."""
    return Vec3(s * a.x, s * a.y, s * a.z)


def add_scaled(a: Vec3, s: float, b: Vec3) -> Vec3:
    """a + s b."""
    return Vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z)


def dot(a: Vec3, b: Vec3) -> float:
    """a . b"""
    return a.x * b.x + a.y * b.y + a.z * b.z


def cross(a: Vec3, b: Vec3) -> Vec3:
    """a x b."""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def add_cross(a: Vec3, b: Vec3, c: Vec3) -> Vec3:
    """a + b x c."""
    return Vec3(
        a.x + b.y * c.z - b.z * c.y,
        a.y + b.z * c.x - b.x * c.z,
        a.z + b.x * c.y - b.y * c.x,
    )


def norm(a: Vec3) -> float:
    """|a|."""
    return sqrt(a.x * a.x + a.y * a.y + a.z * a.z)


def centripetal(omega: Vec3, x: Vec3) -> Vec3:
    """omega x (omega x x) = (omega . x) omega - omega^2 x."""
    along: float = omega.x * x.x + omega.y * x.y + omega.z * x.z
    square: float = omega.x * omega.x + omega.y * omega.y + omega.z * omega.z
    return Vec3(along * omega.x - square * x.x, along * omega.y - square * x.y, along * omega.z - square * x.z)


# --- matrices


def rotate(M: Mat3, a: Vec3) -> Vec3:
    """M a."""
    return Vec3(
        M.xx * a.x + M.xy * a.y + M.xz * a.z,
        M.yx * a.x + M.yy * a.y + M.yz * a.z,
        M.zx * a.x + M.zy * a.y + M.zz * a.z,
    )


def rotate_back(M: Mat3, a: Vec3) -> Vec3:
    """M' a: if M is an attitude, the components of a in the body's axes."""
    return Vec3(
        M.xx * a.x + M.yx * a.y + M.zx * a.z,
        M.xy * a.x + M.yy * a.y + M.zy * a.z,
        M.xz * a.x + M.yz * a.y + M.zz * a.z,
    )


def product(A: Mat3, B: Mat3) -> Mat3:
    """A B."""
    return Mat3(
        A.xx * B.xx + A.xy * B.yx + A.xz * B.zx,
        A.xx * B.xy + A.xy * B.yy + A.xz * B.zy,
        A.xx * B.xz + A.xy * B.yz + A.xz * B.zz,
        A.yx * B.xx + A.yy * B.yx + A.yz * B.zx,
        A.yx * B.xy + A.yy * B.yy + A.yz * B.zy,
        A.yx * B.xz + A.yy * B.yz + A.yz * B.zz,
        A.zx * B.xx + A.zy * B.yx + A.zz * B.zx,
        A.zx * B.xy + A.zy * B.yy + A.zz * B.zy,
        A.zx * B.xz + A.zy * B.yz + A.zz * B.zz,
    )


def add_matrix(A: Mat3, B: Mat3) -> Mat3:
    """A + B."""
    return Mat3(
        A.xx + B.xx,
        A.xy + B.xy,
        A.xz + B.xz,
        A.yx + B.yx,
        A.yy + B.yy,
        A.yz + B.yz,
        A.zx + B.zx,
        A.zy + B.zy,
        A.zz + B.zz,
    )


def sub_dyad(A: Mat3, a: Vec3, b: Vec3) -> Mat3:
    """A - a b'."""
    return Mat3(
        A.xx - a.x * b.x,
        A.xy - a.x * b.y,
        A.xz - a.x * b.z,
        A.yx - a.y * b.x,
        A.yy - a.y * b.y,
        A.yz - a.y * b.z,
        A.zx - a.z * b.x,
        A.zy - a.z * b.y,
        A.zz - a.z * b.z,
    )


def unit_matrix() -> Mat3:
    """Return the unit matrix."""
    return Mat3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def skew(a: Vec3) -> Mat3:
    """hat(a): hat(a) b = a x b."""
    return Mat3(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)


def rotation(n: Vec3, angle: float) -> Mat3:
    """Return the rotation matrix of an angle [rad] about the unit vector n."""
    s: float = sin(angle)
    c: float = cos(angle)
    m: float = 1.0 - c
    return Mat3(
        c + m * n.x * n.x,
        m * n.x * n.y - s * n.z,
        m * n.x * n.z + s * n.y,
        m * n.x * n.y + s * n.z,
        c + m * n.y * n.y,
        m * n.y * n.z - s * n.x,
        m * n.x * n.z - s * n.y,
        m * n.y * n.z + s * n.x,
        c + m * n.z * n.z,
    )


# --- symmetric matrices


def transform(S: Sym3, a: Vec3) -> Vec3:
    """S a."""
    return Vec3(
        S.xx * a.x + S.xy * a.y + S.xz * a.z,
        S.xy * a.x + S.yy * a.y + S.yz * a.z,
        S.xz * a.x + S.yz * a.y + S.zz * a.z,
    )


def add_transformed(b: Vec3, S: Sym3, a: Vec3) -> Vec3:
    """b + S a."""
    return Vec3(
        b.x + S.xx * a.x + S.xy * a.y + S.xz * a.z,
        b.y + S.xy * a.x + S.yy * a.y + S.yz * a.z,
        b.z + S.xz * a.x + S.yz * a.y + S.zz * a.z,
    )


def trace(S: Sym3) -> float:
    """Return the sum of the diagonal."""
    return S.xx + S.yy + S.zz


def scaled_unit_matrix(m: float) -> Sym3:
    """m times the unit matrix."""
    return Sym3(m, 0.0, 0.0, m, 0.0, m)


def add_symmetric(A: Sym3, B: Sym3) -> Sym3:
    """A + B."""
    return Sym3(A.xx + B.xx, A.xy + B.xy, A.xz + B.xz, A.yy + B.yy, A.yz + B.yz, A.zz + B.zz)


def add_symmetric_part(A: Sym3, X: Mat3) -> Sym3:
    """A + X + X'."""
    return Sym3(
        A.xx + 2.0 * X.xx,
        A.xy + X.xy + X.yx,
        A.xz + X.xz + X.zx,
        A.yy + 2.0 * X.yy,
        A.yz + X.yz + X.zy,
        A.zz + 2.0 * X.zz,
    )


def sub_square(S: Sym3, a: Vec3, b: Vec3) -> Sym3:
    """S - a b' for parallel a and b."""
    return Sym3(
        S.xx - a.x * b.x, S.xy - a.x * b.y, S.xz - a.x * b.z, S.yy - a.y * b.y, S.yz - a.y * b.z, S.zz - a.z * b.z
    )


def sub_product(S: Sym3, C: Mat3, G: Mat3) -> Sym3:
    """S - C' G, where C' G is symmetric."""
    return Sym3(
        S.xx - (C.xx * G.xx + C.yx * G.yx + C.zx * G.zx),
        S.xy - (C.xx * G.xy + C.yx * G.yy + C.zx * G.zy),
        S.xz - (C.xx * G.xz + C.yx * G.yz + C.zx * G.zz),
        S.yy - (C.xy * G.xy + C.yy * G.yy + C.zy * G.zy),
        S.yz - (C.xy * G.xz + C.yy * G.yz + C.zy * G.zz),
        S.zz - (C.xz * G.xz + C.yz * G.yz + C.zz * G.zz),
    )


def rotate_tensor(R: Mat3, J: Sym3) -> Sym3:
    """R J R': a tensor's components after the rotation R."""
    xx: float = R.xx * J.xx + R.xy * J.xy + R.xz * J.xz
    xy: float = R.xx * J.xy + R.xy * J.yy + R.xz * J.yz
    xz: float = R.xx * J.xz + R.xy * J.yz + R.xz * J.zz
    yx: float = R.yx * J.xx + R.yy * J.xy + R.yz * J.xz
    yy: float = R.yx * J.xy + R.yy * J.yy + R.yz * J.yz
    yz: float = R.yx * J.xz + R.yy * J.yz + R.yz * J.zz
    zx: float = R.zx * J.xx + R.zy * J.xy + R.zz * J.xz
    zy: float = R.zx * J.xy + R.zy * J.yy + R.zz * J.yz
    zz: float = R.zx * J.xz + R.zy * J.yz + R.zz * J.zz
    return Sym3(
        xx * R.xx + xy * R.xy + xz * R.xz,
        xx * R.yx + xy * R.yy + xz * R.yz,
        xx * R.zx + xy * R.zy + xz * R.zz,
        yx * R.yx + yy * R.yy + yz * R.yz,
        yx * R.zx + yy * R.zy + yz * R.zz,
        zx * R.zx + zy * R.zy + zz * R.zz,
    )


# --- levers


def lever_rows(l: Vec3, M: Mat3) -> Mat3:
    """M hat(l)': each row of M becomes l x row."""
    return Mat3(
        l.y * M.xz - l.z * M.xy,
        l.z * M.xx - l.x * M.xz,
        l.x * M.xy - l.y * M.xx,
        l.y * M.yz - l.z * M.yy,
        l.z * M.yx - l.x * M.yz,
        l.x * M.yy - l.y * M.yx,
        l.y * M.zz - l.z * M.zy,
        l.z * M.zx - l.x * M.zz,
        l.x * M.zy - l.y * M.zx,
    )


def lever(l: Vec3, K: Sym3) -> Mat3:
    """hat(l) K: the moments of the forces K a that act at the lever l."""
    return Mat3(
        l.y * K.xz - l.z * K.xy,
        l.y * K.yz - l.z * K.yy,
        l.y * K.zz - l.z * K.yz,
        l.z * K.xx - l.x * K.xz,
        l.z * K.xy - l.x * K.yz,
        l.z * K.xz - l.x * K.zz,
        l.x * K.xy - l.y * K.xx,
        l.x * K.yy - l.y * K.xy,
        l.x * K.yz - l.y * K.xz,
    )


def both_levers(l: Vec3, lK: Mat3) -> Sym3:
    """hat(l) K hat(l)', from hat(l) K."""
    return Sym3(
        l.y * lK.xz - l.z * lK.xy,
        l.z * lK.xx - l.x * lK.xz,
        l.x * lK.xy - l.y * lK.xx,
        l.z * lK.yx - l.x * lK.yz,
        l.x * lK.yy - l.y * lK.yx,
        l.x * lK.zy - l.y * lK.zx,
    )


# --- factors of a symmetric matrix


def factor(A: Sym3, min_pivot: float) -> Ldl3:
    """Factor A = L D L' and return L with the inverse of D, which is all zero if a pivot does not exceed `min_pivot`.

    A is not inverted: the inverse of a nearly thin rod's inertia loses digits in all directions.
    """
    d1: float = A.xx
    u1: float = 1.0 / d1 if d1 > min_pivot else 0.0
    l21: float = A.xy * u1
    l31: float = A.xz * u1
    d2: float = A.yy - A.xy * l21
    u2: float = 1.0 / d2 if d2 > min_pivot else 0.0
    w: float = A.yz - A.xz * l21
    l32: float = w * u2
    d3: float = A.zz - (A.xz * l31 + w * l32)
    if u1 > 0.0 and u2 > 0.0 and d3 > min_pivot:
        return Ldl3(l21, l31, l32, u1, u2, 1.0 / d3)
    return Ldl3(l21, l31, l32, 0.0, 0.0, 0.0)


def solve(F: Ldl3, b: Vec3) -> Vec3:
    """A^-1 b."""
    y: float = b.y - F.yx * b.x
    z: float = (b.z - F.zx * b.x - F.zy * y) * F.zz
    y = y * F.yy - F.zy * z
    return Vec3(b.x * F.xx - F.yx * y - F.zx * z, y, z)


def solve_columns(F: Ldl3, C: Mat3) -> Mat3:
    """A^-1 C."""
    a: Vec3 = solve(F, Vec3(C.xx, C.yx, C.zx))
    b: Vec3 = solve(F, Vec3(C.xy, C.yy, C.zy))
    c: Vec3 = solve(F, Vec3(C.xz, C.yz, C.zz))
    return Mat3(a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z)


def inverse_form(F: Ldl3, b: Vec3) -> float:
    """b' A^-1 b."""
    y: float = b.y - F.yx * b.x
    z: float = b.z - (F.zx * b.x + F.zy * y)
    return b.x * b.x * F.xx + y * y * F.yy + z * z * F.zz


def inverse_diagonal_roots(F: Ldl3) -> Vec3:
    """D^(-1/2)."""
    return Vec3(sqrt(F.xx), sqrt(F.yy), sqrt(F.zz))


def half_solve(F: Ldl3, r: Vec3, b: Vec3) -> Vec3:
    """D^(-1/2) L^-1 b with r = D^(-1/2); the square of the result is b' A^-1 b."""
    y: float = b.y - F.yx * b.x
    return Vec3(r.x * b.x, r.y * y, r.z * (b.z - F.zx * b.x - F.zy * y))


def undo_half_solve(F: Ldl3, r: Vec3, x: Vec3) -> Vec3:
    """L D^(1/2) x: the inverse of half_solve."""
    a: float = x.x / r.x
    b: float = x.y / r.y
    return Vec3(a, F.yx * a + b, F.zx * a + F.zy * b + x.z / r.z)


# --- attitudes as quaternions


def rotation_matrix(q: Quaternion) -> Mat3:
    """Return the rotation matrix, body to world, of a quaternion of any length but zero."""
    g: float = 2.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z)
    return Mat3(
        1.0 - g * (q.y * q.y + q.z * q.z),
        g * (q.x * q.y - q.w * q.z),
        g * (q.x * q.z + q.w * q.y),
        g * (q.x * q.y + q.w * q.z),
        1.0 - g * (q.x * q.x + q.z * q.z),
        g * (q.y * q.z - q.w * q.x),
        g * (q.x * q.z - q.w * q.y),
        g * (q.y * q.z + q.w * q.x),
        1.0 - g * (q.x * q.x + q.y * q.y),
    )


def quaternion_rate(q: Quaternion, omega: Vec3) -> Quaternion:
    """dq/dt = (0, omega) q / 2, omega in world axes: (40) of Euler's parameters, solved for their rates."""
    u: float = 0.5 * omega.x
    v: float = 0.5 * omega.y
    w: float = 0.5 * omega.z
    return Quaternion(
        -u * q.x - v * q.y - w * q.z,
        u * q.w + v * q.z - w * q.y,
        v * q.w + w * q.x - u * q.z,
        w * q.w + u * q.y - v * q.x,
    )


def apply_small_rotation(q: Quaternion, rotation_vector: Vec3) -> Quaternion:
    """q + (0, rotation_vector) q / 2: q after a small rotation, exact to first order."""
    u: float = 0.5 * rotation_vector.x
    v: float = 0.5 * rotation_vector.y
    w: float = 0.5 * rotation_vector.z
    return Quaternion(
        q.w - u * q.x - v * q.y - w * q.z,
        q.x + u * q.w + v * q.z - w * q.y,
        q.y + v * q.w + w * q.x - u * q.z,
        q.z + w * q.w + u * q.y - v * q.x,
    )
