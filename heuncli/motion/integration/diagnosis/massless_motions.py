"""Find freedoms without inertia: motions of the tree that turn bodies about axes without inertia and move no mass.

Those bodies get some artificial inertia, so that the tree can be factored. The loads that it takes are given back
(kernel/response.py, weigh_lent), so the result is unchanged. If the closed loops hold those bodies, a solution exists.
If nothing holds them, no acceleration exists, and the error says which bodies turn about which axes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import compute_null_space, count_rank
from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.mechanism.loads import GROUND, PointLoad, RopeLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, find_massless_axes, find_missing_inertia
from heuncli.multibody.tree.tables import Table, make_table, vector_array
from heuncli.results.results import Array

POSES = 3  # searched for axes besides the start, because those of one pose may be a coincidence
SEED = 1901  # fixed: the same scene is solved in the same way


@record
class TreePoses:
    """Positions of the bodies in tree order: attitudes R (n, 3, 3), joint points r (n, 3)."""

    R: Array
    r: Array


@record
class MasslessMotions:
    """k independent motions of the tree that move no mass; all bodies that are not listed rest.

    bodies (n): their numbers in the tree
    omega, v (n, 3, k): angular velocity, and velocity of the joint point divided by the scene's size
    """

    bodies: list[int]
    omega: Array
    v: Array

    @property
    def count(self) -> int:
        """Number of motions."""
        return int(self.omega.shape[2])

    def combine(self, N: Array) -> MasslessMotions:
        """Return combinations of the motions, N (k, other)."""
        return MasslessMotions(self.bodies, self.omega @ N, self.v @ N)

    def find_body_velocities(
        self, body: int, point: Array | None, poses: TreePoses, size: float
    ) -> tuple[Array, Array]:
        """Return of a body (-1: the ground) its angular velocities, and velocities of its point divided by the size,
        (3, k).
        """
        if body not in self.bodies:
            return np.zeros((3, self.count)), np.zeros((3, self.count))
        n = self.bodies.index(body)
        arm = np.zeros(3) if point is None else (point - poses.r[body]) / size
        return self.omega[n], self.v[n] + np.cross(self.omega[n], arm, axis=0)

    def find_axes(self, poses: TreePoses) -> dict[int, Array]:
        """Return for each body that turns its angular velocities, body axes (k, 3)."""
        turning = np.einsum("nji,njk->nki", poses.R[self.bodies], self.omega)
        largest = np.abs(turning).max(axis=(1, 2), initial=0.0)
        least = tolerances.RANK * largest.max(initial=0.0)
        return {b: turning[n] for n, b in enumerate(self.bodies) if largest[n] > least}


def add_artificial_inertia(scene: PreparedScene, lacking: Mapping[int, Array]) -> PreparedScene:
    """Return the scene with artificial inertia for what massless motions of its tree turn.

    lacking: the bodies that lack inertia, and their axes without it

    Raises SolveError [no-inertia] where a body without mass can shift without turning.
    """
    layout, poses = scene.layout, start_poses(scene)
    # the parent of the first body that turns is at rest; mostly the body itself resists
    own_resistances = (
        find_rest_conditions(layout, i, axes, poses) @ list_freedom_directions(layout, i, poses).T
        for i, axes in lacking.items()
    )
    if not any(compute_null_space(resisted).size for resisted in own_resistances):
        return scene
    motions = find_massless_motions(scene, lacking, poses)
    if not motions.count:
        return scene
    if any(body.mass == 0.0 for body in scene.mechanism.bodies):
        require_turning(scene, motions)
    carried = compute_branch_inertias(scene, poses)
    rows = [
        row
        for body, axes in find_axes_in_any_pose(scene, lacking).items()
        for row in make_artificial_inertia_rows(scene, body, axes, tolerances.ARTIFICIAL_SHARE * carried[body])
    ]
    return replace(
        scene,
        layout=replace(
            layout, tables=layout.tables | {"artificial_inertias": make_table(kernel.ArtificialInertia, rows)}
        ),
    )


def require_turning(scene: PreparedScene, motions: MasslessMotions) -> None:
    """Raise SolveError [no-inertia] if bodies shift and none turns, for artificial inertia only resists turns."""
    shifts = compute_null_space(motions.omega.reshape(-1, motions.count))
    if not shifts.size:
        return
    reach = np.abs(motions.combine(shifts).v).max(axis=(1, 2))
    names = [
        f"bodies.{scene.mechanism.bodies[scene.layout.spanning.links[body].body].name}"
        for body, moved in zip(motions.bodies, reach.tolist(), strict=True)
        if moved > tolerances.RANK * float(reach.max())
    ]
    message = f"a degree of freedom has no inertia: {' and '.join(names)} can shift without moving any mass"
    raise SolveError(Problem("no-inertia", message, hint="give a mass to what shifts, or hold it by a joint"))


def find_loose_axes(scene: PreparedScene, bodies: Table, rows: Table) -> dict[int, Array]:
    """Return the bodies that turn without inertia where nothing holds them, and their axes, body axes (k, 3), unit
    vectors.

    bodies, rows: results for bodies and closure rows at one instant
    """
    poses = TreePoses(bodies["R"], bodies["r"])
    motions = find_massless_motions(scene, find_missing_inertia(scene), poses)
    return {
        i: find_span_vectors(turning)
        for i, turning in find_loose_motions(scene.layout, motions, poses, rows).find_axes(poses).items()
    }


INDIFFERENT = ("ball", "universal", "rod", "weld")  # to spins of a body about their joint points


def is_unloaded_spin(scene: PreparedScene, evaluation: Evaluation, k: int) -> bool:
    """Return whether the free motions at an instant are spins about all points at which bodies are held, and unloaded.

    Such are those of two thin rods on a universal joint: accelerations and reactions do not depend on them, because one
    rod follows the spin that the universal joint passes on from the other.
    """
    layout, bodies = scene.layout, evaluation.bodies[k]
    poses = TreePoses(bodies["R"], bodies["r"])
    free = find_loose_motions(
        layout, find_massless_motions(scene, find_missing_inertia(scene), poses), poses, evaluation.rows[k]
    )
    if free.count != evaluation.massless_count[k] or not leaves_joints_fixed(scene, free, poses):
        return False
    power, scale = np.zeros(free.count), 0.0
    for load, rows in scene.mechanism.iter_load_rows():
        if isinstance(load, RopeLoad):
            rope_part_power, size = compute_rope_power(scene, evaluation, k, load, free, poses)
            power, scale = power + rope_part_power, scale + size
            continue
        for row, load_result in zip(layout.tables["loads"][rows], evaluation.loads[k, rows], strict=True):
            F, M = load_result["force"], load_result["moment"]
            ends = [(row["b"], load_result["at"], 1.0), (row["a"], load_result["from_at"], -1.0)]
            for body, point, sign in ends[:1] if isinstance(load, PointLoad) else ends:
                omega, v = free.find_body_velocities(int(body), point, poses, layout.size)
                power += sign * (F @ v * layout.size + M @ omega)
            scale += float(np.sqrt(F @ F)) * layout.size + float(np.sqrt(M @ M))
    return bool(np.all(np.abs(power) <= tolerances.NO_MOMENT * scale))


def compute_rope_power(
    scene: PreparedScene, evaluation: Evaluation, k: int, load: RopeLoad, free: MasslessMotions, poses: TreePoses
) -> tuple[Array, float]:
    """Return the power of a stretching rope along the motions at an instant, (count,), and the magnitude of its
    loads.
    """
    layout, row = scene.layout, scene.mechanism.rope_load_row(load.name)
    first, value = int(layout.tables["loads"][row]["part"]), float(evaluation.loads["value"][k, row])
    power, scale = np.zeros(free.count), 0.0
    for part in range(first, first + len(load.parts)):
        ends, part_result = layout.tables["parts"][part], evaluation.parts[k, part]
        F, M = value * part_result["f"], value * part_result["m"]
        for body, sign in ((int(ends["b"]), 1.0), (int(ends["a"]), -1.0)):
            omega, v = free.find_body_velocities(body, part_result["Q"], poses, layout.size)
            power += sign * (F @ v * layout.size + M @ omega)
        scale += float(np.sqrt(F @ F)) * layout.size + float(np.sqrt(M @ M))
    return power, scale


def leaves_joints_fixed(scene: PreparedScene, free: MasslessMotions, poses: TreePoses) -> bool:
    """Return whether motions leave all joint points in place, turn no direction that guides another body and change no
    reported angle, such as a pin's or a cylinder's.
    """
    layout = scene.layout
    for joint in scene.mechanism.joints:
        for end, point in ((joint.a, joint.p), (joint.b, joint.q)):
            body = layout.place.get(end, -1)
            if body < 0:
                continue
            joint_point = poses.r[body] + poses.R[body] @ (point - layout.reference[body])
            omega, v = free.find_body_velocities(body, joint_point, poses, layout.size)
            is_guided = joint.kind in ("line", "plane") and end == joint.b
            if np.abs(v).max(initial=0.0) > tolerances.ON_AXIS:
                return False
            if np.abs(omega).max(initial=0.0) > tolerances.RANK and joint.kind not in INDIFFERENT and not is_guided:
                return False
    return True


def start_poses(scene: PreparedScene) -> TreePoses:
    """Return the positions of the bodies at the start."""
    layout, start = scene.layout, scene.start
    order = [h.body for h in layout.spanning.links]
    R = start.rotation[order]
    return TreePoses(R, start.position[order] + np.einsum("nij,nj->ni", R, layout.reference))


def find_massless_motions(scene: PreparedScene, lacking: Mapping[int, Array], poses: TreePoses) -> MasslessMotions:
    """Find the motions of the tree that move no mass.

    lacking: the bodies that lack inertia, and their axes without it

    A body with all its inertia rests in them as the ground does; its freedoms may compensate the motion of its parent.
    From tips to roots: A (turn, shift) = 0 for a body where neither it nor what it carries resists; what its own
    freedoms S cannot compensate is a condition on its parent. From roots to tips: the resulting motions of the
    freedoms.
    """
    layout = scene.layout
    parents = layout.bodies["parent"].tolist()
    bodies = [i for i, parent in enumerate(parents) if i in lacking or parent in lacking]
    conditions = {i: [find_rest_conditions(layout, i, lacking.get(i), poses)] for i in bodies}
    free_motions, inverse = {}, {}
    for i in reversed(bodies):
        A, S = np.concatenate(conditions[i]), list_freedom_directions(layout, i, poses).T
        U, sigma, Vt = np.linalg.svd(A @ S, full_matrices=True)
        rank = count_rank(sigma)
        free_motions[i] = S @ Vt[rank:].T
        inverse[i] = S @ (Vt[:rank].T / sigma[:rank]) @ U[:, :rank].T @ A
        if parents[i] in lacking:
            conditions[parents[i]].append(independent_rows(U[:, rank:].T @ A @ make_transfer_matrix(layout, i, poses)))
    motion = np.zeros((len(bodies), 6, sum(free.shape[1] for free in free_motions.values())))
    first = 0
    number = {body: n for n, body in enumerate(bodies) if body in lacking}
    for n, i in enumerate(bodies):
        if parents[i] in number:
            carried_motion = make_transfer_matrix(layout, i, poses) @ motion[number[parents[i]]]
            motion[n] = carried_motion - inverse[i] @ carried_motion
        end = first + free_motions[i].shape[1]
        motion[n, :, first:end] += free_motions[i]
        first = end
    _, sigma, Vt = np.linalg.svd(motion.reshape(6 * len(bodies), first), full_matrices=False)
    return MasslessMotions(bodies, motion[:, :3], motion[:, 3:]).combine(Vt.T / sigma)


def find_rest_conditions(layout: Layout, i: int, axes: Array | None, poses: TreePoses) -> Array:
    """Return the conditions on turn and shift of a body, (n, 6): its centre rests, it turns about `axes` without
    inertia alone. A body without mass has none.
    """
    if axes is not None and layout.mechanism.bodies[layout.spanning.links[i].body].mass == 0.0:
        return np.zeros((0, 6))
    R, c = poses.R[i], layout.mechanism.bodies[layout.spanning.links[i].body].center - layout.reference[i]
    across = np.eye(3) if axes is None else compute_null_space(axes).T
    conditions = np.zeros((3 + len(across), 6))
    conditions[:3, :3], conditions[:3, 3:], conditions[3:, :3] = (
        cross_matrix(R @ c / layout.size),
        np.eye(3),
        across @ R.T,
    )
    return conditions


def cross_matrix(arm: Array) -> Array:
    """Return the matrix of omega x arm."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def make_transfer_matrix(layout: Layout, i: int, poses: TreePoses) -> Array:
    """Return the effect of the parent's turn and shift on a body whose joint is fixed, (6, 6); a ball joint passes no
    turn on.
    """
    matrix = np.eye(6)
    arm = (poses.r[i] - poses.r[layout.bodies["parent"][i]]) / layout.size
    matrix[3:, :3] = cross_matrix(arm)
    if layout.bodies["ball"][i]:
        matrix[:3] = 0.0
    return matrix


def list_freedom_directions(layout: Layout, i: int, poses: TreePoses) -> Array:
    """Return turn and shift from each freedom of a body that is not driven, world axes (n, 6)."""
    row = layout.bodies[i]
    of_parent = poses.R[row["parent"]] if row["parent"] >= 0 else np.eye(3)
    directions = [np.eye(3, 6)] if row["ball"] else []
    for freedom in layout.tables["freedoms"][row["first_freedom"] : row["end_freedom"]]:
        if not freedom["driven"]:
            s = (poses.R[i] if freedom["kind"] == kernel.TURN_IN_BODY else of_parent) @ vector_array(
                freedom["direction"]
            )
            shifts = freedom["kind"] == kernel.SHIFT
            directions.append(np.concatenate([0.0 * s, s] if shifts else [s, 0.0 * s])[None])
    return np.concatenate([np.zeros((0, 6)), *directions])


def find_loose_motions(layout: Layout, motions: MasslessMotions, poses: TreePoses, rows: Table) -> MasslessMotions:
    """Select the massless motions that the closure rows resist by no more than NEARLY_SINGULAR; at least one.

    Rows are scaled as in loads/redundancy/self_stress.py.
    """
    number = {body: n for n, body in enumerate(motions.bodies)}
    closures = layout.tables["closures"]
    measure = layout.size / find_mean_lever(layout)
    resisted = np.zeros((len(closures), motions.count))
    for k, closure in enumerate(closures):
        f, m, b = rows["f"][k], rows["m"][k], int(closure["b"])
        Q = vector_array(closure["q"]) if b < 0 else poses.r[b] + poses.R[b] @ vector_array(closure["q"])
        for body, sign in ((b, 1.0), (int(closure["a"]), -1.0)):
            if body in number:
                n = number[body]
                v = motions.v[n] + np.cross(motions.omega[n], (Q - poses.r[body]) / layout.size, axis=0)
                resisted[k] += sign * (measure * f @ v + m @ motions.omega[n])
    free = compute_null_space(resisted, tolerances.NEARLY_SINGULAR)
    return motions.combine(free if free.shape[1] else np.linalg.svd(resisted)[2][-1:].T)


def find_mean_lever(layout: Layout) -> float:
    """Return the mean distance of the cut joints' points from the centres of their bodies [m]; without any, the scene's
    size.
    """
    bodies = layout.mechanism.bodies
    cut = [layout.mechanism.joints[k] for k in layout.spanning.cut]
    arms = [p - bodies[i].center for j in cut for i, p in ((j.a, j.p), (j.b, j.q)) if i != GROUND]
    mean = float(np.mean([np.sqrt(a @ a) for a in arms])) if arms else 0.0
    return mean or layout.size


def find_axes_in_any_pose(scene: PreparedScene, lacking: Mapping[int, Array]) -> dict[int, Array]:
    """Return the bodies that massless motions turn, and their axes in any pose of the tree, body axes (k, 3), unit
    vectors.
    """
    layout = scene.layout
    none = {name: layout.tables[name][:0] for name in ("closures", "contacts")}
    tree_layout = replace(layout, rows=(), contacts=(), tables=layout.tables | none)
    shift = np.zeros((POSES + 1, layout.n_state))
    rng = np.random.default_rng(SEED)
    for group in layout.tables["groups"]:
        coordinates = slice(group["coordinates"], group["rates"])
        shift[1:, coordinates] = rng.uniform(-1.0, 1.0, shift[1:, coordinates].shape)
    shift /= np.where(layout.weights > 0.0, layout.weights, 1.0)
    poses = Evaluator(tree_layout).evaluate(np.zeros(POSES + 1), layout.y0 + shift).bodies
    turnings: dict[int, list[Array]] = {}
    for pose_bodies in poses:
        pose = TreePoses(pose_bodies["R"], pose_bodies["r"])
        for body, turning in find_massless_motions(scene, lacking, pose).find_axes(pose).items():
            turnings.setdefault(body, []).append(turning)
    return {body: find_span_vectors(np.concatenate(turning)) for body, turning in turnings.items()}


def compute_branch_inertias(scene: PreparedScene, poses: TreePoses) -> list[float]:
    """Return for each body in tree order a bound on the moments of inertia that it carries about its joint point at
    the start [kg m^2]: its own, and those of all bodies beyond it.
    """
    links, bodies = scene.layout.spanning.links, scene.mechanism.bodies
    order = [link.body for link in links]
    centers = scene.start.position[order] + np.einsum(
        "nij,nj->ni", poses.R, np.array([bodies[i].center for i in order]).reshape(-1, 3)
    )
    masses = np.array([bodies[i].mass for i in order])
    moments = np.array([np.trace(bodies[i].inertia) for i in order]) + masses * np.sum(centers**2, axis=1)
    firsts = masses[:, None] * centers
    for k in range(len(links) - 1, -1, -1):
        if (parent := links[k].parent) >= 0:
            for sums in (masses, moments, firsts):
                sums[parent] += sums[k]
    arms = poses.r
    inertias: list[float] = (moments - 2.0 * np.sum(arms * firsts, axis=1) + masses * np.sum(arms**2, axis=1)).tolist()
    return inertias


def make_artificial_inertia_rows(
    scene: PreparedScene, place: int, axes: Array, least: float
) -> list[kernel.ArtificialInertia]:
    """Return artificial inertia for a body about some axes, of the order of its mass's own; one row of the kernel's
    table each.

    least: [kg m^2]; below it the rounding of what the body carries would count as inertia of its own
    """
    mechanism, i = scene.mechanism, scene.layout.spanning.links[place].body
    body = mechanism.bodies[i]
    arms = [p - body.center for j in mechanism.joints for end, p in ((j.a, j.p), (j.b, j.q)) if end == i]
    reach = max([tolerances.ARTIFICIAL_RADIUS * scene.layout.size, *(float(np.sqrt(a @ a)) for a in arms)])
    mass = body.mass or max(other.mass for other in mechanism.bodies)
    inertia = max(least, mass * reach**2, find_massless_axes(body, scene.layout.size)[1])
    return [kernel.ArtificialInertia(body=place, root=math.sqrt(inertia), axis=axis) for axis in axes]


def independent_rows(rows: Array) -> Array:
    """Return as many rows as are independent, with the same null space."""
    _, sigma, Vt = np.linalg.svd(rows, full_matrices=False)
    rank = count_rank(sigma)
    return np.asarray(sigma[:rank, None] * Vt[:rank])


def find_span_vectors(rows: Array) -> Array:
    """Return unit vectors that span the rows, (k, 3); the largest component of a single axis is positive."""
    _, S, Vt = np.linalg.svd(rows, full_matrices=False)
    vectors = Vt[S > tolerances.RANK * float(S[0])]
    return vectors if len(vectors) > 1 else vectors * np.sign(vectors[0, np.argmax(np.abs(vectors[0]))]) + 0.0
