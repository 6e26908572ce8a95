"""Closed chains on top of the sweep: closure rows, their multipliers, and the way back onto the closures.

    J Vdot + gamma = 0,   A = J M^-1 J' = sum over freedoms e_r D^-1 e_s,   A lambda = -(J Vdot_free + gamma)
Row r puts the force f at the point Q and the couple m on body b for lambda = 1, and the opposite at the same place on a;
its e_r comes from one upward pass along the two paths to the ground. theory.md 2b; rods with unit direction.

Offsets in I: 24 rows (W) 26 e_r 27 A and its factor 28 selected rows (ints in I) 29 number selected 30 first couplings
              32 counters 33 their number 34 scratch wrenches (W) 35 their axes (P) 36 spread e_r (W)
              37 (W) pivots, scales of the choice, scales of the nearness to a singular pose; a number a row each
              38 choose the rows anew at every instant of `recover` 39 something is driven 40 ropes are watched
row        I (16): 0 kind (0 guide, 1 dot, 2 rod) 1 a 2 b 3 joint 4 program start 5 count 6 path start 7 path length
                   8 e_r start 9 freedoms list start 10 freedoms count 11 couplings start 12 count 13 place among selected
                   14 a rope: may only pull
           P (24): 0 direction in a 3 direction in b 6 P in a 9 Q in b 12 length or offset 13 weight of the gap [m per unit]
           W (16): 0 f 3 m 6 Q 9 gap 10 rate 11 gamma 12 lambda 13 right-hand side 14 prescribed rate
counter    I (4): 0 a 1 b 2 place in the state;  P at I[35] (4): 0 axis in a
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if cython.compiled:
    from cython.cimports.heuncli.kernel.program import jet
    from cython.cimports.heuncli.kernel.tree import (
        balance,
        derivative,
        downward,
        factor,
        kinematics,
        loads,
        push,
        upward,
    )
    from cython.cimports.libc.math import fabs, sqrt
else:
    from math import fabs, sqrt

    from heuncli.kernel.program import jet
    from heuncli.kernel.tree import balance, derivative, downward, factor, kinematics, loads, push, upward


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(k=cython.Py_ssize_t, B=cython.Py_ssize_t, x=cython.double, y=cython.double, z=cython.double)
def carried(I: cython.p_int, P: cython.p_double, W: cython.p_double, b: cython.Py_ssize_t, v: cython.Py_ssize_t, rotate: cython.int, o: cython.Py_ssize_t) -> cython.void:
    """World components at W[o] of a direction (rotate 1) or place (0) P[v:v+3] of body b."""
    if b < 0:
        for k in range(3):
            W[o + k] = P[v + k]
    else:
        B = I[20] + 80 * b
        x = P[v]
        y = P[v + 1]
        z = P[v + 2]
        for k in range(3):
            W[o + k] = W[B + 3 * k] * x + W[B + 3 * k + 1] * y + W[B + 3 * k + 2] * z
        if rotate == 0:
            for k in range(3):
                W[o + k] += W[B + 9 + k]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(k=cython.Py_ssize_t, B=cython.Py_ssize_t, x=cython.double, y=cython.double, z=cython.double, u=cython.double, v=cython.double, w=cython.double, s=cython.double)
def carried_motion(I: cython.p_int, W: cython.p_double, b: cython.Py_ssize_t, q: cython.Py_ssize_t, o: cython.Py_ssize_t) -> cython.void:
    """At W[o]: velocity (3), centripetal acceleration (3) of the body's point at the world place W[q], omega (3)."""
    if b < 0:
        for k in range(9):
            W[o + k] = 0.0
    else:
        B = I[20] + 80 * b
        x = W[q] - W[B + 9]
        y = W[q + 1] - W[B + 10]
        z = W[q + 2] - W[B + 11]
        u = W[B + 12]
        v = W[B + 13]
        w = W[B + 14]
        W[o] = W[B + 15] + v * z - w * y
        W[o + 1] = W[B + 16] + w * x - u * z
        W[o + 2] = W[B + 17] + u * y - v * x
        s = u * x + v * y + w * z
        W[o + 3] = s * u - (u * u + v * v + w * w) * x
        W[o + 4] = s * v - (u * u + v * v + w * w) * y
        W[o + 5] = s * w - (u * u + v * v + w * w) * z
        W[o + 6] = u
        W[o + 7] = v
        W[o + 8] = w


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t, k=cython.Py_ssize_t, i=cython.Py_ssize_t, c=cython.Py_ssize_t, w=cython.Py_ssize_t, T=cython.Py_ssize_t, a=cython.Py_ssize_t, b=cython.Py_ssize_t, g=cython.double, d=cython.double, s=cython.double, e0=cython.double, e1=cython.double, e2=cython.double, u0=cython.double, u1=cython.double, u2=cython.double, v0=cython.double, v1=cython.double, v2=cython.double, l=cython.double)
def closures(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double) -> cython.void:
    """Direction, gap, rate and gamma of every row at the present kinematics."""
    T = I[25]
    for r in range(I[4]):
        i = I[13] + 16 * r
        c = I[19] + 24 * r
        w = I[24] + 16 * r
        a = I[i + 1]
        b = I[i + 2]
        carried(I, P, W, b, c + 9, 0, w + 6)
        carried_motion(I, W, b, w + 6, T)
        if I[i] == 1:
            carried_motion(I, W, a, w + 6, T + 9)
            carried(I, P, W, a, c, 1, T + 18)
            carried(I, P, W, b, c + 3, 1, T + 21)
            e0 = W[T + 18]
            e1 = W[T + 19]
            e2 = W[T + 20]
            # (sigma_a x e) x f + e x (sigma_b x f), by components
            u0 = W[T + 16] * e2 - W[T + 17] * e1
            u1 = W[T + 17] * e0 - W[T + 15] * e2
            u2 = W[T + 15] * e1 - W[T + 16] * e0
            v0 = W[T + 7] * W[T + 23] - W[T + 8] * W[T + 22]
            v1 = W[T + 8] * W[T + 21] - W[T + 6] * W[T + 23]
            v2 = W[T + 6] * W[T + 22] - W[T + 7] * W[T + 21]
            W[w] = 0.0
            W[w + 1] = 0.0
            W[w + 2] = 0.0
            W[w + 3] = W[T + 22] * e2 - W[T + 23] * e1
            W[w + 4] = W[T + 23] * e0 - W[T + 21] * e2
            W[w + 5] = W[T + 21] * e1 - W[T + 22] * e0
            W[w + 9] = e0 * W[T + 21] + e1 * W[T + 22] + e2 * W[T + 23]
            s = 0.0
            g = 0.0
            for k in range(3):
                s += W[w + 3 + k] * (W[T + 6 + k] - W[T + 15 + k])
            g += (W[T + 15] - W[T + 6]) * (u1 * W[T + 23] - u2 * W[T + 22] + e1 * v2 - e2 * v1)
            g += (W[T + 16] - W[T + 7]) * (u2 * W[T + 21] - u0 * W[T + 23] + e2 * v0 - e0 * v2)
            g += (W[T + 17] - W[T + 8]) * (u0 * W[T + 22] - u1 * W[T + 21] + e0 * v1 - e1 * v0)
            W[w + 10] = s
            W[w + 11] = g
        else:
            carried(I, P, W, a, c + 6, 0, T + 18)
            W[w + 3] = 0.0
            W[w + 4] = 0.0
            W[w + 5] = 0.0
            if I[i] == 0:
                carried_motion(I, W, a, w + 6, T + 9)
                carried(I, P, W, a, c, 1, w)
                g = 0.0
                s = 0.0
                for k in range(3):
                    g += W[w + k] * (W[w + 6 + k] - W[T + 18 + k])
                    s += W[w + k] * (W[T + k] - W[T + 9 + k])
                W[w + 9] = g - P[c + 12]
                W[w + 10] = s
                # f . (cen_b - cen_a - 2 sigma_a x v_rel)
                u0 = W[T] - W[T + 9]
                u1 = W[T + 1] - W[T + 10]
                u2 = W[T + 2] - W[T + 11]
                g = W[w] * (W[T + 3] - W[T + 12] - 2.0 * (W[T + 16] * u2 - W[T + 17] * u1))
                g += W[w + 1] * (W[T + 4] - W[T + 13] - 2.0 * (W[T + 17] * u0 - W[T + 15] * u2))
                g += W[w + 2] * (W[T + 5] - W[T + 14] - 2.0 * (W[T + 15] * u1 - W[T + 16] * u0))
                W[w + 11] = g
            else:
                carried_motion(I, W, a, T + 18, T + 9)
                l = 0.0
                for k in range(3):
                    W[w + k] = W[w + 6 + k] - W[T + 18 + k]
                    l += W[w + k] * W[w + k]
                l = sqrt(l)
                if l > 0.0:
                    for k in range(3):
                        W[w + k] = W[w + k] / l
                s = 0.0
                d = 0.0
                g = 0.0
                for k in range(3):
                    u0 = W[T + k] - W[T + 9 + k]
                    s += W[w + k] * u0
                    d += u0 * u0
                    g += W[w + k] * (W[T + 3 + k] - W[T + 12 + k])
                if l > 0.0:
                    g += (d - s * s) / l
                W[w + 9] = l - P[c + 12]
                W[w + 10] = s
                W[w + 11] = g
        if I[i + 5]:
            jet(C, N, I[i + 4], I[i + 5], t, S, X)
            W[w + 9] -= X[0]
            W[w + 10] -= X[1]
            W[w + 14] = X[1]
            W[w + 11] -= X[2]
            X[0] = t


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(k=cython.Py_ssize_t, w=cython.Py_ssize_t, i=cython.Py_ssize_t, a=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, s=cython.double, side=cython.Py_ssize_t, sign=cython.double, x=cython.double, y=cython.double, z=cython.double)
def row_of(I: cython.p_int, P: cython.p_double, W: cython.p_double, r: cython.Py_ssize_t, bias: cython.int) -> cython.double:
    """J Vdot of row r at the accelerations found (the ground at rest is accelerated by -g if bias)."""
    w = I[24] + 16 * r
    i = I[13] + 16 * r
    s = 0.0
    for side in range(2):
        b = I[i + 2 - side]
        sign = 1.0 - 2.0 * side
        if b >= 0:
            B = I[20] + 80 * b
            x = W[w + 6] - W[B + 9]
            y = W[w + 7] - W[B + 10]
            z = W[w + 8] - W[B + 11]
            s += sign * (W[w] * (W[B + 57] + W[B + 55] * z - W[B + 56] * y))
            s += sign * (W[w + 1] * (W[B + 58] + W[B + 56] * x - W[B + 54] * z))
            s += sign * (W[w + 2] * (W[B + 59] + W[B + 54] * y - W[B + 55] * x))
            s += sign * (W[w + 3] * W[B + 54] + W[w + 4] * W[B + 55] + W[w + 5] * W[B + 56])
        elif bias:
            s -= sign * (W[w] * P[0] + W[w + 1] * P[1] + W[w + 2] * P[2])
    return s


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, n=cython.Py_ssize_t, w=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, F=cython.Py_ssize_t, T=cython.Py_ssize_t, V=cython.Py_ssize_t, Q=cython.Py_ssize_t, E=cython.Py_ssize_t, p=cython.Py_ssize_t, side=cython.Py_ssize_t, sign=cython.double, u=cython.double, v=cython.double, e=cython.double, q=cython.double, x=cython.double, y=cython.double, z=cython.double)
def column(I: cython.p_int, P: cython.p_double, W: cython.p_double, r: cython.Py_ssize_t, first: cython.Py_ssize_t, end: cython.Py_ssize_t) -> cython.void:
    """e_r of row r: one upward pass of its unit load along its paths; needs the factored inertias.

    first, end: which of its two sides, 0 on b, 1 on a (0, 2: both).
    """
    i = I[13] + 16 * r
    w = I[24] + 16 * r
    V = I[34]
    for k in range(I[i + 7]):
        b = V + 6 * I[I[i + 6] + k]
        for j in range(6):
            W[b + j] = 0.0
    for side in range(first, end):
        b = I[i + 2 - side]
        sign = 1.0 - 2.0 * side
        if b >= 0:
            B = I[20] + 80 * b
            T = V + 6 * b
            x = W[w + 6] - W[B + 9]
            y = W[w + 7] - W[B + 10]
            z = W[w + 8] - W[B + 11]
            W[T] -= sign * (W[w + 3] + y * W[w + 2] - z * W[w + 1])
            W[T + 1] -= sign * (W[w + 4] + z * W[w] - x * W[w + 2])
            W[T + 2] -= sign * (W[w + 5] + x * W[w + 1] - y * W[w])
            W[T + 3] -= sign * W[w]
            W[T + 4] -= sign * W[w + 1]
            W[T + 5] -= sign * W[w + 2]
    E = I[26] + I[i + 8]
    for n in range(I[i + 7]):
        p = I[I[i + 6] + n]
        b = I[10] + 8 * p
        B = I[20] + 80 * p
        T = V + 6 * p
        u = W[T]
        v = W[T + 1]
        q = W[T + 2]
        x = W[T + 3]
        y = W[T + 4]
        z = W[T + 5]
        if I[b + 1]:
            W[E] = -u
            W[E + 1] = -v
            W[E + 2] = -q
            E += 3
            x -= W[B + 33] * u + W[B + 36] * v + W[B + 39] * q
            y -= W[B + 34] * u + W[B + 37] * v + W[B + 40] * q
            z -= W[B + 35] * u + W[B + 38] * v + W[B + 41] * q
            u = 0.0
            v = 0.0
            q = 0.0
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            j = I[11] + 8 * k
            F = I[21] + 16 * k
            e = 0.0
            if I[j + 3] == 0:
                if I[j] == 2:
                    e = -(W[F] * x + W[F + 1] * y + W[F + 2] * z)
                else:
                    e = -(W[F] * u + W[F + 1] * v + W[F + 2] * q)
            W[E] = e
            E += 1
            e *= W[F + 9]
            u += W[F + 3] * e
            v += W[F + 4] * e
            q += W[F + 5] * e
            x += W[F + 6] * e
            y += W[F + 7] * e
            z += W[F + 8] * e
        if I[b] >= 0:
            Q = V + 6 * I[b]
            W[Q] += u + W[B + 19] * z - W[B + 20] * y
            W[Q + 1] += v + W[B + 20] * x - W[B + 18] * z
            W[Q + 2] += q + W[B + 18] * y - W[B + 19] * x
            W[Q + 3] += x
            W[Q + 4] += y
            W[Q + 5] += z


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, n=cython.Py_ssize_t, p=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, E=cython.Py_ssize_t, H=cython.Py_ssize_t)
def weighted(I: cython.p_int, W: cython.p_double, r: cython.Py_ssize_t, clear: cython.int) -> cython.void:
    """D^-1 e_r, spread over all freedoms at W[I[36]:]; or those places back to zero."""
    i = I[13] + 16 * r
    E = I[26] + I[i + 8]
    for n in range(I[i + 7]):
        p = I[I[i + 6] + n]
        b = I[10] + 8 * p
        B = I[20] + 80 * p
        H = I[36] + I[b + 6]
        if I[b + 1]:
            W[H] = 0.0
            W[H + 1] = 0.0
            W[H + 2] = 0.0
            if clear == 0:
                W[H + 1] = W[E + 1] - W[B + 27] * W[E]
                W[H + 2] = (W[E + 2] - W[B + 28] * W[E] - W[B + 29] * W[H + 1]) * W[B + 32]
                W[H + 1] = W[H + 1] * W[B + 31] - W[B + 29] * W[H + 2]
                W[H] = W[E] * W[B + 30] - W[B + 27] * W[H + 1] - W[B + 28] * W[H + 2]
            E += 3
            H += 3
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            W[H] = 0.0
            if clear == 0:
                W[H] = W[I[21] + 16 * k + 9] * W[E]
            E += 1
            H += 1


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, s=cython.double, E=cython.Py_ssize_t)
def product(I: cython.p_int, W: cython.p_double, r: cython.Py_ssize_t) -> cython.double:
    """e_r . (what `weighted` spread)."""
    i = I[13] + 16 * r
    E = I[26] + I[i + 8]
    s = 0.0
    for k in range(I[i + 10]):
        s += W[E + k] * W[I[36] + I[I[i + 9] + k]]
    return s


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(m=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, r=cython.Py_ssize_t, s=cython.Py_ssize_t, n=cython.Py_ssize_t, A=cython.Py_ssize_t, f=cython.Py_ssize_t, g=cython.Py_ssize_t, x=cython.double, least=cython.double, scale=cython.double)
def factor_closures(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.double:
    """Columns and Cholesky factor of A over the selected rows (within each row's envelope); the least pivot.

    Pivots are relative to what the row could answer (`reach`) when the rows were chosen: a row that vanishes counts.
    """
    m = I[29]
    A = I[27]
    least = 1.0
    for i in range(m):
        column(I, P, W, I[I[28] + i], 0, 2)
    for i in range(m):
        r = I[I[28] + i]
        n = I[13] + 16 * r
        f = i
        for k in range(I[n + 12]):
            s = I[I[13] + 16 * I[I[n + 11] + k] + 13]
            if s >= 0 and s < f:
                f = s
        I[I[30] + i] = f
        weighted(I, W, r, 0)
        for j in range(f, i + 1):
            W[A + m * i + j] = product(I, W, I[I[28] + j])
        weighted(I, W, r, 1)
        for j in range(f, i + 1):
            g = I[I[30] + j]
            if g < f:
                g = f
            x = W[A + m * i + j]
            for k in range(g, j):
                x -= W[A + m * i + k] * W[A + m * j + k]
            if j < i:
                W[A + m * i + j] = x * W[A + m * j + j]
            else:
                scale = W[I[37] + 2 * I[4] + r]
                if x * scale * scale < least:
                    least = x * scale * scale
                if x <= 0.0:
                    least = -1.0
                    x = 1.0
                W[A + m * i + i] = 1.0 / sqrt(x)
    return least


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(m=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, r=cython.Py_ssize_t, A=cython.Py_ssize_t, w=cython.Py_ssize_t, E=cython.Py_ssize_t, n=cython.Py_ssize_t, x=cython.double)
def answer(I: cython.p_int, W: cython.p_double) -> cython.void:
    """lambda = -A^-1 (right-hand sides of the rows); adds sum lambda e_r to e."""
    m = I[29]
    A = I[27]
    for i in range(I[4]):
        W[I[24] + 16 * i + 12] = 0.0
    for i in range(m):
        w = I[24] + 16 * I[I[28] + i]
        x = -W[w + 13]
        for j in range(I[I[30] + i], i):
            x -= W[A + m * i + j] * W[I[24] + 16 * I[I[28] + j] + 12]
        W[w + 12] = x * W[A + m * i + i]
    for i in range(m - 1, -1, -1):
        w = I[24] + 16 * I[I[28] + i]
        x = W[w + 12] * W[A + m * i + i]
        W[w + 12] = x
        for j in range(I[I[30] + i], i):
            W[I[24] + 16 * I[I[28] + j] + 12] -= W[A + m * i + j] * x
    for i in range(m):
        r = I[I[28] + i]
        x = W[I[24] + 16 * r + 12]
        n = I[13] + 16 * r
        E = I[26] + I[n + 8]
        for k in range(I[n + 10]):
            W[I[22] + I[I[n + 9] + k]] += x * W[E + k]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, c=cython.Py_ssize_t, T=cython.Py_ssize_t, s=cython.double)
def count_turns(I: cython.p_int, P: cython.p_double, W: cython.p_double, z: cython.p_double, k0: cython.Py_ssize_t) -> cython.void:
    """Rates of the angles that are counted beside the tree (joints that were cut)."""
    T = I[25]
    for i in range(I[33]):
        c = I[32] + 4 * i
        carried(I, P, W, I[c], I[35] + 4 * i, 1, T)
        s = 0.0
        for k in range(3):
            if I[c + 1] >= 0:
                s += W[T + k] * W[I[20] + 80 * I[c + 1] + 12 + k]
            if I[c] >= 0:
                s -= W[T + k] * W[I[20] + 80 * I[c] + 12 + k]
        z[k0 + I[c + 2]] = s


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t, i=cython.Py_ssize_t, k=cython.Py_ssize_t, w=cython.Py_ssize_t, T=cython.Py_ssize_t)
def push_closures(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.void:
    """Put the multipliers' forces and couples on the bodies, beside the applied loads."""
    T = I[25]
    for r in range(I[4]):
        i = I[13] + 16 * r
        w = I[24] + 16 * r
        for k in range(6):
            W[T + k] = W[w + 12] * W[w + k]
        push(I, W, I[i + 2], w + 6, T, T + 3, 1.0)
        push(I, W, I[i + 1], w + 6, T, T + 3, -1.0)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t, w=cython.Py_ssize_t, bad=cython.int, power=cython.double)
def evaluate(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double, y: cython.p_double, o: cython.Py_ssize_t, z: cython.p_double, k: cython.Py_ssize_t) -> cython.int:
    """Time derivative z[k:] of the state y[o:] at t; 0, or how many freedoms had no inertia behind them, or -1 for lost closures.

    Where something is driven the joint loads are found too (`balance`), for the work of the drives.
    """
    kinematics(I, P, W, C, N, X, S, t, y, o)
    if I[33]:
        count_turns(I, P, W, z, k)
    power = 0.0
    if I[3]:
        power = loads(I, P, W, C, N, X, S)
    bad = factor(I, P, W)
    upward(I, P, W)
    downward(I, P, W, 1)
    if I[29]:
        closures(I, P, W, C, N, X, S, t)
        P[5] = factor_closures(I, P, W)
        if P[5] < P[6]:
            P[6] = P[5]
        if P[5] < 0.0:
            bad = -1
        for r in range(I[4]):
            w = I[24] + 16 * r
            W[w + 13] = W[w + 11] + row_of(I, P, W, r, 1)
        answer(I, W)
        downward(I, P, W, 1)
    if I[39]:
        push_closures(I, P, W)
        balance(I, P, W)
        for r in range(I[1]):
            if I[I[11] + 8 * r + 3]:
                power += W[I[21] + 16 * r + 13] * W[I[21] + 16 * r + 11]
        for r in range(I[4]):
            if I[I[13] + 16 * r + 5]:
                power += W[I[24] + 16 * r + 12] * W[I[24] + 16 * r + 14]
    derivative(I, W, y, o, z, k, power)
    return bad


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, b=cython.Py_ssize_t, B=cython.Py_ssize_t, j=cython.Py_ssize_t, u=cython.double, v=cython.double, w=cython.double, a=cython.double, c=cython.double, d=cython.double, e=cython.double)
def move(I: cython.p_int, W: cython.p_double, y: cython.p_double, o: cython.Py_ssize_t, rates: cython.int) -> cython.void:
    """Add the answer found (small turns and shifts) to the coordinates, or (rates 1) to the velocities of the state."""
    for i in range(I[0]):
        b = I[10] + 8 * i
        if I[b + 1]:
            B = I[20] + 80 * i
            if rates:
                k = o + I[b + 5]
                y[k] += W[B + 54]
                y[k + 1] += W[B + 55]
                y[k + 2] += W[B + 56]
            else:
                k = o + I[b + 4]
                u = 0.5 * W[B + 54]
                v = 0.5 * W[B + 55]
                w = 0.5 * W[B + 56]
                a = y[k]
                c = y[k + 1]
                d = y[k + 2]
                e = y[k + 3]
                y[k] = a - u * c - v * d - w * e
                y[k + 1] = c + u * a + v * e - w * d
                y[k + 2] = d + v * a + w * c - u * e
                y[k + 3] = e + w * a + u * d - v * c
    for i in range(I[1]):
        j = I[11] + 8 * i
        if I[j + 3] == 0:
            y[o + I[j + 1 + rates]] += W[I[21] + 16 * i + 12]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t, k=cython.Py_ssize_t, w=cython.Py_ssize_t, what=cython.Py_ssize_t)
def correction(I: cython.p_int, P: cython.p_double, W: cython.p_double, what: cython.Py_ssize_t) -> cython.void:
    """The least turn (in the measure of M) that takes back the gaps (what 9) or rates (10) of the rows; A is factored."""
    for k in range(I[2]):
        W[I[22] + k] = 0.0
    for r in range(I[4]):
        w = I[24] + 16 * r
        W[w + 13] = W[w + what]
    answer(I, W)
    downward(I, P, W, 0)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t, w=cython.Py_ssize_t, g=cython.double, x=cython.double)
def largest_gap(I: cython.p_int, P: cython.p_double, W: cython.p_double) -> cython.double:
    """Largest gap of all rows [m], the turning ones by their weight."""
    g = 0.0
    for r in range(I[4]):
        x = fabs(W[I[24] + 16 * r + 9]) * P[I[19] + 24 * r + 13]
        if not x <= g:
            g = x
    return g


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.int, i=cython.Py_ssize_t, b=cython.Py_ssize_t, k=cython.Py_ssize_t, s=cython.double, g=cython.double)
def settle(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double, y: cython.p_double, o: cython.Py_ssize_t) -> cython.double:
    """Bring y[o:] onto the unit quaternions and the closures, positions and rates; the gap that is left over all rows [m]."""
    for i in range(I[0]):
        b = I[10] + 8 * i
        if I[b + 1]:
            k = o + I[b + 4]
            s = 1.0 / sqrt(y[k] * y[k] + y[k + 1] * y[k + 1] + y[k + 2] * y[k + 2] + y[k + 3] * y[k + 3])
            y[k] *= s
            y[k + 1] *= s
            y[k + 2] *= s
            y[k + 3] *= s
    if I[4] == 0:
        return 0.0
    kinematics(I, P, W, C, N, X, S, t, y, o)
    closures(I, P, W, C, N, X, S, t)
    g = largest_gap(I, P, W)
    if I[29] == 0:  # rows that nothing answers may still open, in a singular pose say
        return g
    factor(I, P, W)
    P[5] = factor_closures(I, P, W)
    for n in range(5):
        if g <= 1e-15 * P[3]:
            break
        s = g
        correction(I, P, W, 9)
        move(I, W, y, o, 0)
        kinematics(I, P, W, C, N, X, S, t, y, o)
        closures(I, P, W, C, N, X, S, t)
        g = largest_gap(I, P, W)
        # kinematics wrote over the inverse inertias; and near a singular pose the rows turn with every small move
        factor(I, P, W)
        P[5] = factor_closures(I, P, W)
        if P[5] < P[7]:
            if g > 0.5 * s:
                break
        elif g <= 1e-14 * P[3]:
            break
    correction(I, P, W, 10)
    move(I, W, y, o, 1)
    if P[5] < P[7]:
        kinematics(I, P, W, C, N, X, S, t, y, o)
        closures(I, P, W, C, N, X, S, t)
        factor(I, P, W)
        factor_closures(I, P, W)
        correction(I, P, W, 10)
        move(I, W, y, o, 1)
    return g


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, n=cython.Py_ssize_t, k=cython.Py_ssize_t, p=cython.Py_ssize_t, b=cython.Py_ssize_t, w=cython.Py_ssize_t, turn=cython.double, shift=cython.double, s=cython.double)
def loudest(I: cython.p_int, P: cython.p_double, W: cython.p_double, r: cython.Py_ssize_t) -> cython.double:
    """What the freedoms of row r's paths would answer if its force, a size of the scene away, and its couple met all of them."""
    i = I[13] + 16 * r
    w = I[24] + 16 * r
    shift = W[w] * W[w] + W[w + 1] * W[w + 1] + W[w + 2] * W[w + 2]
    turn = shift * P[3] * P[3] + W[w + 3] * W[w + 3] + W[w + 4] * W[w + 4] + W[w + 5] * W[w + 5]
    s = 0.0
    for n in range(I[i + 7]):
        p = I[I[i + 6] + n]
        b = I[10] + 8 * p
        if I[b + 1]:
            s += turn * (W[I[20] + 80 * p + 30] + W[I[20] + 80 * p + 31] + W[I[20] + 80 * p + 32])
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            if I[I[11] + 8 * k + 3] == 0:
                if I[I[11] + 8 * k] == 2:
                    s += shift * W[I[21] + 16 * k + 9]
                else:
                    s += turn * W[I[21] + 16 * k + 9]
    return s


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(B=cython.Py_ssize_t, u=cython.double, v=cython.double, w=cython.double)
def turned_by(W: cython.p_double, B: cython.Py_ssize_t, u: cython.double, v: cython.double, w: cython.double) -> cython.double:
    """v A^-1 v of a body on a ball: what its turning answers to the couple v."""
    v -= W[B + 27] * u
    w -= W[B + 28] * u + W[B + 29] * v
    return u * u * W[B + 30] + v * v * W[B + 31] + w * w * W[B + 32]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, n=cython.Py_ssize_t, k=cython.Py_ssize_t, p=cython.Py_ssize_t, b=cython.Py_ssize_t, w=cython.Py_ssize_t, B=cython.Py_ssize_t, F=cython.Py_ssize_t, force=cython.double, couple=cython.double, s=cython.double, x=cython.double, y=cython.double, z=cython.double, a=cython.double, c=cython.double, d=cython.double)
def reach(I: cython.p_int, P: cython.p_double, W: cython.p_double, r: cython.Py_ssize_t) -> cython.double:
    """What the freedoms of row r's paths would answer from where they are if its force and couple stood across their arms."""
    i = I[13] + 16 * r
    w = I[24] + 16 * r
    force = W[w] * W[w] + W[w + 1] * W[w + 1] + W[w + 2] * W[w + 2]
    couple = W[w + 3] * W[w + 3] + W[w + 4] * W[w + 4] + W[w + 5] * W[w + 5]
    s = 0.0
    for n in range(I[i + 7]):
        p = I[I[i + 6] + n]
        b = I[10] + 8 * p
        B = I[20] + 80 * p
        x = W[w + 6] - W[B + 9]
        y = W[w + 7] - W[B + 10]
        z = W[w + 8] - W[B + 11]
        if I[b + 1]:
            s += force * (turned_by(W, B, 0.0, z, -y) + turned_by(W, B, -z, 0.0, x) + turned_by(W, B, y, -x, 0.0))
            s += turned_by(W, B, W[w + 3], W[w + 4], W[w + 5])
        for k in range(I[b + 2], I[b + 2] + I[b + 3]):
            if I[I[11] + 8 * k + 3] == 0:
                F = I[21] + 16 * k
                if I[I[11] + 8 * k] == 2:
                    s += force * W[F + 9]
                else:
                    a = W[F + 1] * z - W[F + 2] * y
                    c = W[F + 2] * x - W[F] * z
                    d = W[F] * y - W[F + 1] * x
                    s += (force * (a * a + c * c + d * d) + couple) * W[F + 9]
    return s


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, m=cython.Py_ssize_t, n=cython.Py_ssize_t, best=cython.Py_ssize_t, A=cython.Py_ssize_t, D=cython.Py_ssize_t, r=cython.Py_ssize_t, x=cython.double, s=cython.double)
def select(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, t: cython.double, y: cython.p_double, o: cython.Py_ssize_t, fresh: cython.int) -> cython.int:
    """Choose an independent set of rows at y by pivoted Cholesky of the scaled A over all rows; how many."""
    n = I[4]
    A = I[27]
    D = I[37]
    kinematics(I, P, W, C, N, X, S, t, y, o)
    closures(I, P, W, C, N, X, S, t)
    factor(I, P, W)
    for i in range(n):
        # the scale: what each side of the row would answer alone, which no cancelling between the two can make small
        s = 0.0
        for k in range(2):
            column(I, P, W, i, k, k + 1)
            weighted(I, W, i, 0)
            s += product(I, W, i)
            weighted(I, W, i, 1)
        column(I, P, W, i, 0, 2)
        weighted(I, W, i, 0)
        W[D + i] = product(I, W, i)
        weighted(I, W, i, 1)
        # what hardly answers at all (across the only axis its pins have, say) is rounding, and no row
        if s > 1e-24 * loudest(I, P, W, i):
            W[D + n + i] = 1.0 / sqrt(s)
            W[D + i] /= s
        else:
            W[D + n + i] = 0.0
            W[D + i] = 0.0
        # how near to singular is told against what the row can answer, not against what it does in this pose
        x = 0.01 * reach(I, P, W, i)
        if s > x:
            x = s
        x = 1.0 / sqrt(x) if x > 0.0 else 0.0
        if fresh or x < W[D + 2 * n + i]:
            W[D + 2 * n + i] = x
        I[I[13] + 16 * i + 13] = -1
    # row k of the factor belongs to the k-th pivot; L (k, row)
    m = 0
    while m < n:
        best = -1
        x = 1e-11
        for i in range(n):
            # 1 % preference for the earlier row keeps the choice steady
            if I[I[13] + 16 * i + 13] < 0 and W[D + i] > x * 1.01:
                x = W[D + i]
                best = i
        if best < 0:
            break
        s = 1.0 / sqrt(W[D + best])
        weighted(I, W, best, 0)
        for i in range(n):
            if I[I[13] + 16 * i + 13] < 0:
                x = product(I, W, i) * W[D + n + i] * W[D + n + best]
                for k in range(m):
                    x -= W[A + n * k + i] * W[A + n * k + best]
                W[A + n * m + i] = x * s
        weighted(I, W, best, 1)
        I[I[13] + 16 * best + 13] = m
        for i in range(n):
            if I[I[13] + 16 * i + 13] < 0:
                W[D + i] -= W[A + n * m + i] * W[A + n * m + i]
        m += 1
    j = 0
    for i in range(n):
        r = I[13] + 16 * i + 13
        if I[r] >= 0:
            I[r] = j
            I[I[28] + j] = i
            j += 1
    I[29] = m
    if m:
        P[4] = factor_closures(I, P, W)
        P[5] = P[4]
    return m


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(r=cython.Py_ssize_t)
def slack(I: cython.p_int, W: cython.p_double) -> cython.int:
    """1 + the first rope that would have to push at the multipliers found; 0 if there is none."""
    for r in range(I[4]):
        if I[I[13] + 16 * r + 14] and W[I[24] + 16 * r + 12] > 0.0:
            return r + 1
    return 0
