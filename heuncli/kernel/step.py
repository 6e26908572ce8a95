"""The stepping loop: an adaptive embedded Runge-Kutta method with dense output, and the states at given instants.

The error of a step is measured body by body, the largest counts (a resting neighbour must not dilute it): coordinates
against tol (angles) and tol * size (shifts), rates against tol * the largest rate the body has had.

MI (method)  0 stages 1 stages of the dense output 2 its rows;  8.. start of row (in MI and T) of: stages 0-11, solution 12,
             extra stages 13-15, error 3rd order 16, error 5th order 17, dense 18-21; then columns.  T  0-15 nodes, then coefficients
D (int)      0 n state 1 controlled bodies 2 next sample 3 the group of the work (-1) 4 follow the steps given; 8.. per body: start, end of its coordinates, end of its rates
Z (run)      0 t 1 h 2 the row of a rope that would push (+1) 3 rejected before 4 steps 5 evaluations 6 rejected steps 7 largest gap 8 tol 9 t left limit of the
             piece's end 10 piece's end 11 status 12 last row asked 13 global rate 14 fresh start 15 sum m size^2
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if cython.compiled:
    from cython.cimports.heuncli.kernel.loops import evaluate, push_closures, select, settle, slack
    from cython.cimports.heuncli.kernel.tree import balance
    from cython.cimports.libc.math import fabs, pow, sqrt
else:
    from math import fabs, pow, sqrt

    from heuncli.kernel.loops import evaluate, push_closures, select, settle, slack
    from heuncli.kernel.tree import balance

COMPILED = cython.compiled

# Codes of `advance`; motion.py has a sentence for each.
# 0 reached the end of the piece, 1 more steps to do, 2 step collapsed, 3 not a number, 4 closures lost, 5 a rope would push


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, a=cython.Py_ssize_t, b=cython.Py_ssize_t, j=cython.Py_ssize_t, c=cython.double)
def combine(MI: cython.p_int, T: cython.p_double, row: cython.Py_ssize_t, K: cython.p_double, n: cython.Py_ssize_t, z: cython.p_double, o: cython.Py_ssize_t) -> cython.void:
    """z[o:] = sum over stages of the row's coefficients times K, in blocks that stay in the cache."""
    a = 0
    while a < n:
        b = a + 256
        if b > n:
            b = n
        for i in range(a, b):
            z[o + i] = 0.0
        for k in range(MI[8 + row], MI[9 + row]):
            c = T[k]
            j = MI[k] * n
            for i in range(a, b):
                z[o + i] += c * K[j + i]
        a = b


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, i=cython.Py_ssize_t, b=cython.Py_ssize_t, worst=cython.double, e=cython.double, g=cython.double, e3=cython.double, e5=cython.double, sc=cython.double, r=cython.double, tol=cython.double)
def step_error(D: cython.p_int, Z: cython.p_double, G: cython.p_double, y: cython.p_double, z: cython.p_double, err: cython.p_double, h: cython.double) -> cython.double:
    """Largest error over the bodies, 1 = just allowed. G: 0.. weight of a component (1 or 1/size), then rate scale a body, then trial."""
    n = D[0]
    tol = Z[8]
    worst = 0.0
    for b in range(D[1]):
        r = 0.0
        for i in range(D[9 + 3 * b], D[10 + 3 * b]):
            g = z[i] * G[i]
            r += g * g
        r = sqrt(r)
        if r < G[n + b]:
            r = G[n + b]
        G[n + D[1] + b] = r
        e3 = 0.0
        e5 = 0.0
        sc = 1.0 / tol
        for i in range(D[8 + 3 * b], D[9 + 3 * b]):
            g = G[i] * sc
            e = err[i] * g
            e3 += e * e
            e = err[n + i] * g
            e5 += e * e
        sc = r + 0.01 * Z[13] + 1e-200
        if b == D[3]:
            # energy, against the largest work so far or a part of what the bodies may have of it
            sc = r + 0.01 * Z[15] * Z[13] * Z[13] + 1e-200
        sc = 1.0 / (tol * sc)
        for i in range(D[9 + 3 * b], D[10 + 3 * b]):
            g = G[i] * sc
            e = err[i] * g
            e3 += e * e
            e = err[n + i] * g
            e5 += e * e
        if e5 > 0.0:
            e = h * e5 / sqrt(e5 + 0.01 * e3)
            if not e <= worst:
                worst = e
        elif e5 != e5:
            return e5
    return worst


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, b=cython.Py_ssize_t, i=cython.Py_ssize_t, r=cython.double, a=cython.double, g=cython.double, u=cython.double, v=cython.double, h=cython.double)
def first_step(I: cython.p_int, P: cython.p_double, W: cython.p_double, D: cython.p_int, Z: cython.p_double, G: cython.p_double, y: cython.p_double, K: cython.p_double) -> cython.double:
    """A first step from the largest rate and acceleration; sets the rate scales.

    What is held at rest has no rate of its own: a part of what the loads on it could cause is taken for the scene's.
    """
    n = D[0]
    r = 0.0
    a = 0.0
    for b in range(D[1]):
        u = 0.0
        v = 0.0
        for i in range(D[9 + 3 * b], D[10 + 3 * b]):
            g = y[i] * G[i]
            u += g * g
            g = K[i] * G[i]
            v += g * g
        u = sqrt(u)
        v = sqrt(v)
        if b != D[3]:
            if u > G[n + b]:
                G[n + b] = u
            if u > r:
                r = u
            if v > a:
                a = v
    if r > Z[13]:
        Z[13] = r
    a = sqrt(a)
    if a > r:
        r = a
    v = sqrt(P[0] * P[0] + P[1] * P[1] + P[2] * P[2]) / P[3]
    Z[15] = 0.0
    for b in range(I[0]):
        i = I[20] + 80 * b
        g = P[I[16] + 40 * b] * P[3]
        Z[15] += g * P[3]
        u = (fabs(W[i + 63]) + fabs(W[i + 64]) + fabs(W[i + 65]) + (fabs(W[i + 60]) + fabs(W[i + 61]) + fabs(W[i + 62])) / P[3]) / g
        if u > v:
            v = u
    v = 0.1 * sqrt(v)
    if v > Z[13]:
        Z[13] = v
    h = Z[10] - Z[0]
    if r > 0.0:
        h = pow(Z[8], 0.125) / r
    return h


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, s=cython.Py_ssize_t, i=cython.Py_ssize_t, k=cython.Py_ssize_t, t=cython.double, x=cython.double, w=cython.double, q=cython.double)
def dense(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, MI: cython.p_int, T: cython.p_double, D: cython.p_int, Z: cython.p_double, y: cython.p_double, z: cython.p_double, K: cython.p_double, F: cython.p_double, h: cython.double) -> cython.void:
    """The interpolating polynomial of order 7 over the step y -> z, its 7 coefficient rows in F."""
    n = D[0]
    for s in range(MI[0] + 1, MI[0] + 1 + MI[1]):
        combine(MI, T, s, K, n, F, 0)
        for i in range(n):
            F[i] = y[i] + h * F[i]
        t = Z[0] + T[s] * h
        if t > Z[9]:
            t = Z[9]
        if I[4] > 0 and P[6] < P[7]:
            settle(I, P, W, C, N, X, S, t, F, 0)
        evaluate(I, P, W, C, N, X, S, t, F, 0, K, s * n)
    Z[5] += MI[1]
    for i in range(n):
        q = z[i] - y[i]
        F[i] = q
        F[n + i] = h * K[i] - q
        F[2 * n + i] = 2.0 * q - h * (K[MI[0] * n + i] + K[i])
    for s in range(MI[2]):
        combine(MI, T, 18 + s, K, n, F, (3 + s) * n)
        for i in range(n):
            F[(3 + s) * n + i] *= h


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, i=cython.Py_ssize_t, w=cython.double, q=cython.double)
def interpolate(n: cython.Py_ssize_t, y: cython.p_double, F: cython.p_double, x: cython.double, out: cython.p_double, o: cython.Py_ssize_t) -> cython.void:
    """State at the fraction x of the step."""
    w = 1.0 - x
    for i in range(n):
        q = F[6 * n + i] * x
        q = (q + F[5 * n + i]) * w
        q = (q + F[4 * n + i]) * x
        q = (q + F[3 * n + i]) * w
        q = (q + F[2 * n + i]) * x
        q = (q + F[n + i]) * w
        out[o + i] = y[i] + (q + F[i]) * x


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, m=cython.Py_ssize_t, s=cython.Py_ssize_t, i=cython.Py_ssize_t, t=cython.double, q=cython.double, e=cython.double)
def attempt(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, MI: cython.p_int, T: cython.p_double, D: cython.p_int, Z: cython.p_double, y: cython.p_double, z: cython.p_double, K: cython.p_double, h: cython.double, near: cython.int) -> cython.int:
    """The stages of a step of length h and its solution in z, its small parts beside it; what `evaluate` says there.

    near: what is off the closures by a little is accelerated by a lot near a singular pose: the stages are settled too.
    """
    n = D[0]
    m = MI[0]
    for s in range(1, m):
        combine(MI, T, s, K, n, z, 0)
        for i in range(n):
            z[i] = y[i] + h * z[i]
        t = Z[0] + T[s] * h
        if t > Z[9]:
            t = Z[9]
        if near:
            settle(I, P, W, C, N, X, S, t, z, 0)
        evaluate(I, P, W, C, N, X, S, t, z, 0, K, s * n)
    combine(MI, T, m, K, n, z, 0)
    for i in range(n):
        q = h * z[i] + z[2 * n + i]
        e = y[i] + q
        z[n + i] = q - (e - y[i])
        z[i] = e
    Z[5] += m
    t = Z[0] + h
    if t > Z[9]:
        t = Z[9]
    return evaluate(I, P, W, C, N, X, S, t, z, 0, K, m * n)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, i=cython.Py_ssize_t, q=cython.double, have=cython.int)
def sample(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, MI: cython.p_int, T: cython.p_double, D: cython.p_int, Z: cython.p_double, y: cython.p_double, z: cython.p_double, K: cython.p_double, F: cython.p_double, h: cython.double, stop: cython.double, ts: cython.p_double, n_out: cython.Py_ssize_t, out: cython.p_double) -> cython.void:
    """The asked instants within the step y -> z, those at its end only where the piece ends (`stop`, else before it)."""
    n = D[0]
    have = 0
    while D[2] < n_out and (ts[D[2]] < Z[0] + h or ts[D[2]] <= stop):
        q = (ts[D[2]] - Z[0]) / h
        if q >= 1.0:
            for i in range(n):
                out[D[2] * n + i] = z[i]
        else:
            if have == 0:
                have = 1
                dense(I, P, W, C, N, X, S, MI, T, D, Z, y, z, K, F, h)
            interpolate(n, y, F, q, out, D[2] * n)
        D[2] += 1


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(t=cython.double, gap=cython.double)
def land(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, Z: cython.p_double, y: cython.p_double, K: cython.p_double) -> cython.int:
    """Bring the end of a step back onto the closures, with its derivative; 4 where they cannot be held."""
    t = Z[0]
    if t > Z[9]:
        t = Z[9]
    gap = settle(I, P, W, C, N, X, S, t, y, 0)
    if not gap <= 1e-11 * P[3] or P[5] < 1e-3 * P[4]:
        # a row that was left out opens, or the chosen ones come near to depending on each other: choose anew
        select(I, P, W, C, N, X, S, t, y, 0, 0)
        gap = settle(I, P, W, C, N, X, S, t, y, 0)
    if gap > Z[7] or gap != gap:
        Z[7] = gap
    if not gap <= 1e-8 * P[3]:
        return 4
    evaluate(I, P, W, C, N, X, S, t, y, 0, K, 0)
    Z[5] += 2
    return 0


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, i=cython.Py_ssize_t, b=cython.Py_ssize_t, m=cython.Py_ssize_t, count=cython.Py_ssize_t, h=cython.double, e=cython.double, f=cython.double, q=cython.double, noise=cython.double, last=cython.int, bad=cython.int, near=cython.int, dodges=cython.int, best=cython.double, best_h=cython.double, stop=cython.double, here=cython.double, code=cython.int)
def run(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, MI: cython.p_int, T: cython.p_double, D: cython.p_int, Z: cython.p_double, G: cython.p_double, y: cython.p_double, K: cython.p_double, z: cython.p_double, F: cython.p_double, ts: cython.p_double, n_out: cython.Py_ssize_t, out: cython.p_double, ends: cython.p_double, passed: cython.p_double, most: cython.Py_ssize_t) -> cython.int:
    """Up to `most` accepted steps towards the piece's end Z[10]; a code (see above).

    ends, passed: their ends; the states there, each with the least pivot of the closures within the step. Following
    (D[4]), `ends` gives the steps, none is judged and the first one's stages are settled, for how near it is to a
    singular pose is not known again.
    """
    n = D[0]
    m = MI[0]
    count = 0
    dodges = 0
    best = 0.0
    best_h = 0.0
    if Z[14] != 0.0:
        P[6] = 1.0 - D[4]
        if I[4]:
            select(I, P, W, C, N, X, S, Z[0], y, 0, 1)
            settle(I, P, W, C, N, X, S, Z[0], y, 0)
        evaluate(I, P, W, C, N, X, S, Z[0], y, 0, K, 0)
        Z[5] += 1
        if I[40]:
            Z[2] = slack(I, W)
            if Z[2] > 0.0:
                return 5
        e = first_step(I, P, W, D, Z, G, y, K)
        if Z[1] <= 0.0 or e < Z[1]:
            Z[1] = e
        Z[14] = 0.0
        Z[3] = 0.0
        for i in range(n):
            z[2 * n + i] = 0.0
    while D[2] < n_out and ts[D[2]] <= Z[0]:
        for i in range(n):
            out[D[2] * n + i] = y[i]
        D[2] += 1
    here = P[5]
    while Z[0] < Z[10]:
        if count >= most:
            return 1
        h = Z[1]
        stop = Z[10]
        last = 0
        if D[4]:
            stop = ends[count]
            h = stop - Z[0]
            last = 1
        elif Z[0] + 1.01 * h >= Z[10]:
            h = Z[10] - Z[0]
            last = 1
        elif Z[0] + 2.0 * h > Z[10]:
            h = 0.5 * (Z[10] - Z[0])
        if I[4] > 0 and P[5] < 1e-4 and h <= 1e-9 * fabs(Z[10]) and last == 0:
            # the rows come to depend on each other while rates grow: a lock, or the end of the range
            return 4
        if h <= 1e-14 * fabs(Z[10]) or h < 1e-300:
            if last == 0:
                return 2
        near = I[4] > 0 and (P[6] < P[7] or here < P[7])
        P[6] = 1.0
        bad = attempt(I, P, W, C, N, X, S, MI, T, D, Z, y, z, K, h, near)
        if I[40] and D[4] == 0:
            # halve the way to where a rope would push; the run ends just before it
            Z[2] = slack(I, W)
            if Z[2] > 0.0:
                Z[1] = 0.5 * h
                if Z[1] <= 1e-12 * (Z[10] + fabs(Z[0])):
                    return 5
                continue
        e = 0.0
        noise = 0.0
        if D[4] == 0:
            combine(MI, T, 16, K, n, F, 0)
            combine(MI, T, 17, K, n, F, n)
            e = step_error(D, Z, G, y, z, F, h)
        if near and D[4] == 0:
            # what rounding makes of the closures at the worst of the stages, by the tolerance
            noise = 1e300
            if P[6] > 0.0:
                noise = 1e-16 * h * Z[13] / (P[6] * Z[8])
            if dodges < 10 and last == 0 and (noise > 0.1 or e != e or bad < 0 or (e > 1.0 and dodges > 0)):
                # other lengths may keep the stages off the singular pose; at last the best of those tried
                q = noise
                if e > q:
                    q = e
                if e != e or bad < 0:
                    q = 1e300
                if dodges == 0 or q < best:
                    best = q
                    best_h = h
                dodges += 1
                Z[1] = 0.87 * h
                if dodges == 10:
                    Z[1] = best_h
                Z[6] += 1
                continue
            # a step that found no better way may be off by that much, also by what its start makes of the rounding
            q = P[6]
            if here < q:
                q = here
            noise = 3e-13 * h * Z[13] / (q * Z[8]) if q > 0.0 and dodges == 10 else 0.0
        if e != e or (bad < 0 and D[4] == 0):
            # outside what the scene can do: a much smaller step, or the end of it
            Z[6] += 1
            Z[3] = 1.0
            Z[1] = 0.1 * h
            if Z[1] < 1e-14 * (Z[10] - Z[0]) or Z[1] <= 1e-15 * fabs(Z[0]):
                return 3
            continue
        if e > 1.0 + noise:
            f = 0.9 * pow(e, -0.125)
            if f < 0.2:
                f = 0.2
            Z[1] = h * f
            Z[3] = 1.0
            Z[6] += 1
            continue
        dodges = 0
        f = 6.0
        if e > 1.0:
            f = 1.0
        elif e > 0.0:
            f = 0.9 * pow(e, -0.125)
            if f > 6.0:
                f = 6.0
        if Z[3] != 0.0 and f > 1.0:
            f = 1.0
        sample(I, P, W, C, N, X, S, MI, T, D, Z, y, z, K, F, h, stop if last else Z[0], ts, n_out, out)
        for i in range(n):
            y[i] = z[i]
            z[2 * n + i] = z[n + i]
        for b in range(D[1]):
            if D[4]:
                break
            G[n + b] = G[n + D[1] + b]
            if G[n + b] > Z[13] and b != D[3]:
                Z[13] = G[n + b]
        Z[0] += h
        if last:
            Z[0] = stop
        if last == 0 or Z[1] < h * f:
            # a step cut short by the end of the piece says nothing against a longer one after it
            Z[1] = h * f
        Z[3] = 0.0
        Z[4] += 1
        ends[count] = Z[0]
        e = P[6]
        if I[4]:
            code = land(I, P, W, C, N, X, S, Z, y, K)
            if code:
                return code
            here = P[5]
        else:
            for i in range(n):
                K[i] = K[m * n + i]
        if D[4] == 0:
            for i in range(n):
                passed[count * (n + 1) + i] = y[i]
            passed[count * (n + 1) + n] = e
        count += 1
    return 0


@cython.ccall
def advance(I_: cython.int[::1], P_: cython.double[::1], W_: cython.double[::1], C_: cython.int[::1], N_: cython.double[::1], X_: cython.double[::1], S_: cython.double[::1], MI_: cython.int[::1], T_: cython.double[::1], D_: cython.int[::1], Z_: cython.double[::1], G_: cython.double[::1], y_: cython.double[::1], K_: cython.double[::1], z_: cython.double[::1], F_: cython.double[::1], ts_: cython.double[::1], n_out: cython.Py_ssize_t, out_: cython.double[::1], ends_: cython.double[::1], passed_: cython.double[::1], most: cython.Py_ssize_t) -> cython.int:
    """Door to `run`: arrays of the scene, the method, the run's state and its output; all of at least one element."""
    code: cython.int
    if cython.compiled:
        I: cython.p_int = cython.address(I_[0])
        P: cython.p_double = cython.address(P_[0])
        W: cython.p_double = cython.address(W_[0])
        C: cython.p_int = cython.address(C_[0])
        N: cython.p_double = cython.address(N_[0])
        X: cython.p_double = cython.address(X_[0])
        S: cython.p_double = cython.address(S_[0])
        MI: cython.p_int = cython.address(MI_[0])
        T: cython.p_double = cython.address(T_[0])
        D: cython.p_int = cython.address(D_[0])
        Z: cython.p_double = cython.address(Z_[0])
        G: cython.p_double = cython.address(G_[0])
        y: cython.p_double = cython.address(y_[0])
        K: cython.p_double = cython.address(K_[0])
        z: cython.p_double = cython.address(z_[0])
        F: cython.p_double = cython.address(F_[0])
        ts: cython.p_double = cython.address(ts_[0])
        out: cython.p_double = cython.address(out_[0])
        ends: cython.p_double = cython.address(ends_[0])
        passed: cython.p_double = cython.address(passed_[0])
        with cython.nogil:
            code = run(I, P, W, C, N, X, S, MI, T, D, Z, G, y, K, z, F, ts, n_out, out, ends, passed, most)
    else:
        code = run(I_, P_, W_, C_, N_, X_, S_, MI_, T_, D_, Z_, G_, y_, K_, z_, F_, ts_, n_out, out_, ends_, passed_, most)
    return code


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
@cython.locals(n=cython.Py_ssize_t, j=cython.Py_ssize_t, i=cython.Py_ssize_t, k=cython.Py_ssize_t, B=cython.Py_ssize_t, o=cython.Py_ssize_t, bad=cython.int, worst=cython.int, gap=cython.double, least=cython.double)
def recover(I: cython.p_int, P: cython.p_double, W: cython.p_double, C: cython.p_int, N: cython.p_double, X: cython.p_double, S: cython.p_double, n: cython.Py_ssize_t, n_t: cython.Py_ssize_t, ts: cython.p_double, Y: cython.p_double, z: cython.p_double, out: cython.p_double, width: cython.Py_ssize_t) -> cython.int:
    """Everything the sweep knows at each instant, row by row in `out`; Y is settled on the closures in place.

    A row: bodies (30): R 9 r 3 omega 3 v 3 alpha 3 a 3 n_joint 3 f_joint 3; freedoms (4): q u udot driving load; loads (16) as in
    tree.py; rows (2): lambda, gap; then the gap over all rows, how many freedoms had nothing behind them, the least pivot of the closures.
    """
    worst = 0
    least = 1.0
    for j in range(n_t):
        gap = 0.0
        if I[4]:
            if j == 0 or I[38]:
                select(I, P, W, C, N, X, S, ts[j], Y, j * n, 1)
            gap = settle(I, P, W, C, N, X, S, ts[j], Y, j * n)
            least = P[5]
            if not gap <= 1e-11 * P[3] or P[5] < 1e-3 * P[4]:
                # as in `run`
                select(I, P, W, C, N, X, S, ts[j], Y, j * n, 0)
                gap = settle(I, P, W, C, N, X, S, ts[j], Y, j * n)
        bad = evaluate(I, P, W, C, N, X, S, ts[j], Y, j * n, z, 0)
        if bad > worst:
            worst = bad
        if I[39] == 0:
            push_closures(I, P, W)
            balance(I, P, W)
        o = j * width
        for i in range(I[0]):
            B = I[20] + 80 * i
            for k in range(18):
                out[o + k] = W[B + k]
            for k in range(6):
                out[o + 18 + k] = W[B + 54 + k]
                out[o + 24 + k] = W[B + 69 + k]
            o += 30
        for i in range(I[1]):
            B = I[21] + 16 * i
            for k in range(4):
                out[o + k] = W[B + 10 + k]
            o += 4
        for i in range(I[3]):
            B = I[23] + 16 * i
            for k in range(16):
                out[o + k] = W[B + k]
            o += 16
        for i in range(I[4]):
            B = I[24] + 16 * i
            out[o] = W[B + 12]
            out[o + 1] = W[B + 9]
            o += 2
        out[o] = gap
        out[o + 1] = bad
        out[o + 2] = least
    return worst


@cython.ccall
def states(I_: cython.int[::1], P_: cython.double[::1], W_: cython.double[::1], C_: cython.int[::1], N_: cython.double[::1], X_: cython.double[::1], S_: cython.double[::1], n: cython.Py_ssize_t, n_t: cython.Py_ssize_t, ts_: cython.double[::1], Y_: cython.double[::1], z_: cython.double[::1], out_: cython.double[::1], width: cython.Py_ssize_t) -> cython.int:
    """Door to `recover`."""
    code: cython.int
    if cython.compiled:
        I: cython.p_int = cython.address(I_[0])
        P: cython.p_double = cython.address(P_[0])
        W: cython.p_double = cython.address(W_[0])
        C: cython.p_int = cython.address(C_[0])
        N: cython.p_double = cython.address(N_[0])
        X: cython.p_double = cython.address(X_[0])
        S: cython.p_double = cython.address(S_[0])
        ts: cython.p_double = cython.address(ts_[0])
        Y: cython.p_double = cython.address(Y_[0])
        z: cython.p_double = cython.address(z_[0])
        out: cython.p_double = cython.address(out_[0])
        with cython.nogil:
            code = recover(I, P, W, C, N, X, S, n, n_t, ts, Y, z, out, width)
    else:
        code = recover(I_, P_, W_, C_, N_, X_, S_, n, n_t, ts_, Y_, z_, out_, width)
    return code
