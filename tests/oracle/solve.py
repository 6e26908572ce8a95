"""Accelerations and reactions of a scene in one pose, on absolute coordinates.

    M V̇ + b = F + Jᵀλ,   J V̇ + γ = given,   b = (0, σ×Iσ)

With angular columns divided by a length of the scene and rows at unit length, the SVD of J gives its rank, the free
directions N and the self-stresses Z (JᵀZ = 0). V̇ = V̇p + N y, (NᵀMN) y = Nᵀ(F − b − M V̇p): massless parts need no
inverse of M. λ is known up to Z; a load c·λ is unique exactly if cᵀZ = 0 (manual/theory.md, "Redundancy"). Signs and
places are those of manual/signs.md: force and moment of `from` ON `to`, about the `to` point, by the constraint
alone; drives apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tests.oracle.loads import Push, from_outside, gathered, pushes
from tests.oracle.read import GROUND, Joint, Model, Scene, State, model, placed
from tests.oracle.rows import Rows, assemble
from tests.oracle.threads import rubbing, threads
from tests.oracle.turns import Array, cross

RANK = 1e-9  # singular values of the scaled J below this part of the largest count as zero
OPEN = 1e-8  # a share of a self-stress above this part of its largest makes a load open
MASSLESS = 1e-13  # the same for NᵀMN: a free direction that moves no mass


class Reaction(NamedTuple):
    """Force and moment of `from` on `to` by the constraint, about `point` (the `to` point), world axes.

    drive: what its drive exerts on `to` about or along the axis (of a rod the same as its force, positive pushing
    apart). unique: (7,) which of force, moment, drive are certain. share: (7, k) their parts in each self-stress;
    weight: (7,) makes moments forces, by the scene's length.
    """

    point: Array
    force: Array
    moment: Array
    drive: float
    unique: Array
    share: Array
    weight: Array


class Grounded(NamedTuple):
    """What a coupling puts ON the ground, force and moment about the origin (6,); share: in each self-stress (6, k)."""

    wrench: Array
    share: Array

    def about(self, point: Array) -> Grounded:
        """The moments about a point."""
        moved = np.eye(6)
        moved[3:, :3] = -np.cross(point, np.eye(3)).T  # M about it is M - point x F
        return Grounded(moved @ self.wrench, moved @ self.share)


@dataclass(frozen=True, eq=False)
class Solution:
    """One instant, world axes. Vectors by body or joint name.

    acceleration is of the centre of mass; loose (6n, k) are the motions no load decides (spin of a thin rod).
    foundation: force and moment about the asked point ON the foundation (55); residual: how badly J V̇ + γ = given
    fails, against its terms (above rounding no acceleration exists); unbalanced: the same for M V̇ + b = F + Jᵀλ.
    length: what divides moments where they are compared with forces.
    """

    acceleration: dict[str, Array]
    angular_acceleration: dict[str, Array]
    reactions: dict[str, Reaction]
    grounded: dict[str, Grounded]
    loads: dict[str, list[Push]]
    foundation_force: Array
    foundation_moment: Array
    rows: int
    rank: int
    freedoms: int
    grubler: int
    loose: Array
    residual: float
    unbalanced: float
    length: float

    def sum(self, terms: Mapping[str, float]) -> tuple[float, bool]:
        """Value of a sum of components named as in the results ("joints.top.force.z"), and whether it is certain."""
        wrenches: dict[str, Array] = {}
        for path, factor in terms.items():
            _, name, what, *component = path.split(".")
            k = 6 if what == "drive" else {"force": 0, "moment": 3}[what] + "xyz".index(component[0])
            wrenches.setdefault(name, np.zeros(7))[k] += factor
        return self.combined(wrenches)

    def along(self, name: str, force: Array | None = None, moment: Array | None = None) -> tuple[float, bool]:
        """force·F + moment·M of one joint, and whether it is certain."""
        parts = [np.zeros(3) if c is None else c for c in (force, moment)]
        return self.combined({name: np.concatenate([*parts, [0.0]])})

    def combined(self, wrenches: Mapping[str, Array]) -> tuple[float, bool]:
        """Σ c·(force, moment, drive) over joints, c (7,) each, and whether it is certain."""
        value, size, share = 0.0, 0.0, np.zeros_like(self.largest())
        for name, c in wrenches.items():
            joint = self.reactions[name]
            value += float(c[:3] @ joint.force + c[3:6] @ joint.moment + c[6] * joint.drive)
            share += c @ joint.share
            size += float(np.linalg.norm(c / np.where(joint.weight > 0.0, joint.weight, 1.0)))
        return value, bool(np.all(np.abs(share) <= OPEN * size * self.largest()))

    def largest(self) -> Array:
        """Largest part of each self-stress in any joint, (k,)."""
        return largest_part((r.weight, r.share) for r in self.reactions.values())


def largest_part(parts: Iterable[tuple[Array, Array]]) -> Array:
    """Largest weighted entry of each column over all (weight, share) pairs, (k,)."""
    sizes = [np.abs(weight[:, None] * share).max(axis=0) for weight, share in parts]
    return np.max(sizes, axis=0) if sizes else np.zeros(0)


Stiffness = Mapping[str, tuple[Array | float, Array | float]]  # of joints: force [N/m], moment [N m/rad]


class Motion(NamedTuple):
    """What the rows decide before any reaction: V̇ (6n,), the scaled J's SVD in pieces, and how well it fits."""

    V_dot: Array
    rows: Rows
    rank: int
    self_stress: Array
    least: Array
    loose: Array
    residual: float
    unbalanced: float


def solve(
    scene: Model | Scene,
    state: State,
    t: float = 0.0,
    about: Array | None = None,
    stiffness: Stiffness | None = None,
    length: float | None = None,
) -> Solution:
    """Everything at an instant.

    Open loads are split by least Σ|F|² + |M|²/length², or, with `stiffness` = {joint: (force, moment)} [N/m, N m/rad]
    (scalars, or three in the axes of `from`), by least Σ|F|²/k + |M|²/k over those joints, drives' efforts in F and
    M; what that leaves is split by the first.
    """
    read = scene if isinstance(scene, Model) else model(scene)
    size = scene_length(read, state)
    loads = acting(read, state, t, size)
    found = accelerations(read, state, t, loads, size)
    return answer(read, state, found, loads, size, about, stiffness, length)


def acting(read: Model, state: State, t: float, size: float) -> dict[str, list[Push]]:
    """All applied loads, and what rubs in threads by what these carry under them."""
    given = pushes(read, state, t)

    def multipliers(more: Mapping[str, list[Push]]) -> dict[str, float]:
        found = accelerations(read, state, t, {**given, **more}, size)
        rows = {row.joint: k for k, row in enumerate(found.rows.rows)}
        assert not any(np.abs(found.self_stress[rows[name]]).max(initial=0.0) > OPEN for name in threads(read))
        return {name: float(found.least[rows[name]]) for name in threads(read)}

    return given | rubbing(read, state, multipliers)


def answer(
    read: Model,
    state: State,
    found: Motion,
    loads: dict[str, list[Push]],
    size: float,
    about: Array | None = None,
    stiffness: Stiffness | None = None,
    length: float | None = None,
) -> Solution:
    """The reactions and the foundation's load of what moves so under these loads."""
    maps = {j.name: wrench_map(found.rows, j) for j in read.joints}
    lam = chosen(read, state, found, maps, stiffness, size if length is None else length)
    reactions = reactions_of(read, state, found, maps, lam, size)
    origin = np.zeros(3) if about is None else np.asarray(about, dtype=float)
    s, M_s = foundation(read, state, found.V_dot, loads, origin)
    V_dot = found.V_dot.reshape(-1, 6)
    n, rows = len(read.names), len(found.rows.rows)
    return Solution(
        acceleration={b: V_dot[k, :3] for k, b in enumerate(read.names)},
        angular_acceleration={b: V_dot[k, 3:] for k, b in enumerate(read.names)},
        reactions=reactions,
        grounded=on_the_ground(read, state, found, lam),
        loads=loads,
        foundation_force=s,
        foundation_moment=M_s,
        rows=rows,
        rank=found.rank,
        freedoms=6 * n - found.rank,
        grubler=6 * n - rows,
        loose=found.loose,
        residual=found.residual,
        unbalanced=found.unbalanced,
        length=size,
    )


def accelerations(scene: Model, state: State, t: float, loads: Mapping[str, list[Push]], size: float) -> Motion:
    """V̇ under loads."""
    rows = assemble(scene, state, t)
    M, b = inertia(scene, state)
    return moved(rows, rows.acceleration - rows.gamma, M, gathered(scene, state, loads) - b, size)


def moved(rows: Rows, wanted: Array, M: Array, push: Array, size: float, terms: Array | None = None) -> Motion:
    """V̇ of M V̇ = push + Jᵀλ, J V̇ = wanted by J's free directions; the multipliers' particular part and freedom.

    terms: what `wanted` is summed from, if that is larger: its rounding is no residual.
    """
    n = len(M) // 6
    scale = np.tile([1.0, 1, 1, size, size, size], n)  # unknowns: accelerations, and angular ones times the length
    M_, push_ = M / scale / scale[:, None], push / scale
    J_ = rows.J / scale
    norms = np.linalg.norm(J_, axis=1)
    target = wanted / norms
    U, S, Wt = np.linalg.svd(J_ / norms[:, None]) if len(J_) else (np.zeros((0, 0)), np.zeros(0), np.eye(6 * n))
    rank = int(np.sum(RANK * S[0] < S)) if len(S) else 0
    particular = Wt[:rank].T @ ((U[:, :rank].T @ target) / S[:rank])
    N = Wt[rank:].T
    values, vectors = np.linalg.eigh(N.T @ M_ @ N)
    heavy = values > MASSLESS * max(float(np.abs(np.diag(M_)).max()), 1e-300)
    drive = vectors.T @ (N.T @ (push_ - M_ @ particular))
    V_ = particular + N @ (vectors[:, heavy] @ (drive[heavy] / values[heavy]))
    needed = M_ @ V_ - push_  # = J_ᵀ λ_, what the reactions must give
    least = U[:, :rank] @ ((Wt[:rank] @ needed) / S[:rank]) / norms
    missing = target - U[:, :rank] @ (U[:, :rank].T @ target)
    asked = float(np.linalg.norm(target if terms is None else np.maximum(np.abs(wanted), terms) / norms))
    loose = N @ vectors[:, ~heavy]
    load = np.linalg.norm(push_) + np.linalg.norm(needed)
    return Motion(
        V_ / scale,
        rows,
        rank,
        U[:, rank:] / norms[:, None],
        least,
        loose / scale[:, None],
        residual=float(np.linalg.norm(missing) / asked) if asked > 0.0 else 0.0,
        unbalanced=float(np.linalg.norm(drive[~heavy]) / load) if load > 0.0 else 0.0,
    )


def inertia(scene: Model, state: State) -> tuple[Array, Array]:
    """M (6n, 6n) on (v of the centre, σ), and b = (0, σ×Iσ)."""
    n = len(scene.names)
    M, b = np.zeros((6 * n, 6 * n)), np.zeros(6 * n)
    for k, name in enumerate(scene.names):
        R, s = state[name].rotation, state[name].angular_velocity
        I_world = R @ scene.masses[name].inertia @ R.T
        M[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = scene.masses[name].mass * np.eye(3)
        M[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = I_world
        b[6 * k + 3 : 6 * k + 6] = cross(s, I_world @ s)
    return M, b


def wrench_map(rows: Rows, joint: Joint) -> Array:
    """(force, moment, drive) of a joint from all multipliers, (7, rows). A driven rod's force is its drive."""
    G = np.zeros((7, len(rows.rows)))
    for k, row in enumerate(rows.rows):
        if row.joint == joint.name:
            if row.drive:
                G[6, k] = 1.0
            if not row.drive or joint.kind == "rod":
                G[:3, k], G[3:6, k] = row.force, row.moment
    return G


def whole_map(rows: Rows, joint: Joint) -> Array:
    """All that a joint puts on `to`, its drive's effort, too, from all multipliers, (6, rows)."""
    own = [(row.force, row.moment) if row.joint == joint.name else (np.zeros(3), np.zeros(3)) for row in rows.rows]
    return np.array([np.concatenate(wrench) for wrench in own]).reshape(-1, 6).T


def weight_of(joint: Joint, length: float) -> Array:
    """What makes forces of (force, moment, drive), (7,); a rod's drive is its force already."""
    drive = {None: 0.0, "angle": 1 / length, "travel": 1.0, "length": 0.0}[joint.drive and joint.drive[0]]
    return np.array([1.0, 1, 1, *[1 / length] * 3, drive])


def chosen(
    scene: Model, state: State, found: Motion, maps: Mapping[str, Array], stiffness: Stiffness | None, length: float
) -> Array:
    """Multipliers with the least cost among all that fit."""
    Z, lam = found.self_stress, found.least
    if Z.shape[1] == 0:
        return lam
    costs = [np.concatenate([weight_of(j, length)[:, None] * maps[j.name] for j in scene.joints])]
    if stiffness is not None:
        held = []
        for j in scene.joints:
            if j.name in stiffness:
                R, G = placed(state, j.a.body).rotation, whole_map(found.rows, j)
                root = np.sqrt(np.concatenate([np.broadcast_to(k, 3) for k in stiffness[j.name]]))
                held.append(np.concatenate([R.T @ G[:3], R.T @ G[3:6]]) / root[:, None])
        costs.insert(0, np.concatenate(held))
    for C in costs:  # the second only settles what the first leaves
        y, _, rank, _ = np.linalg.lstsq(C @ Z, -C @ lam, rcond=1e-10)
        lam = lam + Z @ y
        Z = Z @ np.linalg.svd(C @ Z)[2][rank:].T
    return lam


def reactions_of(
    scene: Model, state: State, found: Motion, maps: Mapping[str, Array], lam: Array, size: float
) -> dict[str, Reaction]:
    """Each joint's wrench, and which of its components are certain."""
    shares = {j.name: (weight_of(j, size), maps[j.name] @ found.self_stress) for j in scene.joints}
    largest = largest_part(shares.values())
    reactions = {}
    for j in scene.joints:
        wrench = maps[j.name] @ lam
        weight, share = shares[j.name]
        point = placed(state, j.b.body).point(j.b.point)
        unique = np.all(np.abs(weight[:, None] * share) <= OPEN * largest, axis=1)
        if j.kind == "rod":
            unique[6] = unique[:3].all()
        reactions[j.name] = Reaction(point, wrench[:3], wrench[3:6], float(wrench[6]), unique, share, weight)
    return reactions


def on_the_ground(scene: Model, state: State, found: Motion, lam: Array) -> dict[str, Grounded]:
    """What rows of no joint put ON the ground: the opposite of what they put on all bodies, for they are inner."""
    names = {j.name for j in scene.joints}
    rows: dict[str, list[int]] = {}
    for k, row in enumerate(found.rows.rows):
        if row.joint not in names:
            rows.setdefault(row.joint, []).append(k)
    grounded = {}
    for name, own in rows.items():
        G = np.zeros((6, len(own)))
        for i, body in enumerate(scene.names):
            c = state[body].point(scene.masses[body].center)
            F, M = (found.rows.J[own, 6 * i + k : 6 * i + k + 3] for k in (0, 3))
            G -= np.concatenate([F, M + np.cross(c, F)], axis=1).T
        grounded[name] = Grounded(G @ lam[own], G @ found.self_stress[own])
    return grounded


def scene_length(scene: Model, state: State) -> float:
    """Mean distance of the joints' points from the centres of their bodies [m]; 1 if there is none."""
    ends = [e for j in scene.joints for e in (j.a, j.b) if e.body != GROUND]
    arms = [np.linalg.norm(e.point - scene.masses[e.body].center) for e in ends]
    mean = float(np.mean(arms)) if arms else 0.0
    return mean if mean > 0.0 else 1.0


def foundation(
    scene: Model, state: State, V_dot: Array, loads: Mapping[str, list[Push]], about: Array
) -> tuple[Array, Array]:
    """(55): s = Σk − Σmẍ and M_s about a point; k are weight, forces and couples, all else is internal."""
    s, M_s = np.zeros(3), np.zeros(3)
    for name, parts in loads.items():
        if name == "gravity" or from_outside(scene, name):
            for push in (p for p in parts if p.body != GROUND):
                s, M_s = s + push.force, M_s + push.about(about)
    M, b = inertia(scene, state)
    rate = (M @ V_dot + b).reshape(-1, 6)
    for k, name in enumerate(scene.names):
        c = state[name].point(scene.masses[name].center)
        s, M_s = s - rate[k, :3], M_s - cross(c - about, rate[k, :3]) - rate[k, 3:]
    return s, M_s
