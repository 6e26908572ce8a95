# Made of algebra.py by headers.py.

from libc.math cimport cos, sin, sqrt

cdef struct Vec3:
    double x
    double y
    double z
cdef struct Mat3:
    double xx
    double xy
    double xz
    double yx
    double yy
    double yz
    double zx
    double zy
    double zz
cdef struct Sym3:
    double xx
    double xy
    double xz
    double yy
    double yz
    double zz
cdef struct Ldl3:
    double yx
    double zx
    double zy
    double xx
    double yy
    double zz
cdef struct Quaternion:
    double w
    double x
    double y
    double z

cdef inline Vec3 add(Vec3 a, Vec3 b) noexcept nogil:
    return Vec3(a.x + b.x, a.y + b.y, a.z + b.z)

cdef inline Vec3 sub(Vec3 a, Vec3 b) noexcept nogil:
    return Vec3(a.x - b.x, a.y - b.y, a.z - b.z)

cdef inline Vec3 scaled(double s, Vec3 a) noexcept nogil:
    return Vec3(s * a.x, s * a.y, s * a.z)

cdef inline Vec3 add_scaled(Vec3 a, double s, Vec3 b) noexcept nogil:
    return Vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z)

cdef inline double dot(Vec3 a, Vec3 b) noexcept nogil:
    return a.x * b.x + a.y * b.y + a.z * b.z

cdef inline Vec3 cross(Vec3 a, Vec3 b) noexcept nogil:
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)

cdef inline Vec3 add_cross(Vec3 a, Vec3 b, Vec3 c) noexcept nogil:
    return Vec3(a.x + b.y * c.z - b.z * c.y, a.y + b.z * c.x - b.x * c.z, a.z + b.x * c.y - b.y * c.x)

cdef inline double norm(Vec3 a) noexcept nogil:
    return sqrt(a.x * a.x + a.y * a.y + a.z * a.z)

cdef inline Vec3 centripetal(Vec3 omega, Vec3 x) noexcept nogil:
    cdef double along = omega.x * x.x + omega.y * x.y + omega.z * x.z
    cdef double square = omega.x * omega.x + omega.y * omega.y + omega.z * omega.z
    return Vec3(along * omega.x - square * x.x, along * omega.y - square * x.y, along * omega.z - square * x.z)

cdef inline Vec3 rotate(Mat3 M, Vec3 a) noexcept nogil:
    return Vec3(M.xx * a.x + M.xy * a.y + M.xz * a.z, M.yx * a.x + M.yy * a.y + M.yz * a.z, M.zx * a.x + M.zy * a.y + M.zz * a.z)

cdef inline Vec3 rotate_back(Mat3 M, Vec3 a) noexcept nogil:
    return Vec3(M.xx * a.x + M.yx * a.y + M.zx * a.z, M.xy * a.x + M.yy * a.y + M.zy * a.z, M.xz * a.x + M.yz * a.y + M.zz * a.z)

cdef inline Mat3 product(Mat3 A, Mat3 B) noexcept nogil:
    return Mat3(A.xx * B.xx + A.xy * B.yx + A.xz * B.zx, A.xx * B.xy + A.xy * B.yy + A.xz * B.zy, A.xx * B.xz + A.xy * B.yz + A.xz * B.zz, A.yx * B.xx + A.yy * B.yx + A.yz * B.zx, A.yx * B.xy + A.yy * B.yy + A.yz * B.zy, A.yx * B.xz + A.yy * B.yz + A.yz * B.zz, A.zx * B.xx + A.zy * B.yx + A.zz * B.zx, A.zx * B.xy + A.zy * B.yy + A.zz * B.zy, A.zx * B.xz + A.zy * B.yz + A.zz * B.zz)

cdef inline Mat3 add_matrix(Mat3 A, Mat3 B) noexcept nogil:
    return Mat3(A.xx + B.xx, A.xy + B.xy, A.xz + B.xz, A.yx + B.yx, A.yy + B.yy, A.yz + B.yz, A.zx + B.zx, A.zy + B.zy, A.zz + B.zz)

cdef inline Mat3 sub_dyad(Mat3 A, Vec3 a, Vec3 b) noexcept nogil:
    return Mat3(A.xx - a.x * b.x, A.xy - a.x * b.y, A.xz - a.x * b.z, A.yx - a.y * b.x, A.yy - a.y * b.y, A.yz - a.y * b.z, A.zx - a.z * b.x, A.zy - a.z * b.y, A.zz - a.z * b.z)

cdef inline Mat3 unit_matrix() noexcept nogil:
    return Mat3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)

cdef inline Mat3 skew(Vec3 a) noexcept nogil:
    return Mat3(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)

cdef inline Mat3 rotation(Vec3 n, double angle) noexcept nogil:
    cdef double s = sin(angle)
    cdef double c = cos(angle)
    cdef double m = 1.0 - c
    return Mat3(c + m * n.x * n.x, m * n.x * n.y - s * n.z, m * n.x * n.z + s * n.y, m * n.x * n.y + s * n.z, c + m * n.y * n.y, m * n.y * n.z - s * n.x, m * n.x * n.z - s * n.y, m * n.y * n.z + s * n.x, c + m * n.z * n.z)

cdef inline Vec3 transform(Sym3 S, Vec3 a) noexcept nogil:
    return Vec3(S.xx * a.x + S.xy * a.y + S.xz * a.z, S.xy * a.x + S.yy * a.y + S.yz * a.z, S.xz * a.x + S.yz * a.y + S.zz * a.z)

cdef inline Vec3 add_transformed(Vec3 b, Sym3 S, Vec3 a) noexcept nogil:
    return Vec3(b.x + S.xx * a.x + S.xy * a.y + S.xz * a.z, b.y + S.xy * a.x + S.yy * a.y + S.yz * a.z, b.z + S.xz * a.x + S.yz * a.y + S.zz * a.z)

cdef inline double trace(Sym3 S) noexcept nogil:
    return S.xx + S.yy + S.zz

cdef inline Sym3 multiple_of_unit(double m) noexcept nogil:
    return Sym3(m, 0.0, 0.0, m, 0.0, m)

cdef inline Sym3 add_symmetric(Sym3 A, Sym3 B) noexcept nogil:
    return Sym3(A.xx + B.xx, A.xy + B.xy, A.xz + B.xz, A.yy + B.yy, A.yz + B.yz, A.zz + B.zz)

cdef inline Sym3 add_both(Sym3 A, Mat3 X) noexcept nogil:
    return Sym3(A.xx + 2.0 * X.xx, A.xy + X.xy + X.yx, A.xz + X.xz + X.zx, A.yy + 2.0 * X.yy, A.yz + X.yz + X.zy, A.zz + 2.0 * X.zz)

cdef inline Sym3 sub_square(Sym3 S, Vec3 a, Vec3 b) noexcept nogil:
    return Sym3(S.xx - a.x * b.x, S.xy - a.x * b.y, S.xz - a.x * b.z, S.yy - a.y * b.y, S.yz - a.y * b.z, S.zz - a.z * b.z)

cdef inline Sym3 sub_product(Sym3 S, Mat3 C, Mat3 G) noexcept nogil:
    return Sym3(S.xx - (C.xx * G.xx + C.yx * G.yx + C.zx * G.zx), S.xy - (C.xx * G.xy + C.yx * G.yy + C.zx * G.zy), S.xz - (C.xx * G.xz + C.yx * G.yz + C.zx * G.zz), S.yy - (C.xy * G.xy + C.yy * G.yy + C.zy * G.zy), S.yz - (C.xy * G.xz + C.yy * G.yz + C.zy * G.zz), S.zz - (C.xz * G.xz + C.yz * G.yz + C.zz * G.zz))

cdef inline Sym3 turned(Mat3 R, Sym3 J) noexcept nogil:
    cdef double xx = R.xx * J.xx + R.xy * J.xy + R.xz * J.xz
    cdef double xy = R.xx * J.xy + R.xy * J.yy + R.xz * J.yz
    cdef double xz = R.xx * J.xz + R.xy * J.yz + R.xz * J.zz
    cdef double yx = R.yx * J.xx + R.yy * J.xy + R.yz * J.xz
    cdef double yy = R.yx * J.xy + R.yy * J.yy + R.yz * J.yz
    cdef double yz = R.yx * J.xz + R.yy * J.yz + R.yz * J.zz
    cdef double zx = R.zx * J.xx + R.zy * J.xy + R.zz * J.xz
    cdef double zy = R.zx * J.xy + R.zy * J.yy + R.zz * J.yz
    cdef double zz = R.zx * J.xz + R.zy * J.yz + R.zz * J.zz
    return Sym3(xx * R.xx + xy * R.xy + xz * R.xz, xx * R.yx + xy * R.yy + xz * R.yz, xx * R.zx + xy * R.zy + xz * R.zz, yx * R.yx + yy * R.yy + yz * R.yz, yx * R.zx + yy * R.zy + yz * R.zz, zx * R.zx + zy * R.zy + zz * R.zz)

cdef inline Mat3 lever_rows(Vec3 l, Mat3 M) noexcept nogil:
    return Mat3(l.y * M.xz - l.z * M.xy, l.z * M.xx - l.x * M.xz, l.x * M.xy - l.y * M.xx, l.y * M.yz - l.z * M.yy, l.z * M.yx - l.x * M.yz, l.x * M.yy - l.y * M.yx, l.y * M.zz - l.z * M.zy, l.z * M.zx - l.x * M.zz, l.x * M.zy - l.y * M.zx)

cdef inline Mat3 lever(Vec3 l, Sym3 K) noexcept nogil:
    return Mat3(l.y * K.xz - l.z * K.xy, l.y * K.yz - l.z * K.yy, l.y * K.zz - l.z * K.yz, l.z * K.xx - l.x * K.xz, l.z * K.xy - l.x * K.yz, l.z * K.xz - l.x * K.zz, l.x * K.xy - l.y * K.xx, l.x * K.yy - l.y * K.xy, l.x * K.yz - l.y * K.xz)

cdef inline Sym3 both_levers(Vec3 l, Mat3 lK) noexcept nogil:
    return Sym3(l.y * lK.xz - l.z * lK.xy, l.z * lK.xx - l.x * lK.xz, l.x * lK.xy - l.y * lK.xx, l.z * lK.yx - l.x * lK.yz, l.x * lK.yy - l.y * lK.yx, l.x * lK.zy - l.y * lK.zx)

cdef inline Ldl3 factor(Sym3 A, double least) noexcept nogil:
    cdef double d1 = A.xx
    cdef double u1 = 1.0 / d1 if d1 > least else 0.0
    cdef double l21 = A.xy * u1
    cdef double l31 = A.xz * u1
    cdef double d2 = A.yy - A.xy * l21
    cdef double u2 = 1.0 / d2 if d2 > least else 0.0
    cdef double w = A.yz - A.xz * l21
    cdef double l32 = w * u2
    cdef double d3 = A.zz - (A.xz * l31 + w * l32)
    if u1 > 0.0 and u2 > 0.0 and (d3 > least):
        return Ldl3(l21, l31, l32, u1, u2, 1.0 / d3)
    return Ldl3(l21, l31, l32, 0.0, 0.0, 0.0)

cdef inline Vec3 solve(Ldl3 F, Vec3 b) noexcept nogil:
    cdef double y = b.y - F.yx * b.x
    cdef double z = (b.z - F.zx * b.x - F.zy * y) * F.zz
    y = y * F.yy - F.zy * z
    return Vec3(b.x * F.xx - F.yx * y - F.zx * z, y, z)

cdef inline Mat3 solve_columns(Ldl3 F, Mat3 C) noexcept nogil:
    cdef Vec3 a = solve(F, Vec3(C.xx, C.yx, C.zx))
    cdef Vec3 b = solve(F, Vec3(C.xy, C.yy, C.zy))
    cdef Vec3 c = solve(F, Vec3(C.xz, C.yz, C.zz))
    return Mat3(a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z)

cdef inline double inverse_form(Ldl3 F, Vec3 b) noexcept nogil:
    cdef double y = b.y - F.yx * b.x
    cdef double z = b.z - (F.zx * b.x + F.zy * y)
    return b.x * b.x * F.xx + y * y * F.yy + z * z * F.zz

cdef inline Vec3 roots(Ldl3 F) noexcept nogil:
    return Vec3(sqrt(F.xx), sqrt(F.yy), sqrt(F.zz))

cdef inline Vec3 half_solve(Ldl3 F, Vec3 r, Vec3 b) noexcept nogil:
    cdef double y = b.y - F.yx * b.x
    return Vec3(r.x * b.x, r.y * y, r.z * (b.z - F.zx * b.x - F.zy * y))

cdef inline Vec3 from_half(Ldl3 F, Vec3 r, Vec3 x) noexcept nogil:
    cdef double a = x.x / r.x
    cdef double b = x.y / r.y
    return Vec3(a, F.yx * a + b, F.zx * a + F.zy * b + x.z / r.z)

cdef inline Mat3 attitude(Quaternion q) noexcept nogil:
    cdef double g = 2.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z)
    return Mat3(1.0 - g * (q.y * q.y + q.z * q.z), g * (q.x * q.y - q.w * q.z), g * (q.x * q.z + q.w * q.y), g * (q.x * q.y + q.w * q.z), 1.0 - g * (q.x * q.x + q.z * q.z), g * (q.y * q.z - q.w * q.x), g * (q.x * q.z - q.w * q.y), g * (q.y * q.z + q.w * q.x), 1.0 - g * (q.x * q.x + q.y * q.y))

cdef inline Quaternion quaternion_rate(Quaternion q, Vec3 omega) noexcept nogil:
    cdef double u = 0.5 * omega.x
    cdef double v = 0.5 * omega.y
    cdef double w = 0.5 * omega.z
    return Quaternion(-u * q.x - v * q.y - w * q.z, u * q.w + v * q.z - w * q.y, v * q.w + w * q.x - u * q.z, w * q.w + u * q.y - v * q.x)

cdef inline Quaternion slightly_turned(Quaternion q, Vec3 turn) noexcept nogil:
    cdef double u = 0.5 * turn.x
    cdef double v = 0.5 * turn.y
    cdef double w = 0.5 * turn.z
    return Quaternion(q.w - u * q.x - v * q.y - w * q.z, q.x + u * q.w + v * q.z - w * q.y, q.y + v * q.w + w * q.x - u * q.z, q.z + w * q.w + u * q.y - v * q.x)

