"""Trees of bodies by their joint coordinates, with closures and contacts: what pushes them at rest, by own equations.

    M a = Q + J' lambda,     J a = -STIFF phi
Q are springs, weights and pushes at points, and in turning frames what is centrifugal. Nothing of heun is used. Vectors
may be long doubles: then every value has their digits, but for the accelerations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np

Vector = np.ndarray[Any, Any]
STIFF = 20.0  # how fast an open closure closes along the way
TOUCHES = 1e-8  # of a contact
GROUND = -1
EYE = np.eye(3)


@dataclass
class Body:
    """joint: pin, slide, ball, universal or free; at, to: its point in the parent's and the own axes; axes: of pins,
    slides (one, in the parent's axes) and universals (the second in the own ones); start: coordinates, of a ball
    a quaternion, of what is free a place before it."""

    name: str
    parent: int
    joint: str
    at: Vector
    to: Vector
    axes: list[Vector]
    start: list[float]
    mass: float
    center: Vector
    inertia: Vector
    points: dict[str, Vector] = field(default_factory=dict)


@dataclass
class Point:
    """A point of a body, or of the ground (GROUND)."""

    body: int
    place: Vector


@dataclass
class Tree:
    """What stands in a scene.

    springs: (from, to, stiffness, length); pushes: (point, vector, whether it follows the body); couples: the same of
    bodies; torques: (body, a, b, c, d, n, e), a + b x + c x^3 + d sin(n x + e) of its coordinate x; rods: (from, to,
    length); lines: (point, ground, axis); ropes: (from, to, length, sense), 1 at most, -1 at least; stops: (body,
    limit, sense), 1 at least, -1 at most; spin: of the frame, about an axis through the origin.
    """

    bodies: list[Body] = field(default_factory=list)
    gravity: Vector = field(default_factory=lambda: np.zeros(3))
    springs: list[tuple[Point, Point, float, float]] = field(default_factory=list)
    pushes: list[tuple[Point, Vector, bool]] = field(default_factory=list)
    couples: list[tuple[int, Vector, bool]] = field(default_factory=list)
    torques: list[tuple[int, float, float, float, float, float, float]] = field(default_factory=list)
    rods: list[tuple[Point, Point, float]] = field(default_factory=list)
    lines: list[tuple[Point, Vector, Vector]] = field(default_factory=list)
    ropes: list[tuple[Point, Point, float, int]] = field(default_factory=list)
    stops: list[tuple[int, float, int]] = field(default_factory=list)
    spin: Vector = field(default_factory=lambda: np.zeros(3))


@dataclass
class Pushed:
    """M, Q, and of closures, then contacts, rows and gaps; places of all points, (p, 3)."""

    M: Vector
    Q: Vector
    J: Vector
    phi: Vector
    C: Vector
    gaps: Vector
    P: Vector


def cross(a: Vector, b: Vector) -> Vector:
    """Of last axes, without the ceremony of NumPy's."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    first = y * w - z * v
    out = np.empty((*first.shape, 3), dtype=first.dtype)
    out[..., 0], out[..., 1], out[..., 2] = first, z * u - x * w, x * v - y * u
    return out


def hat(v: Vector) -> Vector:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def turn(K: Vector, KK: Vector, angle: Any) -> Vector:
    """About the unit axis whose hat is K, by sines."""
    s = np.sin(angle / 2)
    return EYE + np.sin(angle) * K + 2 * s * s * KK


def of_quaternion(q: Vector) -> Vector:
    """The rotation of a quaternion of any length."""
    w, x, y, z = q
    s = 2 / (w * w + x * x + y * y + z * z)
    return np.array([
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ])  # fmt: skip


WIDTHS = {"pin": (1, 1), "slide": (1, 1), "ball": (4, 3), "universal": (2, 2), "free": (7, 6)}


class Equations:
    """What pushes a tree at a place y; rates of y for velocities u."""

    def __init__(self, tree: Tree) -> None:
        self.tree, n = tree, len(tree.bodies)
        self.y_at, self.u_at = [0], [0]
        for body in tree.bodies:
            a, b = WIDTHS[body.joint]
            self.y_at.append(self.y_at[-1] + a)
            self.u_at.append(self.u_at[-1] + b)
        self.f = self.u_at[-1]
        self.y0 = np.array([x for body in tree.bodies for x in body.start], dtype=float)
        self.hats = [[(hat(a), hat(a) @ hat(a)) for a in body.axes] for body in tree.bodies]
        self.carries = np.zeros((n + 1, self.f), dtype=bool)
        for i, body in enumerate(tree.bodies):
            if body.parent >= 0:
                self.carries[i] = self.carries[body.parent]
            self.carries[i, self.u_at[i] : self.u_at[i + 1]] = True
        self.roots = np.zeros((n, 3, 3))
        for i, body in enumerate(tree.bodies):
            values, axes = np.linalg.eigh(body.inertia)
            self.roots[i] = axes * np.sqrt(np.maximum(values, 0.0))
        self.mass = np.array([body.mass for body in tree.bodies])
        self.gather()

    def gather(self) -> None:
        """All points in one array: centres first, then those of the loads, of closures, of contacts."""
        t, n = self.tree, len(self.tree.bodies)
        points = [Point(i, body.center) for i, body in enumerate(t.bodies)]

        def put(new: list[Point]) -> slice:
            points.extend(new)
            return slice(len(points) - len(new), len(points))

        self.spring_a, self.spring_b = put([s[0] for s in t.springs]), put([s[1] for s in t.springs])
        self.pushed = put([p[0] for p in t.pushes])
        self.rod_a, self.rod_b = put([r[0] for r in t.rods]), put([r[1] for r in t.rods])
        self.line_b = put([line[0] for line in t.lines])
        self.rope_a, self.rope_b = put([r[0] for r in t.ropes]), put([r[1] for r in t.ropes])
        self.told = put([Point(i, p) for i, body in enumerate(t.bodies) for p in (np.zeros(3), *body.points.values())])
        self.owner = np.array([p.body if p.body >= 0 else n for p in points])
        self.local = np.array([p.place for p in points], dtype=float)
        self.k = np.array([s[2] for s in t.springs], dtype=float)
        self.free = np.array([s[3] for s in t.springs], dtype=float)
        self.lengths = np.array([r[2] for r in t.rods], dtype=float)
        self.most = np.array([r[2] for r in t.ropes], dtype=float)
        self.sense = np.array([r[3] for r in t.ropes], dtype=float)
        self.across = []
        for _, _, axis in t.lines:
            e = np.eye(3)[int(np.argmin(np.abs(axis)))]
            first = np.cross(axis, e)
            first = first / np.linalg.norm(first)
            self.across.append(np.array([first, np.cross(axis, first)]))
        self.mask = self.carries[self.owner][:, :, None]

    def placed(self, y: Vector) -> tuple[Vector, Vector, Vector, Vector, Vector]:
        """Rotations and origins of bodies (the ground last), and of velocities axes, points, whether they turn."""
        t, n, kind = self.tree, len(self.tree.bodies), y.dtype
        R, r = np.zeros((n + 1, 3, 3), dtype=kind), np.zeros((n + 1, 3), dtype=kind)
        R[n] = EYE
        axes, at, turns = np.zeros((self.f, 3), dtype=kind), np.zeros((self.f, 3), dtype=kind), np.zeros(self.f)
        for i, body in enumerate(t.bodies):
            Rp, a, u = R[body.parent], self.y_at[i], self.u_at[i]
            p = r[body.parent] + Rp @ body.at
            if body.joint in ("pin", "universal"):
                R[i] = Rp @ turn(*self.hats[i][0], y[a])
                axes[u], at[u], turns[u] = Rp @ body.axes[0], p, 1.0
                if body.joint == "universal":
                    axes[u + 1], at[u + 1], turns[u + 1] = R[i] @ body.axes[1], p, 1.0
                    R[i] = R[i] @ turn(*self.hats[i][1], y[a + 1])
            elif body.joint == "slide":
                R[i] = Rp
                axes[u] = Rp @ body.axes[0]
                p = p + y[a] * axes[u]
            else:
                if body.joint == "free":
                    axes[u : u + 3] = EYE
                    p = p + y[a : a + 3]
                    a, u = a + 3, u + 3
                R[i] = Rp @ of_quaternion(y[a : a + 4])
                axes[u : u + 3], at[u : u + 3], turns[u : u + 3] = EYE, p, 1.0
            r[i] = p - R[i] @ body.to
        return R, r, axes, at, turns

    def pushed_at(self, y: Vector) -> Pushed:
        """All there is at a place."""
        t, n = self.tree, len(self.tree.bodies)
        R, r, axes, at, turns = self.placed(y)
        P = r[self.owner] + (R[self.owner] @ self.local[:, :, None])[:, :, 0]
        V = np.where(turns[:, None] > 0, cross(axes[None], P[:, None] - at[None]), axes[None]) * self.mask
        W = (axes * turns[:, None])[None] * self.carries[:n, :, None]
        root = R[:n] @ self.roots
        X = (V[:n] * np.sqrt(self.mass)[:, None, None]).transpose(1, 0, 2).reshape(self.f, -1)
        Y = (W @ root).transpose(1, 0, 2).reshape(self.f, -1)
        F = np.zeros(P.shape, dtype=y.dtype)
        F[:n] = self.mass[:, None] * t.gravity
        Q = np.zeros(self.f, dtype=y.dtype)
        if t.spin.any():
            F[:n] -= self.mass[:, None] * cross(t.spin, cross(t.spin, P[:n]))
            h = (root @ (root.transpose(0, 2, 1) @ t.spin)[:, :, None])[:, :, 0]
            Q = Q - np.einsum("ifk,ik->f", W, cross(t.spin, h))
        if len(self.k):
            d = P[self.spring_b] - P[self.spring_a]
            pull = (self.k * (1 - self.free / np.sqrt((d * d).sum(axis=1))))[:, None] * d
            F[self.spring_a], F[self.spring_b] = pull, -pull
        for k, (point, vector, follows) in enumerate(t.pushes):
            F[self.pushed.start + k] = R[point.body] @ vector if follows else vector
        for b, vector, follows in t.couples:
            Q = Q + W[b] @ (R[b] @ vector if follows else vector)
        for body, a, b, c, d, m, e in t.torques:
            x = y[self.y_at[body]]
            Q[self.u_at[body]] += a + b * x + c * x**3 + d * np.sin(m * x + e)
        Q = Q + V.transpose(1, 0, 2).reshape(self.f, -1) @ F.ravel()
        J, phi = self.closures(P, V)
        C, gaps = self.contacts(P, V, y)
        return Pushed(X @ X.T + Y @ Y.T, Q, J, phi, C, gaps, P)

    def closures(self, P: Vector, V: Vector) -> tuple[Vector, Vector]:
        """Rows and gaps of rods and lines."""
        J, phi = [np.zeros((0, self.f), dtype=P.dtype)], [np.zeros(0, dtype=P.dtype)]
        if len(self.lengths):
            rows, length = along(P, V, self.rod_a, self.rod_b)
            J.append(rows)
            phi.append(length - self.lengths)
        for k, (_, ground, _) in enumerate(self.tree.lines):
            b = self.line_b.start + k
            J.append(self.across[k] @ V[b].T)
            phi.append(self.across[k] @ (P[b] - ground))
        return np.concatenate(J), np.concatenate(phi)

    def contacts(self, P: Vector, V: Vector, y: Vector) -> tuple[Vector, Vector]:
        """Rows and gaps of ropes and stops; both grow as they open."""
        C, gaps = [np.zeros((0, self.f), dtype=P.dtype)], [np.zeros(0, dtype=P.dtype)]
        if len(self.most):
            rows, length = along(P, V, self.rope_a, self.rope_b)
            C.append(-self.sense[:, None] * rows)
            gaps.append(self.sense * (self.most - length))
        for b, limit, sense in self.tree.stops:
            row = np.zeros((1, self.f), dtype=P.dtype)
            row[0, self.u_at[b]] = sense
            C.append(row)
            gaps.append(np.array([sense * (y[self.y_at[b]] - limit)]))
        return np.concatenate(C), np.concatenate(gaps)

    def rates(self, y: Vector, u: Vector) -> Vector:
        """dy/ds for velocities u."""
        out = np.zeros(len(y), dtype=y.dtype)
        R = None
        for i, body in enumerate(self.tree.bodies):
            a, v = self.y_at[i], self.u_at[i]
            if body.joint in ("pin", "slide", "universal"):
                out[a : self.y_at[i + 1]] = u[v : self.u_at[i + 1]]
                continue
            if body.joint == "free":
                out[a : a + 3] = u[v : v + 3]
                a, v = a + 3, v + 3
            if R is None and body.parent >= 0:
                R = self.placed(y)[0]
            own = u[v : v + 3] if body.parent < 0 or R is None else R[body.parent].T @ u[v : v + 3]
            w, x = y[a], y[a + 1 : a + 4]
            out[a] = -0.5 * (own @ x)
            out[a + 1 : a + 4] = 0.5 * (w * own + cross(own, x))
        return out

    def moved(self, y: Vector, by: Vector) -> Vector:
        """A place displaced by small turns and shifts."""
        new = y + self.rates(y, by)
        for i, body in enumerate(self.tree.bodies):
            if body.joint in ("ball", "free"):
                end = self.y_at[i + 1]
                new[end - 4 : end] = new[end - 4 : end] / np.sqrt((new[end - 4 : end] ** 2).sum())
        return new


def along(P: Vector, V: Vector, a: slice, b: slice) -> tuple[Vector, Vector]:
    """Rows and values of distances between points."""
    d = P[b] - P[a]
    length = np.sqrt((d * d).sum(axis=1))
    return np.einsum("kfi,ki->kf", V[b] - V[a], d / length[:, None]), length


def solve(M: Vector, Q: Vector, J: Vector, wanted: Vector) -> tuple[Vector, Vector]:
    """Accelerations and lambda of M a = Q + J' lambda, J a = wanted; the least lambda where rows repeat one another."""
    if not len(J):
        return np.linalg.solve(M, Q), np.zeros(0)
    back = np.linalg.solve(M, np.column_stack([Q, J.T]))
    S = J @ back[:, 1:]
    rest = wanted - J @ back[:, 0]
    scale = np.sqrt(np.maximum(np.diag(S), 1e-300))
    values, axes = np.linalg.eigh(S / np.outer(scale, scale))
    held = values > 1e-11 * values[-1]
    lam = (axes[:, held] @ ((axes[:, held].T @ (rest / scale)) / values[held])) / scale
    return back[:, 0] + back[:, 1:] @ lam, lam


def bearing(at: Pushed, touching: list[int], leave: int = -1) -> tuple[list[int], Vector]:
    """Which of the touching contacts bear: none pulls, none of the others closes; leave: one that shall not."""
    best: tuple[float, list[int], Vector] = (math.inf, [], np.zeros(0))
    own = [k for k in touching if k != leave]
    for count in range(len(own) + 1):
        for bear in combinations(own, count):
            rows = list(bear)
            J = np.concatenate([at.J, at.C[rows]])
            a, lam = solve(at.M, at.Q, J, np.zeros(len(J)))
            pulls = -lam[len(at.J) :]
            closing = -(at.C[[k for k in own if k not in bear]] @ a)
            sizes = np.sqrt(np.abs(np.einsum("ki,ij,kj->k", at.C[rows], at.M, at.C[rows])))
            worst = max((pulls * 1.0).max(initial=0.0), (closing * (sizes.max(initial=1.0))).max(initial=0.0))
            if worst < 1e-10 * float(np.abs(at.Q).max(initial=0.0)) + 1e-14:
                return rows, a
            if worst < best[0]:
                best = (worst, rows, a)
    return best[1], best[2]
