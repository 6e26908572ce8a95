"""Trees of bodies: kinematics, and the sweep that factors the mass matrix and solves with it, O(n).

    [n; f] = [A C; C' K] [alpha; a] + [d; b]      what the joint must exert on the branch from body i outward, about
                                                  the body's own joint point r; world axes throughout
A free direction s (a unit turn or a unit shift) is eliminated by U = I s, D = s.U, I <- I - U U'/D; a ball's three turns
at once, A = L D L', G = A^-1 C, after which neither A nor C is left and only K is handed on (Heun's absolute angular
velocities: the state of a ball is the attitude and the angular velocity of the body itself, not of the joint).
Gravity enters as the ground's acceleration -g, so `a` is throughout the acceleration less g.
Bodies come parents first. Flat arrays (built by tree/pack.py), no names, no exceptions:

I header   0 bodies 1 scalar freedoms 2 sweep freedoms 3 loads 4 rows 5 n_q 6 n_u 7 work (0/1) 8 work's place in the state
           10.. offsets: 10 bodies 11 freedoms 12 loads 13 rows 14 variables 15 number of variables
P          0-2 gravity 3 size 4 least pivot of the closures when their rows were chosen 5 now
           6 least of a step 7 below it the stages are settled too;  offsets in I: 16 bodies 17 freedoms 18 loads 19 rows
W          offsets in I: 20 bodies 21 freedoms 22 e (sweep freedoms) 23 loads 24 rows 25 scratch
body       I (8): 0 parent 1 ball 2 first freedom 3 freedoms 4 q (quaternion) 5 u 6 e 7 frame R_ref is not 1
           P (40): 0 mass 1-3 m c 4-9 J about r (xx xy xz yy yz zz) 10-12 joint point in the parent 13-21 R_ref
                   22-24 r in the body's own axes, from its origin
           W (80): 0 R 9 r 12 omega 15 v 18 arm 21 c_ang 24 c_lin 27 A|L,1/D 33 C|G 42 K 48 d 51 b 54 alpha 57 a 60 n_ext
                   63 f_ext 66 m c 69 n_joint 72 f_joint
freedom    I (8): 0 kind (0 turn, axis in the parent; 1 turn, axis in the body; 2 shift, direction in the parent) 1 q 2 u
                  3 driven 4 program start 5 count 6 e 7 body;   P (4): 0 direction
           W (16): 0 s 3 U 9 1/D 10 q 11 u 12 udot (driven: given; else solved) 13 driving load
load       I (16): 0 kind 1 a 2 b 3 in body axes 4-9 three programs;  P (16): 0 p 3 q 6 vector 9 stiffness 10 length
                  11 coefficient 12 axis 15 speed;  W (16): 0 F on b 3 M on b 6 its point 9 point on a 12 value 13 length
                  14 rate 15 power
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if cython.compiled:
    from cython.cimports.heuncli.kernel.program import jet, value
    from cython.cimports.libc.math import cos, sin, sqrt, tanh
else:
    from math import cos, sin, sqrt, tanh

    from heuncli.kernel.program import jet, value


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def cross(a: cython.p_double, i: cython.Py_ssize_t, b: cython.p_double, j: cython.Py_ssize_t, o: cython.p_double, k: cython.Py_ssize_t) -> cython.void:
    o[k] = a[i + 1] * b[j + 2] - a[i + 2] * b[j + 1]
    o[k + 1] = a[i + 2] * b[j] - a[i] * b[j + 2]
    o[k + 2] = a[i] * b[j + 1] - a[i + 1] * b[j]


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def turned(R: cython.p_double, i: cython.Py_ssize_t, b: cython.p_double, j: cython.Py_ssize_t, o: cython.p_double, k: cython.Py_ssize_t) -> cython.void:
    """o = R b."""
    o[k] = R[i] * b[j] + R[i + 1] * b[j + 1] + R[i + 2] * b[j + 2]
    o[k + 1] = R[i + 3] * b[j] + R[i + 4] * b[j + 1] + R[i + 5] * b[j + 2]
    o[k + 2] = R[i + 6] * b[j] + R[i + 7] * b[j + 1] + R[i + 8] * b[j + 2]


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def symmetric(A: cython.p_double, i: cython.Py_ssize_t, b: cython.p_double, j: cython.Py_ssize_t, o: cython.p_double, k: cython.Py_ssize_t) -> cython.void:
    """o = A b, A symmetric (xx xy xz yy yz zz)."""
    o[k] = A[i] * b[j] + A[i + 1] * b[j + 1] + A[i + 2] * b[j + 2]
    o[k + 1] = A[i + 1] * b[j] + A[i + 3] * b[j + 1] + A[i + 4] * b[j + 2]
    o[k + 2] = A[i + 2] * b[j] + A[i + 4] * b[j + 1] + A[i + 5] * b[j + 2]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, q0=cython.double, q1=cython.double, q2=cython.double, s=cython.double, c=cython.double, x=cython.double, y=cython.double, z=cython.double, m=cython.double)
def turn_right(W: cython.p_double, B: cython.Py_ssize_t, P: cython.p_double, n: cython.Py_ssize_t, angle: cython.double) -> cython.void:
    """R <- R Rot(n, angle), in place."""
    s = sin(angle)
    c = cos(angle)
    m = 1.0 - c
    x = P[n]
    y = P[n + 1]
    z = P[n + 2]
    for i in range(3):
        j = B + 3 * i
        q0 = W[j]
        q1 = W[j + 1]
        q2 = W[j + 2]
        W[j] = q0 * (c + m * x * x) + q1 * (m * x * y + s * z) + q2 * (m * x * z - s * y)
        W[j + 1] = q0 * (m * x * y - s * z) + q1 * (c + m * y * y) + q2 * (m * y * z + s * x)
        W[j + 2] = q0 * (m * x * z + s * y) + q1 * (m * y * z - s * x) + q2 * (c + m * z * z)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, F=cython.Py_ssize_t, f=cython.Py_ssize_t, p=cython.Py_ssize_t, c=cython.Py_ssize_t)
def coordinates(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double, y: cython.p_double, o: cython.Py_ssize_t) -> cython.void:
    """Coordinates, rates and prescribed accelerations of the scalar freedoms, and the variables of the expressions."""
    for i in range(I[1]):
        f = I[11] + 8 * i
        F = I[21] + 16 * i
        if I[f + 3]:
            jet(C, N, I[f + 4], I[f + 5], t, S, X)
            W[F + 10] = X[0] + P[I[17] + 4 * i + 3]
            W[F + 11] = X[1]
            W[F + 12] = X[2]
        else:
            W[F + 10] = y[o + I[f + 1]]
            W[F + 11] = y[o + I[f + 2]]
            W[F + 12] = 0.0
    X[0] = t
    for k in range(1, I[15]):
        p = I[14] + 2 * k
        c = I[p]
        X[k] = W[I[21] + 16 * c + 10 + I[p + 1]]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, j=cython.Py_ssize_t, F=cython.Py_ssize_t, B=cython.Py_ssize_t, Q=cython.Py_ssize_t, b=cython.Py_ssize_t, c=cython.Py_ssize_t, p=cython.Py_ssize_t, f=cython.Py_ssize_t, T=cython.Py_ssize_t, a00=cython.double, a01=cython.double, a02=cython.double, a10=cython.double, a11=cython.double, a12=cython.double, a20=cython.double, a21=cython.double, a22=cython.double, qw=cython.double, qx=cython.double, qy=cython.double, qz=cython.double, g=cython.double, u=cython.double)
def kinematics(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double, y: cython.p_double, o: cython.Py_ssize_t) -> cython.void:
    """Attitudes, joint points, velocities and velocity terms of all bodies from the state y[o:]; clears the loads."""
    T = I[25]
    if I[1] > 0 or I[15] > 1:
        coordinates(I, P, W, C, N, X, S, t, y, o)
    else:
        X[0] = t
    for i in range(I[0]):
        b = I[10] + 8 * i
        B = I[20] + 80 * i
        c = I[16] + 40 * i
        p = I[b]
        Q = I[20] + 80 * p
        # arm and velocity of the joint point, then the shifts
        if p >= 0:
            turned(W, Q, P, c + 10, W, B + 18)
        else:
            W[B + 18] = P[c + 10]
            W[B + 19] = P[c + 11]
            W[B + 20] = P[c + 12]
        W[T] = 0.0
        W[T + 1] = 0.0
        W[T + 2] = 0.0
        W[T + 3] = 0.0
        W[T + 4] = 0.0
        W[T + 5] = 0.0
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            f = I[11] + 8 * k
            if I[f] == 2:
                F = I[21] + 16 * k
                j = I[17] + 4 * k
                if p >= 0:
                    turned(W, Q, P, j, W, F)
                else:
                    W[F] = P[j]
                    W[F + 1] = P[j + 1]
                    W[F + 2] = P[j + 2]
                g = W[F + 10]
                W[B + 18] += g * W[F]
                W[B + 19] += g * W[F + 1]
                W[B + 20] += g * W[F + 2]
                u = W[F + 11]
                W[T] += u * W[F]
                W[T + 1] += u * W[F + 1]
                W[T + 2] += u * W[F + 2]
                u = W[F + 12]
                W[T + 3] += u * W[F]
                W[T + 4] += u * W[F + 1]
                W[T + 5] += u * W[F + 2]
        if p >= 0:
            cross(W, Q + 12, W, B + 18, W, T + 6)
            for k in range(3):
                W[B + 9 + k] = W[Q + 9 + k] + W[B + 18 + k]
                W[B + 15 + k] = W[Q + 15 + k] + W[T + 6 + k] + W[T + k]
                W[T + 6 + k] += 2.0 * W[T + k]
            cross(W, Q + 12, W, T + 6, W, B + 24)
            for k in range(3):
                W[B + 24 + k] += W[T + 3 + k]
        else:
            for k in range(3):
                W[B + 9 + k] = W[B + 18 + k]
                W[B + 15 + k] = W[T + k]
                W[B + 24 + k] = W[T + 3 + k]
        # attitude and angular velocity
        if I[b + 1]:
            j = o + I[b + 4]
            qw = y[j]
            qx = y[j + 1]
            qy = y[j + 2]
            qz = y[j + 3]
            g = 2.0 / (qw * qw + qx * qx + qy * qy + qz * qz)
            W[B] = 1.0 - g * (qy * qy + qz * qz)
            W[B + 1] = g * (qx * qy - qw * qz)
            W[B + 2] = g * (qx * qz + qw * qy)
            W[B + 3] = g * (qx * qy + qw * qz)
            W[B + 4] = 1.0 - g * (qx * qx + qz * qz)
            W[B + 5] = g * (qy * qz - qw * qx)
            W[B + 6] = g * (qx * qz - qw * qy)
            W[B + 7] = g * (qy * qz + qw * qx)
            W[B + 8] = 1.0 - g * (qx * qx + qy * qy)
            j = o + I[b + 5]
            W[B + 12] = y[j]
            W[B + 13] = y[j + 1]
            W[B + 14] = y[j + 2]
        else:
            if p >= 0:
                for k in range(9):
                    W[B + k] = W[Q + k]
                W[B + 12] = W[Q + 12]
                W[B + 13] = W[Q + 13]
                W[B + 14] = W[Q + 14]
            else:
                for k in range(9):
                    W[B + k] = 0.0
                W[B] = 1.0
                W[B + 4] = 1.0
                W[B + 8] = 1.0
                W[B + 12] = 0.0
                W[B + 13] = 0.0
                W[B + 14] = 0.0
            W[B + 21] = 0.0
            W[B + 22] = 0.0
            W[B + 23] = 0.0
            for k in range(I[b + 2], I[b + 2] + I[b + 3]):
                f = I[11] + 8 * k
                if I[f] == 0:
                    turn(W, B, P, I[17] + 4 * k, I[21] + 16 * k)
            if I[b + 7]:
                for k in range(3):
                    j = B + 3 * k
                    a00 = W[j]
                    a01 = W[j + 1]
                    a02 = W[j + 2]
                    W[j] = a00 * P[c + 13] + a01 * P[c + 16] + a02 * P[c + 19]
                    W[j + 1] = a00 * P[c + 14] + a01 * P[c + 17] + a02 * P[c + 20]
                    W[j + 2] = a00 * P[c + 15] + a01 * P[c + 18] + a02 * P[c + 21]
            for k in range(I[b + 2], I[b + 2] + I[b + 3]):
                f = I[11] + 8 * k
                if I[f] == 1:
                    turn(W, B, P, I[17] + 4 * k, I[21] + 16 * k)
        # inertia about the joint point, first moment, velocity terms, in world axes
        turned(W, B, P, c + 1, W, B + 66)
        qw = P[c + 4]
        qx = P[c + 5]
        qy = P[c + 6]
        qz = P[c + 7]
        g = P[c + 8]
        u = P[c + 9]
        a00 = W[B] * qw + W[B + 1] * qx + W[B + 2] * qy
        a01 = W[B] * qx + W[B + 1] * qz + W[B + 2] * g
        a02 = W[B] * qy + W[B + 1] * g + W[B + 2] * u
        a10 = W[B + 3] * qw + W[B + 4] * qx + W[B + 5] * qy
        a11 = W[B + 3] * qx + W[B + 4] * qz + W[B + 5] * g
        a12 = W[B + 3] * qy + W[B + 4] * g + W[B + 5] * u
        a20 = W[B + 6] * qw + W[B + 7] * qx + W[B + 8] * qy
        a21 = W[B + 6] * qx + W[B + 7] * qz + W[B + 8] * g
        a22 = W[B + 6] * qy + W[B + 7] * g + W[B + 8] * u
        W[B + 27] = a00 * W[B] + a01 * W[B + 1] + a02 * W[B + 2]
        W[B + 28] = a00 * W[B + 3] + a01 * W[B + 4] + a02 * W[B + 5]
        W[B + 29] = a00 * W[B + 6] + a01 * W[B + 7] + a02 * W[B + 8]
        W[B + 30] = a10 * W[B + 3] + a11 * W[B + 4] + a12 * W[B + 5]
        W[B + 31] = a10 * W[B + 6] + a11 * W[B + 7] + a12 * W[B + 8]
        W[B + 32] = a20 * W[B + 6] + a21 * W[B + 7] + a22 * W[B + 8]
        symmetric(W, B + 27, W, B + 12, W, T)
        cross(W, B + 12, W, T, W, B + 48)
        cross(W, B + 12, W, B + 66, W, T)
        cross(W, B + 12, W, T, W, B + 51)
        for k in range(60, 66):
            W[B + k] = 0.0


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(u=cython.double, x=cython.double, y=cython.double, z=cython.double)
def turn(W: cython.p_double, B: cython.Py_ssize_t, P: cython.p_double, j: cython.Py_ssize_t, F: cython.Py_ssize_t) -> cython.void:
    """A turn about an axis: its direction s, R <- R Rot, omega <- omega + s u, c_ang <- c_ang + omega x s u + s udot."""
    turned(W, B, P, j, W, F)
    u = W[F + 11]
    x = u * W[F]
    y = u * W[F + 1]
    z = u * W[F + 2]
    W[B + 21] += W[B + 13] * z - W[B + 14] * y + W[F + 12] * W[F]
    W[B + 22] += W[B + 14] * x - W[B + 12] * z + W[F + 12] * W[F + 1]
    W[B + 23] += W[B + 12] * y - W[B + 13] * x + W[F + 12] * W[F + 2]
    W[B + 12] += x
    W[B + 13] += y
    W[B + 14] += z
    turn_right(W, B, P, j, W[F + 10])


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(k=cython.Py_ssize_t, B=cython.Py_ssize_t)
def point(I: cython.p_int, P: cython.p_double, W: cython.p_double, b: cython.Py_ssize_t, q: cython.Py_ssize_t, x: cython.Py_ssize_t, v: cython.Py_ssize_t) -> cython.void:
    """World place W[x:x+3] and velocity W[v:v+3] of the point P[q:q+3] of body b (given from its joint point)."""
    if b < 0:
        for k in range(3):
            W[x + k] = P[q + k]
            W[v + k] = 0.0
    else:
        B = I[20] + 80 * b
        turned(W, B, P, q, W, x)
        cross(W, B + 12, W, x, W, v)
        for k in range(3):
            W[x + k] += W[B + 9 + k]
            W[v + k] += W[B + 15 + k]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(B=cython.Py_ssize_t, x=cython.double, y=cython.double, z=cython.double)
def push(I: cython.p_int, W: cython.p_double, b: cython.Py_ssize_t, X: cython.Py_ssize_t, F: cython.Py_ssize_t, M: cython.Py_ssize_t, sign: cython.double) -> cython.void:
    """Put sign * (force W[F], couple W[M]) at the world point W[X] on body b."""
    if b >= 0:
        B = I[20] + 80 * b
        x = W[X] - W[B + 9]
        y = W[X + 1] - W[B + 10]
        z = W[X + 2] - W[B + 11]
        W[B + 60] += sign * (W[M] + y * W[F + 2] - z * W[F + 1])
        W[B + 61] += sign * (W[M + 1] + z * W[F] - x * W[F + 2])
        W[B + 62] += sign * (W[M + 2] + x * W[F + 1] - y * W[F])
        W[B + 63] += sign * W[F]
        W[B + 64] += sign * W[F + 1]
        W[B + 65] += sign * W[F + 2]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, l=cython.Py_ssize_t, c=cython.Py_ssize_t, w=cython.Py_ssize_t, a=cython.Py_ssize_t, b=cython.Py_ssize_t, T=cython.Py_ssize_t, kind=cython.Py_ssize_t, F=cython.double, s=cython.double, r=cython.double, power=cython.double)
def loads(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double) -> cython.double:
    """Put all applied loads on the bodies; power of those that have no potential [W]."""
    power = 0.0
    T = I[25]
    for i in range(I[3]):
        l = I[12] + 16 * i
        c = I[18] + 16 * i
        w = I[23] + 16 * i
        kind = I[l]
        a = I[l + 1]
        b = I[l + 2]
        for k in range(6):
            W[w + k] = 0.0
        point(I, P, W, b, c + 3, w + 6, T + 3)
        for k in range(3):
            W[T + 6 + k] = P[c + 6 + k]
            if I[l + 5 + 2 * k]:
                W[T + 6 + k] = value(C, N, I[l + 4 + 2 * k], I[l + 5 + 2 * k], X, S)
        if kind <= 1:
            if I[l + 3]:
                turned(W, I[20] + 80 * b, W, T + 6, W, w + 3 * kind)
            else:
                for k in range(3):
                    W[w + 3 * kind + k] = W[T + 6 + k]
            k = w + 3 * kind
            W[w + 12] = sqrt(W[k] * W[k] + W[k + 1] * W[k + 1] + W[k + 2] * W[k + 2])
            if kind == 0:
                W[w + 15] = W[w] * W[T + 3] + W[w + 1] * W[T + 4] + W[w + 2] * W[T + 5]
            else:
                k = I[20] + 80 * b + 12
                W[w + 15] = W[w + 3] * W[k] + W[w + 4] * W[k + 1] + W[w + 5] * W[k + 2]
            power += W[w + 15]
            push(I, W, b, w + 6, w, w + 3, 1.0)
        elif kind <= 3:
            point(I, P, W, a, c, w + 9, T)
            r = 0.0
            s = 0.0
            for k in range(3):
                W[T + 9 + k] = W[w + 6 + k] - W[w + 9 + k]
                r += W[T + 9 + k] * W[T + 9 + k]
                s += W[T + 9 + k] * (W[T + 3 + k] - W[T + k])
            r = sqrt(r)
            if r > 0.0:
                s = s / r
            if kind == 2:
                F = -P[c + 9] * (r - P[c + 10]) - P[c + 11] * s
                power -= P[c + 11] * s * s
            else:
                F = W[T + 6]
                power += F * s
            W[w + 12] = F
            W[w + 13] = r
            W[w + 14] = s
            W[w + 15] = F * s
            if r > 0.0:
                for k in range(3):
                    W[w + k] = F * W[T + 9 + k] / r
            push(I, W, b, w + 6, w, w + 3, 1.0)
            push(I, W, a, w + 9, w, w + 3, -1.0)
        else:
            # between the two bodies of a joint: even kinds turn (4 torque, 6 damper, 8 friction), odd ones slide
            if a >= 0:
                turned(W, I[20] + 80 * a, P, c + 12, W, T + 9)
            else:
                for k in range(3):
                    W[T + 9 + k] = P[c + 12 + k]
            if kind % 2 == 0:
                for k in range(3):
                    W[T + k] = 0.0
                    if b >= 0:
                        W[T + k] = W[I[20] + 80 * b + 12 + k]
                    if a >= 0:
                        W[T + k] -= W[I[20] + 80 * a + 12 + k]
            elif a >= 0:
                for k in range(3):
                    W[T + k] = W[w + 6 + k] - W[I[20] + 80 * a + 9 + k]
                cross(W, I[20] + 80 * a + 12, W, T, W, T + 12)
                for k in range(3):
                    W[T + k] = W[T + 3 + k] - W[T + 12 + k] - W[I[20] + 80 * a + 15 + k]
            else:
                for k in range(3):
                    W[T + k] = W[T + 3 + k]
            k = w
            if kind % 2 == 0:
                k = w + 3
            s = W[T] * W[T + 9] + W[T + 1] * W[T + 10] + W[T + 2] * W[T + 11]
            if kind <= 5:
                F = W[T + 6]
                W[k] = F * W[T + 9]
                W[k + 1] = F * W[T + 10]
                W[k + 2] = F * W[T + 11]
                W[w + 12] = F
                W[w + 15] = F * s
            else:
                r = sqrt(W[T] * W[T] + W[T + 1] * W[T + 1] + W[T + 2] * W[T + 2])
                F = P[c + 11]
                if kind >= 8:
                    F = 0.0
                    if r > 0.0:
                        F = P[c + 11] * tanh(r / P[c + 15]) / r
                W[k] = -F * W[T]
                W[k + 1] = -F * W[T + 1]
                W[k + 2] = -F * W[T + 2]
                W[w + 12] = -F * r
                if I[l + 3]:
                    W[w + 12] = -F * s
                W[w + 15] = -F * r * r
            W[w + 14] = s
            power += W[w + 15]
            for k in range(3):
                W[w + 9 + k] = W[w + 6 + k]
            push(I, W, b, w + 6, w, w + 3, 1.0)
            push(I, W, a, w + 6, w, w + 3, -1.0)
    return power


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, Q=cython.Py_ssize_t, F=cython.Py_ssize_t, p=cython.Py_ssize_t, T=cython.Py_ssize_t, bad=cython.int, m=cython.double, x=cython.double, y=cython.double, z=cython.double, a=cython.double, c=cython.double, d=cython.double, e=cython.double, f=cython.double, g=cython.double, h=cython.double, D=cython.double, mass=cython.double, turning=cython.double)
def factor(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.int:
    """Articulated inertias from the tips to the roots, reduced by every freedom that is not driven; the number of freedoms with no inertia behind them."""
    T = I[25]
    bad = 0
    for i in range(I[0]):
        B = I[20] + 80 * i
        m = P[I[16] + 40 * i]
        x = W[B + 66]
        y = W[B + 67]
        z = W[B + 68]
        W[B + 33] = 0.0
        W[B + 34] = -z
        W[B + 35] = y
        W[B + 36] = z
        W[B + 37] = 0.0
        W[B + 38] = -x
        W[B + 39] = -y
        W[B + 40] = x
        W[B + 41] = 0.0
        W[B + 42] = m
        W[B + 43] = 0.0
        W[B + 44] = 0.0
        W[B + 45] = m
        W[B + 46] = 0.0
        W[B + 47] = m
    for i in range(I[0] - 1, -1, -1):
        B = I[20] + 80 * i
        b = I[10] + 8 * i
        p = I[b]
        # a freedom's inertia is nothing beside that before any freedom was taken out: what is left of it is rounding
        mass = 1e-14 * (W[B + 42] + W[B + 45] + W[B + 47])
        turning = 1e-14 * (W[B + 27] + W[B + 30] + W[B + 32])
        if I[b + 1]:
            # A = L D L', G = A^-1 C, K <- K - C' G; no inverse: a nearly thin rod's loses digits in all directions
            a = W[B + 27]
            c = W[B + 28]
            d = W[B + 29]
            e = W[B + 30]
            f = W[B + 31]
            g = W[B + 32]
            h = turning
            if a > h:
                a = 1.0 / a
            else:
                a = 0.0
            x = c * a
            y = d * a
            e -= c * x
            if e > h:
                e = 1.0 / e
            else:
                e = 0.0
            f -= d * x
            z = f * e
            g -= d * y + f * z
            if a > 0.0 and e > 0.0 and g > h:
                g = 1.0 / g
            else:
                a = 0.0
                e = 0.0
                g = 0.0
                bad += 1
            W[B + 27] = x
            W[B + 28] = y
            W[B + 29] = z
            W[B + 30] = a
            W[B + 31] = e
            W[B + 32] = g
            for j in range(3):
                c = W[B + 33 + j]
                d = W[B + 36 + j] - x * c
                f = (W[B + 39 + j] - y * c - z * d) * g
                d = d * e - z * f
                W[T + j] = c * a - x * d - y * f
                W[T + 3 + j] = d
                W[T + 6 + j] = f
            if p >= 0 or I[b + 3] > 0:
                W[B + 42] -= W[B + 33] * W[T] + W[B + 36] * W[T + 3] + W[B + 39] * W[T + 6]
                W[B + 43] -= W[B + 33] * W[T + 1] + W[B + 36] * W[T + 4] + W[B + 39] * W[T + 7]
                W[B + 44] -= W[B + 33] * W[T + 2] + W[B + 36] * W[T + 5] + W[B + 39] * W[T + 8]
                W[B + 45] -= W[B + 34] * W[T + 1] + W[B + 37] * W[T + 4] + W[B + 40] * W[T + 7]
                W[B + 46] -= W[B + 34] * W[T + 2] + W[B + 37] * W[T + 5] + W[B + 40] * W[T + 8]
                W[B + 47] -= W[B + 35] * W[T + 2] + W[B + 38] * W[T + 5] + W[B + 41] * W[T + 8]
            for j in range(9):
                W[B + 33 + j] = W[T + j]
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            j = I[11] + 8 * k
            F = I[21] + 16 * k
            if I[j + 3]:
                W[F + 9] = 0.0
                continue
            if I[j] == 2:
                symmetric(W, B + 42, W, F, W, F + 6)
                D = W[F] * W[F + 6] + W[F + 1] * W[F + 7] + W[F + 2] * W[F + 8]
                h = mass
                if I[b + 1]:
                    W[F + 3] = 0.0
                    W[F + 4] = 0.0
                    W[F + 5] = 0.0
                else:
                    turned(W, B + 33, W, F, W, F + 3)
            else:
                symmetric(W, B + 27, W, F, W, F + 3)
                D = W[F] * W[F + 3] + W[F + 1] * W[F + 4] + W[F + 2] * W[F + 5]
                h = turning
                x = W[F]
                y = W[F + 1]
                z = W[F + 2]
                W[F + 6] = W[B + 33] * x + W[B + 36] * y + W[B + 39] * z
                W[F + 7] = W[B + 34] * x + W[B + 37] * y + W[B + 40] * z
                W[F + 8] = W[B + 35] * x + W[B + 38] * y + W[B + 41] * z
            if D > h:
                D = 1.0 / D
            else:
                D = 0.0
                bad += 1
            W[F + 9] = D
            x = W[F + 6] * D
            y = W[F + 7] * D
            z = W[F + 8] * D
            W[B + 42] -= x * W[F + 6]
            W[B + 43] -= x * W[F + 7]
            W[B + 44] -= x * W[F + 8]
            W[B + 45] -= y * W[F + 7]
            W[B + 46] -= y * W[F + 8]
            W[B + 47] -= z * W[F + 8]
            if not I[b + 1]:
                a = W[F + 3]
                c = W[F + 4]
                d = W[F + 5]
                W[B + 33] -= a * x
                W[B + 34] -= a * y
                W[B + 35] -= a * z
                W[B + 36] -= c * x
                W[B + 37] -= c * y
                W[B + 38] -= c * z
                W[B + 39] -= d * x
                W[B + 40] -= d * y
                W[B + 41] -= d * z
                W[B + 27] -= a * a * D
                W[B + 28] -= a * c * D
                W[B + 29] -= a * d * D
                W[B + 30] -= c * c * D
                W[B + 31] -= c * d * D
                W[B + 32] -= d * d * D
        if p >= 0:
            Q = I[20] + 80 * p
            # the branch hangs at the arm l: C <- C + l x K (+ C), A <- A + (l x K) l' (+ A + C l' + l C')
            a = W[B + 42]
            c = W[B + 43]
            d = W[B + 44]
            e = W[B + 45]
            f = W[B + 46]
            g = W[B + 47]
            W[Q + 42] += a
            W[Q + 43] += c
            W[Q + 44] += d
            W[Q + 45] += e
            W[Q + 46] += f
            W[Q + 47] += g
            x = W[B + 18]
            y = W[B + 19]
            z = W[B + 20]
            W[T] = y * d - z * c
            W[T + 1] = y * f - z * e
            W[T + 2] = y * g - z * f
            W[T + 3] = z * a - x * d
            W[T + 4] = z * c - x * f
            W[T + 5] = z * d - x * g
            W[T + 6] = x * c - y * a
            W[T + 7] = x * e - y * c
            W[T + 8] = x * f - y * d
            if not I[b + 1]:
                # A also gets C l' + l C' : add C to both sides of the product with l
                for j in range(3):
                    a = W[B + 33 + 3 * j]
                    c = W[B + 34 + 3 * j]
                    d = W[B + 35 + 3 * j]
                    W[T + 9 + 3 * j] = y * d - z * c
                    W[T + 10 + 3 * j] = z * a - x * d
                    W[T + 11 + 3 * j] = x * c - y * a
                W[Q + 27] += W[B + 27] + 2.0 * W[T + 9]
                W[Q + 28] += W[B + 28] + W[T + 10] + W[T + 12]
                W[Q + 29] += W[B + 29] + W[T + 11] + W[T + 15]
                W[Q + 30] += W[B + 30] + 2.0 * W[T + 13]
                W[Q + 31] += W[B + 31] + W[T + 14] + W[T + 16]
                W[Q + 32] += W[B + 32] + 2.0 * W[T + 17]
                for j in range(9):
                    W[Q + 33 + j] += W[B + 33 + j]
            W[Q + 27] += y * W[T + 2] - z * W[T + 1]
            W[Q + 28] += z * W[T] - x * W[T + 2]
            W[Q + 29] += x * W[T + 1] - y * W[T]
            W[Q + 30] += z * W[T + 3] - x * W[T + 5]
            W[Q + 31] += x * W[T + 4] - y * W[T + 3]
            W[Q + 32] += x * W[T + 7] - y * W[T + 6]
            for j in range(9):
                W[Q + 33 + j] += W[T + j]
    return bad


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, Q=cython.Py_ssize_t, F=cython.Py_ssize_t, p=cython.Py_ssize_t, E=cython.Py_ssize_t, x=cython.double, y=cython.double, z=cython.double, n=cython.double, m=cython.double, o=cython.double, e=cython.double, u=cython.double, v=cython.double, w=cython.double)
def upward(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.void:
    """From loads and velocity terms to e, the load that each freedom has to answer."""
    for i in range(I[0]):
        B = I[20] + 80 * i
        for k in range(3):
            W[B + 48 + k] -= W[B + 60 + k]
            W[B + 51 + k] -= W[B + 63 + k]
    for i in range(I[0] - 1, -1, -1):
        B = I[20] + 80 * i
        b = I[10] + 8 * i
        p = I[b]
        E = I[22] + I[b + 6]
        u = W[B + 48]
        v = W[B + 49]
        w = W[B + 50]
        x = W[B + 51]
        y = W[B + 52]
        z = W[B + 53]
        if I[b + 1]:
            W[E] = -u
            W[E + 1] = -v
            W[E + 2] = -w
            x -= W[B + 33] * u + W[B + 36] * v + W[B + 39] * w
            y -= W[B + 34] * u + W[B + 37] * v + W[B + 40] * w
            z -= W[B + 35] * u + W[B + 38] * v + W[B + 41] * w
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            j = I[11] + 8 * k
            F = I[21] + 16 * k
            if I[j] == 2:
                e = -(W[F] * x + W[F + 1] * y + W[F + 2] * z)
            else:
                e = -(W[F] * u + W[F + 1] * v + W[F + 2] * w)
            if I[j + 3]:
                e = 0.0
            W[I[22] + I[j + 6]] = e
            e *= W[F + 9]
            u += W[F + 3] * e
            v += W[F + 4] * e
            w += W[F + 5] * e
            x += W[F + 6] * e
            y += W[F + 7] * e
            z += W[F + 8] * e
        if p >= 0:
            Q = I[20] + 80 * p
            n = W[B + 24]
            m = W[B + 25]
            o = W[B + 26]
            x += W[B + 42] * n + W[B + 43] * m + W[B + 44] * o
            y += W[B + 43] * n + W[B + 45] * m + W[B + 46] * o
            z += W[B + 44] * n + W[B + 46] * m + W[B + 47] * o
            if not I[b + 1]:
                u += W[B + 33] * n + W[B + 34] * m + W[B + 35] * o
                v += W[B + 36] * n + W[B + 37] * m + W[B + 38] * o
                w += W[B + 39] * n + W[B + 40] * m + W[B + 41] * o
                n = W[B + 21]
                m = W[B + 22]
                o = W[B + 23]
                x += W[B + 33] * n + W[B + 36] * m + W[B + 39] * o
                y += W[B + 34] * n + W[B + 37] * m + W[B + 40] * o
                z += W[B + 35] * n + W[B + 38] * m + W[B + 41] * o
                W[Q + 48] += u + W[B + 27] * n + W[B + 28] * m + W[B + 29] * o
                W[Q + 49] += v + W[B + 28] * n + W[B + 30] * m + W[B + 31] * o
                W[Q + 50] += w + W[B + 29] * n + W[B + 31] * m + W[B + 32] * o
            W[Q + 48] += W[B + 19] * z - W[B + 20] * y
            W[Q + 49] += W[B + 20] * x - W[B + 18] * z
            W[Q + 50] += W[B + 18] * y - W[B + 19] * x
            W[Q + 51] += x
            W[Q + 52] += y
            W[Q + 53] += z


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, Q=cython.Py_ssize_t, F=cython.Py_ssize_t, p=cython.Py_ssize_t, E=cython.Py_ssize_t, x=cython.double, y=cython.double, z=cython.double, u=cython.double, v=cython.double, w=cython.double, s=cython.double)
def downward(I: cython.p_int, P: cython.p_double, W: cython.p_double, bias: cython.int) -> cython.void:
    """From e to the accelerations of freedoms and bodies. bias 0: the answer to e alone (no velocity terms, no gravity)."""
    for i in range(I[0]):
        B = I[20] + 80 * i
        b = I[10] + 8 * i
        p = I[b]
        E = I[22] + I[b + 6]
        if p >= 0:
            Q = I[20] + 80 * p
            u = W[Q + 54]
            v = W[Q + 55]
            w = W[Q + 56]
            x = W[Q + 57] + v * W[B + 20] - w * W[B + 19]
            y = W[Q + 58] + w * W[B + 18] - u * W[B + 20]
            z = W[Q + 59] + u * W[B + 19] - v * W[B + 18]
        else:
            u = 0.0
            v = 0.0
            w = 0.0
            x = 0.0
            y = 0.0
            z = 0.0
            if bias:
                x = -P[0]
                y = -P[1]
                z = -P[2]
        if bias:
            x += W[B + 24]
            y += W[B + 25]
            z += W[B + 26]
            if not I[b + 1]:
                u += W[B + 21]
                v += W[B + 22]
                w += W[B + 23]
        for k in range(I[b + 2] + I[b + 3] - 1, I[b + 2] - 1, -1):
            j = I[11] + 8 * k
            F = I[21] + 16 * k
            if I[j + 3] == 0:
                s = W[F + 6] * x + W[F + 7] * y + W[F + 8] * z
                if not I[b + 1]:
                    s += W[F + 3] * u + W[F + 4] * v + W[F + 5] * w
                s = W[F + 9] * (W[I[22] + I[j + 6]] - s)
                W[F + 12] = s
                if I[j] == 2:
                    x += s * W[F]
                    y += s * W[F + 1]
                    z += s * W[F + 2]
                else:
                    u += s * W[F]
                    v += s * W[F + 1]
                    w += s * W[F + 2]
        if I[b + 1]:
            v = W[E + 1] - W[B + 27] * W[E]
            w = (W[E + 2] - W[B + 28] * W[E] - W[B + 29] * v) * W[B + 32]
            v = v * W[B + 31] - W[B + 29] * w
            u = W[E] * W[B + 30] - W[B + 27] * v - W[B + 28] * w - W[B + 33] * x - W[B + 34] * y - W[B + 35] * z
            v -= W[B + 36] * x + W[B + 37] * y + W[B + 38] * z
            w -= W[B + 39] * x + W[B + 40] * y + W[B + 41] * z
        W[B + 54] = u
        W[B + 55] = v
        W[B + 56] = w
        W[B + 57] = x
        W[B + 58] = y
        W[B + 59] = z


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, F=cython.Py_ssize_t, u=cython.double, v=cython.double, w=cython.double)
def derivative(I: cython.p_int, W: cython.p_double, y: cython.p_double, o: cython.Py_ssize_t, z: cython.p_double, k0: cython.Py_ssize_t, power: cython.double) -> cython.void:
    """The state's time derivative z[k0:], from the accelerations found."""
    for i in range(I[0]):
        b = I[10] + 8 * i
        if I[b + 1]:
            B = I[20] + 80 * i
            u = 0.5 * W[B + 12]
            v = 0.5 * W[B + 13]
            w = 0.5 * W[B + 14]
            j = o + I[b + 4]
            k = k0 + I[b + 4]
            z[k] = -u * y[j + 1] - v * y[j + 2] - w * y[j + 3]
            z[k + 1] = u * y[j] + v * y[j + 3] - w * y[j + 2]
            z[k + 2] = v * y[j] + w * y[j + 1] - u * y[j + 3]
            z[k + 3] = w * y[j] + u * y[j + 2] - v * y[j + 1]
            k = k0 + I[b + 5]
            z[k] = W[B + 54]
            z[k + 1] = W[B + 55]
            z[k + 2] = W[B + 56]
    for i in range(I[1]):
        j = I[11] + 8 * i
        if I[j + 3] == 0:
            F = I[21] + 16 * i
            z[k0 + I[j + 1]] = W[F + 11]
            z[k0 + I[j + 2]] = W[F + 12]
    if I[7]:
        z[k0 + I[8]] = power


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, Q=cython.Py_ssize_t, p=cython.Py_ssize_t, T=cython.Py_ssize_t, c=cython.Py_ssize_t, F=cython.Py_ssize_t, j=cython.Py_ssize_t, m=cython.double, qw=cython.double, qx=cython.double, qy=cython.double, qz=cython.double, g=cython.double, u=cython.double, l0=cython.double, l1=cython.double, l2=cython.double)
def balance(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.void:
    """Joint loads from the found accelerations and the loads on the bodies, by Newton's and Euler's laws, tips to roots.

    Independent of the factored inertias: what of it lies in a free direction is the sweep's rounding error.
    """
    T = I[25]
    for i in range(I[0]):
        B = I[20] + 80 * i
        c = I[16] + 40 * i
        m = P[c]
        # n = R J R' alpha + omega x (R J R' omega) + m c x a - n_ext, in turns of the body axes for J
        for k in range(3):
            W[T + k] = W[B + k] * W[B + 54] + W[B + 3 + k] * W[B + 55] + W[B + 6 + k] * W[B + 56]
            W[T + 3 + k] = W[B + k] * W[B + 12] + W[B + 3 + k] * W[B + 13] + W[B + 6 + k] * W[B + 14]
        symmetric(P, c + 4, W, T, W, T + 6)
        symmetric(P, c + 4, W, T + 3, W, T + 9)
        cross(W, T + 3, W, T + 9, W, T + 12)
        for k in range(3):
            W[T + 6 + k] += W[T + 12 + k]
        turned(W, B, W, T + 6, W, T)
        cross(W, B + 66, W, B + 57, W, T + 3)
        for k in range(3):
            W[B + 69 + k] = W[T + k] + W[T + 3 + k] - W[B + 60 + k]
        cross(W, B + 12, W, B + 66, W, T)
        cross(W, B + 12, W, T, W, T + 3)
        cross(W, B + 54, W, B + 66, W, T)
        for k in range(3):
            W[B + 72 + k] = m * W[B + 57 + k] + W[T + k] + W[T + 3 + k] - W[B + 63 + k]
    for i in range(I[0] - 1, -1, -1):
        B = I[20] + 80 * i
        b = I[10] + 8 * i
        p = I[b]
        if p >= 0:
            Q = I[20] + 80 * p
            cross(W, B + 18, W, B + 72, W, T)
            for k in range(3):
                W[Q + 69 + k] += W[B + 69 + k] + W[T + k]
                W[Q + 72 + k] += W[B + 72 + k]
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            j = I[11] + 8 * k
            if I[j + 3]:
                F = I[21] + 16 * k
                c = B + 69
                if I[j] == 2:
                    c = B + 72
                W[F + 13] = W[F] * W[c] + W[F + 1] * W[c + 1] + W[F + 2] * W[c + 2]
