"""Find where coordinates fail: dead centres of closed chains, half turns and gimbal locks of attitudes."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.motion_diagnostics.twists import Twists, closure_rows, compute_twists
from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.islands import loop_bodies
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows


@record
class Loop:
    """An island with its freedoms (including driven ones), its rows that are not drives, and its coordinates."""

    freedoms: Indices
    unit: Array  # of the freedoms: 1 of a turn, the size of a shift
    rows: Indices
    coordinates: tuple[tuple[int, str], ...]  # joint, and angle or travel


def find_loops(layout: Layout) -> list[Loop]:
    """Return the islands whose joints have coordinates."""
    loops = []
    for island in layout.islands:
        bodies, joints = find_loop_parts(layout, island)
        freedoms, unit = find_freedoms(layout, bodies)
        rows = [r for r in island.rows.tolist() if not layout.tables["closures"]["program"]["count"][r]]
        coordinates = [(k, name) for k in joints for name in JOINTS[layout.mechanism.joints[k].kind].coordinates]
        angles_and_travels = tuple((k, name) for k, name in coordinates if name in ("angle", "travel"))
        if len(angles_and_travels) > 1 and rows:
            loops.append(Loop(np.array(freedoms), np.array(unit), np.array(rows), angles_and_travels))
    return loops


def find_loop_parts(layout: Layout, island: Island) -> tuple[list[int], list[int]]:
    """Return the bodies (tree order) and the joints of an island's loops."""
    closing_joints = {layout.rows[row] for row in island.rows.tolist()}
    bodies = sorted({body for k in closing_joints for body in loop_bodies(layout, k)})
    joints = closing_joints | {layout.spanning.links[body].joint for body in bodies} - {-1}
    return bodies, sorted(k for k in joints if k < len(layout.mechanism.joints))  # and no couplings


def find_freedoms(layout: Layout, bodies: list[int]) -> tuple[list[int], list[float]]:
    """Return the freedoms of bodies, by their index in the solution, and the unit of each."""
    freedoms, unit = [], []
    table = layout.tables["freedoms"]
    for body in layout.bodies[bodies]:
        turns = 3 if body["ball"] else 0
        freedoms += [int(body["velocity_at"]) + i for i in range(turns)]
        unit += [1.0] * turns
        for j in range(int(body["first_freedom"]), int(body["end_freedom"])):
            freedoms.append(int(table["velocity_at"][j]))
            unit.append(layout.size if table["kind"][j] == kernel.SHIFT else 1.0)
    return freedoms, unit


def compute_loop_motions(layout: Layout, loop: Loop, recovered: Evaluation) -> tuple[Array, Array]:
    """Return the shares of a loop's coordinates and freedoms in its motion, (n_t, c + n), and the number of motions.

    nan unless the coordinates take part in exactly one motion. The sign at each instant is arbitrary.
    """
    body_twists = compute_twists(layout, recovered)
    J = closure_rows(body_twists, recovered)[:, loop.rows][:, :, loop.freedoms] * loop.unit
    J = J * (recovered.rows["closed"][:, loop.rows] > 0.0)[:, :, None]
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    J = J / np.where(size > 0.0, size, 1.0)
    _, s, V = np.linalg.svd(J, full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=1.0)[:, None]).sum(axis=1)
    c = make_coordinate_rows(body_twists, layout, loop)
    n = len(loop.freedoms)
    shares, count = np.full((len(J), len(loop.coordinates) + n), np.nan), np.zeros(len(J), dtype=int)
    for r in np.unique(rank).tolist():
        instants = np.flatnonzero(rank == r)
        if r == n:
            continue
        T = V[instants, r:].swapaxes(1, 2)
        _, sizes, v = np.linalg.svd(c[instants] @ T, full_matrices=False)
        moving = sizes > tolerances.RANK
        count[instants] = moving.sum(axis=1)
        is_single = moving.sum(axis=1) == 1
        x = np.einsum("tij,tj->ti", T, v[:, 0])
        single_shares = np.concatenate([np.einsum("tci,ti->tc", c[instants], x), x], axis=1)
        shares[instants[is_single]] = single_shares[is_single]
    return shares, count


def make_coordinate_rows(body_twists: Twists, layout: Layout, loop: Loop) -> Array:
    """Return the rows of a loop's coordinates on its freedoms, travels divided by the scene's size, (n_t, c, n)."""
    rows = np.zeros((len(body_twists.turn), len(loop.coordinates), len(loop.freedoms)))
    for i, (k, name) in enumerate(loop.coordinates):
        joint = layout.mechanism.joints[k]
        axis, Q = body_twists.to_world(joint.a, joint.axis), body_twists.locate_point(joint.b, joint.q)
        (turn_a, shift_a), (turn_b, shift_b) = body_twists.point_twist(joint.a, Q), body_twists.point_twist(joint.b, Q)
        relative_motion = turn_b - turn_a if name == "angle" else (shift_b - shift_a) / layout.size
        rows[:, i] = np.einsum("tni,ti->tn", relative_motion, axis)[:, loop.freedoms] * loop.unit
    return rows


def continue_signs(shares: Array, previous: Array | None = None) -> Array:
    """Return shares with continuous signs; previous (n,): the share before the first."""
    first = np.nan_to_num(shares if previous is None else np.vstack([previous, shares]))
    turned = np.sum(first[1:] * first[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(turned, -1.0, 1.0)]))
    return np.asarray(shares * (sign if previous is None else sign[1:])[:, None])


SEQUENCES = {"zxz": 2, "zyx": 0}  # the body axis that is parallel to the world's z at gimbal lock


def to_quaternions(R: Array) -> Array:
    """Return the quaternions (n_t, 4) of attitudes along a motion, (n_t, 3, 3), with continuous signs."""
    trace = np.trace(R, axis1=1, axis2=2)
    diagonal = np.diagonal(R, axis1=1, axis2=2)
    squares = np.concatenate([1.0 + trace[:, None], 1.0 - trace[:, None] + 2.0 * diagonal], axis=1)  # 4 q_i^2
    K = np.empty((len(R), 4, 4))  # 4 q_i q_j
    K[:, range(4), range(4)] = squares
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        K[:, 0, 1 + i] = K[:, 1 + i, 0] = R[:, k, j] - R[:, j, k]
        K[:, 1 + i, 1 + j] = K[:, 1 + j, 1 + i] = R[:, i, j] + R[:, j, i]
    best = np.argmax(squares, axis=1)
    rows = np.arange(len(R))
    q = K[rows, best] / (2.0 * np.sqrt(squares[rows, best]))[:, None]
    turns = np.sum(q[1:] * q[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(turns, -1.0, 1.0)]))
    return np.asarray(q * sign[:, None])


def project_axis(R: Array, omega: Array, axis: int) -> tuple[Array, Array]:
    """Return the horizontal part (n_t, 2) of a body's axis, and its rate; its length is sin delta."""
    c = R[:, :, axis]
    return c[:, :2], cross_rows(omega, c)[:, :2]


def compute_condition(sine: Array | float) -> Array:
    """Return the condition cot(delta / 2) of the angle matrix, from sin delta."""
    s = np.asarray(sine, dtype=float)
    with np.errstate(divide="ignore"):
        return np.asarray((1.0 + np.sqrt(np.maximum(1.0 - s * s, 0.0))) / s)
