"""Closed loops drawn a little wrong: random ones whose closed pose is known by construction, and drawings off it.

For tests of the assembly: the pose found must be near the drawing, and as near as the known one. Loops of 4 to 7 bodies
(the ground is one), several loops coupled, platforms on rods, and loops with rows that others hold already: parallel
pins, pins through one point, doors on two hinges.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import mean_arm
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector, vector_from_rotation
from tests.shared.drafted_mechanisms import body, joint, scene

KINDS = ("pin", "ball", "universal", "cylinder", "slide", "line", "plane", "rod", "weld")
OFTEN = np.array([5, 4, 3, 3, 2, 1, 1, 1, 0.5])
KEEP_AXES = ("slide", "weld")  # keep the relative attitude: such bodies are drawn with the same axes
# near: `near` says all poses. world: body axes are the world's and nothing is said. mixed: some bodies so, some so.
# positions: body axes are the world's, and near says positions.
MODES = ("near", "world", "mixed", "positions")
FAMILIES = ("loop", "coupled", "platform", "parallel", "spherical", "hinges")


class Known:
    """A mechanism and the pose in which it is closed: x (n, 3) origins, R (n, 3, 3). together: who share their axes."""

    def __init__(self, rng: np.random.Generator, count: int) -> None:
        self.rng = rng
        self.R = np.array([rotation_from_vector(a) for a in rng.normal(size=(count, 3))])
        self.x = rng.normal(size=(count, 3)) * 1.5
        self.center = 0.3 * rng.normal(size=(count, 3))
        self.together = list(range(count))
        self.joints: list[dict[str, Any]] = []

    def unit(self) -> Array:
        a = self.rng.normal(size=3)
        return np.asarray(a / np.linalg.norm(a))

    def pose(self, i: int) -> tuple[Array, Array]:
        return (np.zeros(3), np.eye(3)) if i == GROUND else (self.x[i], self.R[i])

    def share_axes(self, a: int, b: int) -> bool:
        """Give both bodies, and those that share theirs, one attitude; not possible with the ground's once joined."""
        old, new = (GROUND if i == GROUND else self.together[i] for i in (b, a))
        if old == new:
            return True
        if old == GROUND or any(j["b"] == f"b{i}" or j["a"] == f"b{i}" for j in self.joints
                                for i in range(len(self.x)) if self.together[i] == old):  # fmt: skip
            return False
        R = np.eye(3) if a == GROUND else self.R[a]
        for i in range(len(self.x)):
            if self.together[i] == old:
                self.together[i], self.R[i] = new, R
        return True

    def join(self, a: int, b: int, kind: str, at: Array | None = None, axis: Array | None = None) -> None:
        """A joint between two bodies that is closed in the known pose; at, axis: world, else at random."""
        if kind in KEEP_AXES and not self.share_axes(a, b):
            kind = "cylinder"
        rng = self.rng
        (xa, Ra), (xb, Rb) = self.pose(a), self.pose(b)
        P = 0.5 * (xa + xb) + 0.7 * rng.normal(size=3) if at is None else at
        n = self.unit() if axis is None else axis
        across = np.cross(n, self.unit())
        across /= np.linalg.norm(across)
        Q = {
            "cylinder": P + 0.5 * rng.normal() * n, "slide": P + 0.5 * rng.normal() * n,
            "line": P + 0.5 * rng.normal() * n, "plane": P + 0.5 * across, "rod": P + self.unit() * rng.uniform(0.7, 2),
        }.get(kind, P)  # fmt: skip
        given: dict[str, Any] = {}
        if kind in ("pin", "cylinder"):
            given["to_axis"] = Rb.T @ n
        if kind == "universal":
            given["to_axis"] = Rb.T @ across
        if kind == "rod":
            given["length"] = float(np.linalg.norm(Q - P))
        names = ["ground" if i == GROUND else f"b{i}" for i in (a, b)]
        self.joints.append(
            joint(f"j{len(self.joints)}", kind, names[0], Ra.T @ (P - xa), names[1], Rb.T @ (Q - xb), Ra.T @ n, **given)
        )

    def kind(self) -> str:
        return str(self.rng.choice(KINDS, p=OFTEN / OFTEN.sum()))

    def loop(self, path: list[int]) -> None:
        """Joints at random from body to body."""
        for a, b in pairwise(path):
            self.join(a, b, self.kind())


def known(seed: int) -> Known:
    """A closed scene at random; every other one a loop of its own, the rest the families by turns."""
    rng = np.random.default_rng(seed)
    family = FAMILIES[(seed // 2) % len(FAMILIES)] if seed % 2 else "loop"
    count = int(rng.integers(3, 7))
    k = Known(rng, count)
    g = GROUND
    if family == "loop":
        k.loop([g, *range(count), g])
    elif family == "coupled":
        k.loop([g, *range(count), g])
        for _ in range(int(rng.integers(1, 3))):
            a, b = (int(i) for i in rng.choice(count, 2, replace=False))
            k.join(a, b, str(rng.choice(["ball", "line", "plane", "rod", "cylinder"])))
    elif family == "platform":
        k = Known(rng, 2)
        k.join(g, 0, k.kind())
        for _ in range(int(rng.integers(3, 7))):
            k.join(int(rng.choice([g, 0])), 1, "rod")
        k.join(0, 1, str(rng.choice(["rod", "plane"])))
    elif family in ("parallel", "spherical"):
        axis, centre = k.unit(), rng.normal(size=3)
        path = [g, *range(count), g]
        for a, b in pairwise(path):
            at = rng.normal(size=3) * 1.5
            if family == "spherical":
                axis = (at - centre) / np.linalg.norm(at - centre)
            k.join(a, b, "pin", at, axis)
    else:
        k.loop([g, *range(count), g])
        axis, at = k.unit(), rng.normal(size=3)
        a, b = 0, count - 1
        for s in (0.0, 1.0):
            k.join(a, b, str(rng.choice(["ball", "pin"])), at + s * axis, axis)
    return k


@record
class Drawing:
    """A scene, its poses as drawn and the known ones that close it: x (n, 3) origins, R (n, 3, 3); size: of lengths."""

    scene: Mechanism
    x: Array
    R: Array
    x_known: Array
    R_known: Array
    size: float

    def ways(self, x: Array, R: Array) -> Array:
        """Turn [rad] and shift of the centre of mass (by the size) of each body from the drawing, (n, 2)."""
        c = np.array([b.center for b in self.scene.bodies])
        shift = x + np.einsum("nij,nj->ni", R, c) - self.x - np.einsum("nij,nj->ni", self.R, c)
        turn = [np.linalg.norm(vector_from_rotation(Q @ Q0.T)) for Q, Q0 in zip(R, self.R, strict=True)]
        return np.column_stack([turn, np.linalg.norm(shift, axis=1) / self.size])


def drawn(k: Known, off: float, mode: str) -> Drawing:
    """The scene with each body drawn off by up to `off`, of the size and in rad; mode: of MODES."""
    n = len(k.x)
    size = mean_arm(scene([body(f"b{i}", center=k.center[i]) for i in range(n)], k.joints))
    turns = np.array([*(k.unit() * k.rng.uniform(0, off) for _ in range(n)), np.zeros(3)])  # the last is the ground's
    R = np.array([rotation_from_vector(turns[t]) @ Q for t, Q in zip(k.together, k.R, strict=True)])
    c = k.x + np.einsum("nij,nj->ni", k.R, k.center)
    shifts = np.array([k.unit() * size * k.rng.uniform(0, off) for _ in range(n)])
    x = c + shifts - np.einsum("nij,nj->ni", R, k.center)

    # Where body axes are the world's, as drawn, every vector of the body becomes o + S v.
    bodies, S, o = [], np.tile(np.eye(3), (n + 1, 1, 1)), np.zeros((n + 1, 3))
    for i in range(n):
        given = {"near_position": x[i], "near_rotation": R[i]}
        if mode in ("world", "positions") or (mode == "mixed" and max(k.together[i], 0) % 2 == 0):
            S[i] = R[i]
            o[i] = 0.0 if mode == "positions" else x[i]
            given = {"near_position": x[i]} if mode == "positions" else {}
        bodies.append(body(f"b{i}", center=S[i] @ k.center[i] + o[i], **given))
    s = scene(bodies, k.joints)
    joints = tuple(
        replace(j, p=S[j.a] @ j.p + o[j.a], axis=S[j.a] @ j.axis, q=S[j.b] @ j.q + o[j.b], to_axis=S[j.b] @ j.to_axis)
        for j in s.joints
    )
    back = np.swapaxes(S[:n], 1, 2)
    R, R_known = R @ back, k.R @ back
    x, x_known = (y - np.einsum("nij,nj->ni", Q, o[:n]) for y, Q in ((x, R), (k.x, R_known)))
    return Drawing(replace(s, joints=joints), x, R, x_known, R_known, size)
