"""Freedoms without inertia: motions of the tree that turn bodies about axes without inertia and move no mass.

Some inertia is lent to those bodies, so that the tree can be factored, and what it takes of the loads is given back
(kernel/response.py, weigh_lent), which leaves the bodies as they are. Where the closed loops hold them that has an
answer; where nothing holds them no acceleration exists, and it is said which bodies turn about which axes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.mechanism.model import GROUND, PointLoad, RopeLoad
from heuncli.multibody.tree.idle_spins import without_inertia
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, lacking_inertia
from heuncli.multibody.tree.tables import Table, table, vectors
from heuncli.results.results import Array

POSES = 3  # at which axes are looked for beside the start: those of one pose may be an accident
SEED = 1901  # fixed: the same scene is solved in the same way


@record
class TreePoses:
    """Where the bodies are, tree order: attitudes R (n, 3, 3), joint points r (n, 3)."""

    R: Array
    r: Array


@record
class Massless:
    """Motions of the tree, k of them, independent, that move no mass: all bodies that are not listed rest.

    bodies (n): their places in the tree; omega, v (n, 3, k): angular velocity, velocity of the joint point over the
    scene's size.
    """

    bodies: list[int]
    omega: Array
    v: Array

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.omega.shape[2])

    def among(self, N: Array) -> Massless:
        """Combinations of them, N (k, other)."""
        return Massless(self.bodies, self.omega @ N, self.v @ N)

    def of(self, body: int, point: Array | None, at: TreePoses, size: float) -> tuple[Array, Array]:
        """Of a body (-1: the ground) its angular velocities, and velocities over the size of its point, (3, k)."""
        if body not in self.bodies:
            return np.zeros((3, self.count)), np.zeros((3, self.count))
        n = self.bodies.index(body)
        arm = np.zeros(3) if point is None else (point - at.r[body]) / size
        return self.omega[n], self.v[n] + np.cross(self.omega[n], arm, axis=0)

    def axes(self, at: TreePoses) -> dict[int, Array]:
        """Of each body that turns its angular velocities, body axes (k, 3)."""
        turning = np.einsum("nji,njk->nki", at.R[self.bodies], self.omega)
        largest = np.abs(turning).max(axis=(1, 2), initial=0.0)
        least = tolerances.RANK * largest.max(initial=0.0)
        return {b: turning[n] for n, b in enumerate(self.bodies) if largest[n] > least}


def lend(scene: PreparedScene, lacking: Mapping[int, Array]) -> PreparedScene:
    """The scene with inertia lent to what motions of its tree turn that move no mass, among bodies that lack some."""
    layout, at = scene.layout, start_of(scene)
    # the first body that turns hangs on one that rests: mostly it resists by itself
    alone = (at_rest(layout, i, axes, at) @ freedoms_of(layout, i, at).T for i, axes in lacking.items())
    if not any(null_space(resisted, tolerances.RANK).size for resisted in alone):
        return scene
    if not massless(scene, lacking, at).count:
        return scene
    rows = [row for body, axes in axes_to_lend(scene, lacking).items() for row in lent(scene, body, axes)]
    return replace(scene, layout=replace(layout, tables=layout.tables | {"lents": table(kernel.Lent, rows)}))


def loose_axes(scene: PreparedScene, bodies: Table, rows: Table) -> dict[int, Array]:
    """The bodies that turn without inertia where nothing holds them, and their axes, body axes (k, 3), unit vectors.

    By recovered bodies and closure rows, of one instant.
    """
    at = TreePoses(bodies["R"], bodies["r"])
    still = massless(scene, lacking_inertia(scene), at)
    return {i: span(turning) for i, turning in loose(scene.layout, still, at, rows).axes(at).items()}


INDIFFERENT = ("ball", "universal", "rod", "weld")  # to spins of a body about the points that they hold


def is_idle(scene: PreparedScene, recovered: Recovered, k: int) -> bool:
    """Whether what nothing holds at an instant are spins about all points at which bodies are held, and unloaded.

    Such as those of two thin rods on a universal: accelerations and reactions do not depend on them, for what the
    universal holds of one spin the other one gives way to.
    """
    layout, bodies = scene.layout, recovered.bodies[k]
    at = TreePoses(bodies["R"], bodies["r"])
    free = loose(layout, massless(scene, lacking_inertia(scene), at), at, recovered.rows[k])
    if free.count != recovered.idle[k] or not holds_still(scene, free, at):
        return False
    power, scale = np.zeros(free.count), 0.0
    for load, rows in scene.mechanism.load_rows():
        if isinstance(load, RopeLoad):
            pulled, size = pulled_along(scene, recovered, k, load, free, at)
            power, scale = power + pulled, scale + size
            continue
        for row, answer in zip(layout.tables["loads"][rows], recovered.loads[k, rows], strict=True):
            F, M = answer["force"], answer["moment"]
            ends = [(row["b"], answer["at"], 1.0), (row["a"], answer["from_at"], -1.0)]
            for body, point, sign in ends[:1] if isinstance(load, PointLoad) else ends:
                omega, v = free.of(int(body), point, at, layout.size)
                power += sign * (F @ v * layout.size + M @ omega)
            scale += float(np.sqrt(F @ F)) * layout.size + float(np.sqrt(M @ M))
    return bool(np.all(np.abs(power) <= tolerances.NO_MOMENT * scale))


def pulled_along(
    scene: PreparedScene, recovered: Recovered, k: int, load: RopeLoad, free: Massless, at: TreePoses
) -> tuple[Array, float]:
    """What a rope that stretches does along the motions at an instant, (count,), and of what size its loads are."""
    layout, row = scene.layout, scene.mechanism.row_of_rope(load.name)
    first, value = int(layout.tables["loads"][row]["part"]), float(recovered.loads["value"][k, row])
    power, scale = np.zeros(free.count), 0.0
    for own in range(first, first + len(load.parts)):
        ends, answer = layout.tables["parts"][own], recovered.parts[k, own]
        F, M = value * answer["f"], value * answer["m"]
        for body, sign in ((int(ends["b"]), 1.0), (int(ends["a"]), -1.0)):
            omega, v = free.of(body, answer["Q"], at, layout.size)
            power += sign * (F @ v * layout.size + M @ omega)
        scale += float(np.sqrt(F @ F)) * layout.size + float(np.sqrt(M @ M))
    return power, scale


def holds_still(scene: PreparedScene, free: Massless, at: TreePoses) -> bool:
    """Whether motions leave the points of all joints where they are, and turn no direction that guides another body.

    Nor an angle that is told: a pin's, a cylinder's.
    """
    layout = scene.layout
    for joint in scene.mechanism.joints:
        for end, point in ((joint.a, joint.p), (joint.b, joint.q)):
            body = layout.place.get(end, -1)
            if body < 0:
                continue
            held = at.r[body] + at.R[body] @ (point - layout.reference[body])
            omega, v = free.of(body, held, at, layout.size)
            guided = joint.kind in ("line", "plane") and end == joint.b
            if np.abs(v).max(initial=0.0) > tolerances.ON_AXIS:
                return False
            if np.abs(omega).max(initial=0.0) > tolerances.RANK and joint.kind not in INDIFFERENT and not guided:
                return False
    return True


def start_of(scene: PreparedScene) -> TreePoses:
    """Where the bodies are at the start."""
    layout, start = scene.layout, scene.start
    order = [h.body for h in layout.spanning.hangs]
    R = start.rotation[order]
    return TreePoses(R, start.position[order] + np.einsum("nij,nj->ni", R, layout.reference))


def massless(scene: PreparedScene, lacking: Mapping[int, Array], at: TreePoses) -> Massless:
    """The motions of the tree that move no mass; lacking: the bodies that lack inertia, and their axes without it.

    A body with all its inertia rests in them as the ground does; its freedoms may make up for what its parent does.
    Tips to roots: A (turn, shift) = 0 of a body where neither it nor what it carries resists; what its own freedoms S
    cannot make up for is a condition on its parent. Roots to tips: what the freedoms then do.
    """
    layout = scene.layout
    parents = layout.bodies["parent"].tolist()
    bodies = [i for i, parent in enumerate(parents) if i in lacking or parent in lacking]
    conditions = {i: [at_rest(layout, i, lacking.get(i), at)] for i in bodies}
    own, inverse = {}, {}
    for i in reversed(bodies):
        A, S = np.concatenate(conditions[i]), freedoms_of(layout, i, at).T
        U, sigma, Vt = np.linalg.svd(A @ S, full_matrices=True)
        rank = rank_of(sigma, tolerances.RANK)
        own[i] = S @ Vt[rank:].T
        inverse[i] = S @ (Vt[:rank].T / sigma[:rank]) @ U[:, :rank].T @ A
        if parents[i] in lacking:
            conditions[parents[i]].append(independent(U[:, rank:].T @ A @ carried_along(layout, i, at)))
    motion = np.zeros((len(bodies), 6, sum(free.shape[1] for free in own.values())))
    first = 0
    number = {body: n for n, body in enumerate(bodies) if body in lacking}
    for n, i in enumerate(bodies):
        if parents[i] in number:
            along = carried_along(layout, i, at) @ motion[number[parents[i]]]
            motion[n] = along - inverse[i] @ along
        end = first + own[i].shape[1]
        motion[n, :, first:end] += own[i]
        first = end
    _, sigma, Vt = np.linalg.svd(motion.reshape(6 * len(bodies), first), full_matrices=False)
    return Massless(bodies, motion[:, :3], motion[:, 3:]).among(Vt.T / sigma)


def at_rest(layout: Layout, i: int, axes: Array | None, at: TreePoses) -> Array:
    """Conditions on turn and shift of a body, (n, 6): its centre rests, it turns about `axes` without inertia alone."""
    R, c = at.R[i], layout.mechanism.bodies[layout.spanning.hangs[i].body].center - layout.reference[i]
    across = np.eye(3) if axes is None else np.linalg.svd(axes, full_matrices=True)[2][len(axes) :]
    found = np.zeros((3 + len(across), 6))
    found[:3, :3], found[:3, 3:], found[3:, :3] = turned_by(R @ c / layout.size), np.eye(3), across @ R.T
    return found


def turned_by(arm: Array) -> Array:
    """The matrix of omega x arm."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def carried_along(layout: Layout, i: int, at: TreePoses) -> Array:
    """What the parent's turn and shift do to a body whose joint is fixed, (6, 6); a ball's turns are its own."""
    found = np.eye(6)
    arm = (at.r[i] - at.r[layout.bodies["parent"][i]]) / layout.size
    found[3:, :3] = turned_by(arm)
    if layout.bodies["ball"][i]:
        found[:3] = 0.0
    return found


def freedoms_of(layout: Layout, i: int, at: TreePoses) -> Array:
    """What each freedom of a body that is not driven does to it: turn and shift, world axes (n, 6)."""
    row = layout.bodies[i]
    of_parent = at.R[row["parent"]] if row["parent"] >= 0 else np.eye(3)
    found = [np.eye(3, 6)] if row["ball"] else []
    for freedom in layout.tables["freedoms"][row["first_freedom"] : row["end_freedom"]]:
        if not freedom["driven"]:
            s = (at.R[i] if freedom["kind"] == kernel.TURN_IN_BODY else of_parent) @ vectors(freedom["direction"])
            shifts = freedom["kind"] == kernel.SHIFT
            found.append(np.concatenate([0.0 * s, s] if shifts else [s, 0.0 * s])[None])
    return np.concatenate([np.zeros((0, 6)), *found])


def loose(layout: Layout, still: Massless, at: TreePoses, rows: Table) -> Massless:
    """Those massless motions that the closure rows do not resist, or none by more than NEARLY_SINGULAR; one at least.

    Rows as loads/redundancy/self_stress.py scales them.
    """
    number = {body: n for n, body in enumerate(still.bodies)}
    closures = layout.tables["closures"]
    measure = layout.size / lever(layout)
    resisted = np.zeros((len(closures), still.count))
    for k, closure in enumerate(closures):
        f, m, b = rows["f"][k], rows["m"][k], int(closure["b"])
        Q = vectors(closure["q"]) if b < 0 else at.r[b] + at.R[b] @ vectors(closure["q"])
        for body, sign in ((b, 1.0), (int(closure["a"]), -1.0)):
            if body in number:
                n = number[body]
                v = still.v[n] + np.cross(still.omega[n], (Q - at.r[body]) / layout.size, axis=0)
                resisted[k] += sign * (measure * f @ v + m @ still.omega[n])
    free = null_space(resisted, tolerances.NEARLY_SINGULAR)
    return still.among(free if free.shape[1] else np.linalg.svd(resisted)[2][-1:].T)


def lever(layout: Layout) -> float:
    """Mean distance of the cut joints' points from the centres of their bodies [m]; without any, the scene's size."""
    bodies = layout.mechanism.bodies
    cut = [layout.mechanism.joints[k] for k in layout.spanning.cut]
    arms = [p - bodies[i].center for j in cut for i, p in ((j.a, j.p), (j.b, j.q)) if i != GROUND]
    mean = float(np.mean([np.sqrt(a @ a) for a in arms])) if arms else 0.0
    return mean or layout.size


def axes_to_lend(scene: PreparedScene, lacking: Mapping[int, Array]) -> dict[int, Array]:
    """The bodies that massless motions turn, and their axes in any pose of the tree, body axes (k, 3), unit vectors."""
    layout = scene.layout
    none = {name: layout.tables[name][:0] for name in ("closures", "contacts")}
    alone = replace(layout, rows=(), contacts=(), tables=layout.tables | none)
    shift = np.zeros((POSES + 1, layout.n_state))
    rng = np.random.default_rng(SEED)
    for group in layout.tables["groups"]:
        own = slice(group["coordinates"], group["rates"])
        shift[1:, own] = rng.uniform(-1.0, 1.0, shift[1:, own].shape)
    shift /= np.where(layout.weights > 0.0, layout.weights, 1.0)
    poses = Evaluator(alone).recovered(np.zeros(POSES + 1), layout.y0 + shift).bodies
    found: dict[int, list[Array]] = {}
    for one in poses:
        at = TreePoses(one["R"], one["r"])
        for body, turning in massless(scene, lacking, at).axes(at).items():
            found.setdefault(body, []).append(turning)
    return {body: span(np.concatenate(turning)) for body, turning in found.items()}


def lent(scene: PreparedScene, place: int, axes: Array) -> list[dict[str, Any]]:
    """The inertia lent to a body about some axes, such as its mass might have; a row of the kernel's table each."""
    mechanism, i = scene.mechanism, scene.layout.spanning.hangs[place].body
    body = mechanism.bodies[i]
    arms = [p - body.center for j in mechanism.joints for of, p in ((j.a, j.p), (j.b, j.q)) if of == i]
    reach = max([tolerances.LENT_REACH * scene.layout.size, *(float(np.sqrt(a @ a)) for a in arms)])
    inertia = max(body.mass * reach**2, without_inertia(body, scene.layout.size)[1])
    return [{"body": place, "root": math.sqrt(inertia), "axis": axis} for axis in axes]


def rank_of(sigma: Array, least: float) -> int:
    """How many singular values count; `least`: of the largest, or of 1."""
    return int(np.sum(sigma > least * max(1.0, float(sigma.max(initial=0.0)))))


def null_space(A: Array, least: float) -> Array:
    """What A maps to nothing, orthonormal columns."""
    _, sigma, Vt = np.linalg.svd(A, full_matrices=True)
    return Vt[rank_of(sigma, least) :].T


def independent(rows: Array) -> Array:
    """As many rows as are independent, with the same null space."""
    _, sigma, Vt = np.linalg.svd(rows, full_matrices=False)
    rank = rank_of(sigma, tolerances.RANK)
    return np.asarray(sigma[:rank, None] * Vt[:rank])


def span(rows: Array) -> Array:
    """Unit vectors that span the rows, (k, 3); an axis alone points the way of its largest component."""
    _, S, Vt = np.linalg.svd(rows, full_matrices=False)
    found = Vt[S > tolerances.RANK * float(S[0])]
    return found if len(found) > 1 else found * np.sign(found[0, np.argmax(np.abs(found[0]))]) + 0.0
